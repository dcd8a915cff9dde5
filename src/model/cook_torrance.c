/*
 * Geometry of Cook and Torrance: see cook_torrance.h. SPDX-License-Identifier: MIT
 */
#include "model/cook_torrance.h"
#include "base/constants.h"
#include "model/masking.h"
#include "model/rounding.h"

void brdffit_cook_torrance_row(const struct geometry_angles *g, struct geometry *out)
{
    double cos2 = cos2_half(g), masking = masking_v_cavity(g);

    out->b = masking / (PI * g->cos_view * cos2 * cos2);
    out->c = g->tan2_half;
    out->b_error = ENOUGH * (2.0 * rounding_of_cos2(g) + rounding_of_masking(g, masking)) + 12.0 * TOL_UNIT;
    out->c_error = g->tan2_error;
}

void brdffit_cook_torrance_bare_row(const struct geometry_angles *g, struct geometry *out)
{
    double cos2 = cos2_half(g);

    out->b = 1.0 / (PI * g->cos_view * cos2 * cos2);
    out->c = g->tan2_half;
    out->tan2_light = g->tan2_light;
    out->tan2_view = g->tan2_view;
    out->b_error = ENOUGH * (2.0 * rounding_of_cos2(g) + g->view_error) + 12.0 * TOL_UNIT;
    out->c_error = g->tan2_error;
}

double brdffit_cook_torrance_table_factor(double cos2_half)
{
    return 1.0 / (PI * (cos2_half * cos2_half));
}
