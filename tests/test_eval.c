/*
 * brdffit_eval() against the fit's own residuals, and at the edges. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

/* The residuals of the evaluated model are the RMS that the fit reports; f_r is radiance over n.l. */
static void test_eval_agrees(void **state)
{
    brdffit_form form;

    (void)state;
    for (form = BRDFFIT_FORM_DIRECTIONS; form <= BRDFFIT_FORM_COEFFICIENTS; form = (brdffit_form)(form + 1)) {
        struct brdffit_test_data data;
        struct brdffit_test_fit fit;
        double out[84 * 3], brdf[84 * 3];
        size_t i, k;
        struct brdffit_test_spec spec = brdffit_test_spec_default();

        spec.form = form;
        spec.noise = 0.02;
        brdffit_test_data_new(&spec, &data);
        brdffit_test_fit(&data.samples, NULL, &fit);
        assert_int_equal(fit.result.samples_used, 84);
        assert_int_equal(brdffit_test_eval(&fit.result.model, &data.samples, out, NULL), BRDFFIT_OK);
        for (k = 0; k < 3; k++) {
            double sum = 0.0;

            for (i = 0; i < 84; i++) {
                sum += pow(out[3 * i + k] - data.values[3 * i + k], 2.0);
            }
            assert_true(fabs(sqrt(sum / 84.0) / fit.result.rms[k] - 1.0) <= 1e-12);
        }
        if (form != BRDFFIT_FORM_COEFFICIENTS) {
            data.samples.quantity = BRDFFIT_QUANTITY_BRDF;
            assert_int_equal(brdffit_test_eval(&fit.result.model, &data.samples, brdf, NULL), BRDFFIT_OK);
            for (i = 0; i < 84 * 3; i++) {
                assert_true(fabs(brdf[i] * data.samples.cos_light[i / 3] / out[i] - 1.0) <= 1e-14);
            }
        }
        brdffit_test_fit_free(&fit);
        brdffit_test_data_free(&data);
    }
}

/* Values and weights of the samples are not read, and the horizon is dark. */
static void test_eval_edges(void **state)
{
    static const double x[2] = {1.0, 2.0}, y[2] = {0.5, 0.25};
    static const double light[] = {0, 0, 1, 0, 0, -1, 1, 0, 0, 0, 0, 1}, view[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, -1};
    static const double weights[] = {0.0, NAN, -1.0, 0.0}, values[] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    struct brdffit_test_model model = {BRDFFIT_BECKMANN, 1, 2, {0.5, 0.0}, x, y, NULL};
    double out[8], bad_light[12];
    brdffit_samples at;
    brdffit_error error;
    size_t i;

    (void)state;
    brdffit_samples_init(&at);
    at.count = 4;
    at.light = light;
    at.view = view;
    at.weights = weights;
    at.values = values;
    assert_int_equal(brdffit_test_eval(&model, &at, out, &error), BRDFFIT_OK);
    /* Normal incidence, mirror: a = b = 1/pi, c = 0. */
    assert_true(fabs(out[0] * acos(-1.0) / (1.0 + 0.5 * 4.0) - 1.0) <= 1e-15);
    assert_true(fabs(out[1] * acos(-1.0) / (2.0 + 0.25 * 4.0) - 1.0) <= 1e-15);
    for (i = 2; i < 8; i++) {
        assert_true(out[i] == 0.0);
    }
    memcpy(bad_light, light, sizeof light);
    bad_light[4] = NAN;
    at.light = bad_light;
    assert_int_equal(brdffit_test_eval(&model, &at, out, &error), BRDFFIT_ERR_VALUE);
    assert_int_equal(error.sample, 1);
    assert_int_equal(brdffit_test_eval(NULL, &at, out, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_test_eval(&model, NULL, out, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_test_eval(&model, &at, NULL, &error), BRDFFIT_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eval_agrees),
        cmocka_unit_test(test_eval_edges),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
