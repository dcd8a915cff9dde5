/*
 * Descent without derivatives, of objectives with kinks. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_COMPASS_H
#define BRDFFIT_COMPASS_H

#include "base/point.h"

struct compass {
    void *self;
    double (*evaluate)(void *self, const struct point *at);
    int sides;
    const double *theta_low, *theta_high; /* domain: one number a side */
    struct point *at; /* the best so far */
    double objective; /* there */
    int left;         /* evaluations */
};

/* Most evaluations of one descent. */
#define COMPASS_EVALUATIONS 1500

/* Look at a point, moved into the domain; it becomes *at where it is better. Returns whether it is. */
int brdffit_compass_try(struct compass *compass, const struct point *there);

/* From *at, whose objective is there. */
void brdffit_compass(struct compass *compass);

#endif
