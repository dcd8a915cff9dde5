/*
 * Damped Newton descent inside a box of theta, of whatever can be evaluated with derivatives.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_NEWTON_H
#define BRDFFIT_NEWTON_H

#include "base/point.h"

/* Objective at a point and, when derivatives were asked for, its gradient and Hessian by theta. */
struct varpro_value {
    double objective, kkt;
    double gradient[SIDES_MOST];
    double hessian[SIDES_MOST][SIDES_MOST];
};

struct newton {
    void *self;
    void (*evaluate)(void *self, const struct point *at, int derivatives, struct varpro_value *value);
    int sides;
    const double *theta_low, *theta_high; /* domain: one number a side */
    double least; /* a predicted gain up to this is not worth an evaluation: the objective's rounding */
};

/* From *point; returns the objective of what *point becomes, never above that of the start. */
double brdffit_newton(const struct newton *descent, struct point *point);

#endif
