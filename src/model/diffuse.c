/*
 * Columns without a shape: see diffuse.h. SPDX-License-Identifier: MIT
 */
#include "model/diffuse.h"

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

static double fifth(double x)
{
    double square = x * x;

    return square * square * x;
}

/*
 * cos(azimuths) sin(a) tan(b) = [l.v - (n.l)(n.v)] / max(n.l, n.v), with l.v = 1 - 4 t + 2 t^2 for t = 1 - v.h, since l.v =
 * 2 (v.h)^2 - 1. Its error is that of l.v (4 t times the relative one of t), of the product, and a few u.
 */
static void oren_nayar(const struct geometry_angles *g, double a, double *column, double *error)
{
    double t = g->versine, product = g->cos_light * g->cos_view, most = larger(g->cos_light, g->cos_view);
    double part = (1.0 - 4.0 * t + 2.0 * (t * t)) - product;
    double off = 4.0 * t * g->versine_error + product * (g->light_error + g->view_error) + 8.0 * TOL_UNIT;

    *column = part > 0.0 ? a * part / most : 0.0;
    *error = ENOUGH * (a * off / most + *column * (larger(g->light_error, g->view_error) + 4.0 * TOL_UNIT));
}

/* The three columns of Burley's term; what is taken from 1 is known to a few u, whatever it is made of. */
static void burley(const struct geometry_angles *g, double a, double *column, double *error)
{
    double l = fifth(1.0 - g->cos_light), v = fifth(1.0 - g->cos_view), d = 1.0 - g->versine, both = l * v;
    double off_l = 5.0 * g->cos_light * g->light_error + 16.0 * TOL_UNIT;
    double off_v = 5.0 * g->cos_view * g->view_error + 16.0 * TOL_UNIT, off_d = g->versine * g->versine_error;

    column[0] = a * (1.0 - 0.5 * l) * (1.0 - 0.5 * v);
    column[1] = a * 2.0 * (d * d) * (l + v - both);
    column[2] = a * 4.0 * (d * d) * (d * d) * both;
    error[0] = ENOUGH * a * (off_l + off_v);
    error[1] = ENOUGH * a * (2.0 * (off_l + off_v) + 8.0 * off_d);
    error[2] = ENOUGH * a * (4.0 * (off_l + off_v) + 16.0 * off_d);
}

void brdffit_diffuse_row(brdffit_diffuse diffuse, const struct geometry *g, double column[FIXED_MOST],
                         double error[FIXED_MOST])
{
    column[0] = diffuse == BRDFFIT_DIFFUSE_NONE ? 0.0 : g->a;
    error[0] = 0.0;
    if (diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR) {
        oren_nayar(&g->angles, g->a, column + 1, error + 1);
    } else if (diffuse == BRDFFIT_DIFFUSE_BURLEY) {
        burley(&g->angles, g->a, column, error);
    }
}

void brdffit_schlick_column(struct geometry *g)
{
    double w = schlick_weight(&g->angles);

    g->b *= w;
    g->b_hidden *= w;
    g->b_error += w > 0.0 ? ENOUGH * 5.0 * g->angles.versine_error + 6.0 * TOL_UNIT : 0.0;
}
