/*
 * Engine `moment` (theory section 4): certified second-order bounds from convexity in moment space.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_MOMENT_H
#define BRDFFIT_BOUND_MOMENT_H

#include "bound/moment/interval.h"
#include "bound/moment/limits.h"
#include "search/engine.h"

struct bound_moment {
    const struct model *model;
    struct axis *axis; /* one a kind of first columns; refinement of an interval splits it ahead of the search */
    struct moments moments;
    struct intervals intervals[KINDS_MOST];
    struct payment payment; /* for the rounding of the geometry */
    struct limits limits;   /* physical bounds; off, unless somebody turns them on */
};

void brdffit_bound_moment_layout(struct bound_moment *engine, struct arena *arena, const struct moments_room *room,
                                 const struct model *model);

void brdffit_bound_moment_start(struct bound_moment *engine, const struct reduced *data, const struct model *model,
                                const struct kernels *kernels, struct axis *axis);

/* What is known of one interval of a kind's axis, refined by its halves, `depth` levels of them at most, where that pays. */
const struct interval *brdffit_bound_moment_side(struct bound_moment *engine, int kind, uint32_t index, int depth);

/* bound() of struct engine; self is a struct bound_moment. */
double brdffit_bound_moment(struct bound_moment *engine, struct box *box, struct point *met);

/* start() of struct engine: the nodes of the first partition, all combinations of them with more lobes than one. */
double brdffit_bound_moment_first(struct bound_moment *engine, struct point *met);

#endif
