/*
 * Lafortune et al. (1997) with one mirror lobe, -C_x = -C_y = C_z: s = n, lambda(s) = (n + 2) / (2 pi), b = n.l
 * (0 where r.v <= 0), c = -ln(r.v) with r = 2 (n.l) n - l the mirrored light.
 *
 * r.v = 2 (n.l)(n.v) - l.v, and with h = l + v: 1 + l.v = |h|^2 / 2 = [ (n.h)^2 + |n x h|^2 ] / 2, n.h = n.l + n.v,
 * |n x h|^2 = tan^2 alpha (n.h)^2. So
 *
 *     1 - r.v = [ (n.l - n.v)^2 + tan^2 alpha (n.l + n.v)^2 ] / 2
 *
 * Condition. c = -ln(r.v): |dc| = d(r.v) / (r.v), without limit as the viewer comes to be 90 degrees off the mirror
 * direction; and there (r.v)^n is far from flat, because exponents may be small: 1e-17 to the power of 0.1 is 2 %. Within
 * twice its error of 0 nobody can tell r.v from 0: such samples have no lobe here (b = 0), and the greatest lobe that they
 * may have, n.l (r.v + error)^n, is told as hidden. Near the mirror direction |dc| = |r - v| d|r - v|. b: that of n.l.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/constants.h"
#include "base/log1p.h"
#include "base/tolerance.h"
#include "base/log.h"
#include "model/exponential.h"
#include "model/rounding.h"

/* r.v is about 0: what the sample hides, if it may be above. */
static void hide(const struct geometry_angles *g, double mirror, double off, struct geometry *out)
{
    out->b = out->c = out->c_error = 0.0;
    if (mirror > -off) {
        out->b_hidden = g->cos_light * (1.0 + out->b_error);
        out->c_hidden = -kernel_log(mirror + off);
    }
}

/* Viewers more than 90 degrees off the mirror direction see no lobe. */
static void row(const struct geometry_angles *g, struct geometry *out)
{
    double difference = g->cos_light - g->cos_view, sum = g->cos_light + g->cos_view, error = g->mirror_error, q, off;
    double mirror;

    if (!g->accurate && fabs(difference) <= TOL_ANGLE) {
        difference = 0.0; /* roundings of the two cosines; a mirror pair is one, and c = 0 there */
        error += TOL_ANGLE;
    }
    q = g->accurate ? g->off_mirror : 0.5 * (difference * difference + g->tan2_half * (sum * sum));
    mirror = g->accurate ? g->mirror : 1.0 - q;
    off = ENOUGH * error * (sqrt(2.0 * q) + error) + 8.0 * TOL_UNIT * q;
    out->b_error = g->light_error;
    if (!(mirror > 2.0 * off)) {
        hide(g, mirror, off, out);
        return;
    }
    out->b = g->cos_light;
    out->c = g->accurate && q >= 0.5 ? -kernel_log(mirror) : -kernel_log1p(-q);
    out->c_error = off / (mirror - off) + 8.0 * TOL_UNIT * out->c;
}

static double lambda(double s)
{
    return (s + 2.0) / (2.0 * PI);
}

const struct lobe_kind brdffit_lobe_lafortune = {
    .name = "lafortune",
    .title = "Lafortune",
    .reflectance = 1.0,
    .by_exponent = 1,
    .mirrored = 1,
    .row = row,
    .table_kind = TABLE_ROW_NONE,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};
