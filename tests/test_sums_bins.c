/*
 * Binned sums: what a fit of them claims, against the samples themselves in long double; bins against exact groups;
 * sizes that do not depend on the number of samples; misuse. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "fewer.h"
#include "data/sums.h"
#include "support.h"

#define CHANNELS 2

struct rig {
    size_t count;
    double *a, *b, *c, *values, *weights;
    brdffit_samples samples;
};

/* Every c distinct; two lobes of roughness 0.07 and 0.4 on diffuse, each value off by `noise` of itself. */
static void rig_new(struct rig *r, size_t count, double noise, int weighted, double c_low, double c_high, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    size_t i, k;

    r->count = count;
    r->a = malloc((4 + CHANNELS) * count * sizeof(double));
    assert_non_null(r->a);
    r->b = r->a + count;
    r->c = r->b + count;
    r->weights = r->c + count;
    r->values = r->weights + count;
    r->samples = brdffit_test_coefficients(count, CHANNELS, r->a, r->b, r->c, r->values);
    r->samples.weights = weighted ? r->weights : NULL;
    for (i = 0; i < count; i++) {
        double part = brdffit_test_uniform(&random, 0.0, 1.0);
        double c = c_low + (c_high - c_low) * part * part;
        double narrow = exp(-c / 0.0049) / 0.0049, wide = exp(-c / 0.16) / 0.16;

        r->a[i] = brdffit_test_uniform(&random, 0.1, 0.3);
        r->b[i] = brdffit_test_uniform(&random, 0.2, 1.2);
        r->c[i] = c;
        r->weights[i] = brdffit_test_log_uniform(&random, 0.1, 10.0);
        for (k = 0; k < CHANNELS; k++) {
            double lobe = 0.003 * (double)(1 + k) * narrow + 0.1 * wide;

            r->values[i * CHANNELS + k] = (r->a[i] + r->b[i] * lobe) * (1.0 + noise * brdffit_test_normal(&random));
        }
    }
}

struct outcome {
    brdffit_sums *sums;
    void *memory, *workspace;
    size_t room;
    struct brdffit_test_result result;
};

static void add_all(struct outcome *o, const struct rig *r, size_t groups, int bits, const brdffit_options *options)
{
    size_t size = brdffit_sums_size(CHANNELS, groups);
    brdffit_error error = {0};

    o->memory = malloc(size);
    assert_non_null(o->memory);
    assert_int_equal(brdffit_sums_init(o->memory, size, CHANNELS, groups, options, &o->sums, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_sums_bins(o->sums, bits, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_sums_add(o->sums, &r->samples, &error), BRDFFIT_OK);
    o->room = brdffit_sums_workspace_size(o->sums, options);
    o->workspace = malloc(o->room);
    assert_non_null(o->workspace);
}

static void fit(struct outcome *o, const brdffit_options *options)
{
    brdffit_error error = {0};

    assert_int_equal(brdffit_test_run_sums(o->sums, options, o->workspace, o->room, &o->result, &error), BRDFFIT_OK);
}

static void outcome_free(struct outcome *o)
{
    free(o->workspace);
    free(o->memory);
}

/* E^2 of a channel at the best x, Y >= 0 for these s, by trying every set of columns. */
static long double best_channel(const struct rig *r, size_t k, double scale, const long double *s, int lobes)
{
    long double gram[4][4] = {{0.0L}}, best;
    size_t i;
    int set, p, q, m, n = 1 + lobes;

    for (i = 0; i < r->count; i++) {
        long double column[4], w = r->samples.weights ? r->weights[i] : 1.0L;

        column[0] = r->a[i];
        for (p = 0; p < lobes; p++) {
            column[1 + p] = r->b[i] * expl(-s[p] * ((long double)r->c[i]));
        }
        column[n] = r->values[i * CHANNELS + k] / (long double)scale;
        for (p = 0; p <= n; p++) {
            for (q = 0; q <= n; q++) {
                gram[p][q] += w * column[p] * column[q];
            }
        }
    }
    best = gram[n][n];
    for (set = 1; set < 1 << n; set++) { /* Gauss on the columns of the set; the last row is the data's */
        long double work[4][4];
        int index[4], size = 0, fine = 1;

        for (p = 0; p < n; p++) {
            if (set >> p & 1) {
                index[size++] = p;
            }
        }
        index[size] = n;
        for (p = 0; p <= size; p++) {
            for (q = 0; q <= size; q++) {
                work[p][q] = gram[index[p]][index[q]];
            }
        }
        for (p = 0; p < size && fine; p++) {
            fine = work[p][p] > 1e-13L * gram[index[p]][index[p]];
            for (m = p + 1; m <= size && fine; m++) {
                long double factor = work[m][p] / work[p][p];

                for (q = p; q <= size; q++) {
                    work[m][q] -= factor * work[p][q];
                }
            }
        }
        for (p = size - 1; p >= 0 && fine; p--) { /* coefficients must not be negative */
            for (q = p + 1; q < size; q++) {
                work[p][size] -= work[p][q] * work[q][size];
            }
            work[p][size] /= work[p][p];
            fine = work[p][size] >= 0.0L;
        }
        if (fine && work[size][size] < best) {
            best = work[size][size];
        }
    }
    return best;
}

static long double best_at(const struct rig *r, const struct brdffit_test_result *result, const long double *s,
                           int lobes)
{
    long double sum = 0.0L;
    size_t k;

    for (k = 0; k < CHANNELS; k++) {
        sum += best_channel(r, k, result->channel_scale[k], s, lobes);
    }
    return sum;
}

/* lambda(s) of the distributions tried here, and s. */
static long double lambda(const struct brdffit_test_result *result, int p, long double *s)
{
    *s = 1.0L / ((long double)result->model.sigma[p] * result->model.sigma[p]);
    if (result->model.distribution == BRDFFIT_BLINN_PHONG) {
        *s = result->lobe[p].exponent;
        return (*s + 2.0L) / (2.0L * 3.14159265358979323846L);
    }
    return result->model.distribution == BRDFFIT_TORRANCE_SPARROW ? 1.0L : *s;
}

/* E^2 of the samples at the result's model. */
static long double at_result(const struct rig *r, const struct brdffit_test_result *result)
{
    long double sum = 0.0L;
    size_t i, k;
    int p;

    for (i = 0; i < r->count; i++) {
        for (k = 0; k < CHANNELS; k++) {
            long double v = r->a[i] * (long double)result->model.x[k] - r->values[i * CHANNELS + k];

            for (p = 0; p < result->model.lobes; p++) {
                long double s, factor = lambda(result, p, &s);

                v += r->b[i] * (long double)result->model.y[k * (size_t)result->model.lobes + (size_t)p] * factor *
                     expl(-s * r->c[i]);
            }
            v /= result->channel_scale[k];
            sum += (r->samples.weights ? r->weights[i] : 1.0L) * v * v;
        }
    }
    return sum;
}

/* All that the result claims; half of the attacks on the bound are near the optimum. */
static void check_claims(const struct rig *r, const struct brdffit_test_result *result, size_t attacks, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    long double exact = at_result(r, result);
    size_t i;
    int p;

    if (!(fabsl(exact - result->e2) <= result->e2_error)) {
        fail_msg("E^2 %.17Lg, said to be %.17g +- %g", exact, result->e2, result->e2_error);
    }
    assert_true(result->lower_bound <= exact);
    for (i = 0; i < attacks; i++) {
        long double s[2], got;

        for (p = 0; p < result->model.lobes; p++) {
            double sigma = i % 2 ? result->model.sigma[p] * (1.0 + 1e-3 * brdffit_test_normal(&random))
                                 : brdffit_test_log_uniform(&random, 1e-5, 6.0);

            s[p] = 1.0L / ((long double)sigma * sigma);
        }
        got = best_at(r, result, s, result->model.lobes);
        /* The reference cancels: Gauss on long double sums leaves some 1e-16 of the zero model. */
        if (!(got + 1e-15L * result->sum_of_squares >= result->lower_bound)) {
            fail_msg("E^2 %.17Lg at s = %Lg is below the bound %.17g", got, s[0], result->lower_bound);
        }
    }
}

/* Against brdffit_fit() on the samples. */
static void check_samples(const struct rig *r, const brdffit_options *options, const struct brdffit_test_result *binned)
{
    brdffit_error error = {0};
    size_t room = brdffit_workspace_size(r->count, CHANNELS, options);
    void *workspace = malloc(room);
    struct brdffit_test_result exact;

    assert_non_null(workspace);
    assert_int_equal(brdffit_test_run(&r->samples, options, workspace, room, &exact, &error), BRDFFIT_OK);
    assert_true(binned->lower_bound <= exact.e2);
    assert_true(exact.lower_bound <= binned->e2 + binned->e2_error);
    free(workspace);
}

/* Noise that leaves many values negative, down to none; c from 0, away from it, and in less than one cell. */
static void test_claims(void **state)
{
    static const double noise[] = {2.0, 0.1, 0.02, 1e-6, 0.0}, low[] = {0.0, 0.02, 0.0, 9.0, 1e-6};
    static const double high[] = {4.0, 4.0, 1.0, 9.2, 0.3};
    static const brdffit_distribution kind[] = {BRDFFIT_BECKMANN, BRDFFIT_TORRANCE_SPARROW, BRDFFIT_BLINN_PHONG};
    size_t i;

    (void)state;
    for (i = 0; i < 30; i++) {
        brdffit_options options;
        struct rig r;
        struct outcome o;
        int bits = i % 2 ? 10 : 5;

        brdffit_options_init(&options);
        options.lobes = 1 + (int)(i & 1);
        options.normalise = i & 2 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        options.box_budget = 20000;
        options.distribution = kind[i % 3];
        rig_new(&r, 4000, noise[i / 6], i % 4 == 1, low[i % 5], high[i % 5], i);
        add_all(&o, &r, 40000, i % 4 == 2 ? 2 : bits, &options);
        fit(&o, &options);
        check_claims(&r, &o.result, FEWER(60, 8), i);
        check_samples(&r, &options, &o.result);
        outcome_free(&o);
        free(r.a);
    }
}

/* 1e5 distinct c, 5 % noise: the gap of 1e-3 is proven for the samples, though nothing of them is kept. */
static void test_certified(void **state)
{
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        brdffit_options options;
        struct rig r;
        struct outcome o;

        brdffit_options_init(&options);
        options.lobes = lobes;
        rig_new(&r, 100000, 0.05, 0, 0.0, 4.0, 77);
        add_all(&o, &r, 20000, 10, &options);
        fit(&o, &options);
        assert_true(o.result.distinct_c < 20000 && o.result.samples_used == r.count);
        check_claims(&r, &o.result, 6, 9);
        assert_int_equal(o.result.certified, 1);
        assert_int_equal(o.result.stop, BRDFFIT_STOP_RELATIVE_GAP);
        assert_true(o.result.e2 + o.result.e2_error <= (1.0 + options.relative_gap) * o.result.lower_bound);
        outcome_free(&o);
        free(r.a);
    }
}

/* Bins too coarse for the gap: said so, and what is claimed still holds (check_claims of test_claims). */
static void test_coarse(void **state)
{
    brdffit_options options;
    struct rig r;
    struct outcome o;

    (void)state;
    brdffit_options_init(&options);
    rig_new(&r, 5000, 1e-3, 0, 0.0, 4.0, 3);
    add_all(&o, &r, 4000, 3, &options);
    fit(&o, &options);
    assert_int_equal(o.result.certified, 0);
    assert_int_equal(o.result.stop, BRDFFIT_STOP_ROUNDING);
    check_claims(&r, &o.result, 100, 5);
    outcome_free(&o);
    free(r.a);
}

/* The same room takes 100 times the samples, and what the fit sees grows with the octaves of c only. */
static void test_sizes(void **state)
{
    size_t n, groups[4] = {0, 0, 0, 0}, room[4] = {0, 0, 0, 0}, i = 0;
    double octaves;

    (void)state;
    for (n = 10000; n <= 1000000; n *= 10, i++) {
        brdffit_options options;
        struct rig r;
        struct outcome o;

        brdffit_options_init(&options);
        rig_new(&r, n, 0.02, 0, 0.0, 4.0, n);
        add_all(&o, &r, 2000, 6, &options);
        fit(&o, &options);
        groups[i] = o.sums->groups;
        /* 64 nodes an octave, from the last exact c up, and at most one more at either end */
        octaves = log2(4.0) - log2(o.sums->c[o.sums->ascending[o.sums->exact_used - 1]]);
        assert_true((double)(groups[i] - o.sums->exact) <= 64.0 * (octaves + 1.0) + 2.0);
        room[i] = o.room;
        outcome_free(&o);
        free(r.a);
    }
    assert_true(groups[2] <= 2000 && room[2] < 2 * room[0]);
}

/* Samples in any order: the same exact c, and products and cells that differ by rounding only. */
static void test_order(void **state)
{
    brdffit_options options;
    struct rig r;
    struct outcome forth, back;
    size_t i, j, g;

    (void)state;
    brdffit_options_init(&options);
    rig_new(&r, 3001, 0.02, 1, 0.0, 4.0, 12);
    add_all(&forth, &r, 1600, 4, &options);
    for (i = 0, j = r.count - 1; i < j; i++, j--) {
        double *column[4] = {r.a, r.b, r.c, r.weights}, kept;
        size_t k;

        for (k = 0; k < 4 + CHANNELS; k++) {
            double *p = k < 4 ? &column[k][i] : &r.values[i * CHANNELS + k - 4];
            double *q = k < 4 ? &column[k][j] : &r.values[j * CHANNELS + k - 4];

            kept = *p;
            *p = *q;
            *q = kept;
        }
    }
    add_all(&back, &r, 1600, 4, &options);
    assert_int_equal(forth.sums->exact_used, 200);
    for (i = 0; i < 200; i++) {
        assert_true(forth.sums->c[forth.sums->ascending[i]] == back.sums->c[back.sums->ascending[i]]);
    }
    for (g = 200; g < forth.sums->groups; g++) {
        size_t other = brdffit_sums_find(back.sums, forth.sums->c[g]);
        double here = sums_value(sums_group(forth.sums, g) + SUMS_BB), there;

        assert_true(other < back.sums->groups);
        there = sums_value(sums_group(back.sums, other) + SUMS_BB);
        assert_true(fabs(here - there) <= 1e-14 * here);
        here = sums_value(&forth.sums->cell[g]);
        assert_true(fabs(here - sums_value(&back.sums->cell[other])) <= 1e-14 * here);
    }
    outcome_free(&forth);
    outcome_free(&back);
    free(r.a);
}

static brdffit_status try_bins(brdffit_distribution distribution, size_t groups, int bits)
{
    size_t size = brdffit_sums_size(CHANNELS, groups);
    void *memory = malloc(size);
    brdffit_sums *sums = NULL;
    brdffit_options options;
    brdffit_error error = {0};
    brdffit_status status;

    brdffit_options_init(&options);
    options.distribution = distribution;
    assert_int_equal(brdffit_sums_init(memory, size, CHANNELS, groups, &options, &sums, &error), BRDFFIT_OK);
    status = brdffit_sums_bins(sums, bits, &error);
    if (status == BRDFFIT_OK) {
        assert_int_equal(brdffit_sums_bins(sums, bits, &error), BRDFFIT_ERR_ARGUMENT);
    }
    free(memory);
    return status;
}

static void ignore_box(void *user, const brdffit_box *box)
{
    (void)user;
    (void)box;
}

static void test_refusals(void **state)
{
    brdffit_options options;
    struct rig r;
    struct outcome o;
    brdffit_error error = {0};

    (void)state;
    assert_int_equal(try_bins(BRDFFIT_BECKMANN, 100, 4), BRDFFIT_OK);
    assert_int_equal(try_bins(BRDFFIT_BLINN_PHONG, 8, 20), BRDFFIT_OK);
    assert_int_equal(try_bins(BRDFFIT_GGX, 100, 4), BRDFFIT_ERR_UNSUPPORTED);
    assert_int_equal(try_bins(BRDFFIT_BECKMANN, 7, 4), BRDFFIT_ERR_WORKSPACE);
    assert_int_equal(try_bins(BRDFFIT_BECKMANN, 100, 0), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(try_bins(BRDFFIT_BECKMANN, 100, 21), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_sums_bins(NULL, 4, &error), BRDFFIT_ERR_ARGUMENT);
    brdffit_options_init(&options);
    rig_new(&r, 500, 0.02, 0, 0.0, 4.0, 1);
    add_all(&o, &r, 600, 4, &options);
    options.box = ignore_box;
    assert_int_equal(brdffit_test_run_sums(o.sums, &options, o.workspace, o.room, &o.result, &error),
                     BRDFFIT_ERR_UNSUPPORTED);
    outcome_free(&o);
    free(r.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_claims), cmocka_unit_test(test_certified), cmocka_unit_test(test_coarse),
        cmocka_unit_test(test_sizes),  cmocka_unit_test(test_order),     cmocka_unit_test(test_refusals),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
