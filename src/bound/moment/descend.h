/*
 * Descent in moment space: the optimum near a point at the cost of a few nodes. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MOMENT_DESCEND_H
#define BRDFFIT_MOMENT_DESCEND_H

#include "base/point.h"
#include "data/moments.h"

/*
 * Improve a point inside [low, high] (a number a side), for models of one exponential kind; nothing is proven by it, and
 * data near rounding level need the vector form afterwards (theory 4.3).
 */
void brdffit_moment_descend(struct moments *moments, const struct model *model, const double *low, const double *high,
                            struct point *point);

#endif
