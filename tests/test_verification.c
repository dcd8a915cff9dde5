/*
 * brdffit_verify(): bounds of engine moment proven again, levels above the optimum never, and what it counts.
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"
#include "base/tolerance.h"

static brdffit_options options_of(int lobes, size_t budget)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.box_budget = budget;
    return options;
}

static size_t socp_size(const brdffit_samples *samples, const brdffit_options *options)
{
    brdffit_options o = *options;

    o.engine = BRDFFIT_ENGINE_SOCP;
    return brdffit_workspace_size(samples->count, samples->channels, &o);
}

/* Expect this failure, and an untouched answer. */
static void verify_fails(const brdffit_samples *samples, const brdffit_options *options, double level,
                         brdffit_status expected)
{
    size_t size = socp_size(samples, options);
    void *workspace = malloc(size + 1);
    const brdffit_verification *verification = NULL;
    brdffit_error error;

    assert_non_null(workspace);
    assert_int_equal(brdffit_verify(samples, options, level, workspace, size, &verification, &error), expected);
    assert_int_equal(error.status, expected);
    assert_null(verification);
    free(workspace);
}

#ifndef BRDFFIT_NO_ECOS

/* With what must hold whatever the answer is. */
static brdffit_verification verify(const brdffit_samples *samples, const brdffit_options *options, double level)
{
    size_t size = socp_size(samples, options);
    void *workspace = malloc(size);
    const brdffit_verification *made;
    brdffit_verification verification;
    brdffit_error error;

    assert_non_null(workspace);
    assert_int_equal(brdffit_verify(samples, options, level, workspace, size, &made, &error), BRDFFIT_OK);
    verification = *made;
    free(workspace);
    assert_true(verification.level == level);
    assert_true(verification.boxes <= options->box_budget);
    assert_int_equal(verification.solved + verification.decided, verification.boxes);
    assert_true(verification.refused <= verification.solved && verification.leaves <= verification.boxes);
    assert_true(!options->socp_every_box || verification.decided == 0);
    assert_true(verification.proven ? verification.unproven == 0.0
                                    : verification.unproven >= 0.0 && verification.unproven <= 1.0);
    if (verification.proven && options->lobes == 1 && options->sigma_min < options->sigma_max) {
        assert_int_equal(2 * verification.leaves, verification.boxes + FIRST_INTERVALS); /* a binary tree on each */
    }
    return verification;
}

static struct brdffit_test_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    struct brdffit_test_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result; /* its arrays are gone after the next line */
    brdffit_test_fit_free(&fit);
    return result;
}

static void test_bounds_are_proven_again_and_no_more(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < 14; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(1 + i % 2, 60000);
        double margin = options.lobes == 1 ? 1e-3 : 0.1;
        struct brdffit_test_data data;
        struct brdffit_test_result result;
        brdffit_verification verification;

        spec.seed = 300 + (uint64_t)i;
        spec.distribution = options.distribution = (brdffit_distribution)(i / 2 % BRDFFIT_DISTRIBUTION_COUNT);
        spec.channels = 1 + (size_t)i % 3;
        spec.noise = 0.03;
        spec.weighted = i % 5 == 1;
        options.normalise = i % 3 == 1 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        options.socp_every_box = i % 4 == 3;
        brdffit_test_data_new(&spec, &data);
        result = fit_and_free(&data.samples, &options);
        verification = verify(&data.samples, &options, result.lower_bound * (1.0 - margin));
        assert_int_equal(verification.proven, 1);
        assert_true(verification.leaves > 0 && verification.solved > 0);
        /* The optimum itself is there: a level above it cannot be proven. */
        options.box_budget = 3000;
        verification = verify(&data.samples, &options, result.e2 * (1.0 + 1e-9));
        assert_int_equal(verification.proven, 0);
        assert_int_equal(verification.stop, BRDFFIT_STOP_BUDGET);
        assert_true(verification.unproven > 0.0 && verification.unproven < 1.0);
        brdffit_test_data_free(&data);
    }
}

/* Less budget leaves more; a range of one sigma is a point; a resolution stops. */
static void test_budgets_and_domains(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(1, 100000);
    struct brdffit_test_data data;
    struct brdffit_test_result result;
    brdffit_verification verification;
    double before = 1.0;
    size_t budget;
    int lobes;

    (void)state;
    spec.noise = 0.03;
    brdffit_test_data_new(&spec, &data);
    result = fit_and_free(&data.samples, &options);
    for (budget = 1; budget < 1000; budget *= 4) {
        options.box_budget = budget;
        verification = verify(&data.samples, &options, result.lower_bound * (1.0 - 1e-6));
        assert_int_equal(verification.proven, 0);
        assert_true(verification.unproven <= before && verification.unproven > 0.0);
        before = verification.unproven;
    }
    assert_true(before < 0.5);
    options.box_budget = 100000;
    options.sigma_resolution = 0.1;
    verification = verify(&data.samples, &options, result.lower_bound * (1.0 - 1e-3));
    assert_int_equal(verification.proven, 0);
    assert_int_equal(verification.stop, BRDFFIT_STOP_RESOLUTION);
    options.sigma_resolution = 0.0;
    options.sigma_min = options.sigma_max = 0.2;
    for (lobes = 1; lobes <= 2; lobes++) {
        options.lobes = lobes;
        result = fit_and_free(&data.samples, &options);
        verification = verify(&data.samples, &options, result.e2 * (1.0 - 1e-6));
        assert_int_equal(verification.proven, 1);
        assert_int_equal(verification.leaves, 1);
        verification = verify(&data.samples, &options, result.e2 * (1.0 + 1e-6));
        assert_int_equal(verification.proven, 0);
        assert_true(verification.unproven == 1.0);
    }
    brdffit_test_data_free(&data);
}

/* Found by the campaign: with weights of 1e107 the least level underflows in internal units, and 0 proves itself. */
static void test_level_that_underflows(void **state)
{
    const double one[1] = {1.0}, difference[1] = {0.42}, zero[1] = {0.0}, weight[1] = {6e107}, value[1] = {2.9};
    brdffit_options options = options_of(1, 1000);
    brdffit_samples samples;

    (void)state;
    brdffit_samples_init(&samples);
    samples.form = BRDFFIT_FORM_ANGLES;
    samples.count = samples.channels = 1;
    samples.cos_light = samples.cos_view = one;
    samples.cos_difference = difference;
    samples.tan2_half = zero;
    samples.weights = weight;
    samples.values = value;
    options.normalise = BRDFFIT_NORMALISE_NONE;
    options.max_incidence = 90.0;
    assert_true(fit_and_free(&samples, &options).e2 <= 1e-20 * 6e107);
    assert_int_equal(verify(&samples, &options, DBL_MIN).proven, 0);
}

static int stop_at_once(void *user, const brdffit_progress *progress)
{
    double *seen = user;

    *seen = progress->phase == BRDFFIT_PHASE_SEARCH ? progress->e2 : *seen;
    return progress->phase == BRDFFIT_PHASE_SEARCH;
}

static void test_cancelled(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(2, 100000);
    struct brdffit_test_data data;
    struct brdffit_test_result result;
    brdffit_verification verification;
    double seen = 0.0, level;

    (void)state;
    spec.noise = 0.03;
    brdffit_test_data_new(&spec, &data);
    result = fit_and_free(&data.samples, &options);
    level = result.lower_bound * 0.99;
    options.progress = stop_at_once;
    options.progress_user = &seen;
    verification = verify(&data.samples, &options, level);
    assert_int_equal(verification.proven, 0);
    assert_int_equal(verification.stop, BRDFFIT_STOP_CANCELLED);
    assert_true(verification.boxes >= 256 && verification.boxes <= 258); /* a split that was begun is finished */
    assert_true(fabs(seen - level) <= 1e-12 * level);
    brdffit_test_data_free(&data);
}

#else

static void test_unsupported(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(2, 1000);
    struct brdffit_test_data data;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    verify_fails(&data.samples, &options, 0.1, BRDFFIT_ERR_UNSUPPORTED);
    brdffit_test_data_free(&data);
}

#endif

static void test_bad_calls(void **state)
{
    static const double level[] = {0.0, -1.0, INFINITY, -INFINITY, NAN};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options = options_of(1, 1000);
    struct brdffit_test_data data;
    const brdffit_verification *verification;
    unsigned char little[64];
    size_t i;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < sizeof level / sizeof *level; i++) {
        verify_fails(&data.samples, &options, level[i], BRDFFIT_ERR_VALUE);
    }
    assert_int_equal(brdffit_verify(&data.samples, &options, 0.1, little, sizeof little, &verification, NULL),
                     BRDFFIT_ERR_WORKSPACE);
    assert_int_equal(brdffit_verify(&data.samples, &options, 0.1, NULL, 0, &verification, NULL), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_verify(&data.samples, &options, 0.1, little, sizeof little, NULL, NULL),
                     BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_verify(NULL, &options, 0.1, little, sizeof little, &verification, NULL),
                     BRDFFIT_ERR_ARGUMENT);
    options.norm = BRDFFIT_NORM_L1;
    verify_fails(&data.samples, &options, 0.1, BRDFFIT_ERR_UNSUPPORTED);
    options.norm = BRDFFIT_NORM_L2;
    options.lobes = BRDFFIT_MAX_LOBES + 1;
    verify_fails(&data.samples, &options, 0.1, BRDFFIT_ERR_OPTION);
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#ifndef BRDFFIT_NO_ECOS
        cmocka_unit_test(test_bounds_are_proven_again_and_no_more),
        cmocka_unit_test(test_budgets_and_domains),
        cmocka_unit_test(test_level_that_underflows),
        cmocka_unit_test(test_cancelled),
#else
        cmocka_unit_test(test_unsupported),
#endif
        cmocka_unit_test(test_bad_calls),
    };

    return cmocka_run_group_tests_name("verification", tests, NULL, NULL);
}
