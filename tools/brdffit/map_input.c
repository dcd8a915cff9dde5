/* map_input.c: the stack, its geometry, normals and mask: opened, and every
 * shape held against the others. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "map.h"
#include "reading.h"
#include "slurp.h"
#include "tell.h"
#include "terms.h"

/* Bytes of doubles that a tile of the default size has, about. */
#define TILE_BYTES 16e6

/* Few tiles leave threads idle and keep little of an interrupted run. */
#define TILES_WANTED 16

void brdffit_cli_map_shape(struct cli_text *text, const brdffit_array *array)
{
    for (int d = 0; d < array->dims; d++) {
        brdffit_cli_text_printf(text, d == 0 ? "%zu" : " x %zu", array->shape[d]);
    }
    if (array->dims == 0) {
        brdffit_cli_text_puts(text, "a single number");
    }
}

int brdffit_cli_map_array(struct cli_map *map, const char *role, const char *path, brdffit_array **array)
{
    brdffit_error error = {0};
    struct stat about;
    char *file = strdup(path);
    char *member = file == NULL ? NULL : strrchr(file, ':');
    if (file == NULL) {
        return brdffit_cli_no_memory();
    }
    if (member != NULL && stat(path, &about) != 0) {
        *member++ = '\0';
    } else {
        member = NULL;
    }
    brdffit_cli_map_watch(map, file);
    errno = 0;
    const brdffit_status status = brdffit_io_array_open(file, member, array, &error);
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(path, &error, NULL, errno);
    } else {
        brdffit_cli_map_record(map, role, file, *array);
    }
    free(file);
    return brdffit_cli_status_exit(status);
}

/* "brdffit: FILE: its shape is 3 x 4: WANTED" */
static int wrong_shape(const char *path, const brdffit_array *array, const char *wanted)
{
    struct cli_text shape = {0};
    brdffit_cli_map_shape(&shape, array);
    brdffit_cli_tell("brdffit: %s: its shape is %s, and should be %s\n", path, brdffit_cli_text_string(&shape), wanted);
    brdffit_cli_text_free(&shape);
    return CLI_EXIT_DATA;
}

/* Whether the array has exactly these dimensions. */
static int has_shape(const brdffit_array *array, int dims, const size_t *shape)
{
    return array->dims == dims && memcmp(array->shape, shape, (size_t)dims * sizeof *shape) == 0;
}

/* ---- The stack --------------------------------------------------------- */

static int open_stack(struct cli_map *map, const char *path)
{
    const int code = brdffit_cli_map_array(map, "stack", path, &map->stack);
    if (code != 0) {
        return code;
    }
    const brdffit_array *const a = map->stack;
    if (a->dims != 3 && a->dims != 4) {
        return wrong_shape(path, a, "samples x height x width x channels, or samples x height x width");
    }
    map->samples = a->shape[0];
    map->height = a->shape[1];
    map->width = a->shape[2];
    map->channels = a->dims == 4 ? a->shape[3] : 1;
    return 0;
}

static int is_folder(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

static int is_text_table(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot != NULL && (strcmp(dot, ".csv") == 0 || strcmp(dot, ".txt") == 0 || strcmp(dot, ".tsv") == 0);
}

/* ---- The geometry ------------------------------------------------------ */

static int check_table(struct cli_map *map, const char *path)
{
    const brdffit_samples *s = map->table->samples;
    if (s->count != map->table->rows) {
        brdffit_cli_tell("brdffit: %s: %zu of %zu lines have an empty field: a geometry needs every sample\n", path,
                         map->table->rows - s->count, map->table->rows);
        return CLI_EXIT_DATA;
    }
    map->geometry = *s;
    map->geometry.values = NULL;
    return 0;
}

/* The table of directions; its column of files, if it has one, is the stack. */
static int open_table(struct cli_map *map, const char *path, const char *folder, int *files)
{
    struct cli_text text = {0};
    brdffit_io_options io;
    brdffit_error error = {0};
    brdffit_cli_map_watch(map, path);
    int code = brdffit_cli_slurp(&text, path);
    if (code == 0) {
        brdffit_cli_map_record(map, "geometry", path, NULL);
        brdffit_cli_map_record_content(map, "geometry", brdffit_cli_text_string(&text), text.size);
        code = brdffit_cli_map_take_files(map, &text, path, folder, files);
    }
    if (code == 0) {
        brdffit_io_options_init(&io);
        io.format = BRDFFIT_IO_FORMAT_CSV;
        io.directions_only = 1;
        brdffit_cli_reading_options(map->settings, &io);
        const brdffit_status status = brdffit_io_read_memory(brdffit_cli_text_string(&text), text.size, &io,
                                                             &map->table, &error);
        if (status != BRDFFIT_OK) {
            brdffit_cli_report_error(path, &error, NULL, 0);
        } else if (!map->settings->quiet) {
            brdffit_cli_say_notes(path, map->table, 1);
        }
        code = status == BRDFFIT_OK ? check_table(map, path) : brdffit_cli_status_exit(status);
    }
    brdffit_cli_text_free(&text);
    return code;
}

/* N x 3, N x H x W x 3, or for views 3 and 1 x 3. */
static int open_vectors(struct cli_map *map, const char *role, const char *path, double **vectors,
                        brdffit_array **per_pixel)
{
    const size_t constant[2] = {map->samples, 3}, one[2] = {1, 3};
    const size_t pixels[4] = {map->samples, map->height, map->width, 3};
    brdffit_array *array = NULL;
    brdffit_error error = {0};
    int code = brdffit_cli_map_array(map, role, path, &array);
    if (code != 0) {
        return code;
    }
    if (has_shape(array, 4, pixels)) {
        *per_pixel = array;
        return 0;
    }
    const int single = has_shape(array, 1, one + 1) || has_shape(array, 2, one);
    if (!single && !has_shape(array, 2, constant)) {
        struct cli_text wanted = {0};
        brdffit_cli_text_printf(&wanted, "%zu x 3 (a vector a sample), 3, or %zu x %zu x %zu x 3", map->samples,
                                map->samples, map->height, map->width);
        code = wrong_shape(path, array, brdffit_cli_text_string(&wanted));
        brdffit_cli_text_free(&wanted);
    } else {
        static const size_t zero[2] = {0, 0};
        *vectors = calloc(map->samples, 3 * sizeof **vectors);
        if (*vectors == NULL) {
            code = brdffit_cli_no_memory();
        } else if (brdffit_io_array_read(array, zero, array->shape, *vectors, &error) != BRDFFIT_OK) {
            brdffit_cli_report_error(path, &error, NULL, errno);
            code = CLI_EXIT_FAILURE;
        }
        for (size_t i = 3; code == 0 && single && i < 3 * map->samples; i++) {
            (*vectors)[i] = (*vectors)[i - 3];
        }
        if (code == 0) {
            brdffit_cli_map_record_content(map, role, *vectors, 3 * map->samples * sizeof **vectors);
        }
    }
    brdffit_io_array_close(array);
    return code;
}

static int open_directions(struct cli_map *map)
{
    const struct cli_settings *const s = map->settings;
    int code = open_vectors(map, "lights", s->lights, &map->light, &map->light_map);
    if (code == 0 && s->views != NULL) {
        code = open_vectors(map, "views", s->views, &map->view, &map->view_map);
    }
    if (code != 0) {
        return code;
    }
    if (s->views == NULL) {
        map->view = calloc(map->samples, 3 * sizeof *map->view);
        if (map->view == NULL) {
            return brdffit_cli_no_memory();
        }
        for (size_t i = 0; i < map->samples; i++) {
            map->view[3 * i + 2] = 1;
        }
    }
    brdffit_samples_init(&map->geometry);
    map->geometry.count = map->samples;
    map->geometry.light = map->light;
    map->geometry.view = map->view;
    map->geometry.quantity = s->values != CLI_UNSET ? (brdffit_quantity)s->values : BRDFFIT_QUANTITY_BRDF;
    return 0;
}

/* ---- Maps beside the stack --------------------------------------------- */

static int open_normals(struct cli_map *map, const char *path)
{
    const size_t shape[3] = {map->height, map->width, 3};
    const int code = brdffit_cli_map_array(map, "normals", path, &map->normal_map);
    if (code == 0 && !has_shape(map->normal_map, 3, shape)) {
        struct cli_text wanted = {0};
        brdffit_cli_text_printf(&wanted, "%zu x %zu x 3, as the stack's images are", map->height, map->width);
        const int failed = wrong_shape(path, map->normal_map, brdffit_cli_text_string(&wanted));
        brdffit_cli_text_free(&wanted);
        return failed;
    }
    return code;
}

static int open_mask(struct cli_map *map, const char *path)
{
    const size_t shape[3] = {map->height, map->width, 1};
    const int code = brdffit_cli_map_array(map, "mask", path, &map->mask);
    if (code == 0 && !has_shape(map->mask, 2, shape) && !has_shape(map->mask, 3, shape)) {
        struct cli_text wanted = {0};
        brdffit_cli_text_printf(&wanted, "%zu x %zu, as the stack's images are", map->height, map->width);
        const int failed = wrong_shape(path, map->mask, brdffit_cli_text_string(&wanted));
        brdffit_cli_text_free(&wanted);
        return failed;
    }
    return code;
}

/* ---- Everything -------------------------------------------------------- */

static int check_words(const struct cli_settings *s)
{
    const int from_list = s->geometry == NULL && is_text_table(s->files[0]);
    if (s->lights == NULL && s->geometry == NULL && !from_list) {
        brdffit_cli_tell("brdffit map: needs --geometry FILE.csv or --lights FILE.npy\n");
    } else if (s->lights != NULL && (s->geometry != NULL || from_list)) {
        brdffit_cli_tell("brdffit map: the geometry is given twice, as a table and by --lights\n");
    } else if (s->views != NULL && s->lights == NULL) {
        brdffit_cli_tell("brdffit map: --views needs --lights\n");
    } else {
        return 0;
    }
    brdffit_cli_tell("Try 'brdffit map --help'.\n");
    return CLI_EXIT_USAGE;
}

static int open_images_and_geometry(struct cli_map *map)
{
    const struct cli_settings *const s = map->settings;
    const char *const path = s->files[0];
    const int folder = is_folder(path), list = s->geometry == NULL && s->lights == NULL;
    int code = 0, files = 0;
    if (list || s->geometry != NULL) {
        code = open_table(map, list ? path : s->geometry, folder ? path : NULL, &files);
    }
    if (code != 0) {
        return code;
    }
    if (list && !files) {
        brdffit_cli_tell("brdffit: %s: a list of images needs a column named file\n", path);
        return CLI_EXIT_DATA;
    }
    if (list || folder) {
        if (!files) {
            code = brdffit_cli_map_folder(map, path);
        }
        return code != 0 ? code : brdffit_cli_map_images(map);
    }
    if (files) { /* a column that another stack does not need */
        for (size_t i = 0; i < map->samples; i++) {
            free(map->images[i]);
        }
        free(map->images);
        map->images = NULL;
    }
    return open_stack(map, path);
}

static int check_count(const struct cli_map *map)
{
    const struct cli_settings *const s = map->settings;
    if (map->geometry.count == map->samples) {
        return 0;
    }
    brdffit_cli_tell("brdffit: %s: it has %zu samples, and the geometry of %s has %zu\n", s->files[0], map->samples,
                     s->geometry != NULL ? s->geometry : s->files[0], map->geometry.count);
    return CLI_EXIT_DATA;
}

/* Whether this build can fit so at all (without ECOS some options cannot):
 * asked of the smallest problem there is, before thousands refuse. */
static int check_build(const struct cli_map *map)
{
    static const double up[3] = {0, 0, 1}, one = 1;
    brdffit_samples samples;
    const brdffit_result *result = NULL;
    brdffit_error error = {0};
    brdffit_samples_init(&samples);
    samples.count = samples.channels = 1;
    samples.light = samples.view = up;
    samples.values = &one;
    const brdffit_status status = brdffit_fit_new(&samples, &map->options, &result, &error);
    brdffit_result_free(result);
    if (status != BRDFFIT_ERR_UNSUPPORTED) {
        return 0;
    }
    brdffit_cli_tell("brdffit map: %s\n", brdffit_cli_message(&error));
    return CLI_EXIT_USAGE;
}

static int make_plan(struct cli_map *map)
{
    brdffit_error error = {0};
    const char *const path = map->settings->geometry != NULL ? map->settings->geometry
                             : map->settings->lights != NULL ? map->settings->lights
                                                             : map->settings->files[0];
    brdffit_status status = BRDFFIT_OK;
    if (!map->general) {
        const size_t size = brdffit_plan_size(&map->geometry, &map->options);
        map->plan_memory = malloc(size > 0 ? size : 1);
        if (map->plan_memory == NULL) {
            return brdffit_cli_no_memory();
        }
        status = brdffit_plan_init(&map->geometry, &map->options, map->plan_memory, size, &map->plan, &error);
    } else if (brdffit_workspace_size(map->samples, map->channels, &map->options) == 0) {
        brdffit_cli_tell("brdffit: %s: more samples or channels than can be fitted\n", path);
        return CLI_EXIT_DATA;
    }
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(path, &error, map->table, 0);
    }
    return brdffit_cli_status_exit(status);
}

/* Unfitted samples of a shared geometry; values are not looked at where the
 * weights are all there is to read. */
static void count_skipped(struct cli_map *map)
{
    brdffit_samples copy = map->geometry;
    double *zeros = calloc(copy.count, sizeof *zeros);
    copy.channels = 1;
    copy.values = zeros;
    if (zeros != NULL && !map->general) {
        (void)brdffit_inspect(&copy, &map->options, NULL, map->shared_skipped, BRDFFIT_SKIP_COUNT, NULL);
    }
    free(zeros);
}

/* A tile may not depend on the threads: another number of them must be able
 * to go on where a run ended. */
static void choose_tiles(struct cli_map *map)
{
    const double row = 8.0 * (double)map->width *
                       ((double)map->samples *
                        (double)(map->channels + (map->light_map ? 3 : 0) + (map->view_map ? 3 : 0)));
    const size_t most = (map->height + TILES_WANTED - 1) / TILES_WANTED;
    size_t rows = row < TILE_BYTES ? (size_t)(TILE_BYTES / row) : 1;
    rows = rows < most ? rows : most;
    if (map->settings->tile > 0) {
        rows = map->settings->tile < map->height ? map->settings->tile : map->height;
    }
    map->tile_rows = rows;
    map->tiles = (map->height + rows - 1) / rows;
}

size_t brdffit_cli_map_rows(const struct cli_map *map, size_t tile)
{
    const size_t left = map->height - tile * map->tile_rows;
    return left < map->tile_rows ? left : map->tile_rows;
}

size_t brdffit_cli_map_depth(const struct cli_map *map)
{
    const size_t lobes = (size_t)map->options.lobes;
    const size_t f0 = map->options.fresnel != BRDFFIT_FRESNEL_NONE ? lobes : 0;
    return lobes + map->channels * (1 + lobes + f0 + brdffit_cli_more_columns(map->options.diffuse)) + 2;
}

int brdffit_cli_map_open(struct cli_map *map, const struct cli_settings *settings)
{
    memset(map, 0, sizeof *map);
    map->settings = settings;
    map->lock = -1;
    int code = check_words(settings);
    if (code == 0) {
        code = open_images_and_geometry(map);
    }
    if (code == 0 && settings->lights != NULL) {
        code = open_directions(map);
    }
    if (code == 0) {
        code = check_count(map);
    }
    if (code == 0 && settings->normals != NULL) {
        code = open_normals(map, settings->normals);
    }
    if (code == 0 && settings->mask != NULL) {
        code = open_mask(map, settings->mask);
    }
    if (code != 0) {
        return code;
    }
    brdffit_cli_fit_options(settings, &map->options);
    map->general = map->light_map != NULL || map->view_map != NULL || map->normal_map != NULL;
    map->geometry.channels = map->channels;
    if (map->normal_map != NULL && (map->geometry.form != BRDFFIT_FORM_DIRECTIONS || map->geometry.normal != NULL)) {
        brdffit_cli_tell("brdffit map: --normals needs directions without normals of their own\n");
        return CLI_EXIT_USAGE;
    }
    choose_tiles(map);
    code = check_build(map);
    if (code == 0) {
        code = make_plan(map);
    }
    if (code == 0) {
        count_skipped(map);
    }
    return code;
}

void brdffit_cli_map_close(struct cli_map *map)
{
    brdffit_io_array_close(map->stack);
    brdffit_io_array_close(map->light_map);
    brdffit_io_array_close(map->view_map);
    brdffit_io_array_close(map->normal_map);
    brdffit_io_array_close(map->mask);
    brdffit_io_free(map->table);
    for (size_t i = 0; map->images != NULL && i < map->samples; i++) {
        free(map->images[i]);
    }
    free(map->images);
    free(map->light);
    free(map->view);
    free(map->plan_memory);
    free(map->work);
    brdffit_cli_text_free(&map->identity);
    brdffit_cli_text_free(&map->times);
    brdffit_cli_map_forget_inputs(map);
}
