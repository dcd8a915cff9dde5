/*
 * Input that must be refused: every failure has the right code, names the place, and leaves the result alone.
 * And input that must not be refused although it looks odd. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

/* A small valid problem of each form, in writable arrays. */
#define COUNT 12
#define CHANNELS 2

struct problem {
    brdffit_samples samples;
    double light[3 * COUNT], view[3 * COUNT], normal[3 * COUNT];
    double cos_light[COUNT], cos_view[COUNT], tan2_half[COUNT], cos_difference[COUNT];
    double a[COUNT], b[COUNT], c[COUNT], weights[COUNT], values[CHANNELS * COUNT];
};

static void problem_init(struct problem *p, brdffit_form form)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    size_t i;

    spec.count = COUNT;
    spec.channels = CHANNELS;
    brdffit_test_data_new(&spec, &data);
    p->samples = data.samples;
    p->samples.form = form;
    memcpy(p->light, data.samples.light, sizeof p->light);
    memcpy(p->view, data.samples.view, sizeof p->view);
    memcpy(p->cos_light, data.samples.cos_light, sizeof p->cos_light);
    memcpy(p->cos_view, data.samples.cos_view, sizeof p->cos_view);
    memcpy(p->tan2_half, data.samples.tan2_half, sizeof p->tan2_half);
    memcpy(p->cos_difference, data.samples.cos_difference, sizeof p->cos_difference);
    memcpy(p->a, data.samples.a, sizeof p->a);
    memcpy(p->b, data.samples.b, sizeof p->b);
    memcpy(p->c, data.samples.c, sizeof p->c);
    memcpy(p->values, data.values, sizeof p->values);
    for (i = 0; i < COUNT; i++) {
        p->normal[3 * i] = p->normal[3 * i + 1] = 0.0;
        p->normal[3 * i + 2] = 2.0;
        p->weights[i] = 1.0;
    }
    p->samples.light = p->light;
    p->samples.view = p->view;
    p->samples.normal = p->normal;
    p->samples.cos_light = p->cos_light;
    p->samples.cos_view = p->cos_view;
    p->samples.tan2_half = p->tan2_half;
    p->samples.cos_difference = p->cos_difference;
    p->samples.a = p->a;
    p->samples.b = p->b;
    p->samples.c = p->c;
    p->samples.weights = p->weights;
    p->samples.values = p->values;
    brdffit_test_data_free(&data);
}

static brdffit_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    brdffit_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result;
    brdffit_test_fit_free(&fit);
    return result;
}

/* ---- Values --------------------------------------------------------------------------------------------- */

static const double not_finite[] = {NAN, INFINITY, -INFINITY};

/* Replace one number of an array: the error must name sample, channel (when `channels`) and value. */
static void refuse(struct problem *p, double *array, size_t per_sample, size_t where, double value)
{
    double kept = array[where];
    brdffit_error error;

    array[where] = value;
    error = brdffit_test_fit_fails(&p->samples, NULL, BRDFFIT_ERR_VALUE);
    assert_int_equal(error.sample, where / per_sample);
    if (array == p->values) {
        assert_int_equal(error.channel, where % per_sample);
    } else {
        assert_true(error.channel == BRDFFIT_NONE);
    }
    assert_true(error.line == BRDFFIT_NONE && error.column == BRDFFIT_NONE);
    assert_true(error.value == value || (isnan(error.value) && isnan(value)));
    array[where] = kept;
}

/* Each non-finite value at the first, a middle and the last place. */
static void refuse_not_finite(struct problem *p, double *array, size_t per_sample)
{
    size_t j;

    for (j = 0; j < 3; j++) {
        refuse(p, array, per_sample, 0, not_finite[j]);
        refuse(p, array, per_sample, per_sample * (COUNT / 2) + per_sample - 1, not_finite[j]);
        refuse(p, array, per_sample, per_sample * COUNT - 1, not_finite[j]);
    }
}

static void test_not_finite(void **state)
{
    struct problem p;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    refuse_not_finite(&p, p.light, 3);
    refuse_not_finite(&p, p.view, 3);
    refuse_not_finite(&p, p.normal, 3);
    refuse_not_finite(&p, p.weights, 1);
    refuse_not_finite(&p, p.values, CHANNELS);
    problem_init(&p, BRDFFIT_FORM_ANGLES);
    refuse_not_finite(&p, p.cos_light, 1);
    refuse_not_finite(&p, p.cos_view, 1);
    refuse_not_finite(&p, p.tan2_half, 1);
    refuse_not_finite(&p, p.cos_difference, 1);
    refuse_not_finite(&p, p.values, CHANNELS);
    problem_init(&p, BRDFFIT_FORM_COEFFICIENTS);
    refuse_not_finite(&p, p.a, 1);
    refuse_not_finite(&p, p.b, 1);
    refuse_not_finite(&p, p.c, 1);
    refuse_not_finite(&p, p.weights, 1);
    refuse_not_finite(&p, p.values, CHANNELS);
}

static void test_out_of_range(void **state)
{
    struct problem p;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    refuse(&p, p.weights, 1, 3, -1e-300);
    refuse(&p, p.weights, 1, 3, -1.0);
    problem_init(&p, BRDFFIT_FORM_ANGLES);
    refuse(&p, p.cos_light, 1, 2, nextafter(1.0, 2.0));
    refuse(&p, p.cos_light, 1, 2, -1.5);
    refuse(&p, p.cos_view, 1, 2, 1.5);
    refuse(&p, p.tan2_half, 1, 5, -1e-300);
    refuse(&p, p.cos_difference, 1, 5, 0.0);
    refuse(&p, p.cos_difference, 1, 5, 1.5);
    problem_init(&p, BRDFFIT_FORM_COEFFICIENTS);
    refuse(&p, p.a, 1, 2, -1e-300);
    refuse(&p, p.b, 1, 2, -1.0);
    refuse(&p, p.c, 1, 2, -1.0);
}

static void test_zero_length(void **state)
{
    struct problem p;
    double *array[3];
    int j;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    array[0] = p.light;
    array[1] = p.view;
    array[2] = p.normal;
    for (j = 0; j < 3; j++) {
        double kept[3];
        brdffit_error error;

        memcpy(kept, array[j] + 6, sizeof kept);
        memset(array[j] + 6, 0, sizeof kept);
        error = brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_VALUE);
        assert_int_equal(error.sample, 2);
        memcpy(array[j] + 6, kept, sizeof kept);
    }
}

/* Any other length will do, for the same answer up to the rounding of unit vectors. */
static void test_any_length(void **state)
{
    static const double length[] = {1e-308, 1e-200, 3.0, 1e200, 1e308};
    struct problem p;
    brdffit_result first;
    size_t i, j;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    first = fit_and_free(&p.samples, NULL);
    for (j = 0; j < sizeof length / sizeof length[0]; j++) {
        brdffit_result result;

        problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
        for (i = 0; i < 3 * COUNT; i++) {
            p.light[i] *= length[j];
            p.view[i] *= length[sizeof length / sizeof length[0] - 1 - j];
            p.normal[i] *= 0.5 * length[j];
        }
        if (length[j] < 1e-300) {
            continue; /* subnormal components are other directions; that they do not fail is tested below */
        }
        result = fit_and_free(&p.samples, NULL);
        assert_true(fabs(result.model.sigma[0] / first.model.sigma[0] - 1.0) <= 1e-12);
        assert_true(fabs(result.e2 - first.e2) <= 1e-13 * first.sum_of_squares);
    }
    for (i = 0; i < COUNT; i++) { /* the smallest and the largest lengths there are */
        p.light[3 * i] = p.view[3 * i] = 0.0;
        p.light[3 * i + 1] = p.light[3 * i + 2] = 5e-324;
        p.view[3 * i + 1] = -1.7e308;
        p.view[3 * i + 2] = 1.7e308;
    }
    assert_int_equal(fit_and_free(&p.samples, NULL).samples_used, COUNT);
}

/* ---- Samples that do not count -------------------------------------------------------------------------- */

static void test_skipped(void **state)
{
    struct problem p;
    brdffit_options options;
    brdffit_result result;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    brdffit_options_init(&options);
    p.light[2] = -p.light[2];                   /* 0: light below */
    p.view[3 + 2] = -0.1;                       /* 1: view below */
    p.light[6 + 2] = p.view[6 + 2] = -1.0;      /* 2: both below: counted under the light */
    p.weights[3] = 0.0;                         /* 3: no weight, whatever else */
    p.light[9 + 2] = -1.0;
    p.values[3 * CHANNELS] = NAN;               /* never looked at */
    p.light[12] = 1.0;                          /* 4: at the horizon exactly */
    p.light[13] = p.light[14] = 0.0;
    p.light[15] = sin(1.2);                     /* 5: incidence of 69 degrees */
    p.light[16] = 0.0;
    p.light[17] = cos(1.2);
    p.light[18] = sqrt(3.0);                    /* 6: 60 degrees to rounding: counts */
    p.light[19] = 0.0;
    p.light[20] = 1.0;
    result = fit_and_free(&p.samples, &options);
    assert_int_equal(result.samples_used, COUNT - 6);
    assert_int_equal(result.samples_skipped[BRDFFIT_SKIP_ZERO_WEIGHT], 1);
    assert_int_equal(result.samples_skipped[BRDFFIT_SKIP_LIGHT_BELOW_HORIZON], 3);
    assert_int_equal(result.samples_skipped[BRDFFIT_SKIP_VIEW_BELOW_HORIZON], 1);
    assert_int_equal(result.samples_skipped[BRDFFIT_SKIP_INCIDENCE], 1);
    options.max_incidence = 90.0;
    result = fit_and_free(&p.samples, &options);
    assert_int_equal(result.samples_used, COUNT - 5);
    assert_int_equal(result.samples_skipped[BRDFFIT_SKIP_INCIDENCE], 0);
}

static void test_nothing_left(void **state)
{
    struct problem p;
    size_t i;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    p.samples.count = 0;
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_NO_SAMPLES);
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    memset(p.weights, 0, sizeof p.weights);
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_NO_SAMPLES);
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    for (i = 0; i < COUNT; i++) {
        p.normal[3 * i + 2] = -1.0;
    }
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_NO_SAMPLES);
    problem_init(&p, BRDFFIT_FORM_ANGLES);
    for (i = 0; i < COUNT; i++) {
        p.cos_light[i] = 0.1;
    }
    (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_NO_SAMPLES);
}

/* ---- Pointers, sizes, enumerations ----------------------------------------------------------------------- */

static void test_missing_arrays(void **state)
{
    struct problem p;

    (void)state;
#define REFUSE_WITHOUT(form, member)                                                     \
    do {                                                                                 \
        problem_init(&p, form);                                                          \
        p.samples.member = NULL;                                                         \
        (void)brdffit_test_fit_fails(&p.samples, NULL, BRDFFIT_ERR_ARGUMENT);            \
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
    p.samples.struct_size--;
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
    brdffit_result result, *new_result = NULL;
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
    brdffit_fit_free(NULL);
}

/* ---- Options -------------------------------------------------------------------------------------------- */

static void test_bad_options(void **state)
{
    struct problem p;
    brdffit_options o;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
#define REFUSE_OPTION(member, bad)                                                       \
    do {                                                                                 \
        brdffit_options_init(&o);                                                        \
        o.member = bad;                                                                  \
        assert_int_equal(brdffit_workspace_size(COUNT, CHANNELS, &o), 0);                \
        (void)brdffit_test_fit_fails(&p.samples, &o, BRDFFIT_ERR_OPTION);                \
    } while (0)
    REFUSE_OPTION(lobes, 0);
    REFUSE_OPTION(lobes, 3);
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
    o.struct_size++;
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
        brdffit_result result, before;
        brdffit_error error;

        assert_non_null(workspace);
        memset(&result, 0xa5, sizeof result);
        before = result;
        assert_int_equal(brdffit_fit(&p.samples, &o, workspace, size - less, &result, &error), BRDFFIT_ERR_WORKSPACE);
        assert_memory_equal(&result, &before, sizeof result);
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
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_out_of_range),
        cmocka_unit_test(test_zero_length),
        cmocka_unit_test(test_any_length),
        cmocka_unit_test(test_skipped),
        cmocka_unit_test(test_nothing_left),
        cmocka_unit_test(test_missing_arrays),
        cmocka_unit_test(test_bad_samples_struct),
        cmocka_unit_test(test_null_pointers),
        cmocka_unit_test(test_bad_options),
        cmocka_unit_test(test_extreme_options),
        cmocka_unit_test(test_workspace_too_small),
        cmocka_unit_test(test_size_overflow),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
