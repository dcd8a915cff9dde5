/*
 * Engine socp, whole fits: the same optimum as engine moment, with and without its shortcuts, and ECOS fed the worst.
 * Every fit is judged by brdffit_test_verify(). SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "support.h"

static brdffit_options options_of(int lobes, double gap)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.engine = BRDFFIT_ENGINE_SOCP;
    options.relative_gap = gap;
    options.box_budget = 60000;
    return options;
}

#ifndef BRDFFIT_NO_ECOS

static struct brdffit_test_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    struct brdffit_test_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result; /* its arrays are gone after the next line */
    brdffit_test_fit_free(&fit);
    return result;
}

/* Boxes are counted once each: sent to ECOS, or decided without it. */
static void check_counts(const struct brdffit_test_result *result, const brdffit_options *options)
{
    assert_int_equal(result->nodes, result->boxes);
    assert_int_equal(result->programs_solved + result->programs_decided, result->boxes);
    assert_true(result->programs_refused <= result->programs_solved);
    assert_true(!options->socp_every_box || result->programs_decided == 0);
}

/*
 * Fit with each engine, engine socp also with every box sent to ECOS. Returns how many of the latter closed. Where
 * both close they are within the gap of each other; with one lobe both descend into the same valley.
 */
static int compare(const brdffit_samples *samples, const brdffit_options *asked)
{
    double agree = asked->lobes == 1 ? 1e-6 : asked->relative_gap;
    brdffit_options options = *asked;
    struct brdffit_test_result moment, socp;
    int closed = 0;

    options.engine = BRDFFIT_ENGINE_MOMENT;
    options.relative_gap = 1e-6;
    moment = fit_and_free(samples, &options);
    assert_int_equal(moment.programs_solved + moment.programs_refused + moment.programs_decided, 0);
    options.engine = BRDFFIT_ENGINE_SOCP;
    options.relative_gap = asked->relative_gap;
    for (options.socp_every_box = 0; options.socp_every_box < 2; options.socp_every_box++) {
        double floor = 1e-20 * moment.sum_of_squares;

        socp = fit_and_free(samples, &options);
        check_counts(&socp, &options);
        /* Each proof holds against the other's optimum, closed or not. */
        assert_true(socp.lower_bound <= moment.e2 + floor);
        assert_true(moment.lower_bound <= socp.e2 + floor);
        if (moment.certified && socp.certified) {
            assert_true(fabs(moment.e2 - socp.e2) <= agree * moment.e2 + floor);
            closed++;
        }
    }
    return closed;
}

static void test_same_optimum_one_lobe(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < FEWER(28, 7); i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(1, 1e-4);
        struct brdffit_test_data data;

        spec.seed = 100 + (uint64_t)i;
        spec.distribution = (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        spec.layout = i % 3 ? BRDFFIT_TEST_RANDOM : BRDFFIT_TEST_GRID;
        spec.channels = 1 + (size_t)i % 4;
        spec.lobes = 1 + i % 2;
        spec.noise = i % 5 ? 0.02 : 0.0;
        spec.weighted = i % 7 == 3;
        options.distribution = spec.distribution;
        options.normalise = i % 4 == 1 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        brdffit_test_data_new(&spec, &data);
        assert_int_equal(compare(&data.samples, &options), 2);
        brdffit_test_data_free(&data);
    }
}

/* First-order bounds: a gap that they can close in reasonable time where a second lobe is in the data. */
static void test_same_optimum_two_lobes(void **state)
{
    int i, closed = 0, count = FEWER(6, 2);

    (void)state;
    for (i = 0; i < count; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(2, 0.05);
        struct brdffit_test_data data;

        spec.seed = 200 + (uint64_t)i;
        spec.distribution = i % 2 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        spec.channels = 1 + (size_t)i % 3;
        spec.noise = 0.05;
        options.distribution = spec.distribution;
        brdffit_test_data_new(&spec, &data);
        closed += compare(&data.samples, &options);
        brdffit_test_data_free(&data);
    }
    assert_int_equal(closed, 2 * count);
}

/* Judged, counted, and open only where the budget says so. */
static struct brdffit_test_result survives(const brdffit_samples *samples, const brdffit_options *asked)
{
    brdffit_options options = *asked;
    struct brdffit_test_result result;

    for (options.socp_every_box = 0; options.socp_every_box < 2; options.socp_every_box++) {
        result = fit_and_free(samples, &options);
        check_counts(&result, &options);
        assert_true(result.certified || result.stop == BRDFFIT_STOP_BUDGET);
    }
    return result;
}

/* Sigma from 1e-12, and columns (a, b), data and weights scaled: the same answer whatever the scale. */
static void test_columns_of_any_scale(void **state)
{
    static const double scale[][3] = {{1.0, 1.0, 1.0},     {1e12, 1e-12, 1.0},   {1e-12, 1e12, 1.0},
                                      {1e12, 1e12, 1e-12}, {1e-12, 1e-12, 1e12}, {1.0, 1e-12, 1e-12}};
    double e2[2] = {0.0, 0.0};
    size_t i, j;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        for (i = 0; i < sizeof scale / sizeof *scale; i++) {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            brdffit_options options = options_of(lobes, FEWER(0.1, 0.3));
            struct brdffit_test_data data;
            struct brdffit_test_result result;

            spec.form = BRDFFIT_FORM_COEFFICIENTS;
            spec.noise = 0.05;
            options.box_budget = 40000;
            brdffit_test_data_new(&spec, &data);
            for (j = 0; j < spec.count; j++) {
                ((double *)(uintptr_t)data.samples.a)[j] *= scale[i][0];
                ((double *)(uintptr_t)data.samples.b)[j] *= scale[i][1];
            }
            for (j = 0; j < spec.count * spec.channels; j++) {
                data.values[j] *= scale[i][2];
            }
            result = survives(&data.samples, &options);
            assert_int_equal(result.certified, 1);
            e2[lobes - 1] = i ? e2[lobes - 1] : result.e2;
            assert_true(fabs(result.e2 - e2[lobes - 1]) <= 1e-6 * result.e2);
            brdffit_test_data_free(&data);
        }
    }
}

/* Exact data close at the absolute gap; all-zero data at once. */
static void test_zero_residual_and_zero_data(void **state)
{
    int lobes, kind;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        for (kind = 0; kind < 3; kind++) {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            brdffit_options options = options_of(lobes, 1e-3);
            struct brdffit_test_data data;
            struct brdffit_test_result result;

            spec.lobes = lobes;
            options.distribution = spec.distribution = kind == 1 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
            options.box_budget = 2000;
            brdffit_test_data_new(&spec, &data);
            if (kind == 2) {
                memset(data.values, 0, spec.count * spec.channels * sizeof *data.values);
            }
            result = survives(&data.samples, &options);
            assert_int_equal(result.certified, 1);
            assert_true(result.e2 <= 1e-20 * result.sum_of_squares);
            brdffit_test_data_free(&data);
        }
    }
}

/* A gap that asks for more than first-order bounds in doubles can prove: it ends, honestly. */
static void test_tiny_gaps_end(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(1, 1e-15);
    struct brdffit_test_data data;

    (void)state;
    spec.noise = 1e-7;
    options.absolute_gap = 0.0;
    options.box_budget = 10000;
    brdffit_test_data_new(&spec, &data);
    survives(&data.samples, &options);
    brdffit_test_data_free(&data);
}

static void test_any_number_of_channels_and_samples(void **state)
{
    static const size_t count[] = {1, 2, 3, 5, 84, 100000}, channels[] = {1, 31};
    size_t i, k;
    int lobes;

    (void)state;
    for (i = 0; i < sizeof count / sizeof *count; i++) {
        for (k = 0; k < 2; k++) {
            for (lobes = 1; lobes <= 2; lobes++) {
                struct brdffit_test_spec spec = brdffit_test_spec_default();
                brdffit_options options = options_of(lobes, 0.1);
                struct brdffit_test_data data;
                struct brdffit_test_result result;

                if (count[i] > 1000 && k > 0) {
                    continue; /* 3 million values to draw and to judge show nothing more */
                }
                spec.count = count[i];
                spec.channels = channels[k];
                spec.noise = 0.02;
                options.box_budget = k ? FEWER(300, 30) : FEWER(3000, 100);
                brdffit_test_data_new(&spec, &data);
                result = survives(&data.samples, &options);
                assert_int_equal(result.samples_used, spec.count);
                assert_true(result.distinct_c <= 84);
                brdffit_test_data_free(&data);
            }
        }
    }
}

/* Two runs are the same run, and a solver is made and released each time. */
static void test_reproducible(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(2, 0.1);
    struct brdffit_test_data data;
    struct brdffit_test_result first, second;

    (void)state;
    spec.noise = 0.05;
    brdffit_test_data_new(&spec, &data);
    first = fit_and_free(&data.samples, &options);
    second = fit_and_free(&data.samples, &options);
    assert_memory_equal(&first.e2, &second.e2, sizeof first.e2);
    assert_memory_equal(&first.lower_bound, &second.lower_bound, sizeof first.lower_bound);
    assert_int_equal(first.boxes, second.boxes);
    assert_int_equal(first.programs_solved, second.programs_solved);
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_optimum_one_lobe), cmocka_unit_test(test_same_optimum_two_lobes),
        cmocka_unit_test(test_columns_of_any_scale),  cmocka_unit_test(test_zero_residual_and_zero_data),
        cmocka_unit_test(test_tiny_gaps_end),         cmocka_unit_test(test_any_number_of_channels_and_samples),
        cmocka_unit_test(test_reproducible),
    };

    return cmocka_run_group_tests_name("engine_socp", tests, NULL, NULL);
}

#else

/* A build without ECOS says so, and leaves the result alone. */
static void test_unsupported(void **state)
{
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(lobes, 1e-3);
        struct brdffit_test_data data;

        brdffit_test_data_new(&spec, &data);
        brdffit_test_fit_fails(&data.samples, &options, BRDFFIT_ERR_UNSUPPORTED);
        brdffit_test_data_free(&data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unsupported),
    };

    return cmocka_run_group_tests_name("engine_socp without ECOS", tests, NULL, NULL);
}

#endif
