/*
 * Random problems of models with several columns, the insides of their fit, and their objective in long double, which shares
 * no code with the library. For test_columns.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_COLUMNS_CASE_H
#define BRDFFIT_TESTS_COLUMNS_CASE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "columns_formulas.h"
#include "fit/fit.h"
#include "nnls_case.h"
#include "support.h"

#define CC_SAMPLES 16
#define CC_CHANNELS 3
#define CC_LOBES BRDFFIT_MAX_LOBES
#define CC_COLUMNS 7

struct columns_case {
    size_t count, channels;
    brdffit_distribution asked[CC_LOBES];
    double light[3 * CC_SAMPLES], view[3 * CC_SAMPLES]; /* DIRECTIONS */
    double cosine[4][CC_SAMPLES];                       /* ANGLES: n.l, n.v, tan^2 alpha, v.h */
    double weights[CC_SAMPLES], values[CC_SAMPLES * CC_CHANNELS];
    brdffit_samples samples;
    brdffit_options options;
    struct fit fit;
    void *workspace;

    struct columns_angles at[CC_SAMPLES];
    long double root[CC_SAMPLES], value[CC_CHANNELS][CC_SAMPLES]; /* weighted, units of the reduction */
    int columns;
    unsigned last[CC_CHANNELS]; /* support of the last optimum */
};

/* ---- The model's columns ------------------------------------------------------------------------------------ */

static inline void cc_directions(const double *l, const double *v, struct columns_angles *at)
{
    long double L[3], V[3], ll = 0.0L, vv = 0.0L, h2 = 0.0L, t[2], tl, tv, cross[3], c2;
    int j;

    for (j = 0; j < 3; j++) {
        ll += (long double)l[j] * l[j];
        vv += (long double)v[j] * v[j];
    }
    at->lv = 0.0L;
    for (j = 0; j < 3; j++) {
        L[j] = l[j] / sqrtl(ll);
        V[j] = v[j] / sqrtl(vv);
        h2 += (L[j] + V[j]) * (L[j] + V[j]);
        at->lv += L[j] * V[j];
    }
    at->angles.nl = L[2];
    at->angles.nv = V[2];
    at->angles.vh = 0.5L * sqrtl(h2);
    t[0] = L[0] + V[0];
    t[1] = L[1] + V[1];
    at->angles.tan2 = (t[0] * t[0] + t[1] * t[1]) / ((L[2] + V[2]) * (L[2] + V[2]));
    tl = L[0] * L[0] + L[1] * L[1];
    tv = V[0] * V[0] + V[1] * V[1];
    at->tan2_light = tl / (L[2] * L[2]);
    at->tan2_view = tv / (V[2] * V[2]);
    at->versine_light = tl / (1.0L + L[2]);
    at->versine_view = tv / (1.0L + V[2]);
    for (j = 0; j < 3;
         j++) { /* of the doubles as they are: their cross product does not cancel as a difference would */
        int k = (j + 1) % 3, m = (j + 2) % 3;

        cross[j] = (long double)l[k] * v[m] - (long double)l[m] * v[k];
    }
    c2 = (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / (ll * vv);
    at->versine = at->lv > 0.0L ? c2 / (4.0L * at->angles.vh * at->angles.vh * (1.0L + at->angles.vh))
                                : (1.0L - at->lv) / (2.0L * (1.0L + at->angles.vh));
}

static inline void cc_given(const double *l, const double *v, const double *tan2, const double *vh,
                            struct columns_angles *at)
{
    at->angles.nl = *l;
    at->angles.nv = *v;
    at->angles.tan2 = *tan2;
    at->angles.vh = *vh;
    at->lv = 2.0L * at->angles.vh * at->angles.vh - 1.0L;
    at->tan2_light = (1.0L - at->angles.nl) * (1.0L + at->angles.nl) / (at->angles.nl * at->angles.nl);
    at->tan2_view = (1.0L - at->angles.nv) * (1.0L + at->angles.nv) / (at->angles.nv * at->angles.nv);
    at->versine = 1.0L - at->angles.vh;
    at->versine_light = 1.0L - at->angles.nl;
    at->versine_view = 1.0L - at->angles.nv;
}

static inline void cc_sample(const brdffit_samples *s, size_t i, struct columns_angles *at)
{
    if (s->form == BRDFFIT_FORM_DIRECTIONS) {
        cc_directions(s->light + 3 * i, s->view + 3 * i, at);
    } else {
        cc_given(s->cos_light + i, s->cos_view + i, s->tan2_half + i, s->cos_difference + i, at);
    }
}

static inline int cc_fixed(brdffit_diffuse diffuse)
{
    static const int columns[BRDFFIT_DIFFUSE_COUNT] = {1, 1, 2, 3};

    return columns[diffuse];
}

static inline int cc_each(const brdffit_options *o)
{
    return o->fresnel == BRDFFIT_FRESNEL_SCHLICK ? 2 : 1;
}

static inline int cc_columns(const brdffit_options *o)
{
    return cc_fixed(o->diffuse) + cc_each(o) * o->lobes;
}

static inline long double cc_dot(const long double *u, const long double *v, size_t n)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

static inline void cc_unit(long double *u, size_t n)
{
    long double length = sqrtl(cc_dot(u, u, n));
    size_t i;

    for (i = 0; i < n; i++) {
        u[i] = length > 0.0L ? u[i] / length : 0.0L;
    }
}

/* Unit column c of the model (the fixed ones first), weighted; a lobe in units of its own largest sample. */
static inline void cc_column(const struct columns_case *m, int c, const double *theta, long double *out)
{
    const brdffit_options *o = &m->options;
    int fixed = cc_fixed(o->diffuse), each = cc_each(o), p = (c - fixed) / each;
    long double most = -INFINITY, diffuse[COLUMNS_FIXED] = {0.0L};
    size_t i;

    for (i = 0; i < m->count; i++) {
        if (c < fixed) {
            columns_diffuse(o->diffuse, &m->at[i], diffuse);
            out[i] = m->root[i] * diffuse[c];
            continue;
        }
        out[i] = columns_log_lobe(m->fit.model.distribution[p], o->masking, expl((long double)theta[p]), &m->at[i]) +
                 logl(m->root[i]);
        if ((c - fixed) % each) {
            out[i] += logl(columns_fifth(m->at[i].versine)); /* ln 0 is -INFINITY */
        }
        most = fmaxl(most, out[i]);
    }
    for (i = 0; i < m->count && c >= fixed; i++) {
        out[i] = most > -INFINITY ? expl(out[i] - most) : 0.0L;
    }
    cc_unit(out, m->count);
}

/* ---- The least objective at a point -------------------------------------------------------------------------- */

/* Columns as Q R, orthogonalised twice. */
struct cc_factor {
    int n;
    long double q[CC_COLUMNS][CC_SAMPLES], r[CC_COLUMNS][CC_COLUMNS];
};

static inline void cc_orthogonal(long double (*q)[CC_SAMPLES], long double (*r)[CC_COLUMNS], int j, size_t n)
{
    int k, pass;
    size_t i;

    for (k = 0; k < j; k++) {
        r[k][j] = 0.0L;
    }
    for (pass = 0; pass < 2; pass++) {
        for (k = 0; k < j; k++) {
            long double along = cc_dot(q[k], q[j], n);

            r[k][j] += along;
            for (i = 0; i < n; i++) {
                q[j][i] -= along * q[k][i];
            }
        }
    }
    r[j][j] = sqrtl(cc_dot(q[j], q[j], n));
    for (i = 0; i < n; i++) {
        q[j][i] = r[j][j] > 1e-18L ? q[j][i] / r[j][j] : 0.0L;
    }
}

/* |t - R z|^2 with z > 0 on this support only, and whether no other column asks for more; -1: not all are positive. */
static inline long double cc_support(const struct cc_factor *f, const long double *t, unsigned support, int *optimal)
{
    long double q[CC_COLUMNS][CC_SAMPLES], r[CC_COLUMNS][CC_COLUMNS], z[CC_COLUMNS], rest[CC_COLUMNS];
    int n = f->n, m = 0, i, j, k;

    memcpy(rest, t, sizeof rest);
    for (j = 0; j < n; j++) {
        if (!(support >> j & 1)) {
            continue;
        }
        for (i = 0; i < n; i++) {
            q[m][i] = f->r[i][j];
        }
        cc_orthogonal(q, r, m, (size_t)n);
        if (!(r[m][m] > 1e-18L)) {
            return -1.0L;
        }
        z[m] = cc_dot(q[m], rest, (size_t)n);
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
    *optimal = 1;
    for (j = 0; j < n; j++) {
        long double gradient = 0.0L;

        for (i = 0; i < n; i++) {
            gradient += rest[i] * f->r[i][j];
        }
        *optimal = *optimal && gradient <= 0.0L;
    }
    return cc_dot(rest, rest, (size_t)n);
}

/* Every support, unless that of the point before is seen to be the optimum. */
static inline long double cc_channel(struct columns_case *m, const struct cc_factor *f, size_t k)
{
    long double t[CC_COLUMNS] = {0.0L}, rest[CC_SAMPLES], best, outside;
    unsigned support, all = 1u << f->n;
    int j, optimal = 0;
    size_t i;

    memcpy(rest, m->value[k], sizeof rest);
    for (j = 0; j < f->n; j++) {
        t[j] = cc_dot(f->q[j], rest, m->count);
        for (i = 0; i < m->count; i++) {
            rest[i] -= t[j] * f->q[j][i];
        }
    }
    outside = cc_dot(rest, rest, m->count);
    best = cc_support(f, t, m->last[k], &optimal);
    if (best >= 0.0L && optimal) {
        return best + outside;
    }
    best = cc_dot(t, t, (size_t)f->n);
    m->last[k] = 0;
    for (support = 1; support < all; support++) {
        long double here = cc_support(f, t, support, &optimal);

        if (here >= 0.0L && here < best) {
            best = here;
            m->last[k] = support;
        }
    }
    return best + outside;
}

/* Min over coefficients >= 0 at theta of each lobe. */
static inline long double cc_objective(struct columns_case *m, const double *theta)
{
    struct cc_factor f;
    long double sum = 0.0L;
    size_t k;
    int j;

    memset(&f, 0, sizeof f);
    f.n = m->columns;
    for (j = 0; j < f.n; j++) {
        cc_column(m, j, theta, f.q[j]);
        cc_orthogonal(f.q, f.r, j, m->count);
    }
    for (k = 0; k < m->channels; k++) {
        sum += cc_channel(m, &f, k);
    }
    return sum;
}

/* ---- Problems ------------------------------------------------------------------------------------------------- */

/* Every combination of Fresnel, diffuse, masking and lobes comes in turn; the rest is random. */
static inline void cc_draw_model(struct columns_case *m, uint64_t seed, uint64_t *s)
{
    brdffit_options *o = &m->options;
    int p;

    brdffit_options_init(o);
    o->lobes = 1 + (int)(seed % 3);
    o->diffuse = (brdffit_diffuse)(seed / 3 % 4);
    o->masking = (brdffit_masking)(seed / 12 % 4);
    o->fresnel = (brdffit_fresnel)(seed / 48 % 2);
    if (cc_columns(o) > CC_COLUMNS) {
        o->lobes = 2;
    }
    for (p = 0; p < CC_LOBES; p++) {
        size_t kinds = o->masking == BRDFFIT_MASKING_V_CAVITY ? BRDFFIT_DISTRIBUTION_COUNT : 2;

        m->asked[p] = p > 0 && case_next(s) % 2 ? m->asked[p - 1] : (brdffit_distribution)(case_next(s) % kinds);
        if (m->asked[p] == BRDFFIT_LAFORTUNE) { /* its hidden samples have tests of their own */
            m->asked[p] = BRDFFIT_WARD;
        }
    }
    o->distribution = m->asked[0];
    o->distributions = m->asked;
    o->max_incidence = 90.0;
    o->box_budget = 300;
    if (case_next(s) % 3 == 0) {
        o->sigma_min = 1e-3;
        o->sigma_max = 2.0;
    }
}

static inline void cc_direction(double theta, double phi, double *out)
{
    out[0] = sin(theta) * cos(phi);
    out[1] = sin(theta) * sin(phi);
    out[2] = cos(theta);
}

/* Instruments: in plane, anywhere, near the mirror, one v.h for all, retro, grazing beside steep, upright. */
static inline void cc_draw_samples(struct columns_case *m, uint64_t *s)
{
    int kind = (int)(case_next(s) % 8), weighted = case_next(s) % 3 == 0;
    double apart = 0.05 + 1.2 * case_uniform(s);
    size_t i;

    m->count = 1 + case_next(s) % CC_SAMPLES;
    m->channels = 1 + case_next(s) % CC_CHANNELS;
    for (i = 0; i < m->count; i++) {
        double steep = kind == 5 && case_next(s) % 2 ? 1.5707963 - pow(10.0, -8.0 * case_uniform(s)) : 0.0;
        double theta = steep > 0.0 ? steep : (kind == 6 ? 1e-3 : 1.4) * case_uniform(s), phi = 6.28 * case_uniform(s);
        double other = (kind == 6 ? 1e-3 : 1.4) * case_uniform(s), turn = 6.28 * case_uniform(s);

        other = kind == 2 ? fabs(theta + 0.05 * case_signed(s)) : kind == 3 ? fabs(theta - apart) : other;
        turn = kind == 2 || kind == 0 ? phi + 3.14159265358979
               : kind == 3            ? (theta < apart ? phi + 3.14159265 : phi)
                                      : turn;
        other = fmin(other, 1.55);
        theta = kind == 7 && case_next(s) % 2 ? 0.0 : theta;
        cc_direction(theta, phi, m->light + 3 * i);
        cc_direction(other, turn, m->view + 3 * i);
        if (kind == 4 && case_next(s) % 2) {
            memcpy(m->view + 3 * i, m->light + 3 * i, 3 * sizeof *m->view);
        }
        m->cosine[0][i] = kind == 5 && case_next(s) % 2 ? pow(10.0, -9.0 * case_uniform(s))
                                                        : 0.05 + 0.95 * case_uniform(s);
        m->cosine[1][i] = kind == 7 ? 1.0 : 0.05 + 0.95 * case_uniform(s);
        m->cosine[2][i] = kind == 0 ? pow(tan(0.05 * (double)(i / 2)), 2.0) : pow(10.0, -5.0 * case_uniform(s));
        m->cosine[3][i] = kind == 3 ? 0.8 : kind == 4 && case_next(s) % 2 ? 1.0 : 0.1 + 0.9 * case_uniform(s);
        m->weights[i] = pow(10.0, (case_next(s) % 2 ? 12.0 : 1.0) * case_signed(s));
    }
    brdffit_samples_init(&m->samples);
    m->samples.form = case_next(s) % 2 ? BRDFFIT_FORM_ANGLES : BRDFFIT_FORM_DIRECTIONS;
    m->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    m->samples.count = m->count;
    m->samples.channels = m->channels;
    m->samples.light = m->light;
    m->samples.view = m->view;
    m->samples.cos_light = m->cosine[0];
    m->samples.cos_view = m->cosine[1];
    m->samples.tan2_half = m->cosine[2];
    m->samples.cos_difference = m->cosine[3];
    m->samples.weights = weighted ? m->weights : NULL;
    m->samples.values = m->values;
    for (i = 0; i < m->count; i++) {
        cc_sample(&m->samples, i, &m->at[i]);
    }
}

/* A model's radiance with coefficients that bring each column's largest sample to about 1, and noise of either sign. */
static inline void cc_draw_values(struct columns_case *m, uint64_t *s)
{
    double noise = case_next(s) % 3 ? pow(10.0, -5.0 * case_uniform(s)) : 0.0, theta[CC_LOBES];
    int negative = case_next(s) % 6 == 0, c, p;
    size_t i, k;

    for (p = 0; p < CC_LOBES; p++) {
        theta[p] = 2.0 * log(10.0) * 2.5 * case_uniform(s);
        m->fit.model.distribution[p] = m->asked[p];
    }
    for (i = 0; i < m->count; i++) {
        m->root[i] = 1.0L;
    }
    memset(m->values, 0, sizeof m->values);
    for (c = 0; c < m->columns; c++) {
        long double column[CC_SAMPLES];

        cc_column(m, c, theta, column);
        for (k = 0; k < m->channels; k++) {
            double z = case_next(s) % 3 ? case_uniform(s) : 0.0;

            for (i = 0; i < m->count; i++) {
                m->values[i * m->channels + k] += z * (double)column[i] * (1.0 + noise * case_signed(s));
            }
        }
    }
    for (i = 0; i < m->count * m->channels; i++) {
        m->values[i] += negative ? -0.3 * case_uniform(s) : noise * case_signed(s);
    }
}

static inline int cc_open(struct columns_case *m, uint64_t seed)
{
    uint64_t s = seed * 0x5851f42d4c957f2du + 31;
    struct arena arena;
    size_t size, i, k;
    int p;

    cc_draw_model(m, seed, &s);
    m->columns = cc_columns(&m->options);
    cc_draw_samples(m, &s);
    cc_draw_values(m, &s);
    memset(m->last, 0, sizeof m->last);
    size = brdffit_workspace_size(m->count, m->channels, &m->options);
    assert_true(size > 0);
    m->workspace = malloc(size);
    assert_non_null(m->workspace);
    brdffit_arena_init(&arena, m->workspace, size);
    brdffit_fit_layout(&m->fit, &arena, m->count, m->channels, &m->options);
    if (brdffit_reduce(&m->fit.data, &m->samples, &m->fit.model, &m->options, NULL) != BRDFFIT_OK) {
        return 0; /* b spans too much, or nothing counts */
    }
    brdffit_fit_prepare(&m->fit, &m->options);
    assert_int_equal(m->fit.data.used, m->count);
    for (i = 0; i < m->count; i++) {
        m->root[i] = m->samples.weights ? sqrtl((long double)m->weights[i] / m->fit.data.scale_w) : 1.0L;
        for (k = 0; k < m->channels; k++) {
            m->value[k][i] = m->root[i] * m->values[i * m->channels + k] /
                             ((long double)m->fit.data.channel_scale[k] * m->fit.data.value_scale);
        }
    }
    for (p = 0; p < m->fit.model.kinds; p++) { /* as brdffit_fit_start() does */
        const struct domain *d = &m->fit.domain[model_axis(&m->fit.model, p)];
        const double theta[3] = {d->low, d->high, d->flat};

        brdffit_charge_domain(&m->fit.data, &m->fit.model, p, m->fit.varpro.kernels, theta, 1e-10, m->fit.varpro.phi);
    }
    for (i = 0; i < (size_t)m->fit.model.lobes; i++) { /* lobes without a finite coefficient: other tests' */
        const struct domain *d = fit_domain(&m->fit, (int)i);

        if (d->flat < d->low) {
            return 0;
        }
    }
    return m->fit.data.total > 0.0;
}

static inline void cc_close(struct columns_case *m)
{
    free(m->workspace);
}

/* ---- Boxes and points ----------------------------------------------------------------------------------------- */

struct cc_box {
    double range[CC_LOBES][2];
    struct box box;
};

/* Around a point, anywhere, in the tail, the whole domain, a hair wide. */
static inline void cc_draw_side(const struct domain *d, double near, double *range, uint64_t *s)
{
    double width = (d->high - d->low) * pow(10.0, -13.0 * pow(case_uniform(s), 2.0));
    int kind = (int)(case_next(s) % 8);
    double centre = kind < 3 ? near + width * case_signed(s) : d->low + (d->high - d->low) * case_uniform(s);

    range[0] = fmin(fmax(centre - width * case_uniform(s), d->low), d->high);
    range[1] = fmin(fmax(centre + width * case_uniform(s), range[0]), d->high);
    if (kind == 5) {
        range[0] = fmax(d->low, d->high - width);
        range[1] = d->high;
    } else if (kind == 6) {
        range[0] = d->low;
        range[1] = d->high;
    }
}

/* Like lobes ascend: their sides are disjoint, or one interval. */
static inline void cc_draw_box(struct columns_case *m, const double *near, struct cc_box *b, uint64_t *s)
{
    const struct model *model = &m->fit.model;
    static const struct box empty;
    int p, q, kind;

    for (p = 0; p < model->lobes; p++) {
        cc_draw_side(fit_domain(&m->fit, p), near[p], b->range[p], s);
    }
    b->box = empty;
    for (kind = 0; kind < model->axes; kind++) {
        m->fit.axis[kind].nodes = 2 * CC_LOBES;
        m->fit.axis[kind].intervals = CC_LOBES;
    }
    for (p = 0; p < model->lobes; p++) {
        int like = p > model->lobe[p].first;

        b->box.interval[p] = (uint32_t)p;
        if (like && (case_next(s) % 2 || b->range[p][0] < b->range[p - 1][1])) {
            memcpy(b->range[p], b->range[p - 1], sizeof b->range[p]);
            b->box.interval[p] = b->box.interval[p - 1];
        }
    }
    for (p = 0; p < model->lobes; p++) {
        struct axis *axis = &m->fit.axis[model->lobe[p].kind];

        q = (int)b->box.interval[p];
        axis->interval[q].low = 2 * (uint32_t)q;
        axis->interval[q].high = 2 * (uint32_t)q + 1;
        axis->interval[q].child = 0;
        axis->coordinate[2 * q] = b->range[p][0];
        axis->coordinate[2 * q + 1] = b->range[p][1];
    }
}

/* Ends and middles first, then anywhere. */
static inline void cc_draw_point(const struct columns_case *m, const struct cc_box *b, int i, double *theta,
                                 uint64_t *s)
{
    int p, place = i;

    for (p = 0; p < m->fit.model.lobes; p++) {
        double r = i < 9 ? 0.5 * (place % 3) : case_uniform(s);

        place /= 3;
        theta[p] = b->range[p][0] + r * (b->range[p][1] - b->range[p][0]);
        theta[p] = fmin(fmax(theta[p], b->range[p][0]), b->range[p][1]);
    }
}

static inline void cc_print(const struct columns_case *m, const struct cc_box *b)
{
    int p;

    brdffit_test_print(&m->samples, &m->options);
    fprintf(stderr, "fresnel %s, diffuse %s, masking %s\n", brdffit_fresnel_string(m->options.fresnel),
            brdffit_diffuse_string(m->options.diffuse), brdffit_masking_string(m->options.masking));
    for (p = 0; p < m->fit.model.lobes; p++) {
        fprintf(stderr, "lobe %d: %s, theta in [%a, %a], interval %u\n", p,
                brdffit_distribution_string(m->fit.model.distribution[p]), b->range[p][0], b->range[p][1],
                (unsigned)b->box.interval[p]);
    }
}

#endif
