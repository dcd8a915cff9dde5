/*
 * Small helpers on vectors of doubles. Layer 0. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VECTOR_H
#define BRDFFIT_VECTOR_H

#include <math.h>
#include <stddef.h>

/* u.v in four lanes of fixed order, so that its bits do not depend on the instruction set. */
static inline double vector_dot(const double *u, const double *v, size_t n)
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    size_t i = 0;

    for (; i + 4 <= n; i += 4) {
        sum[0] += u[i] * v[i];
        sum[1] += u[i + 1] * v[i + 1];
        sum[2] += u[i + 2] * v[i + 2];
        sum[3] += u[i + 3] * v[i + 3];
    }
    for (; i < n; i++) {
        sum[0] += u[i] * v[i];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
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
