/*
 * Torrance and Sparrow (1967), the paper's section 6: s = 1 / sigma^2, lambda(s) = 1, c = alpha^2,
 * alpha^2 = atan(sqrt(tan^2 alpha))^2; b = G / (pi (n.v)).
 *
 * Condition. c: |dc| = 2 alpha d(alpha), d(alpha) = d(tan alpha) / (1 + tan^2 alpha): as well known as directions are, also
 * at alpha = 90 degrees. b: as in cook_torrance.h, without cos^4. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/atan.h"
#include "base/constants.h"
#include "model/exponential.h"
#include "model/masking.h"
#include "model/rounding.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    double alpha = kernel_atan(sqrt(g->tan2_half)), masking = masking_v_cavity(g);
    double off = ENOUGH * ENOUGH * g->tangent_error / (1.0 + g->tan2_half) + 6.0 * TOL_UNIT * alpha;

    out->b = masking / (PI * g->cos_view);
    out->c = alpha * alpha;
    out->b_error = ENOUGH * rounding_of_masking(g, masking) + 12.0 * TOL_UNIT;
    out->c_error = off * (2.0 * alpha + off) + 2.0 * TOL_UNIT * out->c;
}

static double table_factor(double cos2_half)
{
    (void)cos2_half;
    return 1.0 / PI;
}

static double lambda(double s)
{
    (void)s;
    return 1.0;
}

const struct lobe_kind brdffit_lobe_torrance_sparrow = {
    .name = "torrance-sparrow",
    .row = row,
    .table_kind = TABLE_ROW_SHADOWED,
    .table_factor = table_factor,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
