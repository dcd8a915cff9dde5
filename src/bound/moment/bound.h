/*
 * Engine `moment` (theory section 4): certified second-order bounds from convexity in moment space.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_MOMENT_H
#define BRDFFIT_BOUND_MOMENT_H

#include "search/engine.h"
#include "bound/moment/interval.h"

struct bound_moment {
    struct axis *axis; /* refinement of its intervals splits it ahead of the search */
    struct moments moments;
    struct intervals intervals;
    struct doubt doubt; /* of the box that is being bounded */
};

void brdffit_bound_moment_layout(struct bound_moment *engine, struct arena *arena, size_t count, size_t channels,
                                 uint32_t node_capacity, int lobes);

void brdffit_bound_moment_start(struct bound_moment *engine, const struct reduced *data, const struct lobe_kind *kind,
                                const struct kernels *kernels, struct axis *axis, int lobes);

/* What is known of one interval of the axis, refined by its halves, `depth` levels of them at most, where that pays. */
const struct interval *brdffit_bound_moment_side(struct bound_moment *engine, uint32_t index, int depth);

/* What the geometry's rounding costs this box: before its first bound. */
void brdffit_bound_moment_doubt(struct bound_moment *engine, const struct box *box, int lobes);

/* Lower bound of E^2 from an upper bound of J; never below 0, which is always true. */
double brdffit_bound_moment_objective(const struct bound_moment *engine, double gain);

/* Offer a corner of gain J to *best and *met. J is raised by epsilon: the true objective is not below T - J. */
void brdffit_bound_moment_meet(const struct bound_moment *engine, double gain, const double theta[2], double *best,
                               struct point *met);

/* bound() of struct engine for one and for two lobes; self is a struct bound_moment. */
double brdffit_bound_moment_one(void *self, struct box *box, struct point *met);
double brdffit_bound_moment_two(void *self, struct box *box, struct point *met);

/* start() of struct engine: the nodes of the first partition, and for two lobes all pairs of them. */
double brdffit_bound_moment_start_one(void *self, struct point *met);
double brdffit_bound_moment_start_two(void *self, struct point *met);

#endif
