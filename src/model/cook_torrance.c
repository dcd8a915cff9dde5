/*
 * Geometry of Cook and Torrance: see cook_torrance.h. SPDX-License-Identifier: MIT
 */
#include "model/cook_torrance.h"
#include "base/constants.h"
#include "model/masking.h"

void brdffit_cook_torrance_row(const struct geometry_angles *g, struct geometry *out)
{
    double cos2 = cos2_half(g);

    out->b = masking_v_cavity(g) / (PI * g->cos_view * cos2 * cos2);
    out->c = g->tan2_half;
}

double brdffit_cook_torrance_table_factor(double cos2_half)
{
    return 1.0 / (PI * (cos2_half * cos2_half));
}
