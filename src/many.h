/*
 * Many fits of one geometry: the plan, and how a batch is cut into steps. Layer 5. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MANY_H
#define BRDFFIT_MANY_H

#include "arena.h"
#include "brdffit.h"

struct brdffit_plan {
    brdffit_options options;
    brdffit_samples geometry; /* copies, in the plan's memory; no values */
    size_t workspace_size;
};

/* One texel's result. Arrays of the longest length lie in the workspace. */
struct many_result {
    brdffit_texel_status status;
    brdffit_stop stop;
    size_t where, boxes, nodes;
    int general, one_lobe_enough;
    double e2, lower_bound, sum_of_squares;
    double sigma[BRDFFIT_MAX_LOBES];
    double *x, *y, *channel_scale; /* K, K x P, K */
};

/* What a thread keeps in its workspace. */
struct many {
    double *values; /* samples x K of one texel, or of several */
    struct many_result result;
    void *fit;      /* workspace of brdffit_fit() */
    size_t fit_size;
};

/* Lay a thread's workspace out in an arena (counting or real). */
void brdffit_many_layout(struct many *many, struct arena *arena, const brdffit_options *options, size_t samples,
                         size_t channels);

/* Values of one texel, samples x K, from whatever type and strides they have. */
void brdffit_many_gather(const brdffit_texels *texels, size_t texel, size_t samples, size_t channels,
                         double *values);

/* Fit the texel whose values are given by brdffit_fit(). */
void brdffit_many_general(const brdffit_plan *plan, struct many *many, const double *values,
                          struct many_result *result);

#endif
