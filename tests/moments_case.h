/*
 * Random reduced problems with their insides in hand, and the same quantities in long double from the samples
 * themselves. Shared by test_moments.c and test_interval.c. SPDX-License-Identifier: MIT
 */
#ifndef MOMENTS_CASE_H
#define MOMENTS_CASE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "fit/fit.h"
#include "model/geometry.h"
#include "support.h"
#include "base/tolerance.h"

#define MC_SAMPLES 48
#define MC_CHANNELS 3

struct moments_case {
    size_t count, channels;
    double a[MC_SAMPLES], b[MC_SAMPLES], c[MC_SAMPLES], values[MC_SAMPLES * MC_CHANNELS];
    double light[3 * MC_SAMPLES], view[3 * MC_SAMPLES];
    brdffit_samples samples;
    brdffit_options options;
    struct fit fit;
    void *workspace;
    long double c_min;
    int negative, ggx;
};

/* Half-vector angles as instruments have them, spans that no instrument has, and everything within a hair. */
static inline double mc_tan2(struct brdffit_test_random *random, int kind, size_t i)
{
    switch (kind) {
    case 0: return i % 4 ? brdffit_test_uniform(random, 0.0, 1.5) : 0.0;
    case 1: return brdffit_test_log_uniform(random, 1e-12, 1e12);
    case 2: return 0.7 + brdffit_test_uniform(random, 0.0, 1e-9);
    case 3: return pow(tan(0.04 * (double)(i / 3)), 2.0);
    default: return brdffit_test_log_uniform(random, 1e-25, 1e-20) + (i % 5 ? 0.0 : 0.1);
    }
}

static inline void mc_fill(struct moments_case *m, struct brdffit_test_random *random)
{
    int kind = (int)brdffit_test_below(random, 5), wide_b = brdffit_test_below(random, 4) == 0;
    size_t i, k;

    for (i = 0; i < m->count; i++) {
        m->a[i] = brdffit_test_uniform(random, 0.0, 0.32);
        m->b[i] = wide_b ? brdffit_test_log_uniform(random, 1e-20, 1e3) : brdffit_test_uniform(random, 0.1, 4.0);
        m->c[i] = mc_tan2(random, kind, i);
        for (k = 0; k < m->channels; k++) {
            m->values[i * m->channels + k] = brdffit_test_uniform(random, m->negative ? -0.5 : 0.0, 1.0);
        }
    }
}

/*
 * Directions instead: a goniometer in one plane, turned from sample to sample, so that half-vector angles repeat up to
 * their rounding. The reduction merges such c; a, b and c here are the ones before that.
 */
static inline void mc_directions(struct moments_case *m)
{
    size_t i;

    m->samples.form = BRDFFIT_FORM_DIRECTIONS;
    m->samples.light = m->light;
    m->samples.view = m->view;
    for (i = 0; i < m->count; i++) {
        double turn = 0.1309 * (double)i, theta = 0.05 * (double)(1 + i % 7), tilt = 0.1 * (double)(i % 5);
        struct geometry g;
        brdffit_status status;

        m->light[3 * i] = sin(theta + tilt) * cos(turn);
        m->light[3 * i + 1] = sin(theta + tilt) * sin(turn);
        m->light[3 * i + 2] = cos(theta + tilt);
        m->view[3 * i] = sin(tilt - theta) * cos(turn);
        m->view[3 * i + 1] = sin(tilt - theta) * sin(turn);
        m->view[3 * i + 2] = cos(tilt - theta);
        assert_int_equal(brdffit_geometry_sample(&m->samples, BRDFFIT_BECKMANN, 0.0, i, &g, &status, NULL),
                         BRDFFIT_SKIP_COUNT);
        assert_int_equal(status, BRDFFIT_OK);
        m->a[i] = g.a;
        m->b[i] = g.b;
        m->c[i] = g.c;
    }
}

static inline void mc_new(struct moments_case *m, uint64_t seed)
{
    struct brdffit_test_random random = {seed * 7919};
    struct arena arena;
    size_t size;

    m->count = 1 + brdffit_test_below(&random, MC_SAMPLES);
    m->channels = 1 + brdffit_test_below(&random, MC_CHANNELS);
    m->negative = brdffit_test_below(&random, 3) == 0;
    m->ggx = brdffit_test_below(&random, 2) == 0;
    mc_fill(m, &random);
    m->samples = brdffit_test_coefficients(m->count, m->channels, m->a, m->b, m->c, m->values);
    if (brdffit_test_below(&random, 5) == 0) {
        mc_directions(m);
    }
    brdffit_options_init(&m->options);
    m->options.max_incidence = 90.0;
    m->options.lobes = 2;
    m->options.distribution = m->ggx ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
    m->options.box_budget = 96;
    size = brdffit_workspace_size(m->count, m->channels, &m->options);
    m->workspace = malloc(size);
    assert_non_null(m->workspace);
    brdffit_arena_init(&arena, m->workspace, size);
    brdffit_fit_layout(&m->fit, &arena, m->count, m->channels, &m->options);
    assert_int_equal(brdffit_reduce(&m->fit.data, &m->samples, &m->fit.model, &m->options, NULL), BRDFFIT_OK);
    brdffit_fit_prepare(&m->fit, &m->options);
    m->c_min = (long double)m->fit.data.table[0].c_min;
}

/* No lobe of the range has a finite coefficient: the fit drops them, and there is nothing to compare. */
static inline int mc_without_lobes(const struct moments_case *m)
{
    return !(m->fit.data.table[0].bb[0] > 0.0) || m->fit.domain[0].flat < m->fit.domain[0].low;
}

static inline void mc_free(struct moments_case *m)
{
    free(m->workspace);
}

/* In the units of the reduction; dividing by powers of two is exact. */
static inline long double mc_a(const struct moments_case *m, size_t i)
{
    return (long double)m->a[i] / m->fit.data.scale_a[0];
}

static inline long double mc_b(const struct moments_case *m, size_t i)
{
    return (long double)m->b[i] / m->fit.data.table[0].scale_b;
}

static inline long double mc_value(const struct moments_case *m, size_t i, size_t k)
{
    return (long double)m->values[i * m->channels + k] / (m->fit.data.channel_scale[k] * m->fit.data.value_scale);
}

/* The variable of the family in which phi is what it is. */
static inline long double mc_u(const struct moments_case *m, double theta)
{
    long double s = expl((long double)theta);

    return m->ggx ? s / (1.0L + m->c_min * s) : s;
}

static inline long double mc_phi(const struct moments_case *m, size_t i, long double u)
{
    long double c = (long double)m->c[i] - m->c_min;

    return m->ggx ? 1.0L / ((1.0L + c * u) * (1.0L + c * u)) : expl(-c * u);
}

/* x = -d ln phi / du. */
static inline long double mc_x(const struct moments_case *m, size_t i, long double u)
{
    long double c = (long double)m->c[i] - m->c_min;

    return m->ggx ? 2.0L * c / (1.0L + c * u) : c;
}

/* Weight of sample i in functional f (reduce.h). */
static inline long double mc_weight(const struct moments_case *m, size_t i, size_t f)
{
    long double value;

    if (f == 0) {
        return mc_a(m, i) * mc_b(m, i);
    }
    value = mc_value(m, i, (f - 1) % m->channels);
    value = f > m->channels ? -value : value;
    return value > 0.0L ? value * mc_b(m, i) : 0.0L;
}

/* Everything exact at one point: the shapes, |a|, |g|, kappa and tau. */
struct mc_exact {
    long double u, shape[MC_SAMPLES], h, kappa, tau[MC_CHANNELS];
};

static inline void mc_evaluate(const struct moments_case *m, double theta, struct mc_exact *e)
{
    long double aa = 0.0L, ag = 0.0L;
    size_t i, k;

    e->u = mc_u(m, theta);
    e->h = 0.0L;
    for (i = 0; i < m->count; i++) {
        e->shape[i] = mc_b(m, i) * mc_phi(m, i, e->u);
        e->h += e->shape[i] * e->shape[i];
        ag += mc_a(m, i) * e->shape[i];
        aa += mc_a(m, i) * mc_a(m, i);
    }
    e->kappa = ag / sqrtl(aa * e->h);
    for (k = 0; k < m->channels; k++) {
        e->tau[k] = 0.0L;
        for (i = 0; i < m->count; i++) {
            e->tau[k] += mc_value(m, i, k) * e->shape[i];
        }
        e->tau[k] /= sqrtl(e->h);
    }
}

static inline long double mc_mu(const struct moments_case *m, const struct mc_exact *p, const struct mc_exact *q)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < m->count; i++) {
        sum += p->shape[i] * q->shape[i];
    }
    return sum / sqrtl(p->h * q->h);
}

#endif
