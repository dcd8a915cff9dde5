/* map_work.c: the folder that an unfinished run leaves beside its output, so
 * that the next one can go on. SPDX-License-Identifier: MIT
 *
 *     manifest    what is fitted and how: a run that differs may not go on; and the files' times, in which only parts
 *                 have to agree, as each tile knows the data that it was fitted to
 *     lock        locked by the process that works here, if one does
 *     tile-N      rows of maps: header, counts, values, statuses, checksum
 *     images.npy  PNG, unpacked
 *     out/        the maps, once every tile is there
 *
 * A tile is written under another name, synced and renamed: it is there whole
 * or not at all, whenever the process or the machine ends. One that is
 * damaged all the same, of another run, or of other data, is fitted again.
 *
 * The folder may be where others write, too (/tmp): it has to be a folder, not a link to one, and this user's; what is
 * written in it is a new file each time, whatever stands under its name, and no link is followed. */
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
#include "tell.h"
#include "temporary.h"

static int complain(const char *path, const char *what)
{
    brdffit_cli_tell("brdffit: %s: %s (%s)\n", path, what, strerror(errno));
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
    brdffit_cli_text_puts(text, brdffit_cli_text_string(&map->times));
    brdffit_cli_record_options(text, &map->options);
    brdffit_cli_text_printf(text, "--values %s\n--tile %zu\n",
                            brdffit_cli_choice_name(brdffit_cli_quantity_choices, (int)map->geometry.quantity),
                            map->tile_rows);
    brdffit_cli_text_printf(text, "maps of %zu x %zu x %zu x %zu: %s\n", map->samples, map->height, map->width,
                            map->channels, map->settings->files[0]);
}

static const char time_line[] = "time of ";

static int is_time(const char *line)
{
    return strncmp(line, time_line, strlen(time_line)) == 0;
}

uint64_t brdffit_cli_map_key(const char *manifest)
{
    uint64_t key = 1;
    while (*manifest != '\0') {
        const size_t length = strcspn(manifest, "\n");
        key = is_time(manifest) ? key : brdffit_cli_map_hash(key, manifest, length);
        manifest += length + (manifest[length] != '\0');
    }
    return key;
}

/* The first line in which the two differ, in `before` and `now`; with `times`, of those too. 0: none. */
static int differ(const char **before, const char **now, int times)
{
    while (**before != '\0' || **now != '\0') {
        const size_t b = strcspn(*before, "\n"), n = strcspn(*now, "\n");
        if ((b != n || memcmp(*before, *now, b) != 0) && (times || !is_time(*before) || !is_time(*now))) {
            return 1;
        }
        *before += b + ((*before)[b] != '\0');
        *now += n + ((*now)[n] != '\0');
    }
    return 0;
}

/* Parts that were fitted to files of different times are not put together unseen: nobody reads the files then. */
static int compare(const struct cli_map *map, const char *before, const char *now)
{
    if (!differ(&before, &now, map->settings->shard != NULL)) {
        return 0;
    }
    brdffit_cli_tell("brdffit: %s holds an unfinished run that differs:\n  then: %.*s\n  now:  %.*s\n"
                     "Repeat its options to go on with it, or start over with --fresh.\n",
                     map->work, (int)strcspn(before, "\n"), before, (int)strcspn(now, "\n"), now);
    return CLI_EXIT_USAGE;
}

static int put_manifest(const char *path, const struct cli_text *text)
{
    struct cli_output output;
    if (brdffit_cli_output_replace(&output, path) != 0) {
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
    if (path == NULL || now.failed || map->identity.failed || map->times.failed) {
        code = brdffit_cli_no_memory();
    } else if (lstat(path, &about) == 0) {
        code = brdffit_cli_slurp(&before, path);
        if (code == 0) {
            code = compare(map, brdffit_cli_text_string(&before), now.data);
        }
    }
    if (code == 0 && strcmp(brdffit_cli_text_string(&before), now.data) != 0) {
        code = put_manifest(path, &now);
    }
    map->key = brdffit_cli_map_key(brdffit_cli_text_string(&now));
    free(path);
    brdffit_cli_text_free(&now);
    brdffit_cli_text_free(&before);
    return code;
}

/* ---- The folder -------------------------------------------------------- */

static int is_ours(const char *name)
{
    return strncmp(name, "tile-", 5) == 0 || strcmp(name, "manifest") == 0 || strcmp(name, "images.npy") == 0 ||
           strncmp(name, ".brdffit-", 9) == 0;
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
    map->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    int code = map->lock < 0 ? complain(path, "cannot create the lock") : 0;
    if (code == 0 && fcntl(map->lock, F_SETLK, &lock) != 0) {
        brdffit_cli_tell("brdffit: %s: another brdffit map is at work on this output\n", map->work);
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

/* Whose files would be read and replaced there? */
static int check_folder(const struct cli_map *map)
{
    struct stat about;
    const char *what = NULL;
    if (lstat(map->work, &about) != 0) {
        return complain(map->work, "cannot use the work folder");
    }
    if (S_ISLNK(about.st_mode)) {
        what = "it is a link";
    } else if (!S_ISDIR(about.st_mode)) {
        what = "it is no folder";
    } else if (about.st_uid != geteuid()) {
        what = "it belongs to another user";
    }
    if (what == NULL) {
        return 0;
    }
    brdffit_cli_tell("brdffit: %s: %s, and no work folder of yours: remove it, or choose another --output\n", map->work,
                     what);
    return CLI_EXIT_FAILURE;
}

int brdffit_cli_map_reopen(struct cli_map *map, const char *target)
{
    struct stat about;
    const int code = name_work(map, target);
    if (code != 0) {
        return code;
    }
    if (stat(map->work, &about) != 0 || !S_ISDIR(about.st_mode)) {
        brdffit_cli_tell("brdffit merge: there is no %s: no part of 'brdffit map --shard' was done, or the maps are "
                         "together already\n",
                         map->work);
        return CLI_EXIT_FAILURE;
    }
    const int ours = check_folder(map);
    return ours != 0 ? ours : take_lock(map);
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
    code = check_folder(map);
    if (code == 0) {
        code = take_lock(map);
    }
    if (code != 0) {
        return code;
    }
    char *const inside = brdffit_cli_map_path(map, "");
    if (inside != NULL) {
        brdffit_cli_sweep(inside);
    }
    free(inside);
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
