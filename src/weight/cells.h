/*
 * The share of all pairs of directions that each sample stands for. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_WEIGHT_CELLS_H
#define BRDFFIT_WEIGHT_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

enum place { PLACE_LIGHT, PLACE_VIEW, PLACE_TURN, PLACE_COUNT };

/* Arrays of a place a sample; lists of the samples that have one, in the order of each coordinate. */
struct cells {
    double *at[PLACE_COUNT]; /* sqrt(1 - n.l), sqrt(1 - n.v), and the azimuth between them / pi: each in [0, 1] */
    uint32_t *order[PLACE_COUNT];
    uint32_t *spare;
    unsigned char *above; /* a sample each: beyond the cut of the moment */
    size_t placed;
};

/* Room for `count` samples; arena->failed when there is none. */
void brdffit_cells_take(struct cells *cells, size_t count, struct arena *arena);

/* The next sample in order, i, is above the horizon. */
void brdffit_cells_place(struct cells *cells, size_t i, double cos_light, double cos_view, double cos_difference);

/* share[i] of every sample that was placed, > 0 and 1 together; the places are in disorder afterwards. */
void brdffit_cells_share(struct cells *cells, double *share);

/* Put samples in ascending order of their keys, those of equal keys as they were: a merge sort. The result is in the
 * array that is returned, one of the two. */
uint32_t *brdffit_weight_sort(const double *key, uint32_t *order, uint32_t *spare, size_t count);

#endif
