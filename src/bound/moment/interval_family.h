/*
 * Curvature enclosures of lobes that are not exponential, and of pairs of lobes of two kinds (theory 4.4, 7.6): only
 * interval.c calls them. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_INTERVAL_FAMILY_H
#define BRDFFIT_INTERVAL_FAMILY_H

#include "bound/moment/interval.h"

/* [low, high] of E slope + 2 Var x over the interval. */
void brdffit_family_curvature(struct moments *moments, int kind, const struct interval *v, double *low, double *high);

/* [low, high] of the second derivative of functional f; curvature as above. */
void brdffit_family_functional(struct moments *moments, int kind, const struct interval *v, size_t f,
                               double curvature_low, double curvature_high, double *low, double *high);

/* sup of the second derivative of mu by the variable of one side; mu >= least. */
double brdffit_family_pair(const struct sides *sides, int which, double least);

/* sum W phi^2 [4 (x - X)^2 + 2 slope] over the interval, W = b1 b2 of the two columns of a lobe (interval.c), from above.
 * `low`: their pair at the low end. */
double brdffit_family_beside(struct moments *moments, int kind, const struct interval *second,
                             const struct interval *first, const struct pair *low);

#endif
