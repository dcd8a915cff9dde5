/*
 * Thousands of channels: a bound is a difference of two sums over them, each with roundings of its own that may all be on
 * one side. SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "support.h"

#define SAMPLES 2

#if defined(__SANITIZE_ADDRESS__)
#define PROBLEMS 6
#else
#define PROBLEMS 60
#endif

/* E^2 of one lobe at this roughness and nothing else, summed over the channels. */
static long double truth(const double *b, const double *c, double sigma, const double *values, size_t channels)
{
    long double s = 1.0L / ((long double)sigma * sigma), g[SAMPLES], gg = 0.0L, sum = 0.0L;
    size_t i, k;

    for (i = 0; i < SAMPLES; i++) {
        g[i] = b[i] * expl(-c[i] * s);
        gg += g[i] * g[i];
    }
    for (k = 0; k < channels; k++) {
        long double cross = g[1] * values[k] - g[0] * values[channels + k];

        sum += cross * cross / gg;
    }
    return sum;
}

/* Channels all but equal, so that each addition rounds the same way. */
static void attack(double first, double second, size_t channels)
{
    static const double a[SAMPLES] = {0.0, 0.0}, b[SAMPLES] = {0.7, 0.3}, c[SAMPLES] = {0.01, 0.5};
    double *values = malloc(SAMPLES * channels * sizeof *values);
    brdffit_samples samples;
    const brdffit_result *r;
    brdffit_options o;
    size_t k;

    assert_non_null(values);
    for (k = 0; k < channels; k++) {
        values[k] = first * (1.0 + 1e-15 * (double)(k % 97));
        values[channels + k] = second * (1.0 + 1e-15 * (double)(k % 89));
    }
    samples = brdffit_test_coefficients(SAMPLES, channels, a, b, c, values);
    brdffit_options_init(&o);
    o.sigma_min = o.sigma_max = 0.6;
    o.normalise = BRDFFIT_NORMALISE_NONE;
    o.relative_gap = 1e-12;
    o.absolute_gap = 0.0;
    o.box_budget = 10;
    assert_int_equal(brdffit_fit_new(&samples, &o, &r, NULL), BRDFFIT_OK);
    {
        long double least = truth(b, c, 0.6, values, channels);

        if (!(r->lower_bound <= least)) {
            fail_msg("%g, %g, %zu channels: bound %.17g above %.17Lg by %.3Lg of the data", first, second, channels,
                     r->lower_bound, least, (r->lower_bound - least) / r->sum_of_squares);
        }
        if (!(fabsl(r->e2 - least) <= r->e2_error)) {
            fail_msg("%g, %g, %zu channels: e2 %.17g +- %g, not %.17Lg", first, second, channels, r->e2, r->e2_error,
                     least);
        }
        assert_true(r->lower_bound >= (1.0L - 1e-9L) * least);
    }
    brdffit_result_free(r);
    free(values);
}

static void test_biased_sums(void **state)
{
    struct brdffit_test_random random = {9};
    size_t i;

    (void)state;
    for (i = 0; i < PROBLEMS; i++) {
        attack(brdffit_test_uniform(&random, 0.3, 1.0), brdffit_test_uniform(&random, 0.3, 1.0), i % 3 ? 3000 : 40000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_biased_sums),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
