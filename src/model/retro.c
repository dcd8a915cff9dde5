/*
 * Retro-reflection: s = 1 / sigma^2, lambda(s) = s / pi, c = |l - v|^2, b = n.l. Reciprocal; for narrow lobes y (n.v) is the
 * albedo at the viewer, since exp(-s |l - v|^2) has the solid angle pi / s.
 *
 * The other form of theory 7.2's note, a half vector of the light and the mirrored viewer, needs the normal; here c does not, so that
 * cloth and beads, whose retro-reflection is not that of the surface, keep their width at every angle. Their errors were not compared.
 *
 * Condition. c: |dc| = 2 |l - v| times the error of |l - v|, small where the lobe is, as that of tan alpha in
 * cook_torrance.h. b: as Lambert's. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "base/constants.h"
#include "model/exponential.h"
#include "model/rounding.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    /* Angles that are given are exact. */
    double off = g->difference_error > 0.0 ? 2.0 * TOL_ANGLE + 12.0 * TOL_UNIT : 0.0;

    out->b = g->cos_light;
    out->c = 4.0 * g->versine * (1.0 + g->cos_difference);
    out->b_error = ENOUGH * g->light_error + 2.0 * TOL_UNIT;
    out->c_error = ENOUGH * off * (2.0 * sqrt(out->c) + off) + 16.0 * TOL_UNIT * out->c;
}

static double lambda(double s)
{
    return s / PI;
}

const struct lobe_kind brdffit_lobe_retro = {
    .name = "retro",
    .title = "retro",
    .reflectance = 1.0,
    .row = row,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
