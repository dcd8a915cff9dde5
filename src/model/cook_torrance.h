/*
 * The geometry that Beckmann and GGX share (theory 1): c = tan^2 alpha, b = G / (pi (n.v) cos^4 alpha), G by V-cavities.
 *
 * Condition. c: |dc| = 2 tan alpha d(tan alpha), small where alpha is but without a relative bound; it counts times s.
 * b: 4 tan alpha d(tan alpha) / (1 + c) from cos^4; G / (n.v) does not cancel, and where the viewer grazes below the light
 * it is 2 (n.h) / (v.h), without n.v: the relative error of n.v (u / (n.v) with a given normal) matters where G = 1, that is
 * n.v > (v.h) / 2, and where the light grazes lower still.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_COOK_TORRANCE_H
#define BRDFFIT_COOK_TORRANCE_H

#include "model/geometry.h"

void brdffit_cook_torrance_row(const struct geometry_angles *angles, struct geometry *out);

/* The same without G, and the tangents that Smith's needs. */
void brdffit_cook_torrance_bare_row(const struct geometry_angles *angles, struct geometry *out);
double brdffit_cook_torrance_table_factor(double cos2_half);

#endif
