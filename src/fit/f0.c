/*
 * How well samples tell the F0 of a model's lobes. SPDX-License-Identifier: MIT
 *
 * Given sigma, channel k is linear in n columns: those of the diffuse term, and two a lobe, g_1 = b phi and g_2 = w g_1
 * with coefficients z = (y F0, y (1 - F0)) (theory 7.2). Where w hardly varies, g_2 is nearly a multiple of g_1, and only
 * one combination of the two is told. With the other columns of positive coefficient projected out (S the 2 x 2 Gram
 * matrix that is left, h the data's products with the two), the best y for a given F0 = f, u = (f, 1 - f), lowers E^2 by
 *
 *     D(f) = (u.h)^2 / (u.S u)      where u.h > 0, else by 0,
 *
 * and the model itself by V = 2 z.h - z.S z. f is as good as told when D(f) >= V - delta: u in a cone around z, which cuts
 * an interval out of [0, 1]. Its ends are found by halving.
 *
 * Columns are evaluated one sample at a time, as a model of n channels with one coefficient each, in units of the largest
 * y of each lobe over the channels and of the largest value, so that squares neither overflow nor vanish.
 */
#include <math.h>

#include "base/error.h"
#include "fit/fit.h"
#include "model/geometry.h"
#include "model/model.h"

#define CHANNELS 16 /* of one sweep over the samples */
#define PIVOT 1e-12 /* of a column's square: less is left of it by rounding alone */
#define ERRORS 4.0  /* delta in units of the residuals' variance: two standard errors */

/* The model's columns as a model of its own. */
struct columns {
    brdffit_model model;
    size_t count, fixed, lobes;
    double unit[BRDFFIT_MAX_LOBES]; /* of y */
    double x[COLUMNS_MOST], x_more[COLUMNS_MOST * COLUMNS_MOST];
    double y[COLUMNS_MOST * BRDFFIT_MAX_LOBES], f0[COLUMNS_MOST * BRDFFIT_MAX_LOBES];
};

/* Products of columns, and of columns with the values of some channels. */
struct products {
    double gram[COLUMNS_MOST][COLUMNS_MOST];
    double with[CHANNELS][COLUMNS_MOST], square[CHANNELS];
    size_t used;
};

/* Units: of values, and of weights. */
struct units {
    double value, weight;
};

static double largest_y(const brdffit_model *m, size_t p)
{
    size_t k, lobes = (size_t)m->lobes;
    double largest = 0.0;

    for (k = 0; k < m->channels; k++) {
        largest = fmax(largest, m->y[k * lobes + p]);
    }
    return largest > 0.0 ? largest : 1.0;
}

static void make_columns(struct columns *c, const brdffit_model *m, double value)
{
    size_t j, p, more = (size_t)brdffit_diffuse_columns(m->diffuse) - 1;

    c->model = *m;
    c->lobes = (size_t)m->lobes;
    c->fixed = more + 1;
    c->count = c->model.channels = c->fixed + 2 * c->lobes;
    c->model.x = c->x;
    c->model.x_more = more ? c->x_more : NULL;
    c->model.y = c->y;
    c->model.f0 = c->f0;
    for (p = 0; p < c->lobes; p++) {
        c->unit[p] = largest_y(m, p);
    }
    for (j = 0; j < c->count; j++) {
        c->x[j] = j == 0;
        for (p = 0; p < more; p++) {
            c->x_more[j * more + p] = j == p + 1;
        }
        for (p = 0; p < c->lobes; p++) {
            c->y[j * c->lobes + p] = j >= c->fixed && (j - c->fixed) / 2 == p ? c->unit[p] / value : 0.0;
            c->f0[j * c->lobes + p] = j >= c->fixed && (j - c->fixed) % 2 == 0;
        }
    }
}

static const double *from(const double *array, size_t at)
{
    return array ? array + at : NULL;
}

brdffit_samples brdffit_fit_one_sample(const brdffit_samples *s, size_t i)
{
    brdffit_samples one = *s;

    one.count = 1;
    one.quantity = BRDFFIT_QUANTITY_RADIANCE;
    one.light = from(s->light, 3 * i);
    one.view = from(s->view, 3 * i);
    one.normal = from(s->normal, 3 * i);
    one.tangent = from(s->tangent, 3 * i);
    one.cos_light = from(s->cos_light, i);
    one.cos_view = from(s->cos_view, i);
    one.tan2_half = from(s->tan2_half, i);
    one.cos_difference = from(s->cos_difference, i);
    one.values = from(s->values, i * s->channels);
    return one;
}

double brdffit_fit_to_radiance(const brdffit_samples *s, const brdffit_model *m, double min_cosine, size_t i)
{
    brdffit_distribution lead = m->distributions ? m->distributions[0] : m->distribution;
    brdffit_status status = BRDFFIT_OK;
    struct geometry g;

    if (brdffit_geometry_sample(s, lead, min_cosine, i, &g, &status, NULL) != BRDFFIT_SKIP_COUNT) {
        return 0.0;
    }
    return s->quantity == BRDFFIT_QUANTITY_BRDF ? g.cos_light : 1.0;
}

static struct units find_units(const brdffit_samples *s, const brdffit_model *m, double min_cosine)
{
    struct units units = {0.0, 0.0};
    size_t i, k;

    for (i = 0; i < s->count; i++) {
        double factor = brdffit_fit_to_radiance(s, m, min_cosine, i);

        for (k = 0; k < s->channels && factor > 0.0; k++) {
            units.value = fmax(units.value, fabs(s->values[i * s->channels + k]) * factor);
        }
        units.weight = factor > 0.0 ? fmax(units.weight, s->weights ? s->weights[i] : 1.0) : units.weight;
    }
    units.value = units.value > 0.0 ? units.value : 1.0;
    units.weight = units.weight > 0.0 ? units.weight : 1.0;
    return units;
}

static void add_sample(struct products *to, const double *column, size_t columns, const double *values, size_t channels,
                       double factor, double weight)
{
    size_t j, l, k;

    for (j = 0; j < columns; j++) {
        for (l = 0; l < columns; l++) {
            to->gram[j][l] += weight * column[j] * column[l];
        }
        for (k = 0; k < channels; k++) {
            to->with[k][j] += weight * column[j] * (values[k] * factor);
        }
    }
    for (k = 0; k < channels; k++) {
        to->square[k] += weight * (values[k] * factor) * (values[k] * factor);
    }
    to->used++;
}

static brdffit_status add_up(struct products *to, const struct columns *c, const brdffit_samples *s, double min_cosine,
                             const struct units *units, size_t first, size_t channels, brdffit_error *error)
{
    static const struct products none;
    double column[COLUMNS_MOST];
    size_t i;

    *to = none;
    for (i = 0; i < s->count; i++) {
        double factor = brdffit_fit_to_radiance(s, &c->model, min_cosine, i);
        brdffit_samples one = brdffit_fit_one_sample(s, i);
        brdffit_status status = factor > 0.0 ? brdffit_eval_run(&c->model, &one, column, error) : BRDFFIT_OK;

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (factor > 0.0) {
            add_sample(to, column, c->count, one.values + first, channels, factor / units->value,
                       (s->weights ? s->weights[i] : 1.0) / units->weight);
        }
    }
    return BRDFFIT_OK;
}

/* Coefficients of channel k, one a column. */
static void coefficients(const struct columns *c, const brdffit_model *m, size_t k, double value, double *z)
{
    size_t j, p;

    z[0] = m->x[k] / value;
    for (j = 1; j < c->fixed; j++) {
        z[j] = m->x_more[k * (c->fixed - 1) + j - 1] / value;
    }
    for (p = 0; p < c->lobes; p++) {
        double y = m->y[k * c->lobes + p] / c->unit[p], f0 = m->f0[k * c->lobes + p];

        z[c->fixed + 2 * p] = y * f0;
        z[c->fixed + 2 * p + 1] = y * (1.0 - f0);
    }
}

/* What is left of a lobe's two columns. */
struct remainder {
    double s11, s12, s22, h1, h2;
};

/* Project the other columns of positive coefficient out, one after the other. */
static struct remainder project(const struct products *of, size_t channel, const double *z, size_t columns, size_t at)
{
    double gram[COLUMNS_MOST][COLUMNS_MOST], with[COLUMNS_MOST];
    struct remainder pair;
    size_t q, j, l;

    for (j = 0; j < columns; j++) {
        with[j] = of->with[channel][j];
        for (l = 0; l < columns; l++) {
            gram[j][l] = of->gram[j][l];
        }
    }
    for (q = 0; q < columns; q++) {
        if (q == at || q == at + 1 || !(z[q] > 0.0) || !(gram[q][q] > PIVOT * of->gram[q][q])) {
            continue;
        }
        for (j = 0; j < columns; j++) {
            double share = gram[j][q] / gram[q][q];

            for (l = 0; l < columns && j != q; l++) {
                gram[j][l] -= share * gram[q][l];
            }
            with[j] -= j != q ? share * with[q] : 0.0;
        }
    }
    pair = (struct remainder){gram[at][at], gram[at][at + 1], gram[at + 1][at + 1], with[at], with[at + 1]};
    return pair;
}

/* Whether the best y with F0 = f lowers E^2 by `least` or more. */
static int as_good(const struct remainder *p, double f, double least)
{
    double u = 1.0 - f, product = f * p->h1 + u * p->h2;
    double square = f * f * p->s11 + 2.0 * f * u * p->s12 + u * u * p->s22;

    return least <= 0.0 || (product > 0.0 && product * product >= least * square);
}

/* The last f that is as good, from one that is towards the end. */
static double reach(const struct remainder *p, double f, double end, double least)
{
    int step;

    if (as_good(p, end, least)) {
        return end;
    }
    for (step = 0; step < 60; step++) {
        double middle = 0.5 * (f + end);

        if (as_good(p, middle, least)) {
            f = middle;
        } else {
            end = middle;
        }
    }
    return f;
}

static double residual(const struct products *of, size_t channel, const double *z, size_t columns)
{
    double e2 = of->square[channel];
    size_t j, l;

    for (j = 0; j < columns; j++) {
        e2 -= 2.0 * z[j] * of->with[channel][j];
        for (l = 0; l < columns; l++) {
            e2 += z[j] * z[l] * of->gram[j][l];
        }
    }
    return fmax(e2, 0.0);
}

/* The intervals of one channel. */
static void intervals(const struct columns *c, const struct products *of, size_t channel, const double *z,
                      const double *f0, double absolute_gap, double *low, double *high)
{
    double degrees = of->used > c->count ? (double)(of->used - c->count) : 1.0;
    double delta = fmax(ERRORS * residual(of, channel, z, c->count) / degrees, absolute_gap * of->square[channel]);
    size_t p;

    for (p = 0; p < c->lobes; p++) {
        size_t at = c->fixed + 2 * p;
        struct remainder pair = project(of, channel, z, c->count, at);
        double z1 = z[at], z2 = z[at + 1];
        double gain = 2.0 * (z1 * pair.h1 + z2 * pair.h2) -
                      (z1 * z1 * pair.s11 + 2.0 * z1 * z2 * pair.s12 + z2 * z2 * pair.s22);
        int any = !(z1 + z2 > 0.0);

        low[p] = any ? 0.0 : reach(&pair, f0[p], 0.0, gain - delta);
        high[p] = any ? 1.0 : reach(&pair, f0[p], 1.0, gain - delta);
    }
}

static brdffit_status check(const brdffit_samples *s, const brdffit_options *o, const brdffit_model *m,
                            const double *low, const double *high, brdffit_error *error)
{
    if (!low || !high) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "low or high is NULL");
    }
    if (m->fresnel != BRDFFIT_FRESNEL_SCHLICK || o->norm != BRDFFIT_NORM_L2) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "intervals of F0 need a model with Fresnel, and norm L2");
    }
    if (!(m->lobes >= 1 && m->lobes <= BRDFFIT_MAX_LOBES) || !m->f0 || !m->x || !m->y || !m->sigma ||
        (brdffit_diffuse_columns(m->diffuse) > 1 && !m->x_more) ||
        brdffit_diffuse_columns(m->diffuse) + 2 * m->lobes > COLUMNS_MOST) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: incomplete, or of too many columns");
    }
    if (m->channels != s->channels) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model and samples differ in their number of channels");
    }
    return brdffit_inspect_run(s, o, NULL, NULL, 0, error);
}

brdffit_status brdffit_f0_interval_run(const brdffit_samples *samples, const brdffit_options *options,
                                       const brdffit_model *model, double *low, double *high, brdffit_error *error)
{
    brdffit_status status = check(samples, options, model, low, high, error);
    double min_cosine = brdffit_geometry_min_cosine(options->max_incidence), z[COLUMNS_MOST];
    struct products products = {.used = 0};
    struct columns columns;
    struct units units;
    size_t k;

    if (status != BRDFFIT_OK) {
        return status;
    }
    units = find_units(samples, model, min_cosine);
    make_columns(&columns, model, units.value);
    for (k = 0; k < model->channels; k++) {
        size_t at = k % CHANNELS, left = model->channels - k, base = k * columns.lobes;

        if (at == 0) {
            status = add_up(&products, &columns, samples, min_cosine, &units, k, left < CHANNELS ? left : CHANNELS,
                            error);
        }
        if (status != BRDFFIT_OK) {
            return status;
        }
        coefficients(&columns, model, k, units.value, z);
        intervals(&columns, &products, at, z, model->f0 + base, options->absolute_gap, low + base, high + base);
    }
    return BRDFFIT_OK;
}
