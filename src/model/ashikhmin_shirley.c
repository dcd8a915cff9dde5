/*
 * Ashikhmin and Shirley (2000), isotropic (n_u = n_v) and without its Fresnel factor: s = n,
 * lambda(s) = (n + 1) / (8 pi), b = (n.l) / ((v.h) max(n.l, n.v)), c = -ln cos alpha = ln(1 + tan^2 alpha) / 2.
 *
 * Condition. c: as in blinn_phong.c. b: (n.l) / max(n.l, n.v) is 1 or as well known as both cosines; v.h is |l + v| / 2, and
 * the relative error of that grows as the directions become opposite, which needs both to graze. SPDX-License-Identifier: MIT
 */
#include "base/constants.h"
#include "base/log1p.h"
#include "base/vector.h"
#include "model/exponential.h"
#include "model/rounding.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    out->b = g->cos_light / (g->cos_difference * larger(g->cos_light, g->cos_view));
    out->c = 0.5 * kernel_log1p(g->tan2_half);
    out->b_error = ENOUGH * (g->difference_error +
                             rounding_of_side(g->cos_light, g->cos_view, g->light_error, g->view_error)) +
                   6.0 * TOL_UNIT;
    out->c_error = rounding_of_log(g, out->c);
}

static double lambda(double s)
{
    return (s + 1.0) / (8.0 * PI);
}

const struct lobe_kind brdffit_lobe_ashikhmin_shirley = {
    .name = "ashikhmin-shirley",
    .title = "Ashikhmin-Shirley",
    .reflectance = 1.0,
    .by_exponent = 1,
    .row = row,
    .table_kind = TABLE_ROW_SIDE,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
