/*
 * Sine and cosine of angles in degrees with the same bits on every platform. SPDX-License-Identifier: MIT
 *
 * Degrees reduce exactly (fmod and one subtraction, both without rounding) to [-45, 45], where the Taylor
 * series to x^17 and x^16 is below 0.01 ulp off. No call of libm's sin or cos: their last bit differs between
 * platforms, and with it would every fit from angles, and whether a sample at the limit of incidence counts.
 */
#ifndef BRDFFIT_DEGREES_H
#define BRDFFIT_DEGREES_H

#include <math.h>

#include "base/ieee.h"

#define DEGREE 0.017453292519943295 /* pi / 180 */
#define ROOT_HALF 0.70710678118654752
#define ROOT_THREE_QUARTERS 0.86602540378443865

/* |degrees| <= 45 (one ulp more is fine). */
static inline void degrees_octant(double degrees, double *sine, double *cosine)
{
    double x = degrees * DEGREE, z = x * x, half = 0.5 * z, rest;

    if (fabs(degrees) == 45.0) {
        *sine = degrees < 0.0 ? -ROOT_HALF : ROOT_HALF;
        *cosine = ROOT_HALF;
        return;
    }
    if (fabs(degrees) == 30.0) {
        *sine = degrees < 0.0 ? -0.5 : 0.5;
        *cosine = ROOT_THREE_QUARTERS;
        return;
    }
    rest = 1.0 / 355687428096000.0;                  /* 17! */
    rest = rest * z - 1.0 / 1307674368000.0;         /* 15! */
    rest = rest * z + 1.0 / 6227020800.0;            /* 13! */
    rest = rest * z - 1.0 / 39916800.0;              /* 11! */
    rest = rest * z + 1.0 / 362880.0;                /* 9! */
    rest = rest * z - 1.0 / 5040.0;                  /* 7! */
    rest = rest * z + 1.0 / 120.0;                   /* 5! */
    rest = rest * z - 1.0 / 6.0;                     /* 3! */
    *sine = x + x * (z * rest);
    rest = 1.0 / 20922789888000.0;                   /* 16! */
    rest = rest * z - 1.0 / 87178291200.0;           /* 14! */
    rest = rest * z + 1.0 / 479001600.0;             /* 12! */
    rest = rest * z - 1.0 / 3628800.0;               /* 10! */
    rest = rest * z + 1.0 / 40320.0;                 /* 8! */
    rest = rest * z - 1.0 / 720.0;                   /* 6! */
    rest = rest * z + 1.0 / 24.0;                    /* 4! */
    /* 1 - half rounds; what it lost goes back in. */
    *cosine = (1.0 - half) + (((1.0 - (1.0 - half)) - half) + z * (z * rest));
}

/* Of any finite angle. */
static inline void degrees_sincos(double degrees, double *sine, double *cosine)
{
    double turn = fmod(degrees, 360.0);
    int quarter = (int)floor(turn / 90.0 + 0.5);
    double s, c, swap;

    degrees_octant(turn - 90.0 * quarter, &s, &c);
    if (quarter & 1) {
        swap = s;
        s = c;
        c = -swap;
    }
    if (quarter & 2) {
        s = -s;
        c = -c;
    }
    *sine = s + 0.0; /* -0 becomes +0 */
    *cosine = c + 0.0;
}

#endif
