/*
 * Input at the edges of what makes sense: every fit is judged by brdffit_verify(), and what the answer must be
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
#define FOR_EACH_MODEL(options)                                                                                 \
    for (brdffit_options_init(&(options)); (options).lobes <= 2; (options).lobes++)                             \
        for ((options).distribution = BRDFFIT_BECKMANN; (options).distribution < BRDFFIT_DISTRIBUTION_COUNT;    \
             (options).distribution = (brdffit_distribution)((options).distribution + 1))

static brdffit_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    brdffit_result result;

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
        brdffit_result result = fit_and_free(&samples, &options);

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
        brdffit_result result;

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
        brdffit_result result = fit_and_free(&samples, &options);

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
            brdffit_result result = fit_and_free(&data.samples, &options);

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

/* ---- Exactly representable data ------------------------------------------------------------------------ */

#define EXACT_COUNT 120

/* c over ten decades, so that every sigma from 1e-3 to 5 has samples on its slope. */
struct exact {
    double a[EXACT_COUNT], b[EXACT_COUNT], c[EXACT_COUNT], values[3 * EXACT_COUNT];
};

static brdffit_samples exact_samples(struct exact *e, int ggx, const double *sigma, int lobes)
{
    size_t i, k;
    int p;

    for (i = 0; i < EXACT_COUNT; i++) {
        e->a[i] = 0.1 + 0.2 * (double)(i % 5) / 4.0;
        e->b[i] = 0.2 + 0.3 * (double)(i % 7) / 6.0;
        e->c[i] = i == 0 ? 0.0 : pow(10.0, -8.0 + 10.0 * (double)i / EXACT_COUNT);
        for (k = 0; k < 3; k++) {
            long double value = e->a[i] * (1.0L + (long double)k);

            for (p = 0; p < lobes; p++) {
                long double s = 1.0L / ((long double)sigma[p] * sigma[p]), t = 1.0L + e->c[i] * s;

                /* y s = 1 ... 3: peaks of the diffuse term's size */
                value += e->b[i] * (1.0L + (long double)((k + (size_t)p) % 3)) * (ggx ? 1.0L / (t * t) : expl(-e->c[i] * s));
            }
            e->values[3 * i + k] = (double)value;
        }
    }
    return brdffit_test_coefficients(EXACT_COUNT, 3, e->a, e->b, e->c, e->values);
}

static const double exact_sigma[] = {1e-3, 3e-3, 0.01, 0.05, 0.2, 0.7, 1.5, 3.0, 5.0};
#define EXACT_SIGMAS (sizeof exact_sigma / sizeof exact_sigma[0])

static void test_exact_one_lobe(void **state)
{
    struct exact e;
    brdffit_options options;
    size_t j;

    (void)state;
    for (j = 0; j < EXACT_SIGMAS; j++) {
        FOR_EACH_MODEL(options)
        {
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, exact_sigma + j, 1);
            brdffit_result result = fit_and_free(&samples, &options);

            assert_int_equal(result.certified, 1);
            assert_true(result.rms_total <= 1e-15);
            if (options.lobes == 1) { /* with two, the second is free */
                assert_true(fabs(result.model.sigma[0] / exact_sigma[j] - 1.0) <= 1e-9);
            }
        }
    }
}

static void test_exact_two_lobes(void **state)
{
    struct exact e;
    brdffit_options options;
    size_t i, j;

    (void)state;
    for (i = 0; i < EXACT_SIGMAS; i++) {
        for (j = i + 1; j < EXACT_SIGMAS; j++) {
            double sigma[2] = {exact_sigma[i], exact_sigma[j]};

            FOR_EACH_MODEL(options)
            {
                brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, 2);
                brdffit_result result;

                if (options.lobes == 1) {
                    continue;
                }
                result = fit_and_free(&samples, &options);
                assert_int_equal(result.certified, 1);
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / sigma[0] - 1.0) <= 1e-9);
                assert_true(fabs(result.model.sigma[1] / sigma[1] - 1.0) <= 1e-9);
            }
        }
    }
}

/* The same from directions: the coefficients are rounded once more there. */
static void test_exact_directions(void **state)
{
    static const double sigma[] = {0.02, 0.1, 0.4, 1.0};
    brdffit_options options;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof sigma / sizeof sigma[0]; i++) {
        FOR_EACH_MODEL(options)
        {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;
            brdffit_result result;
            int normals = i % 2 == 1;

            spec.layout = normals ? BRDFFIT_TEST_RANDOM : BRDFFIT_TEST_IN_PLANE;
            spec.count = 400;
            spec.normals = normals;
            spec.quantity = BRDFFIT_QUANTITY_BRDF;
            spec.distribution = options.distribution;
            spec.lobes = options.lobes;
            spec.sigma[0] = sigma[i];
            spec.sigma[1] = 3.0 * sigma[i];
            spec.specular[0] = 0.3 * sigma[i] * sigma[i];
            spec.specular[1] = 3.0 * sigma[i] * sigma[i];
            brdffit_test_data_new(&spec, &data);
            options.max_incidence = 90.0;
            result = fit_and_free(&data.samples, &options);
            assert_int_equal(result.certified, 1);
            assert_true(result.rms_total <= 1e-14);
            assert_true(fabs(result.model.sigma[0] / spec.sigma[0] - 1.0) <= 1e-9);
            assert_true(options.lobes == 1 || fabs(result.model.sigma[1] / spec.sigma[1] - 1.0) <= 1e-9);
            brdffit_test_data_free(&data);
        }
    }
}

/* The truth on, and beyond, the ends of the range. */
static void test_sigma_at_the_ends(void **state)
{
    struct exact e;
    brdffit_options options;
    int which;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        int ggx = options.distribution == BRDFFIT_GGX;

        for (which = 0; which < 4; which++) {
            double truth[2] = {which == 0 ? 0.05 : which == 1 ? 0.5 : which == 2 ? 0.03 : 0.8, 0.5};
            brdffit_samples samples;
            brdffit_result result;

            if (options.lobes == 2) {
                truth[0] = which < 2 ? 0.05 : 0.03;
            }
            samples = exact_samples(&e, ggx, truth, options.lobes);
            options.sigma_min = 0.05;
            options.sigma_max = 0.5;
            result = fit_and_free(&samples, &options);
            assert_int_equal(result.certified, 1);
            if (which < 2) {
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / truth[0] - 1.0) <= 1e-9);
            } else {
                double end = options.lobes == 2 || which == 2 ? options.sigma_min : options.sigma_max;

                assert_true(result.model.sigma[0] == end);
                assert_true(result.lobe[0].warnings & BRDFFIT_WARN_AT_LIMIT);
            }
        }
        options.sigma_min = 1e-12;
    }
}

/* A domain of one point. */
static void test_sigma_fixed(void **state)
{
    struct exact e;
    brdffit_options options;

    (void)state;
    FOR_EACH_MODEL(options)
    {
        static const double truth[1] = {0.2};
        brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, truth, 1);
        brdffit_result result;

        options.sigma_min = options.sigma_max = 0.3;
        result = fit_and_free(&samples, &options);
        assert_true(result.model.sigma[0] == 0.3);
        assert_true(result.gap <= 1e-3 * result.lower_bound);
        options.sigma_max = 6.0;
        options.sigma_min = 1e-12;
    }
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
        brdffit_result first[2];

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
                brdffit_result result;

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

static void test_coefficients_scaled(void **state)
{
    static const double scale[] = {1e100, 1e-100, 1.0};
    struct exact e;
    brdffit_options options;
    size_t i, ja, jb;

    (void)state;
    for (ja = 0; ja < 3; ja++) {
        for (jb = 0; jb < 3; jb++) {
            FOR_EACH_MODEL(options)
            {
                static const double sigma[2] = {0.1, 0.5};
                brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);
                brdffit_result result;

                for (i = 0; i < EXACT_COUNT; i++) {
                    e.a[i] *= scale[ja];
                    e.b[i] *= scale[jb];
                }
                result = fit_and_free(&samples, &options);
                assert_int_equal(result.certified, 1);
                assert_true(result.rms_total <= 1e-15);
                assert_true(fabs(result.model.sigma[0] / sigma[0] - 1.0) <= 1e-9);
            }
        }
    }
}

/* Columns of zeros: no diffuse term, no specular term, neither. */
static void test_zero_columns(void **state)
{
    static const double sigma[2] = {0.1, 0.5};
    brdffit_options options;
    int which;

    (void)state;
    for (which = 1; which < 4; which++) {
        FOR_EACH_MODEL(options)
        {
            struct exact e;
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);
            brdffit_result result;

            if (which & 1) {
                memset(e.a, 0, sizeof e.a);
            }
            if (which & 2) {
                memset(e.b, 0, sizeof e.b);
            }
            result = fit_and_free(&samples, &options);
            assert_int_equal(result.certified, 1);
            assert_true(which != 3 || fabs(result.e2 - result.sum_of_squares) <= 1e-14 * result.sum_of_squares);
        }
    }
}

/* Every sample's c is far from 0: a narrow lobe has no finite y, and no crash either. */
static void test_no_sample_near_the_mirror(void **state)
{
    static const double c_min[] = {0.01, 1.0, 100.0};
    struct exact e;
    brdffit_options options;
    size_t i, j;

    (void)state;
    for (j = 0; j < 3; j++) {
        FOR_EACH_MODEL(options)
        {
            static const double sigma[2] = {1.0, 4.0};
            brdffit_samples samples = exact_samples(&e, options.distribution == BRDFFIT_GGX, sigma, options.lobes);

            for (i = 0; i < EXACT_COUNT; i++) {
                e.c[i] += c_min[j];
            }
            assert_int_equal(fit_and_free(&samples, &options).certified, 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_sample),
        cmocka_unit_test(test_one_sample_of_each_form),
        cmocka_unit_test(test_all_c_equal),
        cmocka_unit_test(test_all_directions_equal),
        cmocka_unit_test(test_a_channel_of_zeros),
        cmocka_unit_test(test_all_zero_and_all_negative),
        cmocka_unit_test(test_some_negative),
        cmocka_unit_test(test_exact_one_lobe),
        cmocka_unit_test(test_exact_two_lobes),
        cmocka_unit_test(test_exact_directions),
        cmocka_unit_test(test_sigma_at_the_ends),
        cmocka_unit_test(test_sigma_fixed),
        cmocka_unit_test(test_channels),
        cmocka_unit_test(test_data_scaled),
        cmocka_unit_test(test_coefficients_scaled),
        cmocka_unit_test(test_zero_columns),
        cmocka_unit_test(test_no_sample_near_the_mirror),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
