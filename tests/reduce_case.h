/*
 * Random samples of form COEFFICIENTS, and what their reduction must hold, in long double from the samples
 * themselves. Shared by test_reduce.c and test_reduce_edges.c. SPDX-License-Identifier: MIT
 */
#ifndef REDUCE_CASE_H
#define REDUCE_CASE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "data/reduce.h"
#include "support.h"
#include "base/tolerance.h"

/* Relative error that reduce_sums.c promises: 64 + 8 units, twice over for a and b themselves. */
#define SUM_ERROR (2.0L * 72.0L * TOL_UNIT)

struct problem {
    size_t count, channels;
    double *a, *b, *c, *values, *weights;
    brdffit_samples samples;
};

static inline void problem_new(struct problem *p, size_t count, size_t channels)
{
    p->count = count;
    p->channels = channels;
    p->a = calloc((4 + channels) * count, sizeof(double));
    assert_non_null(p->a);
    p->b = p->a + count;
    p->c = p->b + count;
    p->weights = p->c + count;
    p->values = p->weights + count;
    p->samples = brdffit_test_coefficients(count, channels, p->a, p->b, p->c, p->values);
}

/* `groups` distinct c; every fifth sample has no lobe when `zeros`. */
static inline void problem_fill(struct problem *p, size_t groups, int negative, int zeros, int weighted, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    size_t i, k;

    for (i = 0; i < p->count; i++) {
        p->a[i] = brdffit_test_uniform(&random, 0.0, 0.3);
        p->b[i] = zeros && i % 5 == 0 ? 0.0 : brdffit_test_log_uniform(&random, 1e-3, 30.0);
        p->c[i] = 0.125 + 0.01 * (double)brdffit_test_below(&random, groups);
        p->weights[i] = i % 7 == 3 ? 0.0 : brdffit_test_log_uniform(&random, 1e-2, 1e2);
        for (k = 0; k < p->channels; k++) {
            p->values[i * p->channels + k] = brdffit_test_uniform(&random, negative ? -1.0 : 0.0, 2.0);
        }
    }
    p->samples.weights = weighted ? p->weights : NULL;
}

struct outcome {
    struct reduced r;
    void *block;
};

static inline brdffit_status try_reduce(struct outcome *o, const brdffit_samples *s, brdffit_error *error)
{
    struct arena arena;
    brdffit_options options;
    struct model model;

    brdffit_options_init(&options);
    brdffit_model_make(&model, &options);
    brdffit_arena_init(&arena, NULL, 0);
    brdffit_reduce_layout(&o->r, &arena, s->count, s->channels, &model);
    o->block = malloc(arena.used);
    assert_non_null(o->block);
    brdffit_arena_init(&arena, o->block, arena.used);
    brdffit_reduce_layout(&o->r, &arena, s->count, s->channels, &model);
    assert_false(arena.failed);
    return brdffit_reduce(&o->r, s, &model, &options, error);
}

static inline void reduce(struct outcome *o, const brdffit_samples *s)
{
    assert_int_equal(try_reduce(o, s, NULL), BRDFFIT_OK);
}

/* Sample i in the units of the reduction, without rounding: weight, a, b, value. */
static inline long double weight(const struct problem *p, const struct reduced *r, size_t i)
{
    return p->samples.weights ? (long double)p->weights[i] / r->scale_w : 1.0L;
}

static inline long double value(const struct problem *p, const struct reduced *r, size_t i, size_t k)
{
    return (long double)p->values[i * p->channels + k] / (r->channel_scale[k] * r->value_scale);
}

static inline void within(const char *what, double got, long double exact, long double allowed)
{
    if (!(fabsl((long double)got - exact) <= allowed)) {
        fail_msg("%s: %.17g, exactly %.17Lg, allowed %Lg off", what, got, exact, allowed);
    }
}

/* Every array of length `stride` at group j; padding is zero. */
static inline void check_group(const struct problem *p, const struct reduced *r, size_t j)
{
    long double bb = 0.0L, b4 = 0.0L, ab = 0.0L;
    size_t i, k, f, K = p->channels;

    for (i = 0; i < p->count; i++) {
        long double b = p->b[i] / r->table[0].scale_b;

        if (j < r->distinct && p->b[i] > 0.0 && p->c[i] - r->table[0].c_min == r->table[0].c[j]) {
            bb += weight(p, r, i) * b * b;
            b4 += powl(weight(p, r, i) * b * b, 2.0L);
            ab += weight(p, r, i) * (p->a[i] / r->scale_a[0]) * b;
        }
    }
    within("bb", r->table[0].bb[j], bb, SUM_ERROR * bb);
    within("concentration", r->table[0].concentration[j], bb > 0.0L ? b4 / (bb * bb) : 0.0L, 4.0L * SUM_ERROR);
    within("ab", r->table[0].linear[j], ab, SUM_ERROR * ab);
    for (f = 1; f < r->functionals; f++) {
        long double sum = 0.0L;

        k = (f - 1) % K;
        for (i = 0; i < p->count; i++) {
            long double v = f > K ? -value(p, r, i, k) : value(p, r, i, k);

            if (j < r->distinct && v > 0.0L && p->c[i] - r->table[0].c_min == r->table[0].c[j]) {
                sum += weight(p, r, i) * v * (p->b[i] / r->table[0].scale_b);
            }
        }
        within("Ib", r->table[0].linear[f * r->stride + j], sum, SUM_ERROR * sum);
    }
}

static inline void check_sums(const struct problem *p, const struct reduced *r)
{
    long double aa = 0.0L, total = 0.0L, weights = 0.0L;
    size_t i, j, k;

    for (i = 0; i < p->count; i++) {
        aa += weight(p, r, i) * powl(p->a[i] / r->scale_a[0], 2.0L);
        weights += weight(p, r, i);
    }
    within("aa", r->aa[0][0], aa, SUM_ERROR * aa);
    within("sum of weights", r->weight_sum, weights, SUM_ERROR * weights);
    for (k = 0; k < p->channels; k++) {
        long double ai = 0.0L, ii = 0.0L, magnitude = 0.0L;

        for (i = 0; i < p->count; i++) {
            long double term = weight(p, r, i) * (p->a[i] / r->scale_a[0]) * value(p, r, i, k);

            ai += term;
            magnitude += fabsl(term);
            ii += weight(p, r, i) * powl(value(p, r, i, k), 2.0L);
        }
        within("ai", r->ai[k], ai, SUM_ERROR * magnitude);
        within("ii", r->ii[k], ii, SUM_ERROR * ii);
        total += ii;
    }
    within("total", r->total, total, SUM_ERROR * total);
    assert_int_equal(r->stride % LANES, 0);
    for (j = 0; j < r->stride; j++) {
        assert_true(j == 0            ? r->table[0].c[j] == 0.0
                    : j < r->distinct ? r->table[0].c[j] > r->table[0].c[j - 1]
                                      : r->table[0].bb[j] == 0.0);
        check_group(p, r, j);
    }
}

/* |a x + b Y_c - I|^2 of channel k over samples and over rows, for random x and Y. */
static inline void check_rows(const struct problem *p, const struct reduced *r, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    double *y = calloc(r->distinct, sizeof *y);
    size_t i, j, k;

    assert_non_null(y);
    assert_true(r->rows <= r->used);
    for (k = 0; k < p->channels; k++) {
        double x = brdffit_test_uniform(&random, -2.0, 2.0);
        long double exact = 0.0L, got = 0.0L, scale = 0.0L;

        for (j = 0; j < r->distinct; j++) {
            y[j] = brdffit_test_uniform(&random, -2.0, 2.0);
        }
        for (i = 0; i < p->count; i++) {
            long double a = p->a[i] / r->scale_a[0], b = p->b[i] / r->table[0].scale_b, v = value(p, r, i, k),
                        along = 0.0L;

            for (j = 0; j < r->distinct; j++) {
                along = p->c[i] - r->table[0].c_min == r->table[0].c[j] ? y[j] : along;
            }
            exact += weight(p, r, i) * powl(a * x + b * along - v, 2.0L);
            scale += weight(p, r, i) * (powl(a * x, 2.0L) + powl(b * along, 2.0L) + v * v);
        }
        for (i = 0; i < r->rows; i++) {
            assert_true(r->row_c[i] < r->distinct);
            got += powl((long double)r->row_a[i] * x + (long double)r->table[0].row_b[i] * y[r->row_c[i]] -
                            r->row_value[k * r->used + i],
                        2.0L);
        }
        within("residual norm", (double)sqrtl(got), sqrtl(exact), 1e-13L * sqrtl(scale));
    }
    free(y);
}

#endif
