/*
 * Directions from angles in degrees: see angle.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/angle.h"

#include "base/degrees.h"

void brdffit_io_sincos_degrees(double degrees, double *sine, double *cosine)
{
    degrees_sincos(degrees, sine, cosine);
}

void brdffit_io_sincos_ratio(uint64_t numerator, uint64_t denominator, double *sine, double *cosine)
{
    int obtuse = numerator > denominator;
    uint64_t acute = obtuse ? 2 * denominator - numerator : numerator;
    double s, c;

    if (acute <= denominator - acute) {
        degrees_octant(90.0 * (double)acute / (double)denominator, &s, &c);
    } else {
        degrees_octant(90.0 * (double)(denominator - acute) / (double)denominator, &c, &s);
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
