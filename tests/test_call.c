/*
 * Pointers, structures, options and workspaces that must be refused, and the ends of ranges that must not.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "misuse_problem.h"

/* ---- Pointers, sizes, enumerations ----------------------------------------------------------------------- */

static void test_missing_arrays(void **state)
{
    struct problem p;

    (void)state;
#define REFUSE_WITHOUT(form, member)                                                                                   \
    do {                                                                                                               \
        problem_init(&p, form);                                                                                        \
        p.samples.member = NULL;                                                                                       \
        (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);                                          \
    } while (0)
    REFUSE_WITHOUT(BRDFFIT_FORM_DIRECTIONS, light);
    REFUSE_WITHOUT(BRDFFIT_FORM_DIRECTIONS, view);
    REFUSE_WITHOUT(BRDFFIT_FORM_DIRECTIONS, values);
    REFUSE_WITHOUT(BRDFFIT_FORM_ANGLES, cos_light);
    REFUSE_WITHOUT(BRDFFIT_FORM_ANGLES, cos_view);
    REFUSE_WITHOUT(BRDFFIT_FORM_ANGLES, tan2_half);
    REFUSE_WITHOUT(BRDFFIT_FORM_ANGLES, cos_difference);
    REFUSE_WITHOUT(BRDFFIT_FORM_COEFFICIENTS, a);
    REFUSE_WITHOUT(BRDFFIT_FORM_COEFFICIENTS, b);
    REFUSE_WITHOUT(BRDFFIT_FORM_COEFFICIENTS, c);
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    p.samples.normal = NULL; /* +z */
    p.samples.weights = NULL;
    assert_int_equal(fit_and_free(&p.samples, NULL).samples_used, COUNT);
}

static void test_bad_samples_struct(void **state)
{
    struct problem p;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    p.samples.struct_size = offsetof(brdffit_samples, tangent) - 1; /* the first version less a byte */
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    p.samples.channels = 0;
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);
    problem_init(&p, (brdffit_form)3);
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    p.samples.quantity = (brdffit_quantity)2;
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);
    problem_init(&p, BRDFFIT_FORM_COEFFICIENTS);
    p.samples.quantity = BRDFFIT_QUANTITY_BRDF; /* without n.l there is no radiance */
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);
}

static void test_null_pointers(void **state)
{
    struct problem p;
    const brdffit_result *result = NULL, *new_result = NULL;
    brdffit_error error;
    size_t size;
    void *workspace;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    size = brdffit_workspace_size(COUNT, CHANNELS, NULL);
    workspace = malloc(size);
    assert_non_null(workspace);
    assert_int_equal(brdffit_fit(NULL, NULL, workspace, size, &result, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit(&p.samples, NULL, NULL, size, &result, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit(&p.samples, NULL, workspace, size, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(error.status, BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit(NULL, NULL, NULL, 0, NULL, NULL), BRDFFIT_ERR_ARGUMENT);
    p.light[4] = NAN;
    assert_int_equal(brdffit_fit(&p.samples, NULL, workspace, size, &result, NULL), BRDFFIT_ERR_VALUE);
    free(workspace);
    assert_int_equal(brdffit_fit_new(&p.samples, NULL, &new_result, &error), BRDFFIT_ERR_VALUE);
    assert_null(new_result);
    assert_int_equal(brdffit_fit_new(&p.samples, NULL, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit_new(NULL, NULL, &new_result, &error), BRDFFIT_ERR_ARGUMENT);
    brdffit_result_free(NULL);
}

/* ---- Options -------------------------------------------------------------------------------------------- */

static void test_bad_options(void **state)
{
    struct problem p;
    brdffit_options o;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
#define REFUSE_OPTION(member, bad)                                                                                     \
    do {                                                                                                               \
        brdffit_options_init(&o);                                                                                      \
        o.member = bad;                                                                                                \
        assert_int_equal(brdffit_workspace_size(COUNT, CHANNELS, &o), 0);                                              \
        (void)brdffit_test_fit_fails(&p.samples, &o, BRDFFIT_ERR_OPTION);                                              \
    } while (0)
    REFUSE_OPTION(lobes, 0);
    REFUSE_OPTION(lobes, BRDFFIT_MAX_LOBES + 1);
    REFUSE_OPTION(lobes, -1);
    REFUSE_OPTION(distribution, BRDFFIT_DISTRIBUTION_COUNT);
    REFUSE_OPTION(distribution, (brdffit_distribution)-1);
    REFUSE_OPTION(norm, BRDFFIT_NORM_COUNT);
    REFUSE_OPTION(norm, (brdffit_norm)-1);
    REFUSE_OPTION(normalise, (brdffit_normalise)2);
    REFUSE_OPTION(sigma_min, 0.0);
    REFUSE_OPTION(sigma_min, 0.99e-12);
    REFUSE_OPTION(sigma_min, -1.0);
    REFUSE_OPTION(sigma_min, 6.1); /* above sigma_max */
    REFUSE_OPTION(sigma_min, NAN);
    REFUSE_OPTION(sigma_min, INFINITY);
    REFUSE_OPTION(sigma_max, 1000.1);
    REFUSE_OPTION(sigma_max, 1e-13);
    REFUSE_OPTION(sigma_max, NAN);
    REFUSE_OPTION(sigma_max, INFINITY);
    REFUSE_OPTION(relative_gap, 0.0);
    REFUSE_OPTION(relative_gap, -1e-3);
    REFUSE_OPTION(relative_gap, NAN);
    REFUSE_OPTION(absolute_gap, -1e-300);
    REFUSE_OPTION(absolute_gap, NAN);
    REFUSE_OPTION(sigma_resolution, -1.0);
    REFUSE_OPTION(sigma_resolution, NAN);
    REFUSE_OPTION(box_budget, 0);
    REFUSE_OPTION(max_incidence, 0.0);
    REFUSE_OPTION(max_incidence, -60.0);
    REFUSE_OPTION(max_incidence, NAN);
    brdffit_options_init(&o);
    o.struct_size = 64;
    (void)brdffit_test_fit_fails(&p.samples, &o, BRDFFIT_ERR_ARGUMENT);
    o.struct_size = (size_t)-1;
    (void)brdffit_test_fit_fails(&p.samples, &o, BRDFFIT_ERR_ARGUMENT);
}

/* The ends of the ranges are inside. */
static void test_extreme_options(void **state)
{
    struct problem p;
    brdffit_options o;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    for (brdffit_options_init(&o); o.lobes <= 2; o.lobes++) {
        o.sigma_max = 1e3;
        (void)fit_and_free(&p.samples, &o);
        o.sigma_min = o.sigma_max;
        (void)fit_and_free(&p.samples, &o);
        o.sigma_min = o.sigma_max = 1e-12;
        (void)fit_and_free(&p.samples, &o);
        o.sigma_max = 6.0;
        o.relative_gap = 1e300;
        assert_int_equal(fit_and_free(&p.samples, &o).certified, 1);
        o.absolute_gap = 1.0;
        o.relative_gap = 5e-324;
        assert_int_equal(fit_and_free(&p.samples, &o).certified, 1);
        o.absolute_gap = 0.0; /* nothing can be proven to nothing: stops for another reason, without hanging */
        o.box_budget = 20000;
        (void)fit_and_free(&p.samples, &o);
        o.max_incidence = 1e-9;
        (void)fit_and_free(&p.samples, &o);
        o.max_incidence = 1e300;
        (void)fit_and_free(&p.samples, &o);
        o.max_incidence = 60.0;
        o.relative_gap = 1e-3;
        o.absolute_gap = 1e-12;
        o.box_budget = 1000000;
    }
}

/* ---- Workspace ------------------------------------------------------------------------------------------ */

static void test_workspace_too_small(void **state)
{
    struct problem p;
    brdffit_options o;
    size_t size, less;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    brdffit_options_init(&o);
    o.box_budget = 100;
    size = brdffit_workspace_size(COUNT, CHANNELS, &o);
    for (less = 1; less < size; less *= 3) {
        void *workspace = malloc(size - less); /* exactly: a sanitizer sees any write beyond */
        const brdffit_result *result = NULL;
        brdffit_error error;

        assert_non_null(workspace);
        assert_int_equal(brdffit_fit(&p.samples, &o, workspace, size - less, &result, &error), BRDFFIT_ERR_WORKSPACE);
        assert_null(result);
        free(workspace);
    }
}

static void test_size_overflow(void **state)
{
    static const size_t huge[] = {(size_t)-1, (size_t)-1 / 2, (size_t)-1 / 8, (size_t)-1 / 64, (size_t)-1 / 1024};
    size_t i, j;

    (void)state;
    for (i = 0; i < sizeof huge / sizeof huge[0]; i++) {
        struct problem p;

        for (j = 0; j < sizeof huge / sizeof huge[0]; j++) {
            assert_int_equal(brdffit_workspace_size(huge[i], huge[j], NULL), 0);
        }
        assert_int_equal(brdffit_workspace_size((size_t)-1 / 8, 1 + i, NULL), 0);
        assert_int_equal(brdffit_workspace_size(1 + i, (size_t)-1 / 8, NULL), 0);
        problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
        p.samples.channels = (size_t)-1 / (1 + i);
        (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_UNSUPPORTED);
    }
    assert_int_equal(brdffit_workspace_size(10, 0, NULL), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_missing_arrays),  cmocka_unit_test(test_bad_samples_struct),
        cmocka_unit_test(test_null_pointers),   cmocka_unit_test(test_bad_options),
        cmocka_unit_test(test_extreme_options), cmocka_unit_test(test_workspace_too_small),
        cmocka_unit_test(test_size_overflow),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
