/*
 * Structures of other sizes than the library's: shorter ones get defaults, longer ones must not ask for what is unknown.
 * What a program of an older version meets in practice: check_abi.sh. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "brdffit_io.h"
#include "support.h"

/* A later version's structure: one field more. */
#define LATER(type)                                                                                                    \
    struct {                                                                                                           \
        type known;                                                                                                    \
        double unknown;                                                                                                \
    }

/* Sized calls, as the macros make them, with other sizes than those of the types. */
static void test_init_writes_the_callers_size(void **state)
{
    unsigned char room[sizeof(brdffit_options) + 64];
    size_t size, i, said;

    (void)state;
    for (size = sizeof size; size <= sizeof room - 8; size += 8) {
        memset(room, 0x5a, sizeof room);
        brdffit_options_init_sized((brdffit_options *)(void *)room, size);
        memcpy(&said, room, sizeof said);
        assert_int_equal(said, size);
        for (i = size; i < sizeof room; i++) {
            assert_int_equal(room[i], 0x5a);
        }
        for (i = sizeof(brdffit_options); i < size; i++) {
            assert_int_equal(room[i], 0);
        }
    }
}

static void test_init_of_nothing(void **state)
{
    (void)state;
    brdffit_samples_init(NULL);
    brdffit_options_init(NULL);
    brdffit_model_init(NULL);
    brdffit_row_init(NULL);
    brdffit_texels_init(NULL, NULL);
    brdffit_texel_results_init(NULL);
    brdffit_many_stats_init(NULL);
    brdffit_io_options_init(NULL);
    brdffit_interval_options_init(NULL);
    brdffit_result_free(NULL);
}

static void expect_refusal(brdffit_status status, const brdffit_error *error, const char *name)
{
    assert_int_equal(status, BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(error->status, BRDFFIT_ERR_ARGUMENT);
    assert_ptr_equal(strstr(error->message, name), error->message);
}

static void test_later_structures_of_a_fit(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    const brdffit_result *result;
    LATER(brdffit_samples) samples;
    LATER(brdffit_options) options;
    LATER(brdffit_model) model;
    double *out;
    brdffit_error error;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    samples.known = data.samples;
    samples.known.struct_size = sizeof samples;
    samples.unknown = 0.0;
    brdffit_options_init_sized(&options.known, sizeof options);
    assert_int_equal(brdffit_fit_new(&samples.known, &options.known, &result, &error), BRDFFIT_OK);
    out = calloc(spec.count * spec.channels, sizeof *out);
    model.known = *result->model;
    model.known.struct_size = sizeof model;
    model.unknown = 0.0;
    assert_int_equal(brdffit_eval(&model.known, &samples.known, out, &error), BRDFFIT_OK);
    model.unknown = 1.0;
    expect_refusal(brdffit_eval(&model.known, &samples.known, out, &error), &error, "model");
    brdffit_result_free(result);
    samples.unknown = 1.0;
    expect_refusal(brdffit_fit_new(&samples.known, &options.known, &result, &error), &error, "samples");
    assert_null(result);
    expect_refusal(brdffit_inspect(&samples.known, NULL, NULL, NULL, 0, &error), &error, "samples");
    samples.unknown = 0.0;
    options.unknown = 1.0;
    expect_refusal(brdffit_fit_new(&samples.known, &options.known, &result, &error), &error, "options");
    assert_int_equal(brdffit_workspace_size(10, 1, &options.known), 0);
    assert_int_equal(brdffit_plan_size(&samples.known, &options.known), 0);
    free(out);
    brdffit_test_data_free(&data);
}

static void test_later_structures_of_a_map(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    const brdffit_plan *plan;
    LATER(brdffit_texels) texels;
    LATER(brdffit_texel_results) results;
    LATER(brdffit_many_stats) stats;
    brdffit_error error;
    void *memory, *workspace;
    size_t size;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    size = brdffit_plan_size(&data.samples, NULL);
    memory = malloc(size);
    assert_int_equal(brdffit_plan_init(&data.samples, NULL, memory, size, &plan, &error), BRDFFIT_OK);
    size = brdffit_many_workspace_size(plan);
    workspace = malloc(size);
    brdffit_texels_init_sized(&texels.known, sizeof texels, plan);
    brdffit_texel_results_init_sized(&results.known, sizeof results);
    brdffit_many_stats_init_sized(&stats.known, sizeof stats);
#define FIT() brdffit_fit_many(plan, &texels.known, &results.known, workspace, size, &stats.known, &error)
    texels.known.count = 1;
    texels.known.values = data.values;
    assert_int_equal(FIT(), BRDFFIT_OK);
    assert_int_equal(stats.known.texels, 1);
    assert_int_equal(stats.known.struct_size, sizeof stats);
    texels.unknown = 1.0;
    expect_refusal(FIT(), &error, "texels");
    texels.unknown = 0.0;
    results.unknown = 1.0;
    expect_refusal(FIT(), &error, "results");
    results.unknown = 0.0;
    stats.unknown = 1.0;
    expect_refusal(FIT(), &error, "stats");
    assert_int_equal(stats.known.texels, 1);
#undef FIT
    free(workspace);
    free(memory);
    brdffit_test_data_free(&data);
}

/* The options of version 0.1, which ended with box_user, on memory of their own. */
static void test_options_of_the_first_version(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    volatile size_t first = offsetof(brdffit_options, distributions); /* not to be reasoned about */
    struct brdffit_test_data data;
    brdffit_options *options = malloc(first); /* a sanitizer sees any access beyond */
    const brdffit_result *result, *other;
    brdffit_error error;

    (void)state;
    assert_non_null(options);
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init_sized(options, first);
    options->lobes = 2;
    assert_int_equal(brdffit_fit_new(&data.samples, options, &result, &error), BRDFFIT_OK);
    assert_int_equal(result->model->lobes, 2);
    options->struct_size = first - sizeof(void *);
    expect_refusal(brdffit_fit_new(&data.samples, options, &other, &error), &error, "options");
    brdffit_result_free(result);
    free(options);
    brdffit_test_data_free(&data);
}

/* A list decides over `distribution`; a plan keeps a copy; lobes come out by kinds in the order of their first mention. */
static void test_lists_of_distributions(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_distribution list[2] = {BRDFFIT_GGX, BRDFFIT_GGX};
    struct brdffit_test_data data;
    const brdffit_result *listed, *named;
    const brdffit_plan *plan;
    brdffit_options options;
    brdffit_error error;
    void *memory;
    size_t size;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&options);
    options.lobes = 2;
    options.distributions = list;
    assert_int_equal(brdffit_fit_new(&data.samples, &options, &listed, &error), BRDFFIT_OK);
    size = brdffit_plan_size(&data.samples, &options);
    memory = malloc(size);
    assert_int_equal(brdffit_plan_init(&data.samples, &options, memory, size, &plan, &error), BRDFFIT_OK);
    free(memory);
    options.distributions = NULL;
    options.distribution = BRDFFIT_GGX;
    assert_int_equal(brdffit_fit_new(&data.samples, &options, &named, &error), BRDFFIT_OK);
    assert_true(listed->e2 == named->e2 && listed->model->sigma[1] == named->model->sigma[1]);
    assert_int_equal(listed->model->distribution, BRDFFIT_GGX);
    assert_int_equal(named->model->distributions[1], BRDFFIT_GGX);
    list[1] = BRDFFIT_WARD;
    options.distributions = list;
    brdffit_result_free(listed);
    assert_int_equal(brdffit_fit_new(&data.samples, &options, &listed, &error), BRDFFIT_OK);
    assert_int_equal(listed->model->distributions[0], BRDFFIT_GGX);
    assert_int_equal(listed->model->distributions[1], BRDFFIT_WARD);
    assert_true(listed->certified && listed->lower_bound <= listed->e2);
    brdffit_result_free(listed);
    brdffit_result_free(named);
    brdffit_test_data_free(&data);
}

/* Nothing is released of a result that lies in a workspace. */
static void test_free_of_a_workspace_result(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t size = brdffit_workspace_size(spec.count, spec.channels, NULL);
    struct brdffit_test_data data;
    void *workspace = malloc(size);
    const brdffit_result *result;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    assert_int_equal(brdffit_fit(&data.samples, NULL, workspace, size, &result, NULL), BRDFFIT_OK);
    brdffit_result_free(result);
    assert_true(result->model->sigma[0] > 0.0);
    free(workspace);
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_init_writes_the_callers_size), cmocka_unit_test(test_init_of_nothing),
        cmocka_unit_test(test_later_structures_of_a_fit),    cmocka_unit_test(test_later_structures_of_a_map),
        cmocka_unit_test(test_options_of_the_first_version), cmocka_unit_test(test_lists_of_distributions),
        cmocka_unit_test(test_free_of_a_workspace_result),
    };

    return cmocka_run_group_tests_name("abi", tests, NULL, NULL);
}
