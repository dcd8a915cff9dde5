/*
 * brdffit_fit_many(): what the interface promises, and each texel against brdffit_fit() on the same data.
 * SPDX-License-Identifier: MIT
 *
 * Calls to the allocator are seen by the linker's --wrap, as in test_promises.c.
 * LDFLAGS: -Wl,--wrap=malloc
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "batch.h"
#include "verify.h"
#include "verify_lobes.h"
#include "verify_samples.h"

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

static size_t allocations;

void *__wrap_malloc(size_t size)
{
    allocations++;
    return __real_malloc(size);
}

/* ---- Attacks ---------------------------------------------------------------------------------------------------- */

/* Smallest sum of squares of v - x a - y g over x, y >= 0, in long double. */
static long double smallest(const struct verify_sample *at, const long double *v, const long double *g, size_t n)
{
    long double aa = 0.0L, gg = 0.0L, ag = 0.0L, av = 0.0L, gv = 0.0L, x, y, sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        aa += at[i].a * at[i].a;
        gg += g[i] * g[i];
        ag += at[i].a * g[i];
        av += at[i].a * v[i];
        gv += g[i] * v[i];
    }
    y = aa * gg - ag * ag > 0.0L ? (gv * aa - av * ag) / (aa * gg - ag * ag) : 0.0L;
    x = aa > 0.0L ? (av - y * ag) / aa : 0.0L;
    if (!(y > 0.0L)) {
        y = 0.0L;
        x = aa > 0.0L ? fmaxl(av / aa, 0.0L) : 0.0L;
    } else if (!(x > 0.0L)) {
        x = 0.0L;
        y = gg > 0.0L ? fmaxl(gv / gg, 0.0L) : 0.0L;
    }
    for (i = 0; i < n; i++) {
        long double rest = v[i] - x * at[i].a - y * g[i];

        sum += rest * rest;
    }
    return sum;
}

/* The objective of one lobe of roughness sigma, its coefficients chosen best. Samples are weighted in place. */
struct attack {
    struct verify_sample at[256];
    long double v[8][256], g[256], scale[8];
    size_t used, channels;
    brdffit_distribution distribution;
};

static long double objective(struct attack *k, long double sigma)
{
    long double sum = 0.0L;
    size_t i, c;

    for (i = 0; i < k->used; i++) {
        k->g[i] = k->at[i].b * verify_lobe(k->distribution, k->at[i].c, sigma);
    }
    for (c = 0; c < k->channels; c++) {
        sum += smallest(k->at, k->v[c], k->g, k->used);
    }
    return sum;
}

static void open_attack(struct attack *k, const struct brdffit_test_batch *b, size_t t)
{
    brdffit_samples samples = brdffit_test_batch_samples(b, t);
    size_t i, c;

    assert_true(samples.count <= 256 && samples.channels <= 8);
    k->used = 0;
    k->channels = samples.channels;
    k->distribution = b->options.distribution;
    for (i = 0; i < samples.count; i++) {
        struct verify_sample *at = &k->at[k->used];
        long double root;

        if (verify_sample_of(k->distribution, &samples, b->options.max_incidence, i, at) != BRDFFIT_SKIP_COUNT) {
            continue;
        }
        root = samples.weights ? sqrtl((long double)samples.weights[i]) : 1.0L;
        for (c = 0; c < k->channels; c++) {
            k->v[c][k->used] = root * at->to_radiance * samples.values[i * k->channels + c] /
                               b->results.channel_scale[t * k->channels + c];
        }
        at->a *= root;
        at->b *= root;
        k->used++;
    }
}

/* No roughness of a dense grid, nor near the optimum, beats the bound; E^2 is what sigma, x and y give. */
static void attack_texel(const struct brdffit_test_batch *b, size_t t)
{
    static struct attack k;
    double bound = b->results.lower_bound[t], sigma = b->results.sigma[t],
           slack = brdffit_test_batch_rounding(bound, b->results.sum_of_squares[t]);
    long double e2 = 0.0L;
    size_t i, c;
    int j;

    if (b->lobes != 1 || b->options.fresnel || b->options.masking || b->options.diffuse) {
        return; /* this attack knows the plain model; the campaign's know them all */
    }
    open_attack(&k, b, t);
    for (j = 0; j < 300; j++) {
        long double at = j < 200 ? 6.0L * powl(1e-3L, (long double)j / 200.0L)
                                 : sigma * (1.0L + 0.2L * (long double)(j - 250) / 50.0L);
        long double value = at <= 6.0L ? objective(&k, at) : INFINITY;

        if (value < bound - slack) {
            fail_msg("texel %zu: sigma %.17Lg has E^2 %.17Lg below the bound %.17g", t, at, value, bound);
        }
    }
    for (c = 0; c < k.channels; c++) {
        double scale = b->results.channel_scale[t * k.channels + c];

        for (i = 0; i < k.used; i++) {
            long double model = k.at[i].a * b->results.x[t * k.channels + c] +
                                k.at[i].b * b->results.y[t * k.channels + c] *
                                    verify_lobe(k.distribution, k.at[i].c, sigma);

            e2 += (k.v[c][i] - model / scale) * (k.v[c][i] - model / scale);
        }
    }
    if (!(fabsl(e2 - b->results.e2[t]) <=
          brdffit_test_batch_rounding(b->results.e2[t], b->results.sum_of_squares[t]))) {
        fail_msg("texel %zu: E^2 %.17g, from its model %.17Lg", t, b->results.e2[t], e2);
    }
}

static void test_against_fit_of(struct brdffit_test_batch *b, double general_share)
{
    size_t before, t;

    brdffit_test_batch_plan(b);
    before = allocations;
    brdffit_test_batch_fit(b);
    assert_int_equal(allocations, before + 1); /* the test's own workspace */
    for (t = 0; t < b->count; t++) {
        assert_int_equal(b->status[t], BRDFFIT_TEXEL_CERTIFIED);
        assert_true(b->stop[t] == BRDFFIT_STOP_RELATIVE_GAP || b->stop[t] == BRDFFIT_STOP_ABSOLUTE_GAP);
        brdffit_test_batch_against_fit(b, t);
        attack_texel(b, t);
    }
    if (!((double)b->stats.general <= general_share * (double)b->count)) {
        fail_msg("%zu of %zu texels took the general path", b->stats.general, b->count);
    }
}

static void check_against_fit(struct brdffit_test_spec spec, size_t count, int lobes, uint64_t seed)
{
    struct brdffit_test_batch b;

    brdffit_test_batch_new(&b, spec, count, lobes, seed);
    test_against_fit_of(&b, lobes > 1 ? 1.0 : 0.1);
    brdffit_test_batch_free(&b);
}

static void test_one_lobe(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    check_against_fit(spec, 60, 1, 7);
    spec.layout = BRDFFIT_TEST_RANDOM;
    spec.weighted = 1;
    spec.quantity = BRDFFIT_QUANTITY_BRDF;
    check_against_fit(spec, 40, 1, 8);
    spec.form = BRDFFIT_FORM_ANGLES;
    spec.channels = 1;
    spec.count = 29;
    check_against_fit(spec, 40, 1, 9);
    spec.form = BRDFFIT_FORM_COEFFICIENTS;
    spec.quantity = BRDFFIT_QUANTITY_RADIANCE;
    spec.channels = 5;
    spec.count = 200;
    check_against_fit(spec, 20, 1, 10);
}

/* Other distributions, units and gaps. */
static void test_options(void **state)
{
    static const double gap[3] = {1e-1, 1e-5, 1e-3};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_batch b;
    int d;

    (void)state;
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        spec.distribution = (brdffit_distribution)d;
        spec.layout = d % 2 ? BRDFFIT_TEST_GRID : BRDFFIT_TEST_RANDOM;
        brdffit_test_batch_new(&b, spec, 12, 1, 20 + (uint64_t)d);
        b.options.distribution = (brdffit_distribution)d;
        b.options.normalise = d % 2 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        b.options.relative_gap = gap[d % 3];
        test_against_fit_of(&b, 0.5);
        brdffit_test_batch_free(&b);
    }
}

/* Masking that depends on roughness, and Fresnel, with F0 from none of it to all: the same path. */
static void test_models(void **state)
{
    static const brdffit_masking masking[4] = {BRDFFIT_MASKING_SMITH, BRDFFIT_MASKING_SMITH_SEPARABLE,
                                               BRDFFIT_MASKING_NONE, BRDFFIT_MASKING_V_CAVITY};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_batch b;
    int d;

    (void)state;
    for (d = 0; d < 16; d++) {
        spec.distribution = d % 2 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        spec.layout = d % 3 ? BRDFFIT_TEST_GRID : BRDFFIT_TEST_RANDOM;
        brdffit_test_batch_new(&b, spec, 12, 1, 120 + (uint64_t)d);
        b.options.distribution = spec.distribution;
        b.options.masking = masking[d / 2 % 4];
        b.options.fresnel = d < 8 ? BRDFFIT_FRESNEL_NONE : BRDFFIT_FRESNEL_SCHLICK;
        b.options.diffuse = d % 5 ? BRDFFIT_DIFFUSE_LAMBERT : BRDFFIT_DIFFUSE_NONE;
        b.options.max_incidence = d < 8 ? 60.0 : 90.0;
        test_against_fit_of(&b, 0.5);
        brdffit_test_batch_free(&b);
    }
}

/* Metals: x is zero in truth, so that noise decides channel by channel whether it is zero in the fit. */
static void test_metals(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_batch b;
    size_t t, i, zero = 0;

    (void)state;
    brdffit_test_batch_new(&b, spec, 40, 1, 31);
    for (t = 0; t < b.count; t++) {
        struct brdffit_test_spec metal = spec;
        struct brdffit_test_data data;

        metal.seed = 100 + t;
        metal.lobes = 1;
        metal.diffuse = 0.0;
        metal.sigma[0] = 0.05 + 0.01 * (double)t;
        metal.noise = 0.02;
        brdffit_test_data_new(&metal, &data);
        memcpy(b.values + t * 84 * 3, data.values, 84 * 3 * sizeof(double));
        brdffit_test_data_free(&data);
    }
    test_against_fit_of(&b, 0.2);
    for (i = 0; i < b.count * 3; i++) {
        zero += b.results.x[i] == 0.0;
    }
    assert_in_range(zero, 20, 100); /* about half of 120: the test tests what it means to */
    brdffit_test_batch_free(&b);
}

static void test_two_lobes(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    check_against_fit(spec, 8, 2, 17);
}

/* One-lobe truth, with noise or without, and two-lobe truth, fitted with two lobes: the count of texels that one lobe suffices for, against two fits. */
static void test_one_lobe_enough(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_batch b;
    size_t t, enough = 0;

    (void)state;
    brdffit_test_batch_new(&b, spec, 8, 2, 41);
    for (t = 0; t < b.count; t++) {
        struct brdffit_test_spec texel = spec;
        struct brdffit_test_data data;

        texel.seed = 300 + t;
        texel.lobes = t < 6 ? 1 : 2;
        texel.sigma[0] = 0.15;
        texel.noise = t < 3 ? 0.0 : 0.01;
        brdffit_test_data_new(&texel, &data);
        memcpy(b.values + t * 84 * 3, data.values, 84 * 3 * sizeof(double));
        brdffit_test_data_free(&data);
    }
    b.options.relative_gap = 0.02; /* what noise alone lets a second lobe gain is about 1 % */
    brdffit_test_batch_fit(&b);
    for (t = 0; t < b.count; t++) {
        brdffit_samples samples = brdffit_test_batch_samples(&b, t);
        brdffit_options options = b.options;
        struct brdffit_test_fit fit;

        options.lobes = 1;
        options.relative_gap = 1e-6;
        brdffit_test_fit(&samples, &options, &fit);
        enough += fit.result.e2 <= 1.02 * b.results.lower_bound[t] ||
                  fit.result.e2 <= b.results.lower_bound[t] + 1e-12 * b.results.sum_of_squares[t];
        brdffit_test_fit_free(&fit);
    }
    assert_true(enough >= 3 && enough <= 6);
    assert_int_equal(b.stats.one_lobe_enough, enough);
    brdffit_test_batch_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_lobe),  cmocka_unit_test(test_options),         cmocka_unit_test(test_metals),
        cmocka_unit_test(test_two_lobes), cmocka_unit_test(test_one_lobe_enough), cmocka_unit_test(test_models),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
