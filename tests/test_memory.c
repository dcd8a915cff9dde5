/*
 * Fits in so many bytes (brdffit_options.memory): certified in little, never a byte beyond, and valid in any.
 * SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

#define GUARD 64u

/* Workspace of the size that the library asks for, with bytes behind it that nobody may touch. */
struct held {
    unsigned char *block;
    size_t size;
};

static struct held hold(const brdffit_samples *samples, const brdffit_options *options)
{
    struct held h = {NULL, brdffit_workspace_size(samples->count, samples->channels, options)};

    assert_true(h.size > 0);
    h.block = malloc(h.size + GUARD);
    assert_non_null(h.block);
    memset(h.block, 0xa5, h.size + GUARD);
    return h;
}

static const brdffit_result *fit_in(struct held *h, const brdffit_samples *samples, const brdffit_options *options)
{
    const brdffit_result *result = NULL;
    brdffit_error error;
    size_t i;

    if (brdffit_fit(samples, options, h->block, h->size, &result, &error) != BRDFFIT_OK) {
        brdffit_test_print(samples, options);
        fail_msg("in %zu bytes: %s", h->size, error.message);
    }
    for (i = 0; i < GUARD; i++) {
        assert_int_equal(h->block[h->size + i], 0xa5);
    }
    return result;
}

static struct brdffit_test_spec noisy(uint64_t seed, int lobes)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    spec.seed = seed;
    spec.lobes = lobes;
    spec.noise = 0.01;
    return spec;
}

/* 84 samples, RGB, gap 1e-3: 32 KB for a lobe, 256 KB for two. */
static void check_certified(int lobes, size_t memory)
{
    brdffit_options options;
    uint64_t seed;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.memory = memory;
    for (seed = 1; seed <= 8; seed++) {
        struct brdffit_test_spec spec = noisy(seed, lobes);
        struct brdffit_test_data data;
        struct brdffit_test_fit fit;

        brdffit_test_data_new(&spec, &data);
        brdffit_test_fit(&data.samples, &options, &fit); /* judged */
        assert_true(fit.workspace_size <= memory);
        assert_true(fit.result.certified);
        brdffit_test_fit_free(&fit);
        brdffit_test_data_free(&data);
    }
}

static void test_certified_in_little(void **state)
{
    (void)state;
    check_certified(1, 32 << 10);
    check_certified(2, 256 << 10);
}

/* More than there is use for is what 0 gives, to the bit; too little is told, and the least still makes a valid fit. */
static void test_more_and_less(void **state)
{
    struct brdffit_test_spec spec = noisy(5, 2);
    struct brdffit_test_data data;
    brdffit_options options;
    const brdffit_result *plain, *result;
    struct brdffit_test_fit least;
    struct held h, g;
    brdffit_error error;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&options);
    options.lobes = 2;
    h = hold(&data.samples, &options);
    plain = fit_in(&h, &data.samples, &options);
    options.memory = (size_t)1 << 30;
    g = hold(&data.samples, &options);
    assert_int_equal(g.size, h.size);
    result = fit_in(&g, &data.samples, &options);
    assert_int_equal(result->boxes, plain->boxes);
    assert_memory_equal(result->model->sigma, plain->model->sigma, 2 * sizeof(double));
    assert_true(result->lower_bound == plain->lower_bound);
    free(g.block);
    options.memory = 1;
    g = hold(&data.samples, &options);
    assert_true(g.size > 1);
    assert_int_equal(brdffit_fit(&data.samples, &options, g.block, g.size - 1, &result, &error), BRDFFIT_ERR_WORKSPACE);
    free(g.block);
    brdffit_test_fit(&data.samples, &options, &least); /* judged */
    brdffit_test_fit_free(&least);
    free(h.block);
    brdffit_test_data_free(&data);
}

/* Any model in any memory: nothing is written beyond it, and bound and error do not contradict each other. */
static void test_any(void **state)
{
    struct brdffit_test_random random = {11};
    int i;

    (void)state;
    for (i = 0; i < 60; i++) {
        struct brdffit_test_spec spec = noisy(brdffit_test_bits(&random), 1 + (int)brdffit_test_below(&random, 2));
        struct brdffit_test_data data;
        const brdffit_result *result;
        brdffit_options options;
        struct held h;

        spec.count = 5 + brdffit_test_below(&random, 90);
        spec.channels = 1 + brdffit_test_below(&random, 4);
        spec.layout = (enum brdffit_test_layout)brdffit_test_below(&random, 3);
        spec.form = BRDFFIT_FORM_DIRECTIONS;
        brdffit_test_data_new(&spec, &data);
        brdffit_options_init(&options);
        options.lobes = 1 + (int)brdffit_test_below(&random, BRDFFIT_MAX_LOBES);
        options.distribution = brdffit_test_below(&random, 2) ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        options.masking = (brdffit_masking)brdffit_test_below(&random, BRDFFIT_MASKING_COUNT);
        options.fresnel = brdffit_test_below(&random, 3) ? BRDFFIT_FRESNEL_NONE : BRDFFIT_FRESNEL_SCHLICK;
        options.diffuse = options.lobes < 3 ? (brdffit_diffuse)brdffit_test_below(&random, BRDFFIT_DIFFUSE_COUNT)
                                            : BRDFFIT_DIFFUSE_LAMBERT;
        options.physical = options.masking == BRDFFIT_MASKING_V_CAVITY && brdffit_test_below(&random, 4) == 0;
        options.box_budget = 400;
        options.max_incidence = 90.0;
        options.memory = 1 + brdffit_test_below(&random, 400000);
        h = hold(&data.samples, &options);
        result = fit_in(&h, &data.samples, &options);
        assert_true(result->stop != BRDFFIT_STOP_CONTRADICTION);
        assert_true(result->lower_bound <= result->e2 + result->e2_error);
        free(h.block);
        brdffit_test_data_free(&data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_certified_in_little),
        cmocka_unit_test(test_more_and_less),
        cmocka_unit_test(test_any),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
