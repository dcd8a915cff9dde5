/*
 * How many boxes a search bounds at each level: the clustering of first-order bounds, seen.
 *
 *     bench_boxes [--engine moment|socp] [--lobes 1|2|3|NAME,...] [--norm l2|linf] [--gap G] [--resolution R] [--budget N]
 *                 FILE...
 *
 * One JSON object a line and file: the result, its time, and "levels", where levels[j] is the number of boxes whose
 * sides were halved j times (in ln sigma, summed over the lobes) since the first partition.
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "brdffit_io.h"
#include "lobes.h"

#define LEVELS 256

struct count {
    size_t level[LEVELS];
};

static void add(void *user, const brdffit_box *box)
{
    struct count *count = user;

    count->level[box->level < LEVELS ? box->level : LEVELS - 1]++;
}

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void print(const brdffit_result *r, const brdffit_options *o, double seconds, const struct count *count)
{
    int last = LEVELS - 1, j;

    while (last > 0 && count->level[last] == 0) {
        last--;
    }
    printf("{\"engine\": \"%s\", \"norm\": \"%s\", \"lobes\": %d, \"e2\": %.17g, \"lower_bound\": %.17g, ",
           brdffit_engine_string(o->engine), brdffit_norm_string(o->norm), o->lobes, r->e2, r->lower_bound);
    printf("\"sum_of_squares\": %.17g, \"rms_total\": %.17g, \"sigma\": [%.17g%s", r->sum_of_squares, r->rms_total,
           r->model->sigma[0], o->lobes > 1 ? ", " : "");
    for (j = 1; j < o->lobes; j++) {
        printf("%.17g%s", r->model->sigma[j], j + 1 < o->lobes ? ", " : "");
    }
    printf("], \"distributions\": [");
    for (j = 0; j < o->lobes; j++) {
        printf("%s\"%s\"", j ? ", " : "", brdffit_distribution_string(r->model->distributions[j]));
    }
    printf("], \"stop\": \"%s\", \"certified\": %s, \"boxes\": %zu, \"solved\": %zu, \"refused\": %zu, "
           "\"decided\": %zu, \"seconds\": %.6g, \"levels\": [",
           brdffit_stop_string(r->stop), r->certified ? "true" : "false", r->boxes, r->programs_solved,
           r->programs_refused, r->programs_decided, seconds);
    for (j = 0; j <= last; j++) {
        printf("%s%zu", j ? ", " : "", count->level[j]);
    }
    printf("]}\n");
    fflush(stdout);
}

static int run(const char *path, brdffit_options *o)
{
    struct count count = {{0}};
    brdffit_io_options io;
    brdffit_table *table = NULL;
    const brdffit_result *result = NULL;
    brdffit_error error;
    double begun;
    int good;

    brdffit_io_options_init(&io);
    io.merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    o->box = add;
    o->box_user = &count;
    good = brdffit_io_read(path, &io, &table, &error) == BRDFFIT_OK;
    begun = now();
    good = good && brdffit_fit_new(table->samples, o, &result, &error) == BRDFFIT_OK;
    if (good) {
        print(result, o, now() - begun, &count);
    } else {
        fprintf(stderr, "bench_boxes: %s: %s\n", path, error.message);
    }
    brdffit_result_free(result);
    brdffit_io_free(table);
    return good;
}

static brdffit_distribution list[BRDFFIT_MAX_LOBES];

static int set(brdffit_options *o, const char *name, const char *value)
{
    if (strcmp(name, "--engine") == 0) {
        o->engine = strcmp(value, "socp") == 0 ? BRDFFIT_ENGINE_SOCP : BRDFFIT_ENGINE_MOMENT;
        return strcmp(value, brdffit_engine_string(o->engine)) == 0;
    }
    if (strcmp(name, "--norm") == 0) {
        o->norm = strcmp(value, "linf") == 0 ? BRDFFIT_NORM_LINF : BRDFFIT_NORM_L2;
        return strcmp(value, brdffit_norm_string(o->norm)) == 0;
    }
    if (strcmp(name, "--lobes") == 0) {
        return bench_lobes(value, o, list);
    }
    if (strcmp(name, "--gap") == 0) {
        o->relative_gap = strtod(value, NULL);
        return o->relative_gap > 0.0;
    }
    if (strcmp(name, "--resolution") == 0) {
        o->sigma_resolution = strtod(value, NULL);
        return o->sigma_resolution >= 0.0;
    }
    if (strcmp(name, "--budget") == 0) {
        o->box_budget = strtoull(value, NULL, 10);
        return o->box_budget > 0;
    }
    return 0;
}

int main(int argc, char **argv)
{
    brdffit_options o;
    int i = 1, good = 1;

    brdffit_options_init(&o);
    while (i + 1 < argc && strncmp(argv[i], "--", 2) == 0 && set(&o, argv[i], argv[i + 1])) {
        i += 2;
    }
    if (i >= argc || argv[i][0] == '-') {
        fprintf(stderr, "usage: bench_boxes [--engine moment|socp] [--lobes 1|2|3|NAME,...] [--norm l2|linf] "
                        "[--gap G] [--resolution R] [--budget N] FILE...\n");
        return 2;
    }
    for (; i < argc; i++) {
        good = run(argv[i], &o) && good;
    }
    return good ? 0 : 1;
}
