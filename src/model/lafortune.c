/*
 * Lafortune et al. (1997) with one mirror lobe, -C_x = -C_y = C_z: s = n, lambda(s) = (n + 2) / (2 pi), b = n.l
 * (0 where r.v <= 0), c = -ln(r.v) with r = 2 (n.l) n - l the mirrored light.
 *
 * r.v = 2 (n.l)(n.v) - l.v, and with h = l + v: 1 + l.v = |h|^2 / 2 = [ (n.h)^2 + |n x h|^2 ] / 2, n.h = n.l + n.v,
 * |n x h|^2 = tan^2 alpha (n.h)^2. So
 *
 *     1 - r.v = [ (n.l - n.v)^2 + tan^2 alpha (n.l + n.v)^2 ] / 2 SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/constants.h"
#include "base/log1p.h"
#include "base/tolerance.h"
#include "model/exponential.h"

/* Viewers more than 90 degrees off the mirror direction see no lobe. */
static void row(const struct geometry_angles *g, struct geometry *out)
{
    double difference = g->cos_light - g->cos_view, sum = g->cos_light + g->cos_view, q;

    if (fabs(difference) <= TOL_ANGLE) {
        difference = 0.0; /* roundings of the two cosines; a mirror pair is one, and c = 0 there */
    }
    q = 0.5 * (difference * difference + g->tan2_half * (sum * sum));
    out->b = q < 1.0 ? g->cos_light : 0.0;
    out->c = q < 1.0 ? -kernel_log1p(-q) : 0.0;
}

static double lambda(double s)
{
    return (s + 2.0) / (2.0 * PI);
}

const struct lobe_kind brdffit_lobe_lafortune = {
    .name = "lafortune",
    .by_exponent = 1,
    .row = row,
    .table_kind = TABLE_ROW_NONE,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
