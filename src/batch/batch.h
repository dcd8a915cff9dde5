/*
 * Many fits of one geometry: the plan, and how a batch is cut into steps. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_H
#define BRDFFIT_BATCH_H

#include "base/arena.h"
#include "brdffit.h"
#include "base/environment.h"
#include "batch/fast.h"

struct brdffit_plan {
    brdffit_options options;
    brdffit_samples geometry; /* copies, in the plan's memory; no values */
    size_t workspace_size;
    const struct batch_kernels *kernels; /* NULL: this geometry and these options have the general path only */
    struct batch_fast fast;
};

/* One texel's result. Arrays of the longest length lie in the workspace. */
struct batch_result {
    brdffit_texel_status status;
    brdffit_stop stop;
    size_t where, boxes, nodes;
    int general, one_lobe_enough;
    double e2, lower_bound, sum_of_squares, sigma_floor;
    double sigma[BRDFFIT_MAX_LOBES];
    double *x, *y, *channel_scale; /* K, K x P, K */
    double *f0, *x_more;           /* K x P, K x (columns - 1); NULL where the model has none */
};

/* Texels that wait for their tile, those equal to one of them included. */
#define BATCH_WAITING 64

/* What a thread keeps in its workspace. */
struct batch {
    const brdffit_plan *plan;
    double *row[BATCH_TILE + 1];         /* samples x K each; the last: the texel fitted before this tile */
    struct batch_result result[BATCH_TILE + 1];
    size_t filled;                      /* rows in use */
    int before;                         /* the last row and result hold a texel */
    size_t waiting, texel[BATCH_WAITING], slot[BATCH_WAITING];
    struct batch_tile tile;              /* laid out if the plan may have kernels */
    void *fit;                          /* workspace of brdffit_fit() */
    size_t fit_size;
};

/* Lay a thread's workspace out in an arena (counting or real). */
void brdffit_batch_layout(struct batch *batch, struct arena *arena, const brdffit_options *options, size_t samples,
                          size_t channels);

/* Values of one texel, samples x K, from whatever type and strides they have. */
void brdffit_batch_gather(const brdffit_texels *texels, size_t texel, size_t samples, size_t channels, double *values);

/* Fit the texels of the rows in use. */
void brdffit_batch_tile(struct batch *batch);

/* Fit the texel whose values are given by brdffit_fit(). */
void brdffit_batch_general(const brdffit_plan *plan, struct batch *batch, const double *values,
                           struct batch_result *result);

/* The public functions without the change of the floating-point environment (entry.c calls them). */
ENVIRONMENT_APART size_t brdffit_plan_bytes(const brdffit_samples *geometry, const brdffit_options *options);
ENVIRONMENT_APART brdffit_status brdffit_plan_make(const brdffit_samples *geometry, const brdffit_options *options,
                                                   void *memory, size_t size, const brdffit_plan **plan,
                                                   brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_batch_run(const brdffit_plan *plan, const brdffit_texels *texels,
                                                   const brdffit_texel_results *results, void *workspace,
                                                   size_t workspace_size, brdffit_many_stats *stats,
                                                   brdffit_error *error);

#endif
