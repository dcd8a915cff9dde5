/*
 * What brdffit.fit_map() and brdffit.fit() are measured against: the same calls of the library from C, on the memory
 * that Python made. A shared library for python_overhead.py, which calls both in turn.
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdlib.h>

#include "brdffit.h"

#if defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* An image stack: samples x texels x channels floats, directions samples x 3. */
typedef struct direct_map {
    const float *values;
    const double *light, *view;
    size_t samples, texels, channels;
    int lobes, threads;
    size_t tile; /* texels of a call */
} direct_map;

EXPORT int direct_fit_map(const direct_map *map, double *e2_sum);
EXPORT int direct_fit(const brdffit_samples *samples, int lobes, size_t times, double *e2);

struct shared {
    const direct_map *map;
    const brdffit_plan *plan;
    brdffit_texel_results results;
    pthread_mutex_t mutex;
    size_t next;
    int failed;
};

static int take(struct shared *s, size_t *first)
{
    pthread_mutex_lock(&s->mutex);
    const int more = !s->failed && s->next < s->map->texels;
    *first = s->next;
    s->next += s->map->tile;
    pthread_mutex_unlock(&s->mutex);
    return more;
}

static brdffit_texel_results behind(const struct shared *s, size_t at)
{
    const size_t lobes = (size_t)s->map->lobes, channels = s->map->channels;
    brdffit_texel_results r = s->results;
    r.sigma += at * lobes;
    r.x += at * channels;
    r.y += at * channels * lobes;
    r.channel_scale += at * channels;
    r.e2 += at;
    r.lower_bound += at;
    r.sum_of_squares += at;
    r.status += at;
    r.stop += at;
    r.where += at;
    r.boxes += at;
    return r;
}

static void *work(void *user)
{
    struct shared *const s = user;
    const direct_map *const map = s->map;
    const size_t size = brdffit_many_workspace_size(s->plan);
    void *const workspace = malloc(size);
    brdffit_many_stats stats;
    brdffit_texels texels;
    size_t first;
    int failed = workspace == NULL;
    brdffit_many_stats_init(&stats);
    brdffit_texels_init(&texels, s->plan);
    texels.type = BRDFFIT_TYPE_FLOAT;
    texels.texel_stride = (ptrdiff_t)map->channels;
    texels.sample_stride = (ptrdiff_t)(map->texels * map->channels);
    while (!failed && take(s, &first)) {
        const brdffit_texel_results part = behind(s, first);
        texels.count = map->texels - first < map->tile ? map->texels - first : map->tile;
        texels.values = map->values + first * map->channels;
        failed = brdffit_fit_many(s->plan, &texels, &part, workspace, size, &stats, NULL) != BRDFFIT_OK;
    }
    free(workspace);
    pthread_mutex_lock(&s->mutex);
    s->failed |= failed;
    pthread_mutex_unlock(&s->mutex);
    return NULL;
}

/* Every array that fit_map returns. */
static int allocate(const direct_map *map, brdffit_texel_results *r)
{
    const size_t n = map->texels, channels = map->channels, lobes = (size_t)map->lobes;
    brdffit_texel_results_init(r);
    r->sigma = malloc(n * lobes * sizeof *r->sigma);
    r->x = malloc(n * channels * sizeof *r->x);
    r->y = malloc(n * channels * lobes * sizeof *r->y);
    r->channel_scale = malloc(n * channels * sizeof *r->channel_scale);
    r->e2 = malloc(n * sizeof *r->e2);
    r->lower_bound = malloc(n * sizeof *r->lower_bound);
    r->sum_of_squares = malloc(n * sizeof *r->sum_of_squares);
    r->status = malloc(n);
    r->stop = malloc(n);
    r->where = malloc(n * sizeof *r->where);
    r->boxes = malloc(n * sizeof *r->boxes);
    return r->sigma && r->x && r->y && r->channel_scale && r->e2 && r->lower_bound && r->sum_of_squares && r->status &&
           r->stop && r->where && r->boxes;
}

static void release(const brdffit_texel_results *r)
{
    free(r->sigma);
    free(r->x);
    free(r->y);
    free(r->channel_scale);
    free(r->e2);
    free(r->lower_bound);
    free(r->sum_of_squares);
    free(r->status);
    free(r->stop);
    free(r->where);
    free(r->boxes);
}

static int run(struct shared *s)
{
    pthread_t ids[64];
    int started = 0;
    const int wanted = s->map->threads < 64 ? s->map->threads : 64;
    while (started < wanted && pthread_create(&ids[started], NULL, work, s) == 0) {
        started++;
    }
    for (int i = 0; i < started; i++) {
        (void)pthread_join(ids[i], NULL);
    }
    return started == wanted && !s->failed;
}

/* From nothing to every result, and the sum of all E^2 so that both sides can be held against each other. 1: done. */
int direct_fit_map(const direct_map *map, double *e2_sum)
{
    struct shared s = {0};
    brdffit_options options;
    brdffit_samples geometry;
    brdffit_options_init(&options);
    options.lobes = map->lobes;
    brdffit_samples_init(&geometry);
    geometry.count = map->samples;
    geometry.channels = map->channels;
    geometry.light = map->light;
    geometry.view = map->view;
    const size_t size = brdffit_plan_size(&geometry, &options);
    void *const memory = malloc(size);
    s.map = map;
    int done = allocate(map, &s.results) && memory != NULL &&
               brdffit_plan_init(&geometry, &options, memory, size, &s.plan, NULL) == BRDFFIT_OK &&
               pthread_mutex_init(&s.mutex, NULL) == 0;
    if (done) {
        done = run(&s);
        (void)pthread_mutex_destroy(&s.mutex);
    }
    *e2_sum = 0;
    for (size_t i = 0; done && i < map->texels; i++) {
        *e2_sum += s.results.e2[i];
    }
    release(&s.results);
    free(memory);
    return done;
}

/* The same fit `times` times, each from nothing. 1: done. */
int direct_fit(const brdffit_samples *samples, int lobes, size_t times, double *e2)
{
    for (size_t i = 0; i < times; i++) {
        brdffit_options options;
        const brdffit_result *result;
        brdffit_options_init(&options);
        options.lobes = lobes;
        if (brdffit_fit_new(samples, &options, &result, NULL) != BRDFFIT_OK) {
            return 0;
        }
        *e2 = result->e2;
        brdffit_result_free(result);
    }
    return 1;
}
