/*
 * Samples that must be refused: every failure has the right code, names the place, and leaves the result alone.
 * And samples that must not be refused although they look odd. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "misuse_problem.h"

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
    struct brdffit_test_result first;
    size_t i, j;

    (void)state;
    problem_init(&p, BRDFFIT_FORM_DIRECTIONS);
    first = fit_and_free(&p.samples, NULL);
    for (j = 0; j < sizeof length / sizeof length[0]; j++) {
        struct brdffit_test_result result;

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
    struct brdffit_test_result result;

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_not_finite), cmocka_unit_test(test_out_of_range), cmocka_unit_test(test_zero_length),
        cmocka_unit_test(test_any_length), cmocka_unit_test(test_skipped),      cmocka_unit_test(test_nothing_left),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
