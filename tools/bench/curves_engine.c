/*
 * The library's two engines as methods of the benchmark. Seconds are those of brdffit_fit() as a whole: geometry,
 * reduction, search, report. SPDX-License-Identifier: MIT
 */
#include "curves.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOMENT, SOCP_WIDTH, SOCP_GAP, SOCP_GAP_EVERY };

struct watch {
    double begun, reduced, patience;
};

static int at_progress(void *user, const brdffit_progress *progress)
{
    struct watch *watch = user;

    if (progress->phase == BRDFFIT_PHASE_REDUCED) {
        watch->reduced = curves_now();
        return 0;
    }
    return curves_now() - watch->begun > watch->patience;
}

/* Medians of repeated fits in one workspace. 0 when the library refuses. */
static int fit(const struct curves_task *task, brdffit_options *options, double patience, struct curves_row *row)
{
    const brdffit_samples *samples = task->table->samples;
    double whole[CURVES_MOST_REPEATS], search[CURVES_MOST_REPEATS], spent = 0.0;
    struct watch watch = {0.0, 0.0, patience};
    const brdffit_result *result;
    brdffit_error error;
    size_t size;
    void *workspace;
    int done = 0, good = 1;

    options->progress = at_progress;
    options->progress_user = &watch;
    size = brdffit_workspace_size(samples->count, samples->channels, options);
    workspace = malloc(size);
    while (workspace && good && (done == 0 || curves_more(task, done, spent))) {
        double end;

        watch.begun = curves_now();
        good = brdffit_fit(samples, options, workspace, size, &result, &error) == BRDFFIT_OK;
        end = curves_now();
        whole[done] = end - watch.begun;
        search[done] = end - watch.reduced;
        spent += whole[done++];
    }
    good = good && workspace;
    if (good) {
        row->seconds = curves_median(whole, done);
        row->search = curves_median(search, done);
        row->e2 = result->e2;
        row->lower_bound = result->lower_bound;
        row->certified = result->certified;
        row->work = (double)result->boxes;
        row->nodes = (double)result->nodes;
    } else {
        fprintf(stderr, "curves: %s: %s\n", task->file, workspace ? error.message : "out of memory");
    }
    free(workspace);
    return good;
}

static brdffit_options plain_options(const struct curves_task *task, double gap)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.lobes = task->lobes;
    options.relative_gap = gap;
    return options;
}

static void run_moment(const struct curves_task *task, const struct curves_method *method)
{
    static const double gap[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
    size_t i;

    for (i = 0; i < sizeof gap / sizeof *gap; i++) {
        brdffit_options options = plain_options(task, gap[i]);
        struct curves_row row = {.knob = gap[i]};

        if (fit(task, &options, 60.0, &row)) {
            curves_print(task, method->name, &row);
        }
    }
}

/* Boxes down to a width, as the paper stops. Time and boxes grow with 1 / width: one step past the patience ends it. */
static void run_socp_width(const struct curves_task *task, const struct curves_method *method)
{
    int m;

    for (m = 1; m <= task->options->width[task->lobes - 1]; m++) {
        brdffit_options options = plain_options(task, 1e-12);
        struct curves_row row = {.knob = ldexp(1.0, -m)};

        options.engine = BRDFFIT_ENGINE_SOCP;
        options.sigma_resolution = row.knob;
        options.socp_every_box = 1;
        if (!fit(task, &options, task->options->patience, &row)) {
            return;
        }
        if (row.seconds > task->options->patience) {
            return; /* cut short: not a point of the curve */
        }
        curves_print(task, method->name, &row);
    }
}

/* To a gap, to compare boxes with engine moment at the same gap. A search cut short by the patience is printed too,
 * not certified: its boxes are then fewer than needed. */
static void run_socp_gap(const struct curves_task *task, const struct curves_method *method)
{
    static const double gap[] = {0.5, 1e-1, 1e-2, 1e-3};
    struct curves_row row = {.certified = 1};
    size_t i;

    for (i = 0; i < sizeof gap / sizeof *gap && row.certified; i++) {
        brdffit_options options = plain_options(task, gap[i]);

        row.knob = gap[i];
        options.engine = BRDFFIT_ENGINE_SOCP;
        options.box_budget = 10000000;
        options.socp_every_box = method->choice == SOCP_GAP_EVERY;
        if (!fit(task, &options, task->options->patience, &row)) {
            return;
        }
        curves_print(task, method->name, &row);
    }
}

const struct curves_method curves_engine_methods[] = {
    {"moment", run_moment, 0, MOMENT},
    {"socp", run_socp_width, 0, SOCP_WIDTH},
    {"socp-gap", run_socp_gap, 1, SOCP_GAP},
    {"socp-gap-every-box", run_socp_gap, 1, SOCP_GAP_EVERY},
    {NULL, NULL, 0, 0},
};
