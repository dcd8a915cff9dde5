/*
 * Sine and cosine of angles in degrees. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_ANGLE_H
#define BRDFFIT_IO_ANGLE_H

#include <stdint.h>

#include "base/ieee.h"

/*
 * Both within 2 ulp (1.64 seen in 2e7 trials), the same bits on every platform, and exact wherever the value is
 * rational: multiples of 90 degrees, sin 30, cos 60 and their mirror images. Zeros are positive. Any finite angle.
 */
void brdffit_io_sincos_degrees(double degrees, double *sine, double *cosine);

/*
 * The same for (numerator / denominator) right angles, 0 <= numerator <= 2 denominator. A ratio of integers
 * keeps the complement exact: the cosine is as accurate near 90 degrees as the sine is near 0.
 */
void brdffit_io_sincos_ratio(uint64_t numerator, uint64_t denominator, double *sine, double *cosine);

/* Unit vector of a polar angle from +z and an azimuth from +x, degrees. */
void brdffit_io_direction(double theta, double phi, double out[3]);

#endif
