/*
 * Data that the model reproduces exactly: roughness to 1e-9, RMS at rounding level, whatever the scales; truths on
 * and beyond the ends of the range. Every fit is judged by brdffit_test_verify(). SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "support.h"

/* Each test runs with one and two lobes and both distributions. */
#define FOR_EACH_MODEL(options)                                                                                        \
    for (brdffit_options_init(&(options)); (options).lobes <= 2; (options).lobes++)                                    \
        for ((options).distribution = BRDFFIT_BECKMANN; (options).distribution <= BRDFFIT_GGX;                         \
             (options).distribution = (brdffit_distribution)((options).distribution + 1))

static struct brdffit_test_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    struct brdffit_test_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result; /* its arrays are gone after the next line */
    brdffit_test_fit_free(&fit);
    return result;
}

#define EXACT_COUNT 120

/* c over ten decades, so that every sigma from 1e-3 to 5 has samples on its slope. */
struct exact {
    double a[EXACT_COUNT], b[EXACT_COUNT], c[EXACT_COUNT], values[3 * EXACT_COUNT];
};

static brdffit_samples exact_samples(struct exact *e, int ggx, const double *sigma, int lobes)
{
    size_t i, k;
    int p;

    for (i = 0; i < EXACT_COUNT; i++) {
        e->a[i] = 0.1 + 0.2 * (double)(i % 5) / 4.0;
        e->b[i] = 0.2 + 0.3 * (double)(i % 7) / 6.0;
        e->c[i] = i == 0 ? 0.0 : pow(10.0, -8.0 + 10.0 * (double)i / EXACT_COUNT);
        for (k = 0; k < 3; k++) {
            long double value = e->a[i] * (1.0L + (long double)k);

            for (p = 0; p < lobes; p++) {
                long double s = 1.0L / ((long double)sigma[p] * sigma[p]), t = 1.0L + e->c[i] * s;

                /* y s = 1 ... 3: peaks of the diffuse term's size */
                value += e->b[i] * (1.0L + (long double)((k + (size_t)p) % 3)) *
                         (ggx ? 1.0L / (t * t) : expl(-e->c[i] * s));
            }
            e->values[3 * i + k] = (double)value;
        }
    }
    return brdffit_test_coefficients(EXACT_COUNT, 3, e->a, e->b, e->c, e->values);
}

static const double exact_sigma[] = {1e-3, 0.01, 0.05, 0.2, 0.7, 2.0, 5.0};
#define EXACT_SIGMAS (sizeof exact_sigma / sizeof exact_sigma[0])

static void test_exact_one_lobe(void **state)
{
    struct exact e;
    brdffit_options options;
    size_t j;

    (void)state;
    for (j = 0; j < EXACT_SIGMAS; j++) {
        FOR_EACH_MODEL(options)
        {
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, exact_sigma + j, 1);
            struct brdffit_test_result result = fit_and_free(&samples, &options);

            assert_int_equal(result.certified, 1);
            assert_true(result.rms_total <= 1e-15);
            if (options.lobes == 1) { /* with two, the second is free */
                assert_true(fabs(result.model.sigma[0] / exact_sigma[j] - 1.0) <= 1e-9);
            }
        }
    }
}

static void test_exact_two_lobes(void **state)
{
    struct exact e;
    brdffit_options options;
    size_t i, j;

    (void)state;
    for (i = 0; i < EXACT_SIGMAS; i++) {
        for (j = i + 1; j < EXACT_SIGMAS; j++) {
            double sigma[2] = {exact_sigma[i], exact_sigma[j]};

            FOR_EACH_MODEL(options)
            {
                brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, 2);
                struct brdffit_test_result result;

                if (options.lobes == 1) {
                    continue;
                }
                result = fit_and_free(&samples, &options);
                assert_int_equal(result.certified, 1);
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / sigma[0] - 1.0) <= 1e-9);
                assert_true(fabs(result.model.sigma[1] / sigma[1] - 1.0) <= 1e-9);
            }
        }
    }
}

/* The same from directions: the coefficients are rounded once more there. */
static void test_exact_directions(void **state)
{
    static const double sigma[] = {0.02, 0.1, 0.4, 1.0};
    brdffit_options options;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof sigma / sizeof sigma[0]; i++) {
        FOR_EACH_MODEL(options)
        {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;
            struct brdffit_test_result result;
            int normals = i % 2 == 1;

            spec.layout = normals ? BRDFFIT_TEST_RANDOM : BRDFFIT_TEST_IN_PLANE;
            spec.count = 400;
            spec.normals = normals;
            spec.quantity = BRDFFIT_QUANTITY_BRDF;
            spec.distribution = options.distribution;
            spec.lobes = options.lobes;
            spec.sigma[0] = sigma[i];
            spec.sigma[1] = 3.0 * sigma[i];
            spec.specular[0] = 0.3 * sigma[i] * sigma[i];
            spec.specular[1] = 3.0 * sigma[i] * sigma[i];
            brdffit_test_data_new(&spec, &data);
            options.max_incidence = 90.0;
            result = fit_and_free(&data.samples, &options);
            assert_int_equal(result.certified, 1);
            assert_true(result.rms_total <= 1e-14);
            assert_true(fabs(result.model.sigma[0] / spec.sigma[0] - 1.0) <= 1e-9);
            assert_true(options.lobes == 1 || fabs(result.model.sigma[1] / spec.sigma[1] - 1.0) <= 1e-9);
            brdffit_test_data_free(&data);
        }
    }
}

/* The truth on, and beyond, the ends of the range. */
static void test_sigma_at_the_ends(void **state)
{
    struct exact e;
    brdffit_options options;
    int which;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        int ggx = options.distribution == BRDFFIT_GGX;

        for (which = 0; which < 4; which++) {
            double truth[2] = {which == 0 ? 0.05 : which == 1 ? 0.5 : which == 2 ? 0.03 : 0.8, 0.5};
            brdffit_samples samples;
            struct brdffit_test_result result;

            if (options.lobes == 2) {
                truth[0] = which < 2 ? 0.05 : 0.03;
            }
            samples = exact_samples(&e, ggx, truth, options.lobes);
            options.sigma_min = 0.05;
            options.sigma_max = 0.5;
            result = fit_and_free(&samples, &options);
            assert_int_equal(result.certified, 1);
            if (which < 2) {
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / truth[0] - 1.0) <= 1e-9);
            } else {
                double end = options.lobes == 2 || which == 2 ? options.sigma_min : options.sigma_max;

                assert_true(result.model.sigma[0] == end);
                assert_true(result.lobe[0].warnings & BRDFFIT_WARN_AT_LIMIT);
            }
        }
        options.sigma_min = 1e-12;
    }
}

/* Any limit comes back as the very number that was asked for, whatever logarithms were taken in between. */
static void test_any_limit(void **state)
{
    struct brdffit_test_random random = {3};
    struct exact e;
    brdffit_options options;
    int round;

    (void)state;
    for (round = 0; round < FEWER(40, 8); round++) {
        FOR_EACH_MODEL(options)
        {
            double limit = brdffit_test_log_uniform(&random, 0.01, 0.1), truth[2] = {0.5 * limit, 20.0 * limit};
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, truth, 2);
            struct brdffit_test_result result;

            options.sigma_min = limit;
            options.sigma_max = 10.0 * limit;
            result = fit_and_free(&samples, &options);
            assert_true(options.lobes == 1 ||
                        (result.model.sigma[0] == options.sigma_min && result.model.sigma[1] == options.sigma_max));
            options.sigma_min = 1e-12;
        }
    }
}

/* A domain of one point. */
static void test_sigma_fixed(void **state)
{
    struct exact e;
    brdffit_options options;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        static const double truth[1] = {0.2};
        brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, truth, 1);
        struct brdffit_test_result result;

        options.sigma_min = options.sigma_max = 0.3;
        result = fit_and_free(&samples, &options);
        assert_true(result.model.sigma[0] == 0.3);
        assert_true(result.gap <= 1e-3 * result.lower_bound);
        options.sigma_max = 6.0;
        options.sigma_min = 1e-12;
    }
}

static void test_coefficients_scaled(void **state)
{
    static const double scale[] = {1e100, 1e-100, 1.0};
    struct exact e;
    brdffit_options options;
    size_t i, ja, jb;

    (void)state;
    for (ja = 0; ja < 3; ja++) {
        for (jb = 0; jb < 3; jb++) {
            FOR_EACH_MODEL(options)
            {
                static const double sigma[2] = {0.1, 0.5};
                brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);
                struct brdffit_test_result result;

                for (i = 0; i < EXACT_COUNT; i++) {
                    e.a[i] *= scale[ja];
                    e.b[i] *= scale[jb];
                }
                result = fit_and_free(&samples, &options);
                assert_int_equal(result.certified, 1);
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / sigma[0] - 1.0) <= 1e-9);
            }
        }
    }
}

/* Columns of zeros: no diffuse term, no specular term, neither. */
static void test_zero_columns(void **state)
{
    static const double sigma[2] = {0.1, 0.5};
    brdffit_options options;
    int which;

    (void)state;
    for (which = 1; which < 4; which++) {
        FOR_EACH_MODEL(options)
        {
            struct exact e;
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);
            struct brdffit_test_result result;

            if (which & 1) {
                memset(e.a, 0, sizeof e.a);
            }
            if (which & 2) {
                memset(e.b, 0, sizeof e.b);
            }
            result = fit_and_free(&samples, &options);
            assert_int_equal(result.certified, 1);
            assert_true(which != 3 || fabs(result.e2 - result.sum_of_squares) <= 1e-14 * result.sum_of_squares);
        }
    }
}

/* Every sample's c is far from 0: a narrow lobe has no finite y, and no crash either. */
static void test_no_sample_near_the_mirror(void **state)
{
    static const double c_min[] = {0.01, 1.0, 100.0};
    struct exact e;
    brdffit_options options;
    size_t i, j;

    (void)state;
    for (j = 0; j < 3; j++) {
        FOR_EACH_MODEL(options)
        {
            static const double sigma[2] = {1.0, 4.0};
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);

            for (i = 0; i < EXACT_COUNT; i++) {
                e.c[i] += c_min[j];
            }
            assert_int_equal(fit_and_free(&samples, &options).certified, 1);
        }
    }
}

/* ---- Found by random problems --------------------------------------------------------------------------- */

/*
 * GGX far from the mirror: (1 + c s)^-2 (1 + c_min s)^2 goes to its limit like 1 / (c_min s), not like (c s)^-2, so
 * the roughness goes on mattering after c s is large. The lower bound has to hold down to sigma_min.
 */
static void test_ggx_tail(void **state)
{
    static const double a[] = {0.0, 0.0}, b[] = {1.4, 1.35}, c[] = {0.58, 1.67}, values[] = {1.0, 0.05};
    brdffit_samples samples = brdffit_test_coefficients(2, 1, a, b, c, values);
    brdffit_options options;

    (void)state;
    brdffit_options_init(&options);
    options.distribution = BRDFFIT_GGX;
    for (options.lobes = 1; options.lobes <= 2; options.lobes++) {
        assert_int_equal(fit_and_free(&samples, &options).certified, 1);
    }
}

/* Nearly dependent columns and exact data: supports whose squares differ by rounding differ in the residual. */
static void test_support_of_exact_data(void **state)
{
    struct brdffit_test_random random = {9};
    brdffit_options options;
    int round;

    (void)state;
    for (round = 0; round < 60; round++) {
        FOR_EACH_MODEL(options)
        {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;

            spec.seed = (uint64_t)round;
            spec.form = BRDFFIT_FORM_COEFFICIENTS;
            spec.layout = BRDFFIT_TEST_RANDOM;
            spec.distribution = options.distribution;
            spec.count = 2 + brdffit_test_below(&random, 6);
            spec.channels = 1 + brdffit_test_below(&random, 2);
            spec.lobes = 1 + (int)brdffit_test_below(&random, 2);
            spec.sigma[0] = brdffit_test_log_uniform(&random, 0.1, 2.0);
            spec.sigma[1] = brdffit_test_log_uniform(&random, 0.1, 2.0);
            brdffit_test_data_new(&spec, &data);
            assert_int_equal(fit_and_free(&data.samples, &options).certified, 1);
            brdffit_test_data_free(&data);
        }
    }
}

/* Where the sharpest sample has a tiny b, y = (data / b) exp(c_min s) / s must still be a finite double. */
static void test_tiny_b(void **state)
{
    static const double tiny[] = {1e-20, 1e-40, 1e-60, 1e-100};
    struct exact e;
    brdffit_options options;
    size_t i, j;

    (void)state;
    for (j = 0; j < sizeof tiny / sizeof tiny[0]; j++) {
        FOR_EACH_MODEL(options)
        {
            static const double sigma[2] = {0.05, 0.2};
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);

            for (i = 0; i < EXACT_COUNT; i++) {
                e.b[i] *= tiny[j];
                e.c[i] = e.c[i] * 0.01 + 1.0;
                e.values[3 * i] = i < 3 ? 1.0 : 0.2;
            }
            options.box_budget = 3000;
            (void)fit_and_free(&samples, &options);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_one_lobe),
        cmocka_unit_test(test_exact_two_lobes),
        cmocka_unit_test(test_exact_directions),
        cmocka_unit_test(test_sigma_at_the_ends),
        cmocka_unit_test(test_any_limit),
        cmocka_unit_test(test_sigma_fixed),
        cmocka_unit_test(test_coefficients_scaled),
        cmocka_unit_test(test_zero_columns),
        cmocka_unit_test(test_no_sample_near_the_mirror),
        cmocka_unit_test(test_ggx_tail),
        cmocka_unit_test(test_support_of_exact_data),
        cmocka_unit_test(test_tiny_b),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
