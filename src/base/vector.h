/*
 * Small helpers on doubles and vectors of them. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VECTOR_H
#define BRDFFIT_VECTOR_H

#include <math.h>
#include <stddef.h>

#include "base/ieee.h"

/* fmax() and fmin() without a call, for numbers; a NaN in x gives y. */
static inline double larger(double x, double y)
{
    return x > y ? x : y;
}

static inline double smaller(double x, double y)
{
    return x < y ? x : y;
}

static inline double vector_largest(const double *v, size_t n)
{
    double largest = 0.0;
    size_t i;

    for (i = 0; i < n; i++) {
        double magnitude = fabs(v[i]);

        largest = magnitude > largest ? magnitude : largest;
    }
    return largest;
}

static inline double dot3(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Power of two p with x / p in [1/2, 1); both p and 1 / p are normal numbers. 1 for x = 0. */
static inline double power_of_two(double x)
{
    int exponent = 0;

    if (!(x > 0.0)) {
        return 1.0;
    }
    (void)frexp(x, &exponent);
    return ldexp(1.0, exponent > 1020 ? 1020 : exponent < -1020 ? -1020 : exponent);
}

#endif
