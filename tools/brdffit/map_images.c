/* map_images.c: a stack that is a file a sample, in a folder by name or as a
 * list says. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "map.h"
#include "tell.h"

static int ends_with(const char *name, const char *end)
{
    const size_t n = strlen(name), e = strlen(end);
    return n > e && strcmp(name + n - e, end) == 0;
}

static int add_image(struct cli_map *map, const char *folder, size_t folder_length, const char *name, size_t length)
{
    if ((map->samples & (map->samples + 1)) == 0 || map->images == NULL) { /* room doubles */
        char **more = realloc(map->images, 2 * (map->samples + 1) * sizeof *more);
        if (more == NULL) {
            return brdffit_cli_no_memory();
        }
        map->images = more;
    }
    char *path = malloc(folder_length + length + 2);
    if (path == NULL) {
        return brdffit_cli_no_memory();
    }
    const int absolute = name[0] == '/' || folder_length == 0;
    (void)sprintf(path, "%.*s%s%.*s", absolute ? 0 : (int)folder_length, folder,
                  absolute || folder[folder_length - 1] == '/' ? "" : "/", (int)length, name);
    map->images[map->samples++] = path;
    return 0;
}

/* ---- A list ------------------------------------------------------------ */

/* The field at `at`, quotes off; returns where it ends. */
static const char *field(const char *at, const char *end, char separator, const char **text, size_t *length)
{
    const char *stop = at;
    int quoted = 0;
    for (; stop < end && (quoted || *stop != separator); stop++) {
        quoted ^= *stop == '"';
    }
    const char *first = at, *last = stop;
    while (first < last && (*first == ' ' || *first == '"')) {
        first++;
    }
    while (last > first && (last[-1] == ' ' || last[-1] == '"' || last[-1] == '\r')) {
        last--;
    }
    *text = first;
    *length = (size_t)(last - first);
    return stop;
}

/* Copy a line without its field number `column`, which goes to text. */
static int cut(struct cli_text *out, const char *line, const char *end, char separator, size_t column,
               const char **text, size_t *length)
{
    const char *name;
    size_t size;
    int found = 0, written = 0;
    for (size_t i = 0; line <= end; i++) {
        const char *stop = field(line, end, separator, &name, &size);
        if (i == column) {
            *text = name;
            *length = size;
            found = 1;
        } else {
            brdffit_cli_text_add(out, &separator, (size_t)(written++ > 0));
            brdffit_cli_text_add(out, line, (size_t)(stop - line));
        }
        line = stop + 1;
    }
    brdffit_cli_text_puts(out, "\n");
    return found;
}

static int find_column(const char *line, const char *end, char separator, size_t *column)
{
    const char *name;
    size_t size;
    for (size_t i = 0; line <= end; i++) {
        line = field(line, end, separator, &name, &size) + 1;
        if (size == 4 && memcmp(name, "file", 4) == 0) {
            *column = i;
            return 1;
        }
    }
    return 0;
}

int brdffit_cli_map_take_files(struct cli_map *map, struct cli_text *list, const char *path, const char *folder,
                               int *found)
{
    const char *at = brdffit_cli_text_string(list), *const all = at + list->size;
    const char *const slash = strrchr(path, '/');
    const size_t folder_length = folder != NULL ? strlen(folder) : slash != NULL ? (size_t)(slash - path) + 1 : 0;
    struct cli_text out = {0};
    char separator = 0;
    size_t column = 0;
    int code = 0;
    *found = 0;
    for (size_t number = 1; code == 0 && at < all; number++) {
        const char *end = memchr(at, '\n', (size_t)(all - at));
        const char *name = "";
        size_t length = 0;
        end = end != NULL ? end : all;
        const size_t blank = strspn(at, " \t\r\xef\xbb\xbf");
        if (*at == '#' || at + blank >= end) {
            brdffit_cli_text_puts(&out, "#\n"); /* keeps the numbers of the lines */
        } else if (separator == 0) {
            separator = memchr(at, '\t', (size_t)(end - at)) != NULL  ? '\t'
                        : memchr(at, ';', (size_t)(end - at)) != NULL ? ';'
                                                                      : ',';
            if (!find_column(at, end, separator, &column)) {
                break;
            }
            *found = 1;
            (void)cut(&out, at, end, separator, column, &name, &length);
        } else if (!cut(&out, at, end, separator, column, &name, &length) || length == 0) {
            brdffit_cli_tell("brdffit: %s: line %zu: no file is named\n", path, number);
            code = CLI_EXIT_DATA;
        } else {
            code = add_image(map, folder != NULL ? folder : path, folder_length, name, length);
        }
        at = end + 1;
    }
    if (code == 0 && out.failed) {
        code = brdffit_cli_no_memory();
    }
    if (*found && code == 0) {
        brdffit_cli_text_free(list);
        *list = out;
    } else {
        brdffit_cli_text_free(&out);
    }
    return code;
}

/* ---- A folder ---------------------------------------------------------- */

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static int is_image(const char *name)
{
    return name[0] != '.' && (ends_with(name, ".pfm") || ends_with(name, ".png") || ends_with(name, ".npy"));
}

int brdffit_cli_map_folder(struct cli_map *map, const char *folder)
{
    DIR *const stream = opendir(folder);
    int code = 0;
    if (stream == NULL) {
        brdffit_cli_tell("brdffit: %s: cannot open the folder (%s)\n", folder, strerror(errno));
        return CLI_EXIT_FAILURE;
    }
    for (const struct dirent *entry; code == 0 && (entry = readdir(stream)) != NULL;) {
        if (is_image(entry->d_name)) {
            code = add_image(map, folder, strlen(folder), entry->d_name, strlen(entry->d_name));
        }
    }
    (void)closedir(stream);
    if (code == 0 && map->samples == 0) {
        brdffit_cli_tell("brdffit: %s: there is no .pfm, .png or .npy in the folder\n", folder);
        code = CLI_EXIT_DATA;
    }
    if (code == 0) {
        qsort(map->images, map->samples, sizeof *map->images, by_name);
    }
    return code;
}

/* ---- Their shapes ------------------------------------------------------ */

static int image_shape(struct cli_map *map, const char *path, size_t shape[3])
{
    brdffit_array *array = NULL;
    if (ends_with(path, ".png")) {
        brdffit_cli_map_watch(map, path);
        brdffit_cli_map_record(map, map->settings->srgb ? "sRGB image" : "image", path, NULL);
        return brdffit_cli_png_shape(path, shape);
    }
    int code = brdffit_cli_map_array(map, "image", path, &array);
    if (code == 0 && array->dims != 2 && array->dims != 3) {
        brdffit_cli_tell("brdffit: %s: an image has height x width x channels, or height x width\n", path);
        code = CLI_EXIT_DATA;
    }
    if (code == 0) {
        memcpy(shape, array->shape, 2 * sizeof *shape);
        shape[2] = array->dims == 3 ? array->shape[2] : 1;
    }
    brdffit_io_array_close(array);
    return code;
}

int brdffit_cli_map_images(struct cli_map *map)
{
    size_t first[3] = {0}, shape[3];
    map->png = ends_with(map->images[0], ".png");
    for (size_t i = 0; i < map->samples; i++) {
        const char *const path = map->images[i];
        const int code = image_shape(map, path, i == 0 ? first : shape);
        if (code != 0) {
            return code;
        }
        if (ends_with(path, ".png") != map->png) {
            brdffit_cli_tell("brdffit: %s: PNG and other images do not mix in a stack\n", path);
            return CLI_EXIT_DATA;
        }
        if (i > 0 && memcmp(first, shape, sizeof first) != 0) {
            brdffit_cli_tell("brdffit: %s: it is %zu x %zu x %zu, and the first image, %s, is %zu x %zu x %zu\n", path,
                             shape[0], shape[1], shape[2], map->images[0], first[0], first[1], first[2]);
            return CLI_EXIT_DATA;
        }
    }
    map->height = first[0];
    map->width = first[1];
    map->channels = first[2];
    return 0;
}
