/*
 * Physical bounds in engine `moment` (theory 7.9): a.z <= 1 in each channel, a >= 0. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MOMENT_LIMITS_H
#define BRDFFIT_MOMENT_LIMITS_H

#include "base/arena.h"
#include "kernels/kernels.h"
#include "model/model.h"

/* What a box is bounded by instead of its columns' own numbers; arrays of K. */
struct limits {
    int on;
    double *multiplier;
    double *omega[FIXED_MOST];
    double *tau[MOVING_MOST][2], *shift[MOVING_MOST], *sup[MOVING_MOST];
    double loss
        [SIDES_MOST]; /* what a corner's gain is too high by at most, as what limits count for is not known along a side */
    double raised; /* what a gain of the box is to be raised by: the sum of multipliers, and its rounding */
};

void brdffit_limits_layout(struct limits *limits, struct arena *arena, size_t channels, const struct model *model);

struct view;

/* After an opening: lowers what the columns of a box may gain by what the limits take. */
void brdffit_limits_apply(struct view *view);

#endif
