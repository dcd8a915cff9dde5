/* map_work.c: the folder that an unfinished run leaves beside its output, so
 * that the next one can go on. SPDX-License-Identifier: MIT
 *
 *     manifest    what is fitted and how: a run that differs may not go on
 *     lock        locked by the process that works here, if one does
 *     tile-N      rows of maps: header, counts, values, statuses, checksum
 *     images.npy  PNG, unpacked
 *     out/        the maps, once every tile is there
 *
 * A tile is written under another name, synced and renamed: it is there whole
 * or not at all, whenever the process or the machine ends. One that is
 * damaged all the same, or of another run, is fitted again. */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "map.h"
#include "output.h"
#include "slurp.h"

struct tile_header {
    char magic[8];
    uint64_t key, tile, texels, depth;
    struct cli_map_counts counts;
};

static const char tile_magic[8] = "BRDFTIL1";

static int complain(const char *path, const char *what)
{
    fprintf(stderr, "brdffit: %s: %s (%s)\n", path, what, strerror(errno));
    return CLI_EXIT_FAILURE;
}

char *brdffit_cli_map_path(const struct cli_map *map, const char *name)
{
    char *path = malloc(strlen(map->work) + strlen(name) + 2);
    if (path != NULL) {
        (void)sprintf(path, "%s/%s", map->work, name);
    }
    return path;
}

/* ---- The manifest ------------------------------------------------------ */

static void write_manifest(const struct cli_map *map, struct cli_text *text)
{
    brdffit_cli_text_printf(text, "brdffit map 1, version %s\n", brdffit_version());
    brdffit_cli_text_puts(text, brdffit_cli_text_string(&map->identity));
    brdffit_cli_record_options(text, &map->options);
    brdffit_cli_text_printf(text, "--values %s\n--tile %zu\n",
                            brdffit_cli_choice_name(brdffit_cli_quantity_choices, (int)map->geometry.quantity),
                            map->tile_rows);
    brdffit_cli_text_printf(text, "maps of %zu x %zu x %zu x %zu: %s\n", map->samples, map->height, map->width,
                            map->channels, map->settings->files[0]);
}

/* The first line in which the two differ. */
static int refuse(const struct cli_map *map, const char *before, const char *now)
{
    size_t b = 0, n = 0;
    while ((b = strcspn(before, "\n")) == (n = strcspn(now, "\n")) && memcmp(before, now, b) == 0 && before[b] &&
           now[n]) {
        before += b + 1;
        now += n + 1;
    }
    fprintf(stderr,
            "brdffit: %s holds an unfinished run that differs:\n  then: %.*s\n  now:  %.*s\n"
            "Repeat its options to go on with it, or start over with --fresh.\n",
            map->work, (int)b, before, (int)n, now);
    return CLI_EXIT_USAGE;
}

static int put_manifest(const char *path, const struct cli_text *text)
{
    struct cli_output output;
    if (brdffit_cli_output_open(&output, path) != 0) {
        return CLI_EXIT_FAILURE;
    }
    if (brdffit_cli_output_write(&output, text) != 0) {
        brdffit_cli_output_abandon(&output);
        return CLI_EXIT_FAILURE;
    }
    return brdffit_cli_output_commit(&output) != 0 ? CLI_EXIT_FAILURE : 0;
}

static int check_manifest(struct cli_map *map)
{
    struct stat about;
    struct cli_text now = {0}, before = {0};
    char *const path = brdffit_cli_map_path(map, "manifest");
    int code = 0;
    write_manifest(map, &now);
    if (path == NULL || now.failed || map->identity.failed) {
        code = brdffit_cli_no_memory();
    } else if (stat(path, &about) != 0) {
        code = put_manifest(path, &now);
    } else {
        code = brdffit_cli_slurp(&before, path);
        if (code == 0 && strcmp(brdffit_cli_text_string(&before), now.data) != 0) {
            code = refuse(map, brdffit_cli_text_string(&before), now.data);
        }
    }
    map->key = brdffit_cli_text_hash(&now);
    free(path);
    brdffit_cli_text_free(&now);
    brdffit_cli_text_free(&before);
    return code;
}

/* ---- The folder -------------------------------------------------------- */

static int is_ours(const char *name)
{
    return strncmp(name, "tile-", 5) == 0 || strcmp(name, "manifest") == 0 || strcmp(name, "images.npy") == 0 ||
           strncmp(name, ".brdffit-", 9) == 0 || strncmp(name, ".tile-", 6) == 0;
}

/* Remove what a run leaves in `folder`, and no more: everything of ours, or
 * (all) every file of out/. */
static void empty(const char *folder, int all)
{
    DIR *const stream = opendir(folder);
    if (stream == NULL) {
        return;
    }
    const int descriptor = dirfd(stream);
    for (const struct dirent *entry; (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] != '\0' &&
            (all ? strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 : is_ours(entry->d_name))) {
            (void)unlinkat(descriptor, entry->d_name, 0);
        }
    }
    (void)closedir(stream);
}

static void clear(const struct cli_map *map)
{
    char *const out = brdffit_cli_map_path(map, "out");
    if (out != NULL) {
        empty(out, 1);
        (void)rmdir(out);
    }
    free(out);
    empty(map->work, 0);
}

static int take_lock(struct cli_map *map)
{
    char *const path = brdffit_cli_map_path(map, "lock");
    struct flock lock;
    if (path == NULL) {
        return brdffit_cli_no_memory();
    }
    memset(&lock, 0, sizeof lock);
    lock.l_type = map->settings->shard != NULL ? F_RDLCK : F_WRLCK; /* parts may work side by side */
    lock.l_whence = SEEK_SET;
    map->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    int code = map->lock < 0 ? complain(path, "cannot create the lock") : 0;
    if (code == 0 && fcntl(map->lock, F_SETLK, &lock) != 0) {
        fprintf(stderr, "brdffit: %s: another brdffit map is at work on this output\n", map->work);
        code = CLI_EXIT_FAILURE;
    }
    free(path);
    return code;
}

static int name_work(struct cli_map *map, const char *target)
{
    static const char suffix[] = ".brdffit-work";
    map->work = malloc(strlen(target) + sizeof suffix);
    if (map->work == NULL) {
        return brdffit_cli_no_memory();
    }
    (void)sprintf(map->work, "%s%s", target, suffix);
    return 0;
}

int brdffit_cli_map_reopen(struct cli_map *map, const char *target)
{
    struct stat about;
    const int code = name_work(map, target);
    if (code != 0) {
        return code;
    }
    if (stat(map->work, &about) != 0 || !S_ISDIR(about.st_mode)) {
        fprintf(stderr,
                "brdffit merge: there is no %s: no part of 'brdffit map --shard' was done, or the maps are "
                "together already\n",
                map->work);
        return CLI_EXIT_FAILURE;
    }
    return take_lock(map);
}

int brdffit_cli_map_begin(struct cli_map *map, const char *target)
{
    int code = name_work(map, target);
    if (code != 0) {
        return code;
    }
    if (mkdir(map->work, 0777) != 0 && errno != EEXIST) {
        return complain(map->work, "cannot create the work folder");
    }
    code = take_lock(map);
    if (code != 0) {
        return code;
    }
    if (map->settings->fresh) {
        clear(map);
    }
    code = check_manifest(map);
    for (size_t tile = 0; code == 0 && tile < map->tiles; tile++) {
        map->resumed += (size_t)brdffit_cli_map_has_tile(map, tile);
    }
    return code;
}

void brdffit_cli_map_forget(struct cli_map *map)
{
    char *const path = brdffit_cli_map_path(map, "lock");
    clear(map);
    if (path != NULL) {
        (void)unlink(path);
    }
    free(path);
    (void)rmdir(map->work);
}

/* ---- Tiles ------------------------------------------------------------- */

static char *tile_path(const struct cli_map *map, const char *format, size_t tile)
{
    char name[64];
    (void)snprintf(name, sizeof name, format, tile);
    return brdffit_cli_map_path(map, name);
}

static void describe_tile(const struct cli_map *map, size_t tile, struct tile_header *header)
{
    memset(header, 0, sizeof *header);
    memcpy(header->magic, tile_magic, sizeof header->magic);
    header->key = map->key;
    header->tile = tile;
    header->texels = brdffit_cli_map_rows(map, tile) * map->width;
    header->depth = brdffit_cli_map_depth(map);
}

static int put(FILE *file, const void *data, size_t size, unsigned long *crc)
{
    *crc = brdffit_io_crc32(*crc, data, size);
    return fwrite(data, 1, size, file) == size ? 0 : -1;
}

static int get(FILE *file, void *data, size_t size, unsigned long *crc)
{
    if (fread(data, 1, size, file) != size) {
        return -1;
    }
    *crc = brdffit_io_crc32(*crc, data, size);
    return 0;
}

int brdffit_cli_map_keep_tile(const struct cli_map *map, size_t tile, const struct cli_map_counts *counts,
                              const double *values, const unsigned char *status)
{
    struct tile_header header;
    unsigned long crc = 0;
    char *const temporary = tile_path(map, ".tile-%zu", tile), *const path = tile_path(map, "tile-%zu", tile);
    int code = temporary == NULL || path == NULL ? brdffit_cli_no_memory() : 0;
    FILE *const file = code == 0 ? fopen(temporary, "wb") : NULL;
    describe_tile(map, tile, &header);
    header.counts = *counts;
    if (code == 0 && file == NULL) {
        code = complain(temporary, "cannot write");
    }
    if (code == 0) {
        int failed = put(file, &header, sizeof header, &crc) ||
                     put(file, values, header.texels * header.depth * sizeof *values, &crc) ||
                     put(file, status, header.texels, &crc);
        const uint64_t sum = crc;
        failed = failed || fwrite(&sum, sizeof sum, 1, file) != 1 || fflush(file) != 0 || fsync(fileno(file)) != 0;
        if (fclose(file) != 0 || failed || rename(temporary, path) != 0) {
            code = complain(path, "cannot write");
            (void)unlink(temporary);
        }
    }
    free(temporary);
    free(path);
    return code;
}

int brdffit_cli_map_load_tile(const struct cli_map *map, size_t tile, struct cli_map_counts *counts, double *values,
                              unsigned char *status)
{
    struct tile_header header, wanted;
    unsigned long crc = 0;
    uint64_t sum = 0;
    char *const path = tile_path(map, "tile-%zu", tile);
    FILE *const file = path != NULL ? fopen(path, "rb") : NULL;
    free(path);
    if (file == NULL) {
        return -1;
    }
    describe_tile(map, tile, &wanted);
    const size_t doubles = wanted.texels * wanted.depth * sizeof *values;
    const int failed = get(file, &header, sizeof header, &crc) ||
                       memcmp(&header, &wanted, offsetof(struct tile_header, counts)) != 0 ||
                       get(file, values, doubles, &crc) || get(file, status, wanted.texels, &crc) ||
                       fread(&sum, sizeof sum, 1, file) != 1 || sum != crc || fgetc(file) != EOF;
    (void)fclose(file);
    if (!failed && counts != NULL) {
        *counts = header.counts;
    }
    return failed ? -1 : 0;
}

int brdffit_cli_map_has_tile(const struct cli_map *map, size_t tile)
{
    struct stat about;
    const size_t texels = brdffit_cli_map_rows(map, tile) * map->width;
    char *const path = tile_path(map, "tile-%zu", tile);
    const int there = path != NULL && stat(path, &about) == 0;
    free(path);
    if (!there) {
        return 0;
    }
    double *const values = malloc(texels * brdffit_cli_map_depth(map) * sizeof *values);
    unsigned char *const status = malloc(texels);
    const int good = values != NULL && status != NULL &&
                     brdffit_cli_map_load_tile(map, tile, NULL, values, status) == 0;
    free(values);
    free(status);
    return good;
}
