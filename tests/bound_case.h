/*
 * Random problems for attacks on bounds: coefficients (a, b, c) and data, made from a seed. Shared by test_bound.c
 * and ref/bound_cases.c (which hands boxes to ball arithmetic). SPDX-License-Identifier: MIT
 */
#ifndef BOUND_CASE_H
#define BOUND_CASE_H

#include "brdffit.h"
#include "nnls_case.h"
#include "data/reduce.h"

#define CASE_SAMPLES 24
#define CASE_CHANNELS 3

struct bound_case {
    int lobes;
    brdffit_distribution distribution;
    size_t count, channels;
    double a[CASE_SAMPLES], b[CASE_SAMPLES], c[CASE_SAMPLES];
    double values[CASE_SAMPLES * CASE_CHANNELS];
};

/* Half-vector angles of an instrument: mirror samples, a few repeated, an outlier now and then. */
static inline double case_c(uint64_t *s, int i, int kind)
{
    double angle = kind == 0 ? 0.05 * (i / 2) : kind == 1 ? 1.2 * case_uniform(s) : 0.3 * case_uniform(s) + 0.02;
    double t = tan(angle);

    if (kind == 3) {
        return pow(10.0, 8.0 * case_signed(s));
    }
    return t * t;
}

static inline void case_data(struct bound_case *c, uint64_t *s)
{
    double sigma[2] = {pow(10.0, -2.5 * case_uniform(s)), pow(10.0, -2.5 * case_uniform(s))};
    double noise = case_next(s) % 3 ? pow(10.0, -4.0 * case_uniform(s)) : 0.0;
    int signed_noise = case_next(s) % 3 == 0;
    size_t i, k;

    if (case_next(s) % 4 == 0) { /* nearly one lobe */
        sigma[1] = sigma[0] * (1.0 + pow(10.0, -8.0 * case_uniform(s)));
    }
    for (k = 0; k < c->channels; k++) {
        double x = case_uniform(s), y0 = case_uniform(s), y1 = case_next(s) % 2 ? case_uniform(s) : 0.0;

        for (i = 0; i < c->count; i++) {
            double v = c->a[i] * x + c->b[i] * (y0 * exp(-c->c[i] / (sigma[0] * sigma[0])) +
                                                y1 * exp(-c->c[i] / (sigma[1] * sigma[1])));

            v *= 1.0 + noise * case_signed(s);
            v += signed_noise ? noise * case_signed(s) : 0.0;
            c->values[i * c->channels + k] = case_next(s) % 97 == 0 ? 0.0 : v;
        }
    }
}

static inline void bound_case_make(struct bound_case *c, uint64_t seed, brdffit_samples *samples,
                                   brdffit_options *options)
{
    uint64_t s = seed * 0x5851f42d4c957f2du + 17;
    int kind = (int)(case_next(&s) % 4);
    size_t i;

    c->lobes = 1 + (int)(case_next(&s) % 3 != 0);
    c->distribution = case_next(&s) % 4 ? BRDFFIT_BECKMANN : BRDFFIT_GGX;
    c->count = 1 + case_next(&s) % CASE_SAMPLES;
    c->channels = 1 + case_next(&s) % CASE_CHANNELS;
    for (i = 0; i < c->count; i++) {
        c->a[i] = 0.3 * (0.1 + case_uniform(&s));
        c->b[i] = 0.3 + 3.0 * case_uniform(&s) * case_uniform(&s);
        c->c[i] = case_c(&s, (int)i, kind);
    }
    case_data(c, &s);
    brdffit_samples_init(samples);
    samples->form = BRDFFIT_FORM_COEFFICIENTS;
    samples->quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples->count = c->count;
    samples->channels = c->channels;
    samples->a = c->a;
    samples->b = c->b;
    samples->c = c->c;
    samples->values = c->values;
    brdffit_options_init(options);
    options->lobes = c->lobes;
    options->distribution = c->distribution;
    options->relative_gap = 1e-2;
    options->box_budget = 2000;
    if (case_next(&s) % 3 == 0) {
        options->sigma_min = 1e-3;
        options->sigma_max = 2.0;
    }
}

/* To the internal units of the reduction (powers of two, except the channels, whose division case_nnls repeats). */
static inline void bound_case_rescale(struct bound_case *c, const struct reduced *data)
{
    size_t i;

    for (i = 0; i < c->count; i++) {
        c->a[i] /= data->scale_a[0];
        c->b[i] /= data->table[0].scale_b;
    }
}

/* ||I_k - A z||^2 minimised over z >= 0 by enumeration of supports; columns have unit norm or are zero. */
static inline long double case_nnls(const struct bound_case *c, double scale, int channel, int columns,
                                    long double column[3][CASE_SAMPLES])
{
    long double data[CASE_SAMPLES], best = 0.0L;
    int n = (int)c->count, i, j, k;
    unsigned bits;

    for (i = 0; i < n; i++) {
        data[i] = (long double)c->values[(size_t)i * c->channels + (size_t)channel] / scale;
        best += data[i] * data[i];
    }
    for (bits = 1; bits < 1u << columns; bits++) {
        long double q[3][CASE_SAMPLES], r[3][3], t[3], z[3], rest[CASE_SAMPLES], rss = 0.0L;
        int m = 0, usable = 1;

        for (i = 0; i < n; i++) {
            rest[i] = data[i];
        }
        for (j = 0; j < columns && usable; j++) {
            long double norm = 0.0L;
            int pass;

            if (!(bits & (1u << j))) {
                continue;
            }
            for (i = 0; i < n; i++) {
                q[m][i] = column[j][i];
            }
            for (k = 0; k < m; k++) {
                r[k][m] = 0.0L;
            }
            for (pass = 0; pass < 2; pass++) {
                for (k = 0; k < m; k++) {
                    long double part = 0.0L;

                    for (i = 0; i < n; i++) {
                        part += q[k][i] * q[m][i];
                    }
                    for (i = 0; i < n; i++) {
                        q[m][i] -= part * q[k][i];
                    }
                    r[k][m] += part;
                }
            }
            for (i = 0; i < n; i++) {
                norm += q[m][i] * q[m][i];
            }
            r[m][m] = sqrtl(norm);
            usable = r[m][m] > 1e-18L;
            t[m] = 0.0L;
            for (i = 0; i < n && usable; i++) {
                q[m][i] /= r[m][m];
                t[m] += q[m][i] * rest[i];
            }
            for (i = 0; i < n && usable; i++) {
                rest[i] -= t[m] * q[m][i];
            }
            m++;
        }
        for (j = m - 1; j >= 0 && usable; j--) {
            z[j] = t[j];
            for (k = j + 1; k < m; k++) {
                z[j] -= r[j][k] * z[k];
            }
            z[j] /= r[j][j];
            usable = z[j] >= 0.0L;
        }
        for (i = 0; i < n; i++) {
            rss += rest[i] * rest[i];
        }
        if (usable && rss < best) {
            best = rss;
        }
    }
    return best;
}

static inline void bound_case_print(const struct bound_case *c, FILE *out)
{
    size_t i, k;

    fprintf(out, "distribution %d, samples %zu, channels %zu\n", (int)c->distribution, c->count, c->channels);
    for (i = 0; i < c->count; i++) {
        fprintf(out, "%a,%a,%a", c->a[i], c->b[i], c->c[i]);
        for (k = 0; k < c->channels; k++) {
            fprintf(out, ",%a", c->values[i * c->channels + k]);
        }
        fprintf(out, "\n");
    }
}

#endif
