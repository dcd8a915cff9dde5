/*
 * What an engine is: it bounds boxes and tries points; search.c does the rest.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_H
#define BRDFFIT_BOUND_H

#include "search/axis.h"
#include "search/heap.h"

/* The sides of a box, one a lobe. Those of like lobes stand together; a search keeps their intervals ascending. */
struct box_sides {
    int count;
    int axis[SIDES_MOST];  /* of each side: which axis */
    int first[SIDES_MOST]; /* of each side: the first one of like sides */
};

struct engine {
    void *self;
    struct box_sides sides;

    /*
     * On entry box->bound is what would close the box: more is not asked for. Set it to a proven lower bound of the
     * objective for every point of box->interval, and box->split to the side that had better be split. Returns the
     * smallest (approximate) objective met on the way and its point in *met, or infinity.
     */
    double (*bound)(void *self, struct box *box, struct point *met);

    /* NULL, or: the best of a few points of the first partition, so that the search starts with an incumbent; returns its
     * (approximate) objective. */
    double (*start)(void *self, struct point *met);

    /* Improve a point by descent inside the domain; returns the exact objective of what *point becomes. */
    double (*try_point)(void *self, struct point *point);

    /* Width of an interval of an axis in sigma, for the resolution rule. */
    double (*width)(void *self, int axis, uint32_t interval);

    /* Rounding of `met`: smaller differences mean nothing. */
    double noise;
};

#endif
