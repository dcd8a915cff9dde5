/*
 * What a fit says, as a plain structure: the one place here that touches the library's results.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_FIT_VIEW_H
#define BRDFFIT_TESTS_FIT_VIEW_H

#include "quad.h"

struct fit_view {
    brdffit_status status;
    const char *message; /* of a failure */
    int lobes;
    size_t channels, used;
    double sigma[QUAD_LOBES];
    int fixed;
    double *x, *y, *scale, *f0; /* channels x fixed, channels x lobes, channels, channels x lobes or NULL: copies */
    double e2, e2_error, lower_bound, gap, sum_of_squares, sigma_floor;
    int binned;            /* from sums in bins: certified then speaks of e2 + e2_error */
    int certified;
    brdffit_stop stop;
    size_t boxes;
    int nans; /* NaN among all numbers of the result */
};

/* What a fit_view is of. */
struct fit_question {
    const brdffit_samples *samples;
    brdffit_options options;
    int lobes;
    brdffit_distribution distribution[QUAD_LOBES]; /* one a lobe; lobes of one distribution stand together */
};

/* Defaults, with these lobes of one distribution. */
void fit_question_init(struct fit_question *q, const brdffit_samples *samples, int lobes,
                       brdffit_distribution distribution);

/* options.lobes, options.distribution and whatever else says them, from the question. 0: this build cannot. */
int fit_question_options(const struct fit_question *q, brdffit_options *options);

/* By brdffit_fit_new(); by sums of two halves of the samples, in bins where bits > 0 (2^bits an octave). */
void fit_view_new(struct fit_view *view, const struct fit_question *q);
void fit_view_sums(struct fit_view *view, const struct fit_question *q, size_t groups, int bits);

/* By a plan, `texels` of them: values texel, sample, channel. views: one a texel. Where the plan or the call fails, so
 * do all of them. sigma_floor is taken from a fit of the texel's own. */
void fit_view_many(struct fit_view *views, size_t texels, const double *values, const struct fit_question *q);

void fit_view_free(struct fit_view *view);

/* Boxes of a fit and what was proven of each: a random choice of at most `most`. Returns how many there are. */
struct fit_box {
    double sigma_low[QUAD_LOBES], sigma_high[QUAD_LOBES], lower_bound;
};
size_t fit_view_boxes(const struct fit_question *q, struct fit_box *boxes, size_t most, unsigned long long seed);

/* Whether brdffit_verify() says that it has proven the level. */
int fit_view_proves(const struct fit_question *q, double level);

#endif
