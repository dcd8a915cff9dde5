/*
 * Channels that bounds do without: zero ones, and ones that repeat another. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "support.h"

/* `count` samples of 5 channels from the 2 of `from`: 0, none, 1, 0, 1. */
static double *spread(const brdffit_samples *from)
{
    static const int source[5] = {0, -1, 1, 0, 1};
    double *values = malloc(from->count * 5 * sizeof *values);
    size_t i, k;

    assert_non_null(values);
    for (i = 0; i < from->count; i++) {
        for (k = 0; k < 5; k++) {
            values[i * 5 + k] = source[k] < 0 ? 0.0 : from->values[i * 2 + (size_t)source[k]];
        }
    }
    return values;
}

static void compare(uint64_t seed, int lobes, double sign)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct brdffit_test_fit two, five;
    brdffit_samples samples;
    brdffit_options options;
    double *values;
    size_t i;

    spec.seed = seed;
    spec.channels = 2;
    spec.noise = 0.03;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < data.samples.count * 2; i += 7) {
        data.values[i] *= sign; /* with some negative values, too */
    }
    brdffit_options_init(&options);
    options.lobes = lobes;
    options.relative_gap = 1e-6;
    values = spread(&data.samples);
    samples = data.samples;
    samples.channels = 5;
    samples.values = values;
    brdffit_test_fit(&data.samples, &options, &two); /* both judged by verify.c */
    brdffit_test_fit(&samples, &options, &five);
    assert_int_equal(two.result.channels_zero + two.result.channels_identical, 0);
    assert_int_equal(five.result.channels_zero, 1);
    assert_int_equal(five.result.channels_identical, 2);
    /* Twice the objective: each bounds the other's optimum. */
    assert_true(five.result.e2 >= 2.0 * two.result.lower_bound * (1.0 - 1e-12));
    assert_true(2.0 * two.result.e2 >= five.result.lower_bound * (1.0 - 1e-12));
    assert_true(five.result.certified && two.result.certified);
    assert_true(five.result.model.x[0] == five.result.model.x[3]);
    assert_true(five.result.model.x[1] == 0.0 && five.result.rms[1] == 0.0);
    brdffit_test_fit_free(&two);
    brdffit_test_fit_free(&five);
    brdffit_test_data_free(&data);
    free(values);
}

static void test_repeated_and_zero_channels(void **state)
{
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 6; seed++) {
        compare(seed, 1 + (int)(seed % 2), seed % 3 ? 1.0 : -1.0);
    }
}

/* Nothing but black: the zero model, proven, in every channel. */
static void test_all_zero(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct brdffit_test_fit fit;
    brdffit_options options;
    size_t i;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < data.samples.count * data.samples.channels; i++) {
        data.values[i] = 0.0;
    }
    brdffit_options_init(&options);
    options.lobes = 2;
    brdffit_test_fit(&data.samples, &options, &fit);
    assert_int_equal(fit.result.channels_zero, 3);
    assert_true(fit.result.e2 == 0.0 && fit.result.certified);
    brdffit_test_fit_free(&fit);
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repeated_and_zero_channels),
        cmocka_unit_test(test_all_zero),
    };

    return cmocka_run_group_tests_name("channels", tests, NULL, NULL);
}
