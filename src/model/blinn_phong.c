/*
 * Blinn (1977) with today's factor: s = n, lambda(s) = (n + 2) / (2 pi), b = n.l, c = -ln cos alpha,
 * taken as ln(1 + tan^2 alpha) / 2: near the mirror direction every digit of c counts, and a cosine near 1 has lost them.
 *
 * Condition. c: |dc| = tan alpha d(tan alpha) / (1 + tan^2 alpha), beside 7 u of c itself from the logarithm, which counts
 * where alpha is large. b: the relative error of n.l. SPDX-License-Identifier: MIT
 */
#include "base/constants.h"
#include "base/log1p.h"
#include "model/exponential.h"
#include "model/rounding.h"

static void row(const struct geometry_angles *g, struct geometry *out)
{
    out->b = g->cos_light;
    out->c = 0.5 * kernel_log1p(g->tan2_half);
    out->b_error = g->light_error;
    out->c_error = rounding_of_log(g, out->c);
}

static double lambda(double s)
{
    return (s + 2.0) / (2.0 * PI);
}

const struct lobe_kind brdffit_lobe_blinn_phong = {
    .name = "blinn-phong",
    .title = "Blinn-Phong",
    .reflectance = 1.0,
    .by_exponent = 1,
    .row = row,
    .table_kind = TABLE_ROW_LIGHT,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
