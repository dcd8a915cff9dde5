/*
 * Ward (1992), isotropic: s = 1 / sigma^2, lambda(s) = s, c = tan^2 alpha, b = sqrt((n.l) / (n.v)) / (4 pi).
 *
 * Condition. c: as in cook_torrance.h. b: half the relative errors of n.l and n.v, and it grows without limit as the viewer
 * grazes, where n.v is known least. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/constants.h"
#include "model/exponential.h"
#include "model/rounding.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    out->b = sqrt(g->cos_light / g->cos_view) / (4.0 * PI);
    out->c = g->tan2_half;
    out->b_error = 0.5 * ENOUGH * (g->light_error + g->view_error) + 6.0 * TOL_UNIT;
    out->c_error = g->tan2_error;
}

static double table_factor(double cos2_half)
{
    (void)cos2_half;
    return 1.0 / (4.0 * PI);
}

static double lambda(double s)
{
    return s;
}

const struct lobe_kind brdffit_lobe_ward = {
    .name = "ward",
    .title = "Ward",
    .reflectance = 1.0,
    .row = row,
    .table_kind = TABLE_ROW_ROOT,
    .table_factor = table_factor,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
