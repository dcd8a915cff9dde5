/*
 * Rows of geometry: (a, b, c) of each distribution from the same few angles. Layer 2. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_GEOMETRY_ROWS_H
#define BRDFFIT_GEOMETRY_ROWS_H

#include "geometry.h"
#include "strip.h"

/* Fill out->a, b, c and cos_light; both cosines are above LIMIT_GRAZING, and the distribution is one of ours. */
void brdffit_geometry_row(brdffit_distribution distribution, const struct geometry_angles *angles,
                          struct geometry *out);

/* What the cells of one theta_h share: b is `factor` times the strip's b (enum strip_kind), a is n.l / pi. */
struct geometry_strip {
    enum strip_kind kind;
    double factor;
    double shared; /* of strip.h, but for 1 / (v.h) */
    double c;
};

/* 0 when c is not the row's alone (Lafortune). */
int brdffit_geometry_strip(brdffit_distribution distribution, double tan2_half, struct geometry_strip *out);

#endif
