/*
 * Beckmann's distribution in Cook and Torrance's model (1982), as the paper's equations 1 to 4 write it:
 * s = 1 / sigma^2, lambda(s) = s, c = tan^2 alpha. SPDX-License-Identifier: MIT
 */
#include "model/cook_torrance.h"
#include "model/exponential.h"

static double lambda(double s)
{
    return s;
}

const struct lobe_kind brdffit_lobe_beckmann = {
    .name = "beckmann",
    .title = "Beckmann",
    .reflectance = 4.0,
    .row = brdffit_cook_torrance_row,
    .table_kind = TABLE_ROW_SHADOWED,
    .table_factor = brdffit_cook_torrance_table_factor,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
