/*
 * The geometry that Beckmann and GGX share (theory 1): c = tan^2 alpha, b = G / (pi (n.v) cos^4 alpha), G by V-cavities.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_COOK_TORRANCE_H
#define BRDFFIT_COOK_TORRANCE_H

#include "model/geometry.h"

void brdffit_cook_torrance_row(const struct geometry_angles *angles, struct geometry *out);
double brdffit_cook_torrance_table_factor(double cos2_half);

#endif
