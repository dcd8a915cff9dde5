/* map_fit.c: one tile from the files to its maps. With a shared geometry the
 * texels go to brdffit_fit_many() together; with directions a texel, each is
 * a fit of its own. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"
#include "map.h"
#include "tell.h"
#include "terms.h"

/* Texels between two looks at whether somebody wants to stop: some
 * milliseconds. Linear and cone programs take that long for one. */
#define BATCH_ONE_LOBE 256
#define BATCH_MORE_LOBES 32
#define BATCH_PROGRAMS 1

struct cli_map_worker {
    const struct cli_map *map;
    double *values;                 /* samples x texels x channels */
    double *light, *view, *normal;  /* samples x texels x 3, the last texels x 3; NULL: shared */
    double *mask_values;
    unsigned char *mask;            /* NULL: all */
    double *out;                    /* depth x texels: sigma, x, y, e2, lower_bound, f0, x_more */
    unsigned char *status;
    size_t *where;
    double *own;                    /* one texel: values, light, view, normal */
    void *workspace;
    size_t workspace_size;
};

static size_t texels_of(const struct cli_map *map)
{
    return map->tile_rows * map->width;
}

static size_t workspace_of(const struct cli_map *map)
{
    return map->general ? brdffit_workspace_size(map->samples, map->channels, &map->options)
                        : brdffit_many_workspace_size(map->plan);
}

size_t brdffit_cli_map_worker_bytes(const struct cli_map *map)
{
    size_t doubles = map->samples * map->channels + brdffit_cli_map_depth(map) + 1;
    doubles += (map->light_map ? 3 * map->samples : 0) + (map->view_map ? 3 * map->samples : 0) +
               (map->normal_map ? 3 : 0) + (map->mask ? 1 : 0);
    return texels_of(map) * (8 * doubles + 2) + workspace_of(map);
}

void brdffit_cli_map_worker_free(struct cli_map_worker *w)
{
    if (w == NULL) {
        return;
    }
    free(w->values);
    free(w->light);
    free(w->view);
    free(w->normal);
    free(w->mask_values);
    free(w->mask);
    free(w->out);
    free(w->status);
    free(w->where);
    free(w->own);
    free(w->workspace);
    free(w);
}

static double *doubles(int wanted, size_t a, size_t b, int *failed)
{
    double *const block = wanted ? calloc(a, b * sizeof *block) : NULL;
    *failed |= wanted && block == NULL;
    return block;
}

struct cli_map_worker *brdffit_cli_map_worker(const struct cli_map *map)
{
    const size_t texels = texels_of(map);
    int failed = 0;
    struct cli_map_worker *const w = calloc(1, sizeof *w);
    if (w == NULL) {
        return NULL;
    }
    w->map = map;
    w->values = doubles(1, map->samples * map->channels, texels, &failed);
    w->light = doubles(map->light_map != NULL, map->samples * 3, texels, &failed);
    w->view = doubles(map->view_map != NULL, map->samples * 3, texels, &failed);
    w->normal = doubles(map->normal_map != NULL, 3, texels, &failed);
    w->mask_values = doubles(map->mask != NULL, 1, texels, &failed);
    w->mask = map->mask != NULL ? calloc(texels, 1) : NULL;
    w->out = doubles(1, brdffit_cli_map_depth(map), texels, &failed);
    w->own = doubles(map->general, map->samples, map->channels + 9, &failed);
    w->status = calloc(texels, 1);
    w->where = calloc(texels, sizeof *w->where);
    w->workspace_size = workspace_of(map);
    w->workspace = malloc(w->workspace_size > 0 ? w->workspace_size : 1);
    if (failed || w->status == NULL || w->where == NULL || w->workspace == NULL || (map->mask && w->mask == NULL)) {
        brdffit_cli_map_worker_free(w);
        return NULL;
    }
    return w;
}

/* ---- Reading ----------------------------------------------------------- */

static int report(const char *path, const brdffit_error *error)
{
    brdffit_cli_report_error(path, error, NULL, errno);
    return brdffit_cli_status_exit(error->status);
}

/* Rows of an array whose dimension `rows_at` is the image's height. */
static int read_rows(const brdffit_array *array, int rows_at, size_t first, size_t rows, double *out, const char *path)
{
    size_t start[BRDFFIT_IO_MAX_DIMS] = {0}, count[BRDFFIT_IO_MAX_DIMS];
    brdffit_error error = {0};
    memcpy(count, array->shape, sizeof count);
    start[rows_at] = first;
    count[rows_at] = rows;
    errno = 0;
    return brdffit_io_array_read(array, start, count, out, &error) == BRDFFIT_OK ? 0 : report(path, &error);
}

/* One file a sample, opened for these rows only: there may be more of them
 * than files that a process may have open. */
static int read_images(struct cli_map_worker *w, size_t first, size_t rows)
{
    const struct cli_map *const map = w->map;
    const size_t step = rows * map->width * map->channels;
    for (size_t i = 0; i < map->samples; i++) {
        brdffit_array *array = NULL;
        brdffit_error error = {0};
        errno = 0;
        if (brdffit_io_array_open(map->images[i], NULL, &array, &error) != BRDFFIT_OK) {
            return report(map->images[i], &error);
        }
        const size_t depth = array->dims == 3 ? array->shape[2] : 1;
        int code = 0;
        if (array->dims < 2 || array->shape[0] != map->height || array->shape[1] != map->width ||
            depth != map->channels) {
            brdffit_cli_tell("brdffit: %s: the image changed while it was read\n", map->images[i]);
            code = CLI_EXIT_DATA;
        } else {
            code = read_rows(array, 0, first, rows, w->values + i * step, map->images[i]);
        }
        brdffit_io_array_close(array);
        if (code != 0) {
            return code;
        }
    }
    return 0;
}

static int read_tile(struct cli_map_worker *w, size_t first, size_t rows)
{
    const struct cli_map *const map = w->map;
    const struct cli_settings *const s = map->settings;
    int code = map->stack != NULL ? read_rows(map->stack, 1, first, rows, w->values, s->files[0])
                                  : read_images(w, first, rows);
    if (code == 0 && map->light_map != NULL) {
        code = read_rows(map->light_map, 1, first, rows, w->light, s->lights);
    }
    if (code == 0 && map->view_map != NULL) {
        code = read_rows(map->view_map, 1, first, rows, w->view, s->views);
    }
    if (code == 0 && map->normal_map != NULL) {
        code = read_rows(map->normal_map, 0, first, rows, w->normal, s->normals);
    }
    if (code == 0 && map->mask != NULL) {
        code = read_rows(map->mask, 0, first, rows, w->mask_values, s->mask);
    }
    for (size_t i = 0; code == 0 && map->mask != NULL && i < rows * map->width; i++) {
        w->mask[i] = w->mask_values[i] > 0 || w->mask_values[i] < 0; /* NaN masks too */
    }
    return code;
}

/* ---- Fitting ----------------------------------------------------------- */

/* Where the maps of `texels` texels begin in `out`. */
static void lay_out(const struct cli_map *map, double *out, size_t texels, brdffit_texel_results *r)
{
    const size_t lobes = (size_t)map->options.lobes;
    brdffit_texel_results_init(r);
    r->sigma = out;
    r->x = r->sigma + texels * lobes;
    r->y = r->x + texels * map->channels;
    r->e2 = r->y + texels * map->channels * lobes;
    r->lower_bound = r->e2 + texels;
    r->f0 = map->options.fresnel ? r->lower_bound + texels : NULL;
    r->x_more = r->lower_bound + texels * (1 + (r->f0 != NULL ? map->channels * lobes : 0));
}

/* The same results `at` texels further on. */
static brdffit_texel_results behind(const struct cli_map *map, const brdffit_texel_results *all, size_t at)
{
    const size_t lobes = (size_t)map->options.lobes;
    brdffit_texel_results r = *all;
    r.sigma += at * lobes;
    r.x += at * map->channels;
    r.y += at * map->channels * lobes;
    r.e2 += at;
    r.lower_bound += at;
    r.f0 = r.f0 != NULL ? r.f0 + at * map->channels * lobes : NULL;
    r.x_more += at * map->channels * brdffit_cli_more_columns(map->options.diffuse);
    r.status += at;
    r.where += at;
    return r;
}

static void note_bad(struct cli_map_counts *counts, const struct cli_map_worker *w, size_t first_texel, size_t texel)
{
    if (w->status[texel] == BRDFFIT_TEXEL_BAD_VALUE && counts->bad_texel == UINT64_MAX) {
        counts->bad_texel = first_texel + texel;
        counts->bad_where = w->where[texel];
    }
}

static size_t batch_of(const brdffit_options *options)
{
    if (options->norm != BRDFFIT_NORM_L2 || options->engine != BRDFFIT_ENGINE_MOMENT) {
        return BATCH_PROGRAMS;
    }
    return options->lobes == 1 ? BATCH_ONE_LOBE : BATCH_MORE_LOBES;
}

static int fit_shared(struct cli_map_worker *w, size_t texels, const brdffit_texel_results *results,
                      struct cli_map_counts *counts, cli_map_tick tick, void *user)
{
    const struct cli_map *const map = w->map;
    brdffit_many_stats stats;
    const size_t most = batch_of(&map->options);
    brdffit_many_stats_init(&stats);
    for (size_t at = 0; at < texels; at += most) {
        brdffit_texels batch;
        brdffit_error error = {0};
        brdffit_texels_init(&batch, map->plan);
        batch.count = texels - at < most ? texels - at : most;
        batch.values = w->values + at * map->channels;
        batch.texel_stride = (ptrdiff_t)map->channels;
        batch.sample_stride = (ptrdiff_t)(texels * map->channels);
        batch.mask = w->mask != NULL ? w->mask + at : NULL;
        const brdffit_texel_results part = behind(map, results, at);
        if (brdffit_fit_many(map->plan, &batch, &part, w->workspace, w->workspace_size, &stats, &error) != BRDFFIT_OK) {
            return report(map->settings->files[0], &error);
        }
        if (tick(user, batch.count)) {
            return -1;
        }
    }
    counts->equal = stats.equal;
    counts->general = stats.general;
    counts->zero_channels = stats.zero_channels;
    counts->equal_channels = stats.equal_channels;
    counts->boxes = stats.boxes;
    counts->nodes = stats.nodes;
    counts->one_lobe_enough = stats.one_lobe_enough;
    return 0;
}

/* A texel's column of an array samples x texels x width. */
static const double *column(const struct cli_map *map, const double *from, size_t texels, size_t texel, size_t width,
                            double *to)
{
    for (size_t i = 0; i < map->samples; i++) {
        memcpy(to + i * width, from + (i * texels + texel) * width, width * sizeof *to);
    }
    return to;
}

static void own_samples(const struct cli_map_worker *w, size_t texels, size_t texel, brdffit_samples *samples)
{
    const struct cli_map *const map = w->map;
    double *const values = w->own, *const light = values + map->samples * map->channels;
    double *const view = light + 3 * map->samples, *const normal = view + 3 * map->samples;
    *samples = map->geometry;
    samples->values = column(map, w->values, texels, texel, map->channels, values);
    if (w->light != NULL) {
        samples->light = column(map, w->light, texels, texel, 3, light);
    }
    if (w->view != NULL) {
        samples->view = column(map, w->view, texels, texel, 3, view);
    }
    if (w->normal != NULL) {
        for (size_t i = 0; i < map->samples; i++) {
            memcpy(normal + 3 * i, w->normal + 3 * texel, 3 * sizeof *normal);
        }
        samples->normal = normal;
    }
}

static void publish(const struct cli_map *map, const brdffit_texel_results *to, const brdffit_result *from)
{
    const size_t lobes = (size_t)map->options.lobes;
    const int good = from != NULL;
    for (size_t p = 0; p < lobes; p++) {
        to->sigma[p] = good ? from->model->sigma[p] : NAN;
    }
    for (size_t k = 0; k < map->channels; k++) {
        to->x[k] = good ? from->model->x[k] : NAN;
    }
    for (size_t j = 0; j < map->channels * lobes; j++) {
        to->y[j] = good ? from->model->y[j] : NAN;
    }
    for (size_t j = 0; to->f0 != NULL && j < map->channels * lobes; j++) {
        to->f0[j] = good ? from->model->f0[j] : NAN;
    }
    for (size_t j = 0; j < map->channels * brdffit_cli_more_columns(map->options.diffuse); j++) {
        to->x_more[j] = good ? from->model->x_more[j] : NAN;
    }
    *to->e2 = good ? from->e2 : NAN;
    *to->lower_bound = good ? from->lower_bound : NAN;
}

static unsigned char status_of(brdffit_status status, const brdffit_result *result, const brdffit_error *error)
{
    if (status == BRDFFIT_OK) {
        return !(result->sum_of_squares > 0) ? BRDFFIT_TEXEL_NO_SIGNAL
               : result->certified           ? BRDFFIT_TEXEL_CERTIFIED
                                             : BRDFFIT_TEXEL_OPEN;
    }
    if (status == BRDFFIT_ERR_NO_SAMPLES) {
        return CLI_TEXEL_NO_SAMPLES;
    }
    return status == BRDFFIT_ERR_VALUE && error->sample != BRDFFIT_NONE ? BRDFFIT_TEXEL_BAD_VALUE
                                                                        : BRDFFIT_TEXEL_REFUSED;
}

static int cancelled(void *user, const brdffit_progress *progress)
{
    (void)user;
    (void)progress;
    return brdffit_cli_interrupted();
}

/* Fit one texel with its own directions. 0 or an exit code. */
static int fit_one(struct cli_map_worker *w, size_t texels, size_t texel, const brdffit_texel_results *to,
                   struct cli_map_counts *counts)
{
    const struct cli_map *const map = w->map;
    brdffit_options options = map->options;
    brdffit_samples samples;
    const brdffit_result *result = NULL;
    brdffit_error error = {0};
    options.progress = cancelled;
    own_samples(w, texels, texel, &samples);
    const brdffit_status status = brdffit_fit(&samples, &options, w->workspace, w->workspace_size, &result, &error);
    if (status != BRDFFIT_OK && status != BRDFFIT_ERR_VALUE && status != BRDFFIT_ERR_NO_SAMPLES) {
        return report(map->settings->files[0], &error);
    }
    const int fitted = status == BRDFFIT_OK;
    *to->status = status_of(status, result, &error);
    *to->where = *to->status == BRDFFIT_TEXEL_BAD_VALUE
                     ? error.sample * map->channels + (error.channel != BRDFFIT_NONE ? error.channel : 0)
                     : BRDFFIT_NONE;
    publish(map, to, result);
    counts->boxes += fitted ? result->boxes : 0;
    counts->nodes += fitted ? result->nodes : 0;
    counts->general += fitted && *to->status <= BRDFFIT_TEXEL_OPEN;
    for (int reason = 0; fitted && reason < BRDFFIT_SKIP_COUNT; reason++) {
        counts->skipped[reason] += result->samples_skipped[reason];
    }
    return 0;
}

static int fit_each(struct cli_map_worker *w, size_t texels, const brdffit_texel_results *results,
                    struct cli_map_counts *counts, cli_map_tick tick, void *user)
{
    size_t told = 0;
    for (size_t at = 0; at < texels; at++) {
        const brdffit_texel_results one = behind(w->map, results, at);
        *one.where = BRDFFIT_NONE;
        if (w->mask != NULL && !w->mask[at]) {
            *one.status = BRDFFIT_TEXEL_MASKED;
            publish(w->map, &one, NULL);
        } else {
            const int code = fit_one(w, texels, at, &one, counts);
            if (code != 0) {
                return code;
            }
        }
        if (at % 16 == 15 || at + 1 == texels || brdffit_cli_interrupted()) {
            if (tick(user, at + 1 - told)) {
                return -1;
            }
            told = at + 1;
        }
    }
    return 0;
}

/* Of all that was read for a tile. */
static uint64_t hash_tile(const struct cli_map_worker *w, size_t texels)
{
    const size_t vectors = w->map->samples * texels * 3;
    uint64_t hash = brdffit_cli_map_hash(texels, w->values,
                                         w->map->samples * texels * w->map->channels * sizeof(double));
    hash = brdffit_cli_map_hash(hash, w->light, w->light != NULL ? vectors * sizeof(double) : 0);
    hash = brdffit_cli_map_hash(hash, w->view, w->view != NULL ? vectors * sizeof(double) : 0);
    hash = brdffit_cli_map_hash(hash, w->normal, w->normal != NULL ? texels * 3 * sizeof(double) : 0);
    return brdffit_cli_map_hash(hash, w->mask, w->mask != NULL ? texels : 0);
}

int brdffit_cli_map_tile(struct cli_map_worker *w, size_t tile, int *stale, cli_map_tick tick, void *user)
{
    const struct cli_map *const map = w->map;
    const size_t first = tile * map->tile_rows, rows = brdffit_cli_map_rows(map, tile), texels = rows * map->width;
    brdffit_texel_results results;
    struct cli_map_counts counts;
    int code = read_tile(w, first, rows);
    if (code != 0) {
        return code;
    }
    const uint64_t data = hash_tile(w, texels);
    uint64_t before;
    const int kept = map->resumed > 0 && brdffit_cli_map_tile_data(map, tile, &before);
    if (kept && before == data) {
        return 0;
    }
    *stale = kept;
    memset(&counts, 0, sizeof counts);
    counts.bad_texel = UINT64_MAX;
    lay_out(map, w->out, texels, &results);
    results.status = w->status;
    results.where = w->where;
    code = map->general ? fit_each(w, texels, &results, &counts, tick, user)
                        : fit_shared(w, texels, &results, &counts, tick, user);
    if (code != 0) {
        return code;
    }
    for (size_t i = 0; i < texels; i++) {
        counts.status[w->status[i]]++;
        note_bad(&counts, w, first * map->width, i);
    }
    return brdffit_cli_map_keep_tile(map, tile, data, &counts, w->out, w->status);
}
