/*
 * Residuals and Jacobian of the fit for the peers: see peers_problem.h. Beckmann, as in the paper:
 * a = (n.l)/pi, b = G / (pi (n.v) cos^4 alpha), c = tan^2 alpha, g(sigma) = b s exp(-c s).
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include "peers_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brdffit_io.h"

static const double pi = 3.14159265358979323846;

const char *peers_chart_name(enum peers_chart chart)
{
    static const char *const name[PEERS_CHARTS] = {"plain", "log", "squares"};

    return name[chart];
}

/* ---- From a file ---------------------------------------------------------------------------------------- */

static void unit(const double *from, double *to)
{
    double length = hypot(hypot(from[0], from[1]), from[2]);
    int j;

    for (j = 0; j < 3; j++) {
        to[j] = from[j] / length;
    }
}

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* a, b, c of sample i from its directions. Returns n.l, or 0 when the paper leaves such a sample out. */
static double directions(struct peers_problem *p, const brdffit_samples *s, size_t i, size_t at)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    double n[3], l[3], v[3], h[3], nl, nv, nh, vh, g;
    int j;

    unit(s->normal ? s->normal + 3 * i : up, n);
    unit(s->light + 3 * i, l);
    unit(s->view + 3 * i, v);
    nl = dot(n, l);
    nv = dot(n, v);
    if (!(nl >= 0.5 - 1e-9 && nv > 0.0)) { /* incidence up to 60 degrees, viewer above the horizon */
        return 0.0;
    }
    for (j = 0; j < 3; j++) {
        h[j] = l[j] + v[j];
    }
    unit(h, h);
    nh = dot(n, h);
    vh = dot(v, h);
    g = fmin(1.0, fmin(2.0 * nh * nv / vh, 2.0 * nh * nl / vh));
    p->a[at] = nl / pi;
    p->b[at] = g / (pi * nv * nh * nh * nh * nh);
    p->c[at] = fmax(0.0, (1.0 - nh * nh) / (nh * nh));
    return nl;
}

/* Row `at` of the problem from sample i; 0 when it is left out. */
static int add_sample(struct peers_problem *p, const brdffit_samples *s, size_t i, size_t at)
{
    double factor = 1.0;
    size_t k;

    if (s->form == BRDFFIT_FORM_COEFFICIENTS) {
        p->a[at] = s->a[i];
        p->b[at] = s->b[i];
        p->c[at] = s->c[i];
    } else {
        factor = directions(p, s, i, at);
        if (!(factor > 0.0)) {
            return 0;
        }
        factor = s->quantity == BRDFFIT_QUANTITY_BRDF ? factor : 1.0;
    }
    for (k = 0; k < s->channels; k++) {
        p->value[at * s->channels + k] = s->values[i * s->channels + k] * factor;
    }
    return 1;
}

static int divide_by_maxima(struct peers_problem *p)
{
    size_t i, k;

    for (k = 0; k < p->channels; k++) {
        double most = 0.0;

        for (i = 0; i < p->samples; i++) {
            most = fmax(most, p->value[i * p->channels + k]);
        }
        if (!(most > 0.0)) {
            return 0;
        }
        for (i = 0; i < p->samples; i++) {
            p->value[i * p->channels + k] /= most;
        }
    }
    return 1;
}

static uint64_t mix_in(uint64_t digest, const double *value, size_t count)
{
    const unsigned char *byte = (const unsigned char *)value;
    size_t i;

    for (i = 0; i < count * sizeof *value; i++) {
        digest = (digest ^ byte[i]) * UINT64_C(0x100000001b3); /* FNV-1a */
    }
    return digest;
}

static void summarise(struct peers_problem *p)
{
    size_t i;

    p->c_min = INFINITY;
    p->a_max = p->b_max = p->total = 0.0;
    for (i = 0; i < p->samples; i++) {
        p->c_min = fmin(p->c_min, p->c[i]);
        p->a_max = fmax(p->a_max, p->a[i]);
        p->b_max = fmax(p->b_max, p->b[i]);
    }
    for (i = 0; i < p->samples * p->channels; i++) {
        p->total += p->value[i] * p->value[i];
    }
    p->digest = mix_in(UINT64_C(0xcbf29ce484222325), p->a, p->samples);
    p->digest = mix_in(p->digest, p->b, p->samples);
    p->digest = mix_in(p->digest, p->c, p->samples);
    p->digest = mix_in(p->digest, p->value, p->samples * p->channels);
}

static const char *take(const brdffit_samples *s, struct peers_problem *p)
{
    size_t i;

    if (s->form == BRDFFIT_FORM_ANGLES || s->weights || s->channels > PEERS_MOST_CHANNELS) {
        return "the peers take directions or coefficients without weights, and at most 64 channels";
    }
    p->a = malloc(s->count * (5 + 2 * s->channels) * sizeof *p->a);
    if (!p->a) {
        return "out of memory";
    }
    p->b = p->a + s->count;
    p->c = p->b + s->count;
    p->column = p->c + s->count;
    p->slope = p->column + s->count;
    p->value = p->slope + s->count;
    p->model = p->value + s->count * s->channels;
    p->channels = s->channels;
    for (i = 0; i < s->count; i++) {
        p->samples += (size_t)add_sample(p, s, i, p->samples);
    }
    if (p->samples == 0 || !divide_by_maxima(p)) {
        return "no samples to fit, or a channel without a positive value";
    }
    summarise(p);
    return NULL;
}

int peers_problem_read(const char *path, struct peers_problem *problem, const char **message)
{
    brdffit_io_options options;
    brdffit_table *table = NULL;
    brdffit_error error;

    memset(problem, 0, sizeof *problem);
    brdffit_io_options_init(&options);
    options.merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    if (brdffit_io_read(path, &options, &table, &error) != BRDFFIT_OK) {
        *message = error.message;
        return 0;
    }
    *message = take(table->samples, problem);
    brdffit_io_free(table);
    return !*message;
}

void peers_problem_free(struct peers_problem *problem)
{
    free(problem->a);
    problem->a = NULL;
}

/* ---- Charts --------------------------------------------------------------------------------------------- */

size_t peers_parameters(const struct peers_problem *p)
{
    return (size_t)p->lobes + p->channels * (size_t)(1 + p->lobes);
}

size_t peers_residuals(const struct peers_problem *p)
{
    return p->samples * p->channels;
}

void peers_bounds(const struct peers_problem *p, double *lower, double *upper)
{
    size_t j, lobes = (size_t)p->lobes;

    for (j = 0; j < peers_parameters(p); j++) {
        lower[j] = p->chart == PEERS_SQUARES ? -INFINITY : 0.0;
        upper[j] = INFINITY;
        if (j < lobes && p->chart != PEERS_SQUARES) {
            lower[j] = peers_sigma_to_chart(p, PEERS_SIGMA_MIN);
            upper[j] = peers_sigma_to_chart(p, PEERS_SIGMA_MAX);
        }
    }
}

double peers_sigma(const struct peers_problem *p, const double *parameter, int lobe)
{
    return p->chart == PEERS_PLAIN ? parameter[lobe] : exp(parameter[lobe]);
}

double peers_sigma_to_chart(const struct peers_problem *p, double sigma)
{
    return p->chart == PEERS_PLAIN ? sigma : log(sigma);
}

void peers_column(const struct peers_problem *p, double roughness, double *column, double *derivative)
{
    int plain = p->chart == PEERS_PLAIN;
    double s = plain ? 1.0 / (roughness * roughness) : exp(-2.0 * roughness);
    size_t i;

    for (i = 0; i < p->samples; i++) {
        double exponent = (plain ? p->c[i] : p->c[i] - p->c_min) * s;

        column[i] = p->b[i] * (plain ? s : 1.0) * exp(-exponent);
        if (derivative) {
            double slope = plain ? 2.0 * (exponent - 1.0) / roughness : 2.0 * exponent;

            /* Not 0 times infinity: the column has vanished long before its exponent overflows. */
            derivative[i] = column[i] > 0.0 ? column[i] * slope : 0.0;
        }
    }
}

static double coefficient(const struct peers_problem *p, double parameter)
{
    return p->chart == PEERS_SQUARES ? parameter * parameter : parameter;
}

static double coefficient_slope(const struct peers_problem *p, double parameter)
{
    return p->chart == PEERS_SQUARES ? 2.0 * parameter : 1.0;
}

void peers_model(const struct peers_problem *p, const double *parameter, double *model)
{
    size_t i, k, lobe, lobes = (size_t)p->lobes;
    const double *x = parameter + lobes, *y = x + p->channels;

    for (i = 0; i < p->samples; i++) {
        for (k = 0; k < p->channels; k++) {
            model[i * p->channels + k] = p->a[i] * coefficient(p, x[k]);
        }
    }
    for (lobe = 0; lobe < lobes; lobe++) {
        peers_column(p, parameter[lobe], p->column, NULL);
        for (i = 0; i < p->samples; i++) {
            for (k = 0; k < p->channels; k++) {
                model[i * p->channels + k] += p->column[i] * coefficient(p, y[k * lobes + lobe]);
            }
        }
    }
}

void peers_jacobian(const struct peers_problem *p, const double *parameter, double *jacobian)
{
    size_t i, k, lobe, lobes = (size_t)p->lobes, width = peers_parameters(p);
    const double *x = parameter + lobes, *y = x + p->channels;

    memset(jacobian, 0, peers_residuals(p) * width * sizeof *jacobian);
    for (i = 0; i < p->samples; i++) {
        for (k = 0; k < p->channels; k++) {
            jacobian[(i * p->channels + k) * width + lobes + k] = p->a[i] * coefficient_slope(p, x[k]);
        }
    }
    for (lobe = 0; lobe < lobes; lobe++) {
        peers_column(p, parameter[lobe], p->column, p->slope);
        for (i = 0; i < p->samples; i++) {
            for (k = 0; k < p->channels; k++) {
                double *row = jacobian + (i * p->channels + k) * width;
                double here = y[k * lobes + lobe];

                row[lobe] = p->slope[i] * coefficient(p, here);
                row[lobes + p->channels + k * lobes + lobe] = p->column[i] * coefficient_slope(p, here);
            }
        }
    }
}

double peers_e2(const struct peers_problem *p, const double *parameter)
{
    size_t j, count = peers_residuals(p);
    double sum = 0.0;

    peers_model(p, parameter, p->model);
    for (j = 0; j < count; j++) {
        double residual = p->value[j] - p->model[j];

        sum += residual * residual;
    }
    return sum;
}

int peers_reasonable(const struct peers_problem *p, const double *parameter)
{
    size_t j;
    int lobe;

    for (j = 0; j < peers_parameters(p); j++) {
        if (!isfinite(parameter[j])) {
            return 0;
        }
    }
    for (lobe = 0; lobe < p->lobes; lobe++) {
        double sigma = peers_sigma(p, parameter, lobe);

        if (!(sigma >= PEERS_SIGMA_MIN * (1.0 - 1e-9) && sigma <= PEERS_SIGMA_MAX * (1.0 + 1e-9))) {
            return 0;
        }
    }
    return 1;
}
