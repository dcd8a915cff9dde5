/*
 * Columns without a shape: see diffuse.h. SPDX-License-Identifier: MIT
 */
#include "model/diffuse.h"

#include <math.h>

#include "base/constants.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "model/rounding.h"

static const struct {
    const char *name;
    int columns;
} table[BRDFFIT_DIFFUSE_COUNT] = {
    [BRDFFIT_DIFFUSE_LAMBERT] = {"lambert", 1},
    [BRDFFIT_DIFFUSE_NONE] = {"none", 1},
    [BRDFFIT_DIFFUSE_OREN_NAYAR] = {"oren-nayar", 2},
    [BRDFFIT_DIFFUSE_BURLEY] = {"burley", 3},
};

const char *brdffit_diffuse_string(brdffit_diffuse diffuse)
{
    return (unsigned)diffuse < BRDFFIT_DIFFUSE_COUNT ? table[diffuse].name : "unknown";
}

int brdffit_diffuse_columns(brdffit_diffuse diffuse)
{
    return (unsigned)diffuse < BRDFFIT_DIFFUSE_COUNT ? table[diffuse].columns : 0;
}

const char *brdffit_fresnel_string(brdffit_fresnel fresnel)
{
    return fresnel == BRDFFIT_FRESNEL_NONE ? "none" : fresnel == BRDFFIT_FRESNEL_SCHLICK ? "schlick" : "unknown";
}

const char *brdffit_masking_string(brdffit_masking masking)
{
    static const char *const names[BRDFFIT_MASKING_COUNT] = {"v-cavity", "smith", "smith-separable", "none"};

    return (unsigned)masking < BRDFFIT_MASKING_COUNT ? names[masking] : "unknown";
}

/* F = (1 - t)^5 of Schlick, and how far it may be off: all of it where its 1 - t may count as 0 or not. */
struct fifth {
    double value, off;
};

static struct fifth fifth_of(double versine, double error)
{
    double value = schlick_fifth(versine);
    struct fifth f = {value, value * (ENOUGH * 5.0 * error + 6.0 * TOL_UNIT)};

    if (fabs(versine - LIMIT_VERSINE) <= 2.0 * error * LIMIT_VERSINE) {
        f.off = 2.0 * (LIMIT_VERSINE * LIMIT_VERSINE) * (LIMIT_VERSINE * LIMIT_VERSINE) * LIMIT_VERSINE;
    }
    return f;
}

/*
 * cos(azimuths) sin(a) tan(b) = [l.v - (n.l)(n.v)] / max(n.l, n.v), with l.v = 1 - 4 t + 2 t^2 for t = 1 - v.h, since l.v =
 * 2 (v.h)^2 - 1. Its error is that of l.v (4 t times the relative one of t), of the product, and a few u. What may be on
 * either side of LIMIT_PRODUCT may be off by as much.
 */
static void oren_nayar(const struct geometry_angles *g, double a, double *column, double *error)
{
    double t = g->versine, product = g->cos_light * g->cos_view, most = larger(g->cos_light, g->cos_view);
    double part = ((1.0 - 4.0 * t + 2.0 * (t * t)) - product) / most;
    double off = 4.0 * t * g->versine_error + product * (g->light_error + g->view_error) + 8.0 * TOL_UNIT;

    off = off / most + fabs(part) * (larger(g->light_error, g->view_error) + 4.0 * TOL_UNIT);
    *column = part > LIMIT_PRODUCT ? a * part : 0.0;
    *error = part + 2.0 * off < LIMIT_PRODUCT   ? 0.0
             : part - 2.0 * off > LIMIT_PRODUCT ? ENOUGH * a * off
                                                : ENOUGH * a * (LIMIT_PRODUCT + 2.0 * off);
}

/* The three columns of Burley's term. */
static void burley(const struct geometry_angles *g, double a, double *column, double *error)
{
    struct fifth l = fifth_of(g->versine_light, g->versine_light_error);
    struct fifth v = fifth_of(g->versine_view, g->versine_view_error);
    double d = 1.0 - g->versine, d2 = d * d, both = l.value * v.value, few = 16.0 * TOL_UNIT;
    double off = 2.0 * g->difference_error; /* of d^2, relative */

    column[0] = a * (1.0 - 0.5 * l.value) * (1.0 - 0.5 * v.value);
    column[1] = a * 2.0 * d2 * (l.value + v.value - both);
    column[2] = a * 4.0 * (d2 * d2) * both;
    error[0] = ENOUGH * a * (l.off + v.off + few);
    error[1] = ENOUGH * (a * 2.0 * d2 * (l.off + v.off) + column[1] * (off + few));
    error[2] = ENOUGH *
               (a * 4.0 * (d2 * d2) * (l.off * (v.value + v.off) + v.off * l.value) + column[2] * (2.0 * off + few));
}

void brdffit_diffuse_row(brdffit_diffuse diffuse, const struct geometry *g, double column[FIXED_MOST],
                         double error[FIXED_MOST])
{
    column[0] = diffuse == BRDFFIT_DIFFUSE_NONE ? 0.0 : g->a;
    error[0] = 0.0;
#ifndef BRDFFIT_WITHOUT_DIFFUSE
    if (diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR) {
        oren_nayar(&g->angles, g->a, column + 1, error + 1);
    } else if (diffuse == BRDFFIT_DIFFUSE_BURLEY) {
        burley(&g->angles, g->a, column, error);
    }
#endif
}

void brdffit_schlick_column(struct geometry *g)
{
    double w = schlick_weight(&g->angles);

    g->b *= w;
    g->b_hidden *= w;
    g->b_error += w > 0.0 ? ENOUGH * 5.0 * g->angles.versine_error + 6.0 * TOL_UNIT : 0.0;
}
