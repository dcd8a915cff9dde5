/*
 * How far coefficients reach over a box among the models that gain enough (theory 7.10). SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MOMENT_EXTREME_H
#define BRDFFIT_MOMENT_EXTREME_H

#include "bound/moment/bound.h"

/* A functional of the coefficients of one channel, for columns of unit norm. */
struct extreme {
    size_t channel; /* of those that bounds look at; `bounded` of them: one without signal */
    int column[2]; /* of the model; column[1] < 0: there is one */
    int share; /* 1: z0 / (z0 + ratio z1) instead of sense (z0 + second z1) */
    int sense; /* 1: its supremum, -1: that of its negative; a share: 1 */
    double second; /* >= 0: weight of the second column; of a share, the ratio */
    double total_gain; /* what all channels gain together at least */
};

/* At least the supremum over the models of the box; -INFINITY when there is none. At each corner, theta ascending bits as of a
 * box's ends, about what is reached there (-INFINITY: nothing, or a mirror image of another corner). */
double brdffit_moment_extreme(struct bound_moment *engine, const struct box *box, const struct extreme *what,
                              double corner[1u << SIDES_MOST]);

/* About what each corner gains; -INFINITY of mirror images. */
void brdffit_moment_corners(struct bound_moment *engine, const struct box *box, double gain[1u << SIDES_MOST]);

/* Where what is proven of internal sums is proven of the true ones, too: the least gain of a model with E^2 <= threshold, both
 * in internal units, whose lobes are in the box. -INFINITY when nothing is known. */
double brdffit_moment_least_gain(const struct bound_moment *engine, const struct box *box, double threshold);

#endif
