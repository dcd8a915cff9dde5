/*
 * Torrance and Sparrow (1967), the paper's section 6: s = 1 / sigma^2, lambda(s) = 1, c = alpha^2,
 * alpha^2 = atan(sqrt(tan^2 alpha))^2; b = G / (pi (n.v)). SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/atan.h"
#include "base/constants.h"
#include "model/exponential.h"
#include "model/masking.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    double alpha = kernel_atan(sqrt(g->tan2_half));

    out->b = masking_v_cavity(g) / (PI * g->cos_view);
    out->c = alpha * alpha;
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
