/*
 * Small fits and what their samples are in a reading: directions as doubles, moved, or of exact angles. E^2 in 113 bits at
 * many roughnesses, each an upper bound of the least one. Include once in a test. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ROUNDING_PROBLEM_H
#define BRDFFIT_TESTS_ROUNDING_PROBLEM_H

#include "base/tolerance.h"
#include "rounding_scene.h"

#define MOST 160

/* Directions of a reading, and the data: radiance or f_r of one channel. */
struct reading {
    size_t count;
    quad light[MOST][3], view[MOST][3], normal[MOST][3], value[MOST];
    int brdf;
    quad scale; /* channel_scale of the result */
};

struct problem {
    double light[MOST][3], view[MOST][3], normal[MOST][3], value[MOST];
    brdffit_samples samples;
    brdffit_options options;
};

static inline void problem_start(struct problem *p)
{
    brdffit_samples_init(&p->samples);
    brdffit_options_init(&p->options);
    p->samples.channels = 1;
    p->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    p->samples.light = &p->light[0][0];
    p->samples.view = &p->view[0][0];
    p->samples.values = p->value;
    p->options.max_incidence = 90.0;
    p->options.box_budget = 20000;
}

/* `by`: radians that every direction is moved; but mirror images within TOL_ANGLE are mirror images (data/charge.h). */
static inline void read_doubles(struct brdffit_test_random *random, const struct problem *p, quad by, struct reading *r)
{
    size_t i;

    r->count = p->samples.count;
    r->brdf = p->samples.quantity == BRDFFIT_QUANTITY_BRDF;
    for (i = 0; i < r->count; i++) {
        static const double up[3] = {0.0, 0.0, 1.0};
        const double *normal = p->samples.normal ? p->normal[i] : up;
        quad distance = by;

        moved(random, p->light[i], 0, r->light[i]);
        moved(random, p->view[i], 0, r->view[i]);
        moved(random, normal, 0, r->normal[i]);
        if (oracle_angles(r->light[i], r->view[i], r->normal[i]).tan2 <= 8 * (quad)TOL_ANGLE * TOL_ANGLE) {
            distance = 0;
        }
        moved(random, p->light[i], distance, r->light[i]);
        moved(random, p->view[i], distance, r->view[i]);
        moved(random, normal, p->samples.normal ? distance : 0, r->normal[i]);
        r->value[i] = p->value[i];
    }
}

/* Samples that count, and the columns a and g of some s. */
struct columns {
    quad b[MOST], c[MOST], column[3][MOST], data[MOST], least;
    size_t count;
};

static inline void open_columns(const struct reading *r, brdffit_distribution d, struct columns *out)
{
    size_t i;

    out->count = 0;
    out->least = -1;
    for (i = 0; i < r->count; i++) {
        struct oracle_angles at = oracle_angles(r->light[i], r->view[i], r->normal[i]);
        struct oracle_row row;

        if (!(at.light > 0 && at.view > 0)) {
            continue;
        }
        row = oracle_row(d, &at);
        out->column[0][out->count] = row.a;
        out->b[out->count] = row.b;
        out->c[out->count] = row.c;
        out->data[out->count] = r->value[i] * (r->brdf ? at.light : 1) / r->scale;
        out->least = row.b > 0 && (out->least < 0 || row.c < out->least) ? row.c : out->least;
        out->count++;
    }
}

/* Column p + 1 at s; `least`: the c where the shape is 1. */
static inline void columns_at(struct columns *m, int p, brdffit_distribution d, quad s, quad least)
{
    size_t i;

    for (i = 0; i < m->count; i++) {
        m->column[1 + p][i] = m->b[i] > 0 ? m->b[i] * oracle_shape(d, s, m->c[i], least) : 0;
    }
}

/* The norm's objective at coefficients of n columns. */
static inline quad objective(const struct columns *m, brdffit_norm norm, int n, const quad *z)
{
    quad sum = 0;
    size_t i;
    int j;

    for (i = 0; i < m->count; i++) {
        quad r = m->data[i];

        for (j = 0; j < n; j++) {
            r -= z[j] * m->column[j][i];
        }
        r = fabsq(r);
        sum = norm == BRDFFIT_NORM_L2 ? sum + r * r : norm == BRDFFIT_NORM_L1 ? sum + r : fmaxq(sum, r);
    }
    return sum;
}

/* z of the columns in `support`, 0 elsewhere, by Cholesky's factors of unit columns; 0 when they are dependent or z is negative. */
static inline int solve_support(const struct columns *m, int n, unsigned support, quad *z)
{
    quad g[3][4], size[3];
    int index[3], k = 0, i, j, l;
    size_t r;

    for (j = 0; j < n; j++) {
        z[j] = 0;
        if (support >> j & 1) {
            index[k++] = j;
        }
    }
    for (i = 0; i < k; i++) {
        size[i] = 0;
        for (r = 0; r < m->count; r++) {
            size[i] += m->column[index[i]][r] * m->column[index[i]][r];
        }
        size[i] = sqrtq(size[i]);
        if (!(size[i] > 0)) {
            return 0;
        }
    }
    for (i = 0; i < k; i++) {
        for (j = 0; j <= k; j++) {
            g[i][j] = 0;
            for (r = 0; r < m->count; r++) {
                g[i][j] += m->column[index[i]][r] / size[i] * (j < k ? m->column[index[j]][r] / size[j] : m->data[r]);
            }
        }
    }
    for (i = 0; i < k; i++) { /* positive definite: no pivoting */
        if (!(g[i][i] > (quad)1e-25)) {
            return 0;
        }
        for (l = i + 1; l < k; l++) {
            for (j = k; j >= i; j--) {
                g[l][j] -= g[l][i] / g[i][i] * g[i][j];
            }
        }
    }
    for (i = k - 1; i >= 0; i--) {
        for (j = i + 1; j < k; j++) {
            g[i][k] -= g[i][j] * z[index[j]] * size[j];
        }
        z[index[i]] = g[i][k] / g[i][i] / size[i];
        if (!(z[index[i]] >= 0)) {
            return 0;
        }
    }
    return 1;
}

/* The least in l2 over coefficients >= 0 of n columns. */
static inline quad least_squares(const struct columns *m, int n)
{
    quad best = (quad)INFINITY, z[3];
    unsigned support;

    for (support = 0; support < 1u << n; support++) {
        if (solve_support(m, n, support, z)) {
            best = fminq(best, objective(m, BRDFFIT_NORM_L2, n, z));
        }
    }
    return best;
}

/* s of lobe p as the reported sigma says it. */
static inline quad reported_s(const brdffit_result *r, int p)
{
    return 1 / ((quad)r->model->sigma[p] * r->model->sigma[p]);
}

/* Objective at the reported parameters. */
static inline quad at_model(const struct reading *r, const struct problem *p, const brdffit_result *result)
{
    quad z[3] = {result->model->x[0] / r->scale};
    struct columns m;
    int j;

    open_columns(r, p->options.distribution, &m);
    for (j = 0; j < p->options.lobes; j++) {
        quad s = reported_s(result, j);

        columns_at(&m, j, p->options.distribution, s, 0);
        z[1 + j] = result->model->y[j] * oracle_lambda(p->options.distribution, s) / r->scale;
    }
    return objective(&m, p->options.norm, 1 + p->options.lobes, z);
}

/* The domain of s. */
struct range {
    quad low, high;
};

static inline struct range range_of(const struct problem *p, const brdffit_result *result)
{
    int exponent = oracle_by_exponent(p->options.distribution);
    quad low = exponent ? (quad)p->options.exponent_min : 1 / ((quad)p->options.sigma_max * p->options.sigma_max);
    quad high = exponent ? (quad)p->options.exponent_max : 1 / ((quad)p->options.sigma_min * p->options.sigma_min);
    struct range range = {low, fminq(high, 1 / ((quad)result->sigma_floor * result->sigma_floor))};

    return range;
}

static inline quad inside(const struct range *range, quad s)
{
    return fminq(fmaxq(s, range->low), range->high);
}

static inline quad try_at(struct columns *m, const struct problem *p, int lobe, quad s)
{
    columns_at(m, lobe, p->options.distribution, s, m->least);
    return least_squares(m, 1 + p->options.lobes);
}

/* The least objective met at many s of the domain, and near the reported ones: all of them bound the truth from above. */
static inline quad least_met(const struct reading *r, const struct problem *p, const brdffit_result *result)
{
    const struct range range = range_of(p, result);
    quad best, at[2], width = (quad)0.1;
    struct columns m;
    int i, j, lobes = p->options.lobes;

    if (p->options.norm != BRDFFIT_NORM_L2) {
        return at_model(r, p, result);
    }
    open_columns(r, p->options.distribution, &m);
    for (j = 0; j < lobes; j++) {
        at[j] = inside(&range, reported_s(result, j));
        columns_at(&m, j, p->options.distribution, at[j], m.least);
    }
    best = least_squares(&m, 1 + lobes);
    for (j = 0; j < lobes; j++) {
        for (i = 0; i <= 60; i++) {
            best = fminq(best, try_at(&m, p, j, range.low * powq(range.high / range.low, (quad)i / 60)));
        }
        width = (quad)0.1;
        for (i = 0; i < 40; i++, width *= i % 2 ? 1 : (quad)0.5) { /* closer and closer */
            best = fminq(best, try_at(&m, p, j, inside(&range, at[j] * (1 + (i % 2 ? width : -width)))));
        }
        best = fminq(best, try_at(&m, p, j, at[j]));
    }
    return best;
}

static inline void check_bound(const struct problem *p, const brdffit_result *result, const struct reading *r,
                               const char *what)
{
    quad least = least_met(r, p, result);

    if ((quad)result->lower_bound > least * (1 + (quad)1e-25)) {
        fail_msg("%s, %s: lower bound %.17g of e2 %.17g is above %.17g, by %g of it (sigma %.17g)",
                 brdffit_distribution_string(p->options.distribution), what, result->lower_bound, result->e2,
                 (double)least, (double)(result->lower_bound / least - 1), result->model->sigma[0]);
    }
}

#endif
