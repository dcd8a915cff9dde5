/*
 * Every distribution of brdffit.h: its row of geometry and its lambda against textbook formulas on vectors, its own
 * truth recovered, its parameter and range. Every fit is judged by brdffit_test_verify(). SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "distribution_scene.h"
#include "model/geometry.h"
#include "base/atan.h"
#include "base/log1p.h"
#include "support.h"

#define UNIT 1.1102230246251565e-16L

#define FOR_EACH(distribution)                                                                                         \
    for ((distribution) = BRDFFIT_BECKMANN; (distribution) < BRDFFIT_DISTRIBUTION_COUNT;                               \
         (distribution) = (brdffit_distribution)((distribution) + 1))

/* ---- kernels ------------------------------------------------------------------------------------------ */

static long double error_in_ulp(double value, long double truth)
{
    int exponent;

    (void)frexpl(truth, &exponent);
    return fabsl(value - truth) / ldexpl(1.0L, exponent - 53);
}

static void check_kernels(double x)
{
    if (!(error_in_ulp(kernel_log1p(x), log1pl(x)) < 3.5L)) {
        fail_msg("kernel_log1p(%a) = %a", x, kernel_log1p(x));
    }
    if (x < 1.0 && !(error_in_ulp(kernel_log1p(-x), log1pl(-x)) < 3.5L)) {
        fail_msg("kernel_log1p(%a) = %a", -x, kernel_log1p(-x));
    }
    if (!(error_in_ulp(kernel_atan(x), atanl(x)) < 2.0L)) {
        fail_msg("kernel_atan(%a) = %a", x, kernel_atan(x));
    }
}

static void test_kernels(void **state)
{
    /* clang-format off */
    static const double edge[] = {0x1p-1022, 1e-20,  0x1p-54, 0x1p-53, 0x1p-52,
                                  0x1.8p-52, 0.4375, 0.6875,  1.0,     1.1875,
                                  2.4375,    0x1p53, 1e100,   0.41421356237309503, 0.29289321881345254};
    /* clang-format on */
    struct brdffit_test_random random = {3};
    size_t i;
    int k;

    (void)state;
    for (i = 0; i < 300000; i++) {
        check_kernels(brdffit_test_log_uniform(&random, 1e-20, 1e100));
        check_kernels(brdffit_test_log_uniform(&random, 1e-3, 10.0));
        check_kernels(brdffit_test_uniform(&random, 0.0, 3.0));
    }
    for (i = 0; i < sizeof edge / sizeof edge[0]; i++) {
        double x = edge[i];

        for (k = 0; k < 8; k++, x = nextafter(x, INFINITY)) {
            check_kernels(x);
        }
        check_kernels(nextafter(edge[i], 0.0) > 0.0 ? nextafter(edge[i], 0.0) : edge[i]);
    }
    assert_true(kernel_log1p(0.0) == 0.0 && kernel_atan(0.0) == 0.0);
    assert_true(kernel_atan(INFINITY) == 1.5707963267948966);
}

/* ---- recovery ----------------------------------------------------------------------------------------- */

static double found(const struct brdffit_test_result *result, int lobe)
{
    return by_exponent(result->model.distribution) ? result->lobe[lobe].exponent : result->lobe[lobe].sigma;
}

static void check_recovery(struct scene *s, brdffit_form form, const brdffit_options *options, const double *truth)
{
    brdffit_samples samples = scene_samples(s, form);
    struct brdffit_test_fit fit;
    const struct brdffit_test_result *r = &fit.result;
    int p;

    brdffit_test_fit(&samples, options, &fit);
    assert_int_equal(r->certified, 1);
    for (p = 0; p < options->lobes; p++) {
        long double y = coefficient(options->distribution, truth[p], p);

        if (!(fabs(found(r, p) / truth[p] - 1.0) <= 1e-9)) {
            fail_msg("%s, form %d, lobe %d of %d: %.17g, not %.17g", brdffit_distribution_string(options->distribution),
                     (int)form, p, options->lobes, found(r, p), truth[p]);
        }
        assert_true(fabsl(r->model.y[p] / y - 1.0L) <= 1e-8L);
        assert_true(fabsl(r->model.y[options->lobes + p] / (3.0L * y) - 1.0L) <= 1e-8L);
        assert_true(r->lobe[p].warnings == 0);
    }
    assert_true(fabs(r->model.x[0] / 0.3 - 1.0) <= 1e-8 && fabs(r->model.x[1] / 0.3 - 1.0) <= 1e-8);
    assert_true(r->rms_total <= 1e-12);
    brdffit_test_fit_free(&fit);
}

/* From directions and from the same directions' angles; broad lobes and ones of a tenth of a degree. */
static void test_recovery(void **state)
{
    static const double sigma[][2] = {{0.002, 0.1}, {0.02, 0.3}, {0.1, 0.4}, {0.01, 0.7}};
    static const double exponent[][2] = {{250000.0, 20.0}, {2500.0, 12.0}, {200.0, 5.0}, {9000.5, 3.3}};
    struct scene *s = malloc(sizeof *s);
    brdffit_options options;
    size_t i;
    int form;

    (void)state;
    assert_non_null(s);
    scene_new(s);
    assert_true(s->count > 200);
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        options.max_incidence = 90.0;
        FOR_EACH(options.distribution)
        {
            scene_new(s);
            if (options.distribution == BRDFFIT_RETRO) {
                scene_mirror(s);
            }
            for (i = 0; i < 4; i++) {
                const double *truth = by_exponent(options.distribution) ? exponent[i] : sigma[i];

                scene_values(s, options.distribution, truth, options.lobes);
                /* v.h as a double tells |l - v|^2 to 1e-16 only: narrow retro lobes need directions. */
                int last = options.distribution == BRDFFIT_RETRO ? BRDFFIT_FORM_DIRECTIONS : BRDFFIT_FORM_ANGLES;

                for (form = BRDFFIT_FORM_DIRECTIONS; form <= last; form++) {
                    check_recovery(s, (brdffit_form)form, &options, truth);
                }
                if (options.lobes == 1) { /* the second of the pair on its own */
                    scene_values(s, options.distribution, truth + 1, 1);
                    check_recovery(s, BRDFFIT_FORM_DIRECTIONS, &options, truth + 1);
                }
            }
        }
    }
    free(s);
}

/* Noise, weights, f_r, every layout: the judge's attacks on the bound for every distribution. */
static void test_noisy(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options;
    int i;

    (void)state;
    brdffit_options_init(&options);
    FOR_EACH(options.distribution)
    {
        for (i = 0; i < 12; i++) {
            struct brdffit_test_data data;
            struct brdffit_test_fit fit;

            spec.seed = (uint64_t)i + 100;
            spec.layout = (enum brdffit_test_layout)(i % 3);
            spec.form = (brdffit_form)(i / 3 % 3);
            spec.quantity = BRDFFIT_QUANTITY_RADIANCE;
            if (spec.form != BRDFFIT_FORM_COEFFICIENTS && i % 2) {
                spec.quantity = BRDFFIT_QUANTITY_BRDF;
            }
            spec.distribution = options.distribution;
            spec.noise = i % 4 ? 0.02 : 0.0;
            spec.weighted = i % 5 == 2;
            options.lobes = 1 + i % 2;
            brdffit_test_data_new(&spec, &data);
            brdffit_test_fit(&data.samples, &options, &fit);
            assert_int_equal(fit.result.certified, 1);
            brdffit_test_fit_free(&fit);
            brdffit_test_data_free(&data);
        }
    }
}

/* ---- evaluation --------------------------------------------------------------------------------------- */

static void test_eval(void **state)
{
    struct brdffit_test_random random = {11};
    brdffit_distribution distribution;
    int i, j, zero = 0;

    (void)state;
    FOR_EACH(distribution)
    {
        for (i = 0; i < 2000; i++) {
            double light[3], view[3], x = 0.2, y = 1.5, out, parameter = brdffit_test_log_uniform(&random, 0.03, 3.0);
            struct brdffit_test_model model = {distribution, 1, 1, {parameter, 0.0}, &x, &y, NULL};
            brdffit_samples at;
            long double lobe, exact, length;

            brdffit_samples_init(&at);
            at.count = 1;
            at.light = light;
            at.view = view;
            at.quantity = i % 2 ? BRDFFIT_QUANTITY_RADIANCE : BRDFFIT_QUANTITY_BRDF;
            for (j = 0; j < 3; j++) {
                light[j] = brdffit_test_uniform(&random, j == 2 ? 0.1 : -1.0, 1.0);
                view[j] = brdffit_test_uniform(&random, j == 2 ? 0.1 : -1.0, 1.0);
            }
            lobe = textbook(distribution, light, view,
                            by_exponent(distribution) ? 1.0L / ((long double)parameter * parameter) : parameter);
            length = hypotl(hypotl(light[0], light[1]), light[2]);
            exact = 0.2L * light[2] / length / PI + 1.5L * lobe;
            zero += lobe == 0.0L;
            exact /= i % 2 ? 1.0L : light[2] / length;
            assert_int_equal(brdffit_test_eval(&model, &at, &out, NULL), BRDFFIT_OK);
            if (!(fabsl(out - exact) <= 1e-12L * exact)) {
                fail_msg("%s: %.17g, exactly %.17Lg", brdffit_distribution_string(distribution), out, exact);
            }
        }
    }
    assert_true(zero > 100); /* Lafortune's lobe beyond 90 degrees of the mirror direction */
}

/* ---- near the mirror ---------------------------------------------------------------------------------- */

/* c of a sample of form ANGLES. */
static double c_at(brdffit_distribution distribution, double cosine, double tan2)
{
    double one = 1.0, value = 1.0;
    brdffit_samples s;
    struct geometry g;
    brdffit_status status;

    brdffit_samples_init(&s);
    s.count = s.channels = 1;
    s.form = BRDFFIT_FORM_ANGLES;
    s.cos_light = s.cos_view = &cosine;
    s.tan2_half = &tan2;
    s.cos_difference = &one;
    s.values = &value;
    assert_int_equal(brdffit_geometry_sample(&s, distribution, 0.0, 0, &g, &status, NULL), BRDFFIT_SKIP_COUNT);
    assert_int_equal(status, BRDFFIT_OK);
    return g.c;
}

/* Every digit of c, however near: -ln(cos alpha) from a cosine would be 0 below 1e-8. */
static void test_mirror(void **state)
{
    double tan2;

    (void)state;
    for (tan2 = 1e-40; tan2 < 1e30; tan2 *= 7.3) {
        long double alpha = atanl(sqrtl(tan2)), half = 0.5L * log1pl(tan2), off = 2.0L * tan2 * 0.0625L;

        assert_true(c_at(BRDFFIT_BECKMANN, 0.5, tan2) == tan2 && c_at(BRDFFIT_WARD, 0.5, tan2) == tan2);
        assert_true(fabsl(c_at(BRDFFIT_TORRANCE_SPARROW, 0.5, tan2) - alpha * alpha) <= 8.0L * UNIT * alpha * alpha);
        assert_true(fabsl(c_at(BRDFFIT_BLINN_PHONG, 0.5, tan2) - half) <= 8.0L * UNIT * half);
        assert_true(c_at(BRDFFIT_ASHIKHMIN_SHIRLEY, 0.5, tan2) == c_at(BRDFFIT_BLINN_PHONG, 0.5, tan2));
        if (off < 0.9L) { /* both cosines 1/4 */
            assert_true(fabsl(c_at(BRDFFIT_LAFORTUNE, 0.25, tan2) + log1pl(-off)) <= 8.0L * UNIT * -log1pl(-off));
        }
    }
    assert_true(c_at(BRDFFIT_LAFORTUNE, 0.5, 0.0) == 0.0 && c_at(BRDFFIT_BLINN_PHONG, 0.5, 0.0) == 0.0);
}

/* ---- the parameter and its range ---------------------------------------------------------------------- */

static void test_names(void **state)
{
    brdffit_distribution d;

    (void)state;
    FOR_EACH(d)
    {
        assert_string_equal(brdffit_parameter_string(d), by_exponent(d) ? "exponent" : "sigma");
    }
    assert_string_equal(brdffit_parameter_string(BRDFFIT_DISTRIBUTION_COUNT), "unknown");
    assert_string_equal(brdffit_parameter_string((brdffit_distribution)-1), "unknown");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_TORRANCE_SPARROW), "torrance-sparrow");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_WARD), "ward");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_BLINN_PHONG), "blinn-phong");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_ASHIKHMIN_SHIRLEY), "ashikhmin-shirley");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_LAFORTUNE), "lafortune");
    assert_int_equal(BRDFFIT_GGX, 1);
}

static void test_range_checked(void **state)
{
    static const double bad[][2] = {{0.0, 1e7},      {-1.0, 1e7}, {NAN, 1e7},  {0.1, NAN},    {INFINITY, INFINITY},
                                    {0.1, INFINITY}, {5.0, 4.0},  {9e-7, 1.0}, {0.1, 1.1e24}, {1.1e24, 1.2e24}};
    brdffit_options options;
    brdffit_error error;
    double value = 1.0, c = 0.0;
    brdffit_samples samples = brdffit_test_coefficients(1, 1, &value, &value, &c, &value);
    size_t i;

    (void)state;
    brdffit_options_init(&options);
    assert_true(options.exponent_min == 0.1 && options.exponent_max == 1e7);
    for (i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        options.exponent_min = bad[i][0];
        options.exponent_max = bad[i][1];
        assert_int_equal(brdffit_workspace_size(1, 1, &options), 0);
        error = brdffit_test_fit_fails(&samples, &options, BRDFFIT_ERR_OPTION);
        assert_non_null(strstr(error.message, "exponent_m"));
    }
    options.exponent_min = 1e-6;
    options.exponent_max = 1e24;
    assert_true(brdffit_workspace_size(1, 1, &options) > 0);
}

/* An optimum beyond an end sits on it exactly, and says so; a fixed exponent is that exponent. */
static void test_ends(void **state)
{
    static const double range[][2] = {{30.0, 77.7}, {1000.0, 3.3e6}, {314.0, 314.0}};
    static const double expected[] = {77.7, 1000.0, 314.0}, truth[] = {300.0};
    struct scene *s = malloc(sizeof *s);
    brdffit_options options;
    size_t i;

    (void)state;
    assert_non_null(s);
    scene_new(s);
    brdffit_options_init(&options);
    options.max_incidence = 90.0;
    for (options.distribution = BRDFFIT_BECKMANN; options.distribution < BRDFFIT_DISTRIBUTION_COUNT;
         options.distribution = (brdffit_distribution)(options.distribution + 1)) {
        if (!by_exponent(options.distribution)) {
            continue;
        }
        scene_values(s, options.distribution, truth, 1);
        for (i = 0; i < 3; i++) {
            brdffit_samples samples = scene_samples(s, BRDFFIT_FORM_ANGLES);
            struct brdffit_test_fit fit;

            options.exponent_min = range[i][0];
            options.exponent_max = range[i][1];
            brdffit_test_fit(&samples, &options, &fit);
            assert_true(fit.result.lobe[0].exponent == expected[i]);
            assert_true(fit.result.lobe[0].warnings & (BRDFFIT_WARN_AT_LIMIT | BRDFFIT_WARN_FLAT));
            assert_true(fit.result.model.sigma[0] == 1.0 / sqrt(expected[i]));
            brdffit_test_fit_free(&fit);
        }
    }
    free(s);
}

/*
 * A lobe that only one sample can see: any exponent from some on fits as well. The smallest is reported, the
 * interval ends at exponent_max, and y is finite although c_min n reaches hundreds.
 */
static void test_flat(void **state)
{
    static const double a[] = {0.1, 0.2, 0.3, 0.2}, b[] = {0.5, 0.4, 0.5, 0.3}, c[] = {0.01, 0.5, 0.9, 1.4};
    static const double values[] = {1.1, 0.2, 0.3, 0.2};
    brdffit_samples samples = brdffit_test_coefficients(4, 1, a, b, c, values);
    brdffit_options options;

    (void)state;
    brdffit_options_init(&options);
    options.exponent_max = 1e24;
    FOR_EACH(options.distribution)
    {
        struct brdffit_test_fit fit;
        const brdffit_lobe *lobe = &fit.result.lobe[0];

        brdffit_test_fit(&samples, &options, &fit);
        assert_int_equal(fit.result.certified, 1);
        if (options.distribution != BRDFFIT_GGX) {
            assert_true(lobe->warnings & BRDFFIT_WARN_FLAT);
            assert_true(fit.result.rms_total < 1e-12);
            assert_true(lobe->effective_samples < 1.001);
        }
        if (by_exponent(options.distribution)) {
            assert_true(lobe->exponent == lobe->exponent_low && lobe->exponent > 20.0 && lobe->exponent < 200.0);
            assert_true(lobe->exponent_high > 60000.0);
        }
        brdffit_test_fit_free(&fit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernels), cmocka_unit_test(test_names), cmocka_unit_test(test_range_checked),
        cmocka_unit_test(test_mirror),  cmocka_unit_test(test_eval),  cmocka_unit_test(test_recovery),
        cmocka_unit_test(test_noisy),   cmocka_unit_test(test_ends),  cmocka_unit_test(test_flat),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
