/*
 * Random problems of one to three lobes, each of its own distribution, with the insides of their fit in hand, and their
 * objective in long double. Shared by test_bound_lobes.c and test_bound_lobes_conic.c. SPDX-License-Identifier: MIT
 *
 * The coefficients (a, b, c) of each sample and distribution are taken as the library's doubles, which geometry has tests
 * of its own for; weights, columns, factorisation and restricted problem are worked out here.
 */
#ifndef LOBES_CASE_H
#define LOBES_CASE_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/tolerance.h"
#include "fit/fit.h"
#include "model/geometry.h"
#include "nnls_case.h"
#include "support.h"

#define LC_SAMPLES 24
#define LC_CHANNELS 3
#define LC_LOBES BRDFFIT_MAX_LOBES
#define LC_COLUMNS (1 + LC_LOBES)

/* Without cmocka, for ref/bound_lobes_cases.c. */
#define LC_REQUIRE(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                            \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

struct lobes_case {
    int lobes;
    size_t count, channels;
    brdffit_distribution asked[LC_LOBES];
    double a[LC_SAMPLES], b[LC_SAMPLES], c[LC_SAMPLES];
    double light[LC_SAMPLES], view[LC_SAMPLES], difference[LC_SAMPLES], tan2[LC_SAMPLES];
    double weights[LC_SAMPLES], values[LC_SAMPLES * LC_CHANNELS];
    brdffit_samples samples;
    brdffit_options options;
    struct fit fit;
    void *workspace;

    /* In internal units, weights included; lobes in the model's order. */
    long double row_a[LC_SAMPLES], row_b[LC_LOBES][LC_SAMPLES], row_c[LC_LOBES][LC_SAMPLES], c_min[LC_LOBES];
    long double row_value[LC_CHANNELS][LC_SAMPLES];
    int ggx[LC_LOBES], vanished[LC_LOBES]; /* no lobe of the range has a finite coefficient: there is none */
    double true_theta[LC_LOBES]; /* of the lobes in the data, in the model's order */
};

/* ---- Which lobes ------------------------------------------------------------------------------------------ */

/* Every third problem has like lobes, every third two kinds; the named mixes of the brief come first. */
static inline void lc_draw_lobes(struct lobes_case *m, uint64_t seed, uint64_t *s)
{
    static const brdffit_distribution named[][LC_LOBES + 1] = {
        {2, BRDFFIT_BECKMANN, BRDFFIT_GGX, 0},
        {2, BRDFFIT_GGX, BRDFFIT_TORRANCE_SPARROW, 0},
        {2, BRDFFIT_WARD, BRDFFIT_LAFORTUNE, 0},
        {3, BRDFFIT_BLINN_PHONG, BRDFFIT_BECKMANN, BRDFFIT_GGX},
        {3, BRDFFIT_GGX, BRDFFIT_GGX, BRDFFIT_GGX},
        {3, BRDFFIT_GGX, BRDFFIT_BECKMANN, BRDFFIT_GGX},
        {3, BRDFFIT_BECKMANN, BRDFFIT_BECKMANN, BRDFFIT_BECKMANN},
        {3, BRDFFIT_LAFORTUNE, BRDFFIT_WARD, BRDFFIT_WARD},
        {3, BRDFFIT_ASHIKHMIN_SHIRLEY, BRDFFIT_GGX, BRDFFIT_TORRANCE_SPARROW},
        {2, BRDFFIT_GGX, BRDFFIT_GGX, 0},
    };
    size_t names = sizeof named / sizeof *named, i = (size_t)seed % (2 * names);
    int p, kinds = (int)(case_next(s) % 3);

    if (i < names) {
        m->lobes = (int)named[i][0];
        memcpy(m->asked, named[i] + 1, sizeof m->asked);
        return;
    }
    m->lobes = 1 + (int)(case_next(s) % LC_LOBES);
    for (p = 0; p < LC_LOBES; p++) {
        int again = p > 0 && (kinds == 0 || (kinds == 1 && case_next(s) % 2));

        m->asked[p] = again ? m->asked[p - 1] : (brdffit_distribution)(case_next(s) % BRDFFIT_DISTRIBUTION_COUNT);
    }
}

/* Whether the lobes are of more than one distribution. */
static inline int lc_mixed(const struct lobes_case *m)
{
    int p, mixed = 0;

    for (p = 1; p < m->lobes; p++) {
        mixed = mixed || m->asked[p] != m->asked[0];
    }
    return mixed;
}

/* Whether given coefficients may be used: one geometry only. */
static inline int lc_one_geometry(const struct lobes_case *m)
{
    int p, one = 1;

    for (p = 1; p < m->lobes; p++) {
        one = one && brdffit_lobe_kind_of(m->asked[p])->row == brdffit_lobe_kind_of(m->asked[0])->row;
    }
    return one;
}

/* ---- Samples ---------------------------------------------------------------------------------------------- */

/* Half-vector angles of an instrument: mirror samples, a few repeated; far out; all within a hair. */
static inline double lc_tan2(uint64_t *s, size_t i, int kind)
{
    double angle = kind == 0   ? 0.05 * (double)(i / 2)
                   : kind == 1 ? 1.2 * case_uniform(s)
                   : kind == 2 ? 0.02 + 0.3 * case_uniform(s)
                               : 1.3;

    if (kind == 3) {
        return i % 4 ? pow(10.0, 4.0 * case_signed(s)) : 0.0;
    }
    if (kind == 5) { /* no exponential lobe has a finite coefficient here */
        return pow(10.0, 5.0 + case_uniform(s));
    }
    return kind == 4 ? 0.3 * (1.0 + 1e-9 * case_uniform(s)) : pow(tan(angle), 2.0);
}

static inline void lc_draw_samples(struct lobes_case *m, uint64_t *s)
{
    int kind = case_next(s) % 24 == 0 ? 5 : (int)(case_next(s) % 5), wide = case_next(s) % 4 == 0,
        weighted = case_next(s) % 3 == 0;
    double span = case_next(s) % 2 ? 12.0 : 1.0;
    size_t i;

    m->count = 1 + case_next(s) % LC_SAMPLES;
    m->channels = 1 + case_next(s) % LC_CHANNELS;
    for (i = 0; i < m->count; i++) {
        m->a[i] = 0.3 * (0.1 + case_uniform(s));
        m->b[i] = wide ? pow(10.0, -20.0 * case_uniform(s)) : 0.3 + 3.0 * case_uniform(s) * case_uniform(s);
        m->tan2[i] = m->c[i] = lc_tan2(s, i, kind);
        m->light[i] = 0.02 + 0.98 * case_uniform(s);
        m->view[i] = kind == 0 && i % 3 == 0 ? m->light[i] : 0.02 + 0.98 * case_uniform(s);
        m->difference[i] = 0.1 + 0.9 * case_uniform(s);
        m->weights[i] = pow(10.0, span * case_signed(s));
    }
    brdffit_samples_init(&m->samples);
    m->samples.form = BRDFFIT_FORM_ANGLES;
    m->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    if (lc_one_geometry(m) && case_next(s) % 2) {
        m->samples.form = BRDFFIT_FORM_COEFFICIENTS;
    }
    m->samples.count = m->count;
    m->samples.channels = m->channels;
    m->samples.a = m->a;
    m->samples.b = m->b;
    m->samples.c = m->c;
    m->samples.cos_light = m->light;
    m->samples.cos_view = m->view;
    m->samples.cos_difference = m->difference;
    m->samples.tan2_half = m->tan2;
    m->samples.weights = weighted ? m->weights : NULL;
    m->samples.values = m->values;
}

static inline void lc_geometry(const struct lobes_case *m, size_t i, brdffit_distribution distribution,
                               struct geometry *g)
{
    brdffit_status status;

    LC_REQUIRE(brdffit_geometry_sample(&m->samples, distribution, 0.0, i, g, &status, NULL) == BRDFFIT_SKIP_COUNT);
    LC_REQUIRE(status == BRDFFIT_OK);
}

/* Up to three lobes, some nearly equal, with noise of either sign; sometimes one channel twice, or nothing in it. */
static inline void lc_draw_values(struct lobes_case *m, uint64_t *s)
{
    double noise = case_next(s) % 3 ? pow(10.0, -4.0 * case_uniform(s)) : 0.0, theta[LC_LOBES];
    int signed_noise = case_next(s) % 3 == 0, p, twins = case_next(s) % 5 == 0, negative = case_next(s) % 5 == 0;
    size_t i, k;

    for (p = 0; p < m->lobes; p++) {
        theta[p] = 2.0 * log(10.0) * 2.5 * case_uniform(s);
        if (p > 0 && case_next(s) % 3 == 0) { /* nearly the lobe before */
            theta[p] = theta[p - 1] + pow(10.0, -8.0 * case_uniform(s));
        }
        m->true_theta[p] = theta[p];
    }
    for (k = 0; k < m->channels; k++) {
        double x = case_uniform(s), y[LC_LOBES];

        for (p = 0; p < m->lobes; p++) {
            y[p] = case_next(s) % 4 ? case_uniform(s) : 0.0;
        }
        for (i = 0; i < m->count; i++) {
            double v = 0.0;

            for (p = 0; p < m->lobes; p++) {
                struct geometry g;

                lc_geometry(m, i, m->asked[p], &g);
                v += (p == 0 ? g.a * x : 0.0) + y[p] * g.b * exp(-fmin(g.c * exp(theta[p]), 700.0));
            }
            v *= 1.0 + noise * case_signed(s);
            v += signed_noise ? noise * case_signed(s) : 0.0;
            v = negative ? v - 0.3 * case_uniform(s) : v;
            m->values[i * m->channels + k] = case_next(s) % 97 == 0 ? 0.0 : v;
        }
    }
    for (i = 0; i < m->count && twins && m->channels > 1; i++) {
        m->values[i * m->channels + 1] = m->values[i * m->channels];
    }
}

/* ---- The fit's insides ------------------------------------------------------------------------------------ */

/* What the weight of sample i multiplies its row by. */
static inline long double lc_root(const struct lobes_case *m, size_t i)
{
    long double w = m->samples.weights ? (long double)m->weights[i] / m->fit.data.scale_w : 1.0L;

    return m->fit.norm == BRDFFIT_NORM_L2 ? sqrtl(w) : m->fit.norm == BRDFFIT_NORM_L1 ? w : 1.0L;
}

static inline void lc_rows(struct lobes_case *m)
{
    const struct reduced *data = &m->fit.data;
    size_t i, k;
    int p;

    for (p = 0; p < m->lobes; p++) {
        const struct model *model = &m->fit.model;
        const struct table *table = &data->table[model->geometry[model->lobe[p].kind]];

        m->ggx[p] = !model_kind(model, p)->exponential;
        m->vanished[p] = fit_domain(&m->fit, p)->flat < fit_domain(&m->fit, p)->low;
        m->c_min[p] = (long double)table->c_min;
        for (i = 0; i < m->count; i++) {
            long double root = lc_root(m, i);
            struct geometry g;

            lc_geometry(m, i, model->distribution[p], &g);
            m->row_a[i] = root * g.a / data->scale_a[0];
            m->row_b[p][i] = root * g.b / table->scale_b;
            m->row_c[p][i] = (long double)g.c - m->c_min[p];
            for (k = 0; k < m->channels; k++) {
                m->row_value[k][i] = root * m->values[i * m->channels + k] /
                                     ((long double)data->channel_scale[k] * data->value_scale);
            }
        }
    }
}

/* 0 when there is nothing to bound. */
static inline int lc_open(struct lobes_case *m, uint64_t seed, brdffit_norm norm, brdffit_engine engine)
{
    uint64_t s = seed * 0x5851f42d4c957f2du + 29;
    struct arena arena;
    size_t size;

    lc_draw_lobes(m, seed, &s);
    lc_draw_samples(m, &s);
    lc_draw_values(m, &s);
    brdffit_options_init(&m->options);
    m->options.lobes = m->lobes;
    m->options.distribution = m->asked[0];
    m->options.distributions = lc_mixed(m) || case_next(&s) % 2 ? m->asked : NULL;
    m->options.norm = norm;
    m->options.engine = engine;
    m->options.max_incidence = 90.0;
    m->options.box_budget = 300;
    if (case_next(&s) % 3 == 0) {
        m->options.sigma_min = 1e-3;
        m->options.sigma_max = 2.0;
    }
    size = brdffit_workspace_size(m->count, m->channels, &m->options);
    m->workspace = malloc(size);
    LC_REQUIRE(m->workspace);
    brdffit_arena_init(&arena, m->workspace, size);
    brdffit_fit_layout(&m->fit, &arena, m->count, m->channels, &m->options);
    LC_REQUIRE(brdffit_reduce(&m->fit.data, &m->samples, &m->fit.model, &m->options, NULL) == BRDFFIT_OK);
    brdffit_fit_prepare(&m->fit, &m->options);
    lc_rows(m);
    return m->fit.data.total > 0.0;
}

static inline void lc_close(struct lobes_case *m)
{
    free(m->workspace);
}

/* ---- The objective in long double -------------------------------------------------------------------------- */

/* Lobe p at theta, in the scaling of its sharpest sample. */
static inline void lc_column(const struct lobes_case *m, int p, double theta, long double *out)
{
    long double s = expl((long double)theta), rest = 1.0L + m->c_min[p] * s;
    size_t i;

    for (i = 0; i < m->count; i++) {
        long double d = m->row_c[p][i], root = 1.0L / (1.0L + d * s / rest);

        out[i] = m->row_b[p][i] > 0.0L && !m->vanished[p] ? m->row_b[p][i] * (m->ggx[p] ? root * root : expl(-d * s))
                                                          : 0.0L;
    }
}

/* Columns as Q R, orthogonalised twice; a column that adds nothing has a zero q. */
struct lc_factor {
    int columns;
    long double q[LC_COLUMNS][LC_SAMPLES], r[LC_COLUMNS][LC_COLUMNS];
};

static inline long double lc_dot(const long double *u, const long double *v, size_t n)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

static inline void lc_factor(const struct lobes_case *m, const double *theta, struct lc_factor *f)
{
    size_t i, n = m->count;
    int j, k, pass;

    f->columns = 1 + m->lobes;
    memset(f->r, 0, sizeof f->r);
    for (j = 0; j < f->columns; j++) {
        long double norm;

        if (j == 0) {
            memcpy(f->q[0], m->row_a, sizeof f->q[0]);
        } else {
            lc_column(m, j - 1, theta[j - 1], f->q[j]);
        }
        norm = sqrtl(lc_dot(f->q[j], f->q[j], n));
        for (i = 0; i < n && norm > 0.0L; i++) {
            f->q[j][i] /= norm;
        }
        for (pass = 0; pass < 2; pass++) {
            for (k = 0; k < j; k++) {
                long double along = lc_dot(f->q[k], f->q[j], n);

                f->r[k][j] += along;
                for (i = 0; i < n; i++) {
                    f->q[j][i] -= along * f->q[k][i];
                }
            }
        }
        norm = sqrtl(lc_dot(f->q[j], f->q[j], n));
        f->r[j][j] = norm > 1e-18L ? norm : 0.0L;
        for (i = 0; i < n; i++) {
            f->q[j][i] = norm > 1e-18L ? f->q[j][i] / norm : 0.0L;
        }
    }
}

/* |t - R z|^2 over z >= 0 on one support, or -1: Gram-Schmidt again, on the little triangle. */
static inline long double lc_support(const struct lc_factor *f, const long double *t, unsigned support)
{
    long double q[LC_COLUMNS][LC_COLUMNS], r[LC_COLUMNS][LC_COLUMNS] = {{0.0L}}, z[LC_COLUMNS], rest[LC_COLUMNS];
    int n = f->columns, m = 0, i, j, k, pass;

    memcpy(rest, t, sizeof rest);
    for (j = 0; j < n; j++) {
        long double norm;

        if (!(support >> j & 1)) {
            continue;
        }
        for (i = 0; i < n; i++) {
            q[m][i] = f->r[i][j];
        }
        for (pass = 0; pass < 2; pass++) {
            for (k = 0; k < m; k++) {
                long double along = lc_dot(q[k], q[m], (size_t)n);

                r[k][m] += along;
                for (i = 0; i < n; i++) {
                    q[m][i] -= along * q[k][i];
                }
            }
        }
        norm = sqrtl(lc_dot(q[m], q[m], (size_t)n));
        if (!(norm > 1e-18L)) {
            return -1.0L;
        }
        r[m][m] = norm;
        for (i = 0; i < n; i++) {
            q[m][i] /= norm;
        }
        z[m] = lc_dot(q[m], rest, (size_t)n);
        for (i = 0; i < n; i++) {
            rest[i] -= z[m] * q[m][i];
        }
        m++;
    }
    for (j = m - 1; j >= 0; j--) {
        for (k = j + 1; k < m; k++) {
            z[j] -= r[j][k] * z[k];
        }
        z[j] /= r[j][j];
        if (z[j] < 0.0L) {
            return -1.0L;
        }
    }
    return lc_dot(rest, rest, (size_t)n);
}

/* Min over coefficients >= 0 of the sum of squared residuals at theta (lobes in the model's order). */
static inline long double lc_objective(const struct lobes_case *m, const double *theta)
{
    struct lc_factor f;
    long double sum = 0.0L;
    size_t i, k;
    int j;

    lc_factor(m, theta, &f);
    for (k = 0; k < m->channels; k++) {
        long double t[LC_COLUMNS] = {0.0L}, rest[LC_SAMPLES], best;
        unsigned support;

        memcpy(rest, m->row_value[k], sizeof rest);
        for (j = 0; j < f.columns; j++) {
            t[j] = lc_dot(f.q[j], rest, m->count);
            for (i = 0; i < m->count; i++) {
                rest[i] -= t[j] * f.q[j][i];
            }
        }
        best = lc_dot(t, t, (size_t)f.columns);
        for (support = 1; support < 1u << f.columns; support++) {
            long double here = lc_support(&f, t, support);

            best = here >= 0.0L && here < best ? here : best;
        }
        sum += best + lc_dot(rest, rest, m->count);
    }
    return sum;
}

/* ---- Boxes and points -------------------------------------------------------------------------------------- */

struct lc_box {
    double range[LC_LOBES][2];
    struct box box;
};

static inline double lc_clamp(double v, double low, double high)
{
    return fmin(fmax(v, low), high);
}

/* One side: around the optimum, anywhere, in the tail, the whole domain, a hair wide, a point. */
static inline void lc_draw_side(const struct domain *d, double near, int kind, double *range, uint64_t *s)
{
    double width = (d->high - d->low) * pow(10.0, -13.0 * pow(case_uniform(s), 2.0));
    double centre = kind < 3 ? near + width * case_signed(s) : d->low + (d->high - d->low) * case_uniform(s);

    range[0] = lc_clamp(centre - width * case_uniform(s), d->low, d->high);
    range[1] = lc_clamp(centre + width * case_uniform(s), range[0], d->high);
    if (kind == 5) {
        range[0] = fmax(d->low, d->high - width);
        range[1] = d->high;
    } else if (kind == 6) {
        range[0] = d->low;
        range[1] = d->high;
    } else if (kind == 7 && case_next(s) % 2) {
        range[1] = lc_clamp(nextafter(range[0], 1e9), range[0], d->high);
    }
}

/* Sides of like lobes are disjoint and ascend, or are one interval. */
static inline void lc_draw_box(struct lobes_case *m, const struct point *optimum, struct lc_box *b, uint64_t *s)
{
    const struct model *model = &m->fit.model;
    static const struct box empty;
    int p, q, kind, shared = (int)(case_next(s) % 3);

    for (p = 0; p < m->lobes; p++) {
        lc_draw_side(fit_domain(&m->fit, p), optimum->theta[p], (int)(case_next(s) % 8), b->range[p], s);
    }
    for (p = 0; p < m->lobes; p++) {
        for (q = p; q > model->lobe[p].first && b->range[q - 1][0] > b->range[q][0]; q--) {
            double keep[2];

            memcpy(keep, b->range[q], sizeof keep);
            memcpy(b->range[q], b->range[q - 1], sizeof keep);
            memcpy(b->range[q - 1], keep, sizeof keep);
        }
    }
    b->box = empty;
    for (kind = 0; kind < model->kinds; kind++) {
        m->fit.axis[kind].nodes = 2 * LC_LOBES;
        m->fit.axis[kind].intervals = LC_LOBES;
    }
    for (p = 0; p < m->lobes; p++) {
        struct axis *axis = &m->fit.axis[model->lobe[p].kind];
        int like = p > model->lobe[p].first;

        b->box.interval[p] = (uint32_t)p;
        if (like && (shared == 2 || (shared == 1 && case_next(s) % 2))) {
            memcpy(b->range[p], b->range[p - 1], sizeof b->range[p]);
            b->box.interval[p] = b->box.interval[p - 1];
        } else if (like) {
            for (q = p - 1; q >= model->lobe[p].first; q--) {
                uint32_t i = b->box.interval[q];

                b->range[q][1] = fmin(b->range[q][1], b->range[p][0]);
                axis->coordinate[2 * i + 1] = b->range[q][1];
            }
        }
        axis->interval[p].low = 2 * (uint32_t)p;
        axis->interval[p].high = 2 * (uint32_t)p + 1;
        axis->interval[p].child = 0;
        axis->coordinate[2 * p] = b->range[p][0];
        axis->coordinate[2 * p + 1] = b->range[p][1];
    }
}

/* Ends and middles first, then anywhere. */
static inline void lc_draw_point(const struct lobes_case *m, const struct lc_box *b, int i, double *theta, uint64_t *s)
{
    int p, place = i;

    for (p = 0; p < m->lobes; p++) {
        double r = i < 27 ? 0.5 * (place % 3) : case_uniform(s);

        place /= 3;
        theta[p] = b->range[p][0] + r * (b->range[p][1] - b->range[p][0]);
        theta[p] = lc_clamp(theta[p], b->range[p][0], b->range[p][1]);
    }
}

static inline void lc_print(const struct lobes_case *m, const struct lc_box *b)
{
    int p;

    brdffit_test_print(&m->samples, &m->options);
    for (p = 0; p < m->lobes; p++) {
        fprintf(stderr, "lobe %d: %s, theta in [%a, %a], interval %u\n", p,
                brdffit_distribution_string(m->fit.model.distribution[p]), b->range[p][0], b->range[p][1],
                (unsigned)b->box.interval[p]);
    }
}

/* Where a descent ends that starts at the truth or anywhere. */
static inline struct point lc_optimum(struct lobes_case *m, uint64_t *s)
{
    struct point at = {{0.0}};
    int p;

    for (p = 0; p < m->lobes; p++) {
        const struct domain *d = fit_domain(&m->fit, p);
        double anywhere = d->low + (d->high - d->low) * case_uniform(s);

        at.theta[p] = lc_clamp(case_next(s) % 2 ? m->true_theta[p] : anywhere, d->low, d->high);
    }
    (void)brdffit_varpro_descend(&m->fit.varpro, &at);
    return at;
}

#endif
