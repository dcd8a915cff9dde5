/*
 * Sine and cosine of angles in degrees: see angle.h. SPDX-License-Identifier: MIT
 *
 * Degrees reduce exactly (fmod and one subtraction, both without rounding) to [-45, 45], where the Taylor
 * series to x^17 and x^16 is below 0.01 ulp off. No call of libm's sin or cos: their last bit differs between
 * platforms, and with it would every fit from angles.
 */
#include "io/csv/angle.h"

#include <math.h>

#define RADIANS 0.017453292519943295 /* pi / 180 */
#define ROOT_HALF 0.70710678118654752
#define ROOT_THREE_QUARTERS 0.86602540378443865

/* |degrees| <= 45 (one ulp more is fine). */
static void kernel(double degrees, double *sine, double *cosine)
{
    double x = degrees * RADIANS, z = x * x, half = 0.5 * z, rest;

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

void brdffit_io_sincos_degrees(double degrees, double *sine, double *cosine)
{
    double turn = fmod(degrees, 360.0);
    int quarter = (int)floor(turn / 90.0 + 0.5);
    double s, c, swap;

    kernel(turn - 90.0 * quarter, &s, &c);
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

void brdffit_io_sincos_ratio(uint64_t numerator, uint64_t denominator, double *sine, double *cosine)
{
    int obtuse = numerator > denominator;
    uint64_t acute = obtuse ? 2 * denominator - numerator : numerator;
    double s, c;

    if (acute <= denominator - acute) {
        kernel(90.0 * (double)acute / (double)denominator, &s, &c);
    } else {
        kernel(90.0 * (double)(denominator - acute) / (double)denominator, &c, &s);
    }
    *sine = s + 0.0;
    *cosine = (obtuse ? -c : c) + 0.0;
}

void brdffit_io_direction(double theta, double phi, double out[3])
{
    double sin_theta, cos_theta, sin_phi, cos_phi;

    brdffit_io_sincos_degrees(theta, &sin_theta, &cos_theta);
    brdffit_io_sincos_degrees(phi, &sin_phi, &cos_phi);
    out[0] = sin_theta * cos_phi;
    out[1] = sin_theta * sin_phi;
    out[2] = cos_theta;
}
