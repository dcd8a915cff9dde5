/*
 * Models near the optimum, in long double from columns alone: what attacks brdffit_intervals(). SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_INTERVALS_ATTACK_H
#define BRDFFIT_TESTS_INTERVALS_ATTACK_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brdffit.h"
#include "support.h"

#define ATTACK_COLUMNS 9

/* E^2 of channel k is I^2 - 2 h.z + z'G z, z in the data's units. */
struct attack {
    const brdffit_samples *samples;
    const brdffit_options *options;
    const double *scale; /* channel_scale */
    const brdffit_interval_result *claim;
    int lobes, fixed, each, columns;
    size_t channels, count;
    double *column; /* columns x count: radiance times root of weight; 0 where not used */
    long double gram[ATTACK_COLUMNS][ATTACK_COLUMNS], *along, *square; /* along: channels x columns */
    size_t inside,
        outside; /* models tried with E^2 <= threshold; of these, with a parameter outside of what is claimed */
    long double reached[2][256]; /* least and largest of each parameter met, in the order of attack_check() */
};

static inline int attack_used(const struct attack *a, size_t i)
{
    const double *l = a->samples->light + 3 * i, *v = a->samples->view + 3 * i;
    const double up[3] = {0.0, 0.0, 1.0}, *n = a->samples->normal ? a->samples->normal + 3 * i : up;
    double nl = n[0] * l[0] + n[1] * l[1] + n[2] * l[2], nv = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];

    return nl > 0.0 && nv > 0.0 && nl >= cos(a->options->max_incidence * 3.14159265358979323846 / 180.0) - 1e-9 &&
           (!a->samples->weights || a->samples->weights[i] > 0.0);
}

/* Column c at roughness sigma[lobes], by a model that has 1 there and 0 elsewhere. */
static inline void attack_column(struct attack *a, const double *sigma, int c)
{
    double x = 0.0, x_more[4] = {0.0}, y[BRDFFIT_MAX_LOBES] = {0.0}, f0[BRDFFIT_MAX_LOBES] = {0.0};
    brdffit_distribution kinds[BRDFFIT_MAX_LOBES] = {a->options->distribution, a->options->distribution,
                                                     a->options->distribution};
    brdffit_samples at = *a->samples;
    brdffit_model model;
    size_t i;

    brdffit_model_init(&model);
    model.distribution = a->options->distribution;
    model.distributions = kinds;
    model.lobes = a->lobes;
    model.channels = 1;
    model.sigma = sigma;
    model.x = &x;
    model.y = y;
    model.fresnel = a->options->fresnel;
    model.diffuse = a->options->diffuse;
    model.masking = a->options->masking;
    model.f0 = a->each > 1 ? f0 : NULL;
    model.x_more = a->fixed > 1 ? x_more : NULL;
    if (c == 0) {
        x = 1.0;
    } else if (c < a->fixed) {
        x_more[c - 1] = 1.0;
    } else {
        y[(c - a->fixed) / a->each] = 1.0;
        f0[(c - a->fixed) / a->each] = (c - a->fixed) % a->each == 0 ? 1.0 : 0.0;
    }
    at.quantity = BRDFFIT_QUANTITY_RADIANCE;
    if (brdffit_eval(&model, &at, a->column + (size_t)c * a->count, NULL) != BRDFFIT_OK) {
        abort();
    }
    for (i = 0; i < a->count; i++) {
        a->column[(size_t)c * a->count + i] *= attack_used(a, i)
                                                   ? sqrt(a->samples->weights ? a->samples->weights[i] : 1.0)
                                                   : 0.0;
    }
}

static inline void attack_at(struct attack *a, const double *sigma)
{
    int c, d;
    size_t i, k;

    for (c = 0; c < a->columns; c++) {
        attack_column(a, sigma, c);
        for (d = 0; d <= c; d++) {
            long double sum = 0.0L;

            for (i = 0; i < a->count; i++) {
                sum += (long double)a->column[(size_t)c * a->count + i] * a->column[(size_t)d * a->count + i];
            }
            a->gram[c][d] = a->gram[d][c] = sum;
        }
        for (k = 0; k < a->channels; k++) {
            long double sum = 0.0L;

            for (i = 0; i < a->count; i++) {
                double w = a->samples->weights ? sqrt(a->samples->weights[i]) : 1.0;

                sum += attack_used(a, i) ? (long double)a->column[(size_t)c * a->count + i] * w *
                                               a->samples->values[i * a->channels + k]
                                         : 0.0L;
            }
            a->along[k * (size_t)a->columns + (size_t)c] = sum;
        }
    }
}

/* E^2 of channel k, in the units that were minimised. */
static inline long double attack_e2(const struct attack *a, size_t k, const long double *z)
{
    long double sum = a->square[k];
    int c, d;

    for (c = 0; c < a->columns; c++) {
        long double inner = 0.0L;

        for (d = 0; d < a->columns; d++) {
            inner += a->gram[c][d] * z[d];
        }
        sum += z[c] * (inner - 2.0L * a->along[k * (size_t)a->columns + (size_t)c]);
    }
    return sum / ((long double)a->scale[k] * a->scale[k]);
}

/* min over z >= 0 of E_k^2 - lambda.z (in the channel's own units), by coordinate descent from *z. */
static inline void attack_solve(const struct attack *a, size_t k, const long double *lambda, int sweeps, long double *z)
{
    int sweep, c, d;

    for (sweep = 0; sweep < sweeps; sweep++) {
        long double moved = 0.0L;

        for (c = 0; c < a->columns; c++) {
            long double slope = a->along[k * (size_t)a->columns + (size_t)c] + 0.5L * lambda[c], next;

            for (d = 0; d < a->columns; d++) {
                slope -= d == c ? 0.0L : a->gram[c][d] * z[d];
            }
            next = a->gram[c][c] > 0.0L ? fmaxl(0.0L, slope / a->gram[c][c]) : 0.0L;
            moved = fmaxl(moved, fabsl(next - z[c]) / (fabsl(z[c]) + 1e-300L));
            z[c] = next;
        }
        if (moved < 1e-15L) {
            return;
        }
    }
}

static inline void attack_note(struct attack *a, size_t at, long double value, const brdffit_range *range, double slack)
{
    if (at < 256) {
        a->reached[0][at] = fminl(a->reached[0][at], value);
        a->reached[1][at] = fmaxl(a->reached[1][at], value);
    }
    /* `slack`: what the oracle's own rounding may have done to the parameter. */
    if (value < (long double)range->low * (1.0L - slack) || value > (long double)range->high * (1.0L + slack)) {
        a->outside++;
    }
}

/* A model that is near enough: is it inside? sigma as given, like lobes ascending. */
static inline void attack_check(struct attack *a, const double *sigma, const long double *z)
{
    size_t k, at = 0;
    int p, c;

    a->inside++;
    for (p = 0; p < a->lobes; p++) {
        attack_note(a, at++, sigma[p], &a->claim->sigma[p], 0.0);
    }
    for (k = 0; k < a->channels; k++) {
        const long double *own = z + k * (size_t)a->columns;

        for (c = 0; c < a->fixed; c++) {
            attack_note(a, at++, own[c], &a->claim->x[k * (size_t)a->fixed + (size_t)c], 1e-15);
        }
        for (p = 0; p < a->lobes; p++) {
            const long double *y = own + a->fixed + p * a->each;
            long double sum = y[0] + (a->each > 1 ? y[1] : 0.0L);

            attack_note(a, at++, sum, &a->claim->y[k * (size_t)a->lobes + (size_t)p], 1e-15);
            if (a->each > 1 && sum > 0.0L) {
                attack_note(a, at, y[0] / sum, &a->claim->f0[k * (size_t)a->lobes + (size_t)p], 1e-15);
            }
            at += a->each > 1 ? 1 : 0;
        }
    }
}

static inline void attack_new(struct attack *a, const brdffit_samples *samples, const brdffit_options *options,
                              const double *scale, const brdffit_interval_result *claim)
{
    size_t k, i;

    memset(a, 0, sizeof *a);
    a->samples = samples;
    a->options = options;
    a->scale = scale;
    a->claim = claim;
    a->lobes = options->lobes;
    a->fixed = brdffit_diffuse_columns(options->diffuse);
    a->each = options->fresnel == BRDFFIT_FRESNEL_SCHLICK ? 2 : 1;
    a->columns = a->fixed + a->each * a->lobes;
    a->channels = samples->channels;
    a->count = samples->count;
    a->column = calloc((size_t)a->columns * a->count, sizeof *a->column);
    a->along = calloc(a->channels * (size_t)a->columns, sizeof *a->along);
    a->square = calloc(a->channels, sizeof *a->square);
    for (k = 0; k < 256; k++) {
        a->reached[0][k] = INFINITY;
        a->reached[1][k] = -INFINITY;
    }
    for (k = 0; k < a->channels; k++) {
        for (i = 0; i < a->count; i++) {
            long double v = samples->values[i * a->channels + k];

            a->square[k] += attack_used(a, i) ? v * v * (samples->weights ? samples->weights[i] : 1.0) : 0.0L;
        }
    }
}

static inline void attack_free(struct attack *a)
{
    free(a->column);
    free(a->along);
    free(a->square);
}

/*
 * From the best coefficients at sigma: those that push column c of channel k up or down to the threshold exactly, the others following,
 * and `walks` models on the way of a random walk. Returns 0 where no model of this sigma is near enough.
 */
static inline int attack_sigma(struct attack *a, const double *sigma, int walks, struct brdffit_test_random *random)
{
    size_t n = (size_t)a->columns, k, total = a->channels * n;
    long double *best = calloc(total, sizeof *best), *z = calloc(total, sizeof *z), lambda[ATTACK_COLUMNS] = {0.0L};
    long double *e2 = calloc(a->channels, sizeof *e2), all = 0.0L, limit = (long double)a->claim->threshold;
    int c, i, fine, sense;

    attack_at(a, sigma);
    for (k = 0; k < a->channels; k++) {
        attack_solve(a, k, lambda, 5000, best + k * n);
        e2[k] = attack_e2(a, k, best + k * n);
        all += e2[k];
    }
    fine = all <= limit;
    if (fine) {
        attack_check(a, sigma, best);
    }
    for (k = 0; fine && k < a->channels; k++) {
        long double room = limit - all + e2[k];

        for (c = 0; c < 2 * a->columns; c++) {
            long double low = -60.0L, high = 20.0L, unit;

            sense = c % 2 ? 1 : -1;
            memcpy(z, best, total * sizeof *z);
            unit = sqrtl(fmaxl(limit - all, 1e-30L) * a->gram[c / 2][c / 2]) * a->scale[k];
            for (i = 0; i < 26; i++) {
                long double middle = 0.5L * (low + high), *own = z + k * n;

                memcpy(own, best + k * n, n * sizeof *own);
                memset(lambda, 0, sizeof lambda);
                lambda[c / 2] = sense * unit * expl(0.3L * middle);
                attack_solve(a, k, lambda, 150, own);
                if (attack_e2(a, k, own) <= room) {
                    low = middle;
                    attack_check(a, sigma, z);
                } else {
                    high = middle;
                }
            }
        }
    }
    memcpy(z, best, total * sizeof *z);
    for (i = 0; fine && i < walks; i++) {
        size_t where = brdffit_test_below(random, total);
        long double old = z[where], sum = 0.0L,
                    own = old +
                          brdffit_test_normal(random) * 0.1L * (best[where] + sqrtl(limit / (long double)a->count));

        z[where] = a->gram[where % n][where % n] > 0.0L ? fmaxl(own, 0.0L) : 0.0L; /* a column that there is not */
        for (k = 0; k < a->channels; k++) {
            sum += attack_e2(a, k, z + k * n);
        }
        if (sum <= limit) {
            attack_check(a, sigma, z);
        } else {
            z[where] = old;
        }
    }
    free(best);
    free(z);
    free(e2);
    return fine;
}

#endif
