/*
 * Curvature sample by sample: see interval_family.h and the formula in interval.c. SPDX-License-Identifier: MIT
 *
 * For one c, x = -ell(u, c) falls with u, and the mean of x falls with u too (H is log-convex), so
 * (x - mean)^2 over the interval is at most its largest value at the four combinations of ends, and at least
 * the squared distance of the two ranges [x(u), x(l)] and [mean(u), mean(l)]; slope >= 0 falls with u.
 */
#include "bound/moment/interval_family.h"

#include "base/tolerance.h"

#define UP (1.0 + TOL_CURVATURE)
#define DOWN (1.0 - TOL_CURVATURE)

/* Scratch of the moments: two shapes, then x and slope of the two ends. */
static struct local local_of(struct moments *m, int kind, const struct interval *v)
{
    size_t stride = m->data->stride;
    struct local at;

    at.x_low = brdffit_moments_slopes(m, kind, v->low, m->scratch + 2 * stride, &at.slope_low);
    at.x_high = brdffit_moments_slopes(m, kind, v->high, m->scratch + 4 * stride, &at.slope_high);
    at.mean_low = v->low->mean;
    at.mean_high = v->high->mean;
    return at;
}

void brdffit_family_curvature(struct moments *m, int kind, const struct interval *v, double *low, double *high)
{
    const double *phi_l = brdffit_moments_shape(m, kind, v->low, m->scratch);
    const double *phi_u = brdffit_moments_shape(m, kind, v->high, m->scratch + m->data->stride);
    const struct local at = local_of(m, kind, v);
    double sum[2];

    m->kernels->curvature(m->kind[kind].table->bb, phi_l, phi_u, &at, m->data->stride, sum);
    *low = DOWN * sum[0] / v->low->h;
    *high = UP * sum[1] / v->high->h;
}

void brdffit_family_functional(struct moments *m, int kind, const struct interval *v, size_t f, double curvature_low,
                               double curvature_high, double *low, double *high)
{
    const double *phi_l = brdffit_moments_shape(m, kind, v->low, m->scratch);
    const double *phi_u = brdffit_moments_shape(m, kind, v->high, m->scratch + m->data->stride);
    const double *w = m->kind[kind].table->linear + f * m->data->stride;
    const struct local at = local_of(m, kind, v);
    double sum[2];

    m->kernels->functional_curvature(w, phi_l, phi_u, &at, m->data->stride, sum);
    *high = UP * sum[1] / v->high->root - DOWN * curvature_low * (v->high->functional[f].f0 / v->low->root);
    *low = DOWN * sum[0] / v->low->root - UP * curvature_high * (v->low->functional[f].f0 / v->high->root);
}

double brdffit_family_pair(const struct sides *b, int which, double least)
{
    struct moments *m = b->moments;
    const double *phi = brdffit_moments_shape(m, b->kind[0], b->side[0]->low, m->scratch);
    const double *psi = brdffit_moments_shape(m, b->kind[1], b->side[1]->low, m->scratch + m->data->stride);
    const double *w = reduced_cross(m->data, m->kind[b->kind[0]].geometry, m->kind[b->kind[1]].geometry);
    const struct local at = local_of(m, b->kind[which], b->side[which]);
    double above = m->kernels->pair_curvature(w, phi, psi, &at, m->data->stride);

    return UP * above / (b->side[0]->high->root * b->side[1]->high->root) - DOWN * (b->side[which]->curvature * least);
}

/* Exponential lobes: x is c', the sum about any mean follows from the pair's moments, and it is convex in that mean. */
static double beside_exponential(const struct interval *second, const struct interval *first, const struct pair *low)
{
    double middle_low = 0.5 * (second->low->mean + first->low->mean);
    double middle_high = 0.5 * (second->high->mean + first->high->mean);
    double d = low->mean - middle_low, e = low->mean - middle_high;

    d *= d;
    e *= e;
    return 4.0 * low->value * (low->variance + (d > e ? d : e));
}

double brdffit_family_beside(struct moments *m, int kind, const struct interval *second, const struct interval *first,
                             const struct pair *low)
{
    const double *phi_l, *phi_u, *w;
    struct local at;
    double sum[2];

    if (m->kind[kind].kind->exponential) {
        return beside_exponential(second, first, low);
    }
    phi_l = brdffit_moments_shape(m, kind, second->low, m->scratch);
    phi_u = brdffit_moments_shape(m, kind, second->high, m->scratch + m->data->stride);
    w = reduced_cross(m->data, m->kind[kind].geometry, m->kind[kind].geometry - m->data->bases);
    at = local_of(m, kind, second);
    at.mean_low = 0.5 * (second->low->mean + first->low->mean);
    at.mean_high = 0.5 * (second->high->mean + first->high->mean);
    m->kernels->curvature(w, phi_l, phi_u, &at, m->data->stride, sum);
    return 2.0 * sum[1];
}
