/*
 * Input at the edges of what makes sense: every fit is judged by brdffit_test_verify(), and what the answer must be
 * is checked besides. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

/* Each test runs with one and two lobes and both distributions. */
#define FOR_EACH_MODEL(options)                                                                                        \
    for (brdffit_options_init(&(options)); (options).lobes <= 2; (options).lobes++)                                    \
        for ((options).distribution = BRDFFIT_BECKMANN; (options).distribution <= BRDFFIT_GGX;                         \
             (options).distribution = (brdffit_distribution)((options).distribution + 1))

static struct brdffit_test_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    struct brdffit_test_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result; /* its arrays are gone after the next line */
    brdffit_test_fit_free(&fit);
    return result;
}

static void test_one_sample(void **state)
{
    static const double a[] = {0.3}, b[] = {0.5}, c[] = {0.01}, values[] = {0.4, 0.0, 0.7};
    brdffit_samples samples = brdffit_test_coefficients(1, 3, a, b, c, values);
    brdffit_options options;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        struct brdffit_test_result result = fit_and_free(&samples, &options);

        assert_int_equal(result.certified, 1);
        assert_true(result.e2 <= 1e-30 * result.sum_of_squares);
    }
}

static void test_one_sample_of_each_form(void **state)
{
    brdffit_options options;
    brdffit_form form;

    (void)state;
    for (form = BRDFFIT_FORM_DIRECTIONS; form <= BRDFFIT_FORM_COEFFICIENTS; form = (brdffit_form)(form + 1)) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        struct brdffit_test_data data;

        spec.form = form;
        spec.count = 1;
        brdffit_test_data_new(&spec, &data);
        FOR_EACH_MODEL(options)
        {
            (void)fit_and_free(&data.samples, &options);
        }
        brdffit_test_data_free(&data);
    }
}

/* No roughness fits better than another: all of the domain is flat, and that is said. */
static void test_all_c_equal(void **state)
{
    static const double a[] = {0.3, 0.1, 0.2, 0.25}, b[] = {0.5, 0.4, 0.2, 0.1}, c[] = {0.5, 0.5, 0.5, 0.5};
    static const double values[] = {1.0, 0.9, 0.3, 0.35};
    brdffit_samples samples = brdffit_test_coefficients(4, 1, a, b, c, values);
    brdffit_options options;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        struct brdffit_test_result result;

        options.sigma_min = 0.05;
        result = fit_and_free(&samples, &options);
        assert_int_equal(result.distinct_c, 1);
        assert_int_equal(result.certified, 1);
        assert_true(result.lobe[0].warnings & BRDFFIT_WARN_FLAT);
        assert_true(result.lobe[0].sigma == options.sigma_max);
        assert_true(result.lobe[0].sigma_low == options.sigma_min);
    }
}

static void test_all_directions_equal(void **state)
{
    enum { COUNT = 9 };
    double light[3 * COUNT], view[3 * COUNT], values[COUNT];
    brdffit_samples samples;
    brdffit_options options;
    int i;

    (void)state;
    for (i = 0; i < COUNT; i++) {
        static const double one[3] = {0.3, 0.1, 0.8}, other[3] = {-0.2, 0.3, 0.5};

        memcpy(light + 3 * i, one, sizeof one);
        memcpy(view + 3 * i, other, sizeof other);
        values[i] = 1.0 + 0.1 * (i - 4);
    }
    brdffit_samples_init(&samples);
    samples.count = COUNT;
    samples.channels = 1;
    samples.light = light;
    samples.view = view;
    samples.values = values;
    FOR_EACH_MODEL(options)
    {
        struct brdffit_test_result result = fit_and_free(&samples, &options);

        /* Every model is a constant: the mean remains. 1.4 is the largest value. */
        assert_true(fabs(result.e2 - 0.6 / (1.4 * 1.4)) <= 1e-14);
        assert_int_equal(result.distinct_c, 1);
        assert_int_equal(result.certified, 1);
    }
}

static void test_a_channel_of_zeros(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_options options;
    size_t i;

    (void)state;
    spec.noise = 0.01;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < spec.count; i++) {
        data.values[3 * i + 1] = 0.0;
    }
    FOR_EACH_MODEL(options)
    {
        struct brdffit_test_fit fit;
        int p;

        brdffit_test_fit(&data.samples, &options, &fit);
        assert_int_equal(fit.result.certified, 1);
        assert_true(fit.result.model.x[1] == 0.0);
        for (p = 0; p < options.lobes; p++) {
            assert_true(fit.result.model.y[options.lobes + p] == 0.0);
        }
        assert_true(fit.result.rms[1] == 0.0);
        brdffit_test_fit_free(&fit);
    }
    brdffit_test_data_free(&data);
}

/* Nothing to explain, or nothing that non-negative coefficients can explain. */
static void test_all_zero_and_all_negative(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options;
    double sign;

    (void)state;
    for (sign = 0.0; sign >= -1.0; sign -= 1.0) {
        struct brdffit_test_data data;
        size_t i;

        brdffit_test_data_new(&spec, &data);
        for (i = 0; i < 3 * spec.count; i++) {
            data.values[i] *= sign;
        }
        FOR_EACH_MODEL(options)
        {
            struct brdffit_test_result result = fit_and_free(&data.samples, &options);

            assert_int_equal(result.certified, 1);
            assert_true(fabs(result.e2 - result.sum_of_squares) <= 1e-14 * result.sum_of_squares);
            assert_true(result.lobe[0].weight == 0.0);
            assert_true(result.lobe[0].warnings & BRDFFIT_WARN_UNUSED);
        }
        brdffit_test_data_free(&data);
    }
}

static void test_some_negative(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_options options;
    size_t i;

    (void)state;
    spec.noise = 0.05;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < 3 * spec.count; i += 7) {
        data.values[i] = -data.values[i];
    }
    FOR_EACH_MODEL(options)
    {
        assert_int_equal(fit_and_free(&data.samples, &options).certified, 1);
    }
    brdffit_test_data_free(&data);
}

/* ---- Scales and sizes ---------------------------------------------------------------------------------- */

static void test_channels(void **state)
{
    static const size_t channels[] = {1, 2, 5, 31};
    brdffit_options options;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof channels / sizeof channels[0]; i++) {
        FOR_EACH_MODEL(options)
        {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;

            spec.channels = channels[i];
            spec.noise = 0.01;
            brdffit_test_data_new(&spec, &data);
            assert_int_equal(fit_and_free(&data.samples, &options).certified, 1);
            brdffit_test_data_free(&data);
        }
    }
}

/* Units change nothing: data in units of 1e100 or 1e-100, normalised or not, give the same roughness. */
static void test_data_scaled(void **state)
{
    static const double scale[] = {1.0, 1e100, 1e-100};
    brdffit_options options;
    size_t i, j;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        struct brdffit_test_result first[2];

        for (j = 0; j < 3; j++) {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;
            int n;

            spec.noise = 0.01;
            brdffit_test_data_new(&spec, &data);
            for (i = 0; i < spec.count * spec.channels; i++) {
                data.values[i] *= scale[j];
            }
            for (n = 0; n < 2; n++) {
                double unit = n ? scale[j] : 1.0;
                struct brdffit_test_result result;

                options.normalise = n ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
                result = fit_and_free(&data.samples, &options);
                first[n] = j ? first[n] : result;
                assert_int_equal(result.certified, 1);
                assert_true(fabs(result.model.sigma[0] / first[n].model.sigma[0] - 1.0) <= 1e-7);
                assert_true(fabs(result.rms_total / unit / first[n].rms_total - 1.0) <= 1e-12);
            }
            brdffit_test_data_free(&data);
        }
        options.normalise = BRDFFIT_NORMALISE_MAX;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_sample),         cmocka_unit_test(test_one_sample_of_each_form),
        cmocka_unit_test(test_all_c_equal),        cmocka_unit_test(test_all_directions_equal),
        cmocka_unit_test(test_a_channel_of_zeros), cmocka_unit_test(test_all_zero_and_all_negative),
        cmocka_unit_test(test_some_negative),      cmocka_unit_test(test_channels),
        cmocka_unit_test(test_data_scaled),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
