/* map_identity.c: which files a run is about, and whether they are still what they were. SPDX-License-Identifier: MIT
 *
 * Three answers, each for its question. Is this the run that the work folder is of? Roles, names, sizes and shapes, in the
 * manifest, and the content of what all texels share. Are the data of a tile those that it was fitted to? A hash of what
 * was read for it, kept with the tile: times and sizes can be restored, a stack may be larger than memory, and its tiles
 * are read anyway. Did a file change under a run? What the system says of it, the time of its last change (st_ctime, which
 * nobody can set) included, before and after. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "map.h"
#include "tell.h"

struct cli_map_input {
    char *path;
    struct stat about;
};

/* Of a name: a line of it could pass for an option. */
static void add_on_one_line(struct cli_text *text, const char *string)
{
    for (; *string != '\0'; string++) {
        brdffit_cli_text_add(text, *string == '\n' ? " " : string, 1);
    }
}

void brdffit_cli_map_watch(struct cli_map *map, const char *path)
{
    struct cli_map_input *const more = realloc(map->inputs, (map->input_count + 1) * sizeof *more);
    char *const copy = strdup(path);
    if (more != NULL) {
        map->inputs = more;
    }
    if (more == NULL || copy == NULL) {
        free(copy);
        map->identity.failed = 1;
        return;
    }
    struct cli_map_input *const input = &more[map->input_count++];
    input->path = copy;
    if (stat(path, &input->about) != 0) {
        memset(&input->about, 0, sizeof input->about);
    }
}

void brdffit_cli_map_record(struct cli_map *map, const char *role, const char *path, const brdffit_array *array)
{
    static const struct stat none;
    const struct stat about = map->input_count > 0 ? map->inputs[map->input_count - 1].about : none;
    brdffit_cli_text_printf(&map->identity, "%s ", role);
    add_on_one_line(&map->identity, path);
    brdffit_cli_text_printf(&map->identity, ": %lld bytes", (long long)about.st_size);
    if (array != NULL) {
        brdffit_cli_text_printf(&map->identity, ", %c%d, ", array->kind, array->item_size);
        brdffit_cli_map_shape(&map->identity, array);
    }
    brdffit_cli_text_puts(&map->identity, "\n");
    brdffit_cli_text_printf(&map->times, "time of %s ", role);
    add_on_one_line(&map->times, path);
    brdffit_cli_text_printf(&map->times, ": %lld.%09ld\n", (long long)about.st_mtim.tv_sec,
                            (long)about.st_mtim.tv_nsec);
}

uint64_t brdffit_cli_map_hash(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *at = data;
    for (; size >= 8; size -= 8, at += 8) {
        uint64_t word;
        memcpy(&word, at, 8);
        hash = (hash ^ word) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 29;
    }
    for (; size > 0; size--) {
        hash = (hash ^ *at++) * UINT64_C(1099511628211);
    }
    return hash ^ hash >> 32;
}

void brdffit_cli_map_record_content(struct cli_map *map, const char *role, const void *data, size_t size)
{
    brdffit_cli_text_printf(&map->identity, "content of %s: %016llx\n", role,
                            (unsigned long long)brdffit_cli_map_hash(size, data, size));
}

static int same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec &&
           a->st_ctim.tv_sec == b->st_ctim.tv_sec && a->st_ctim.tv_nsec == b->st_ctim.tv_nsec;
}

int brdffit_cli_map_unchanged(const struct cli_map *map)
{
    for (size_t i = 0; i < map->input_count; i++) {
        struct stat now;
        memset(&now, 0, sizeof now);
        if (stat(map->inputs[i].path, &now) != 0 ? map->inputs[i].about.st_ino != 0
                                                 : !same(&now, &map->inputs[i].about)) {
            brdffit_cli_tell("brdffit: %s: the file changed while it was read, and no maps were written. The same "
                             "command fits what differs, and keeps the other tiles in %s\n",
                             map->inputs[i].path, map->work);
            return CLI_EXIT_FAILURE;
        }
    }
    return 0;
}

void brdffit_cli_map_forget_inputs(struct cli_map *map)
{
    for (size_t i = 0; i < map->input_count; i++) {
        free(map->inputs[i].path);
    }
    free(map->inputs);
    map->inputs = NULL;
    map->input_count = 0;
}
