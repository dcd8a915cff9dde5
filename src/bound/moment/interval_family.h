/*
 * Curvature enclosures for families that are not exponential (theory 4.4): only interval.c calls them.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_INTERVAL_GENERAL_H
#define BRDFFIT_INTERVAL_GENERAL_H

#include "bound/moment/interval.h"

/* [low, high] of E slope + 2 Var x over the interval. */
void brdffit_general_curvature(struct moments *moments, const struct interval *v, double *low, double *high);

/* [low, high] of the second derivative of functional f; curvature as above. */
void brdffit_general_functional(struct moments *moments, const struct interval *v, size_t f, double curvature_low,
                                double curvature_high, double *low, double *high);

/* sup of the second derivative of mu by the variable of one side. */
double brdffit_general_pair(struct moments *moments, const struct interval *first, const struct interval *second,
                            int which, double mu_inf);

#endif
