/*
 * Curvature for general families: see interval_family.h and the formula in interval.c.
 * SPDX-License-Identifier: MIT
 *
 * For one c, x = -ell(u, c) falls with u, and the mean of x falls with u too (H is log-convex), so
 * (x - mean)^2 over the interval is at most its largest value at the four combinations of ends, and at least
 * the squared distance of the two ranges [x(u), x(l)] and [mean(u), mean(l)]; slope >= 0 falls with u.
 */
#include "bound/moment/interval_family.h"

#include <math.h>

#include "base/tolerance.h"

#define UP (1.0 + TOL_CURVATURE)
#define DOWN (1.0 - TOL_CURVATURE)

/* Ranges over an interval of (x - mean)^2 and slope at one c. */
struct local {
    double square_low, square_high, slope_low, slope_high;
};

static struct local local_ranges(const struct lobe_kind *kind, double c, const struct interval *v)
{
    double ell_l, ell_u, down, up;
    struct local r;

    kind->slope(c, v->low->u, &ell_l, &r.slope_high);
    kind->slope(c, v->high->u, &ell_u, &r.slope_low);
    down = -ell_u - v->low->mean;  /* smallest x - mean */
    up = -ell_l - v->high->mean;   /* largest */
    r.square_high = fmax(down * down, up * up);
    r.square_low = down > 0.0 ? down * down : up < 0.0 ? up * up : 0.0;
    return r;
}

void brdffit_general_curvature(struct moments *m, const struct interval *v, double *low, double *high)
{
    const struct reduced *data = m->data;
    const double *phi_l = brdffit_moments_shape(m, v->low, m->scratch);
    const double *phi_u = brdffit_moments_shape(m, v->high, m->scratch + data->stride);
    double below = 0.0, above = 0.0;
    size_t j;

    for (j = 0; j < data->distinct; j++) {
        struct local r = local_ranges(m->kind, data->c[j], v);

        below += data->bb[j] * (phi_u[j] * phi_u[j]) * (r.slope_low + 2.0 * r.square_low);
        above += data->bb[j] * (phi_l[j] * phi_l[j]) * (r.slope_high + 2.0 * r.square_high);
    }
    *low = DOWN * below / v->low->h;
    *high = UP * above / v->high->h;
}

void brdffit_general_functional(struct moments *m, const struct interval *v, size_t f, double curvature_low,
                                double curvature_high, double *low, double *high)
{
    const struct reduced *data = m->data;
    const double *phi_l = brdffit_moments_shape(m, v->low, m->scratch);
    const double *phi_u = brdffit_moments_shape(m, v->high, m->scratch + data->stride);
    const double *w = data->linear + f * data->stride;
    double below = 0.0, above = 0.0;
    size_t j;

    for (j = 0; j < data->distinct; j++) {
        struct local r = local_ranges(m->kind, data->c[j], v);

        below += w[j] * phi_u[j] * (r.square_low + r.slope_low);
        above += w[j] * phi_l[j] * (r.square_high + r.slope_high);
    }
    *high = UP * above / v->high->root - DOWN * curvature_low * (v->high->functional[f].f0 / v->low->root);
    *low = DOWN * below / v->low->root - UP * curvature_high * (v->low->functional[f].f0 / v->high->root);
}

double brdffit_general_pair(struct moments *m, const struct interval *first, const struct interval *second, int which,
                            double mu_inf)
{
    const struct reduced *data = m->data;
    const struct interval *side = which ? second : first;
    const double *phi = brdffit_moments_shape(m, first->low, m->scratch);
    const double *psi = brdffit_moments_shape(m, second->low, m->scratch + data->stride);
    double above = 0.0;
    size_t j;

    for (j = 0; j < data->distinct; j++) {
        struct local r = local_ranges(m->kind, data->c[j], side);

        above += data->bb[j] * (phi[j] * psi[j]) * (r.square_high + r.slope_high);
    }
    return UP * above / (first->high->root * second->high->root) - DOWN * (side->curvature * mu_inf);
}
