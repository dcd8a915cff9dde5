/*
 * Engine socp, whole fits: the same optimum as engine moment, with and without its shortcuts, and ECOS fed the worst.
 * Every fit is judged by brdffit_verify(). SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

static brdffit_options options_of(int lobes, double gap)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.engine = BRDFFIT_ENGINE_SOCP;
    options.relative_gap = gap;
    options.box_budget = 30000;
    return options;
}

#ifndef BRDFFIT_NO_ECOS

static brdffit_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    brdffit_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result; /* its arrays are gone after the next line */
    brdffit_test_fit_free(&fit);
    return result;
}

/* Boxes are counted once each: sent to ECOS, or decided without it. */
static void check_counts(const brdffit_result *result, const brdffit_options *options)
{
    assert_int_equal(result->nodes, result->boxes);
    assert_int_equal(result->socp_solved + result->socp_decided, result->boxes);
    assert_true(result->socp_refused <= result->socp_solved);
    assert_true(!options->socp_every_box || result->socp_decided == 0);
}

/* Fit with each engine, engine socp also with every box sent to ECOS. Returns how many of the latter closed. */
static int compare(const brdffit_samples *samples, const brdffit_options *asked)
{
    brdffit_options options = *asked;
    brdffit_result moment, socp;
    int closed = 0;

    options.engine = BRDFFIT_ENGINE_MOMENT;
    moment = fit_and_free(samples, &options);
    assert_int_equal(moment.socp_solved + moment.socp_refused + moment.socp_decided, 0);
    options.engine = BRDFFIT_ENGINE_SOCP;
    for (options.socp_every_box = 0; options.socp_every_box < 2; options.socp_every_box++) {
        double floor = 1e-20 * moment.sum_of_squares;

        socp = fit_and_free(samples, &options);
        check_counts(&socp, &options);
        /* Each proof holds against the other's optimum, closed or not. */
        assert_true(socp.lower_bound <= moment.e2 + floor);
        assert_true(moment.lower_bound <= socp.e2 + floor);
        print_message("%d %d e2 %g %g lb %g %g boxes %zu %zu stop %d %d refused %zu\n", moment.certified, socp.certified, moment.e2, socp.e2, moment.lower_bound, socp.lower_bound, moment.boxes, socp.boxes, moment.stop, socp.stop, socp.socp_refused);
        if (moment.certified && socp.certified) {
            assert_true(fabs(moment.e2 - socp.e2) <= 1e-6 * moment.e2 + floor);
            closed++;
        }
    }
    return closed;
}

static void test_same_optimum_one_lobe(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < 28; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(1, 1e-6);
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
    int i, closed = 0;

    (void)state;
    for (i = 0; i < 6; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(2, 0.05);
        struct brdffit_test_data data;

        spec.seed = 200 + (uint64_t)i;
        spec.distribution = i % 2 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        spec.channels = 1 + (size_t)i % 3;
        spec.noise = 0.05;
        options.distribution = spec.distribution;
        brdffit_test_data_new(&spec, &data);
        closed += compare(&data.samples, &options); print_message("two lobes %d closed %d\n", i, closed);
        brdffit_test_data_free(&data);
    }
    assert_true(closed >= 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_optimum_one_lobe),
        cmocka_unit_test(test_same_optimum_two_lobes),
    };

    return cmocka_run_group_tests_name("engine_socp", tests, NULL, NULL);
}
#else
int main(void) { return 0; }
#endif
