/*
 * How well angles are known, and what that makes of b and c. SPDX-License-Identifier: MIT
 *
 * Two things are allowed for, and both stand in every error of struct geometry:
 *
 *   arithmetic. Unit vectors of geometry.c are off by 4.5 u in norm (a division by the largest component, five roundings
 *   under a root, another division), and a component of one by 4.5 u relative to itself. A dot product of two adds 3 u.
 *   accurate.c is exact to the last bit.
 *
 *   input. Directions are known to TOL_ANGLE (brdffit.h): doubles made from degrees, taken at their word and read as
 *   those degrees, are two different sets of directions, and what is proven holds for both. A given normal likewise. Two
 *   exceptions: directions that are mirror images to the last bit come from angles that are (the same sines and cosines of
 *   the same degrees); and below GRAZE a cosine is what the doubles say, because nothing could be said otherwise.
 *
 * Errors e are propagated to first order, and ENOUGH times the sum of a few of them covers the higher orders: a relative
 * error of a cosine is below TOL_ANGLE * 4 / GRAZE = 1e-3, one of tan alpha twice that.
 *
 * Condition of the geometry, absolute errors e_S of |n x h| and e_C of n.h = n.l + n.v:
 *
 *     tan alpha = |n x h| / n.h:   e_S / (n.h) + tan alpha e_C / (n.h)          c = tan^2 alpha:  e (2 tan alpha + e)
 *     1 - v.h = |l - v|^2 / (4 (1 + v.h)), e of |l - v|: 2 e / |l - v| relative
 *     |r - v| = sqrt(2 (1 - r.v)): e_S and the errors of both cosines           1 - r.v:  e |r - v| + e^2 / 2
 */
#ifndef BRDFFIT_ROUNDING_H
#define BRDFFIT_ROUNDING_H

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "model/geometry.h"

/* Cosines below this are not charged with TOL_ANGLE. */
#define GRAZE (4096.0 * TOL_ANGLE)
#define ENOUGH 1.1

/* Half angles whose tan^2, cosines whose size, or 1 - |1 - r.v| that ask for accurate.c: what is left above is known to
 * 1e-11 relative, which is no more than TOL_ANGLE makes of it. */
#define ACCURATE_TAN2 1e-8
#define ACCURATE_COSINE 0.015625

/* 1 - v.h, relative: |l - v| is that of unit vectors off by 5 u each and known to TOL_ANGLE, less a rounding. */
static inline double rounding_of_versine(const struct geometry_angles *g)
{
    double apart = sqrt(4.0 * g->versine * (1.0 + g->cos_difference));

    return apart > 0.0 ? smaller(1.0, ENOUGH * 2.0 * (2.0 * TOL_ANGLE + 12.0 * TOL_UNIT) / apart) + 12.0 * TOL_UNIT
                       : 0.0;
}

/* 1 - cos of an angle with the normal that is known to `input`, relative: d(1 - cos) = sin times that. */
static inline double rounding_of_side_versine(double versine, double cosine, double input)
{
    double sine = sqrt(versine * (1.0 + cosine));

    return sine > 0.0 ? ENOUGH * (input + 16.0 * TOL_UNIT) * (1.0 + cosine) / sine + 12.0 * TOL_UNIT : 0.0;
}

/* Directions: fills the errors. `general`: a normal was given. */
static inline void rounding_of_directions(struct geometry_angles *g, int general)
{
    double input = general ? 4.0 * TOL_ANGLE : 2.0 * TOL_ANGLE; /* of n x h, n.h and r - v */
    double cosines = g->cos_light + g->cos_view, tangent = sqrt(g->tan2_half);
    double light = g->cos_light > GRAZE ? 0.5 * input : 0.0, view = g->cos_view > GRAZE ? 0.5 * input : 0.0;
    double sum = cosines > GRAZE ? input : 0.0, across = sum, distance = input;

    if (g->accurate) {
        across = (g->tan2_half > 0.0 ? across : 0.0) + 1e-28;
        distance = (g->off_mirror > 0.0 ? distance : 0.0) + 1e-28;
        g->light_error = light / g->cos_light + 6.0 * TOL_UNIT; /* those of +z, where nothing else cancels */
        g->view_error = view / g->cos_view + 6.0 * TOL_UNIT;
        g->difference_error = (input + 10.0 * TOL_UNIT) / g->cos_difference;
    } else if (general) {
        across += 27.0 * TOL_UNIT;
        sum += 27.0 * TOL_UNIT;
        distance += 54.0 * TOL_UNIT;
        g->light_error = (light + 13.0 * TOL_UNIT) / g->cos_light;
        g->view_error = (view + 13.0 * TOL_UNIT) / g->cos_view;
        g->difference_error = (input + 10.0 * TOL_UNIT) / g->cos_difference;
    } else { /* +z: cosines are components, and n.h is a sum of two positive ones */
        across += 12.0 * TOL_UNIT;
        distance += 24.0 * TOL_UNIT;
        g->light_error = light / g->cos_light + 6.0 * TOL_UNIT;
        g->view_error = view / g->cos_view + 6.0 * TOL_UNIT;
        g->difference_error = (input + 10.0 * TOL_UNIT) / g->cos_difference;
    }
    g->tangent_error = (across + tangent * sum) / cosines + 16.0 * TOL_UNIT * tangent;
    g->tan2_error = ENOUGH * g->tangent_error * (2.0 * tangent + g->tangent_error);
    g->mirror_error = distance;
    g->versine_error = rounding_of_versine(g);
    g->versine_light_error = rounding_of_side_versine(g->versine_light, g->cos_light, 0.5 * input);
    g->versine_view_error = rounding_of_side_versine(g->versine_view, g->cos_view, 0.5 * input);
}

/* Angles that are given are exact. */
static inline void rounding_of_angles(struct geometry_angles *g)
{
    g->accurate = 0;
    g->light_error = g->view_error = g->difference_error = 0.0;
    g->tangent_error = g->tan2_error = g->mirror_error = 0.0;
    g->versine_error = g->versine_light_error = g->versine_view_error = 2.0 * TOL_UNIT;
}

/* Of 1 + tan^2 alpha, relative. */
static inline double rounding_of_cos2(const struct geometry_angles *g)
{
    return g->tan2_error / (1.0 + g->tan2_half) + 2.0 * TOL_UNIT;
}

/* Of min(n.l / n.v, 1) (or of min(n.v / n.l, 1), cosines exchanged): none where the 1 leaves no doubt. */
static inline double rounding_of_side(double first, double second, double first_error, double second_error)
{
    return first > 1.02 * second ? 0.0 : first_error + second_error;
}

/* Of the V-cavities' G / (n.v), relative: min{ 1 / (n.v), shared min(1, n.l / n.v) }, shared = 2 (n.h) / (v.h). */
static inline double rounding_of_masking(const struct geometry_angles *g, double masking)
{
    double shared = 0.5 * rounding_of_cos2(g) + g->difference_error +
                    rounding_of_side(g->cos_light, g->cos_view, g->light_error, g->view_error);

    return masking < 0.98 ? shared : larger(shared, g->view_error);
}

/* Of ln(1 + tan^2 alpha) / 2, which was computed as c: kernel_log1p is within 7 u. */
static inline double rounding_of_log(const struct geometry_angles *g, double c)
{
    return 0.5 * ENOUGH * g->tan2_error / (1.0 + g->tan2_half) + 8.0 * TOL_UNIT * c;
}

#endif
