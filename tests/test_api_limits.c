/*
 * Public calls with numbers at the limits of double: a number or an error comes out, never NaN; and inspection gives
 * the verdict that a fit gives. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "support.h"

/* What is no number must not come out of finite input: an error, or a number. */
static void test_eval_of_extremes(void **state)
{
    static const double sigma[] = {1e-12, 1e-100, 1e-155, 1e-200, 1e-300, 1e3, 1e100, 1e200, 1e300};
    static const double tan2[] = {0.0, 1e-300, 1.0, 1e60, 1e100, 1e154, 1e160, 1e200, 1e308};
    static const double cosines[] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, x[] = {0.3}, y[] = {0.1};
    brdffit_samples at;
    size_t i, j;
    int d;

    (void)state;
    brdffit_samples_init(&at);
    at.form = BRDFFIT_FORM_ANGLES;
    at.count = 1;
    at.cos_light = at.cos_view = at.cos_difference = cosines;
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        for (i = 0; i < sizeof sigma / sizeof sigma[0]; i++) {
            struct brdffit_test_model model = {(brdffit_distribution)d, 1, 1, {sigma[i], 0.0}, x, y, NULL};

            for (j = 0; j < sizeof tan2 / sizeof tan2[0]; j++) {
                double out = 0.0;

                at.tan2_half = tan2 + j;
                if (brdffit_test_eval(&model, &at, &out, NULL) == BRDFFIT_OK && isnan(out)) {
                    fail_msg("%s: sigma %g, tan2_half %g: NaN", brdffit_distribution_string((brdffit_distribution)d),
                             sigma[i], tan2[j]);
                }
            }
        }
    }
}

/* Finite data of any size give numbers, or the fit says why not. */
static void check_numbers(const brdffit_samples *samples, const brdffit_options *options)
{
    const brdffit_result *result = NULL;
    brdffit_error error;
    brdffit_status status = brdffit_fit_new(samples, options, &result, &error);

    if (status != BRDFFIT_OK) {
        assert_int_equal(status, BRDFFIT_ERR_VALUE);
        return;
    }
    if (!(isfinite(result->e2) && isfinite(result->lower_bound) && result->gap >= 0.0 &&
          isfinite(result->model->x[0]) && isfinite(result->model->y[0]) && isfinite(result->rms[0]) &&
          isfinite(result->rms_total) && result->kkt_residual >= 0.0 && isfinite(result->sum_of_squares))) {
        brdffit_test_print(samples, options);
        fail_msg("e2 %g bound %g gap %g x %g y %g rms %g total %g", result->e2, result->lower_bound, result->gap,
                 result->model->x[0], result->model->y[0], result->rms[0], result->rms_total);
    }
    brdffit_result_free(result);
}

static void test_fit_of_extremes(void **state)
{
    static const double size[] = {1e-300, 1e-160, 1e-100, 1.0, 1e100, 1e149, 1e200, 1e307};
    static const double a[4] = {0.3, 0.2, 0.1, 0.05}, b[4] = {1.0, 0.9, 0.8, 0.7};
    size_t i, j, n;
    int variant;

    (void)state;
    for (i = 0; i < 8; i++) {
        for (j = 0; j < 8; j++) {
            for (variant = 0; variant < 4; variant++) {
                double c[4], values[4], weights[4];
                brdffit_samples s = brdffit_test_coefficients(4, 1, a, b, c, values);
                brdffit_options options;

                for (n = 0; n < 4; n++) {
                    c[n] = 0.01 * (double)(n * n) * (variant < 2 ? 1.0 : size[j]);
                    c[n] += variant == 3 ? 0.1 * size[j] : 0.0;
                    values[n] = (1.0 + (double)(n % 3)) * fmin(size[i], 1e200); /* y is 72 times that */
                    weights[n] = variant < 2 ? size[j] : 1.0;
                }
                s.weights = weights;
                brdffit_options_init(&options);
                options.normalise = variant & 1 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
                check_numbers(&s, &options);
            }
        }
    }
}

static void test_fit_of_grazing_angles(void **state)
{
    static const double cosines[] = {0.6, 0.7, 0.8, 0.9}, values[] = {1.0, 0.4, 0.2, 0.1};
    static const double far[] = {1e10, 1e70, 1e120, 1e160, 1e200, 1e300};
    size_t i;

    (void)state;
    for (i = 0; i < 6; i++) {
        double tan2[4] = {0.0, 0.1, 0.2, 0.0};
        brdffit_samples s;

        tan2[3] = far[i];
        brdffit_samples_init(&s);
        s.form = BRDFFIT_FORM_ANGLES;
        s.count = 4;
        s.channels = 1;
        s.cos_light = s.cos_view = s.cos_difference = cosines;
        s.tan2_half = tan2;
        s.values = values;
        check_numbers(&s, NULL);
    }
}

/* ---- inspection --------------------------------------------------------------------------------------- */

/* The same verdict as a fit: status, and the counts. */
static void check_inspect(const brdffit_samples *s, const brdffit_options *options)
{
    size_t used = 12345, skipped[BRDFFIT_SKIP_COUNT], i;
    brdffit_error error = {BRDFFIT_OK, NULL, 0, 0, 0, 0, 0.0};
    const brdffit_result *result = NULL;
    brdffit_status fitted = brdffit_fit_new(s, options, &result, NULL);
    brdffit_status inspected = brdffit_inspect(s, options, &used, skipped, BRDFFIT_SKIP_COUNT, &error);

    assert_string_equal(brdffit_status_string(inspected), brdffit_status_string(fitted));
    assert_int_equal(brdffit_inspect(s, options, NULL, NULL, 0, NULL), inspected);
    if (inspected == BRDFFIT_OK) {
        assert_int_equal(used, result->samples_used);
        for (i = 0; i < BRDFFIT_SKIP_COUNT; i++) {
            assert_int_equal(skipped[i], result->samples_skipped[i]);
        }
    } else {
        assert_int_equal(error.status, inspected);
        assert_non_null(error.message);
        assert_null(result);
    }
    brdffit_result_free(result);
}

static void test_inspect(void **state)
{
    static const double incidence[] = {60.0, 90.0, 20.0, 1e-3};
    int i;

    (void)state;
    for (i = 0; i < 48; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        struct brdffit_test_data data;
        brdffit_options options;

        spec.seed = (uint64_t)i;
        spec.layout = BRDFFIT_TEST_RANDOM;
        spec.form = (brdffit_form)(i % 3);
        spec.weighted = i & 1;
        spec.normals = i & 2;
        spec.noise = 0.1;
        brdffit_test_data_new(&spec, &data);
        brdffit_options_init(&options);
        options.box_budget = 50;
        options.max_incidence = incidence[i % 4];
        check_inspect(&data.samples, &options);
        if (i % 5 == 0) {
            data.values[7] = NAN;
            check_inspect(&data.samples, &options);
        }
        brdffit_test_data_free(&data);
    }
}

static void test_inspect_of_bad_input(void **state)
{
    static const double a[2] = {0.3, 0.2}, c[2] = {0.0, 0.1}, huge[2] = {1e200, 1.0}, small[2] = {1.0, 0.5};
    static const double b[2] = {1.0, 1.0}, b_span[2] = {1e150, 1e-150};
    brdffit_samples s = brdffit_test_coefficients(2, 1, a, b, c, small);
    brdffit_options options;

    (void)state;
    brdffit_options_init(&options);
    check_inspect(&s, &options);
    s.b = b_span; /* a limit on the data as a whole: the fit's to find */
    assert_int_equal(brdffit_inspect(&s, &options, NULL, NULL, 0, NULL), BRDFFIT_OK);
    s.b = b;
    s.values = huge;
    check_inspect(&s, &options);
    s.values = NULL;
    check_inspect(&s, &options);
    options.lobes = 3;
    check_inspect(&s, &options);
    brdffit_options_init(&options);
    options.struct_size = 4;
    check_inspect(&s, &options);
    assert_int_equal(brdffit_inspect(NULL, NULL, NULL, NULL, 0, NULL), BRDFFIT_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eval_of_extremes),      cmocka_unit_test(test_fit_of_extremes),
        cmocka_unit_test(test_fit_of_grazing_angles), cmocka_unit_test(test_inspect),
        cmocka_unit_test(test_inspect_of_bad_input),
    };

    return cmocka_run_group_tests_name("api_limits", tests, NULL, NULL);
}
