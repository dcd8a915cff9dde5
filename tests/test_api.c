/*
 * The public calls around a fit: evaluation against the formulas of brdffit.h, the allocating fit, progress,
 * strings. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>
#include <limits.h>

#include "support.h"
#include "verify_samples.h"

/* ---- strings ------------------------------------------------------------------------------------------ */

static void test_version(void **state)
{
    char text[64];

    (void)state;
    snprintf(text, sizeof text, "%d.%d.%d", BRDFFIT_VERSION_MAJOR, BRDFFIT_VERSION_MINOR, BRDFFIT_VERSION_PATCH);
    assert_string_equal(brdffit_version(), text);
    assert_string_equal(BRDFFIT_VERSION_STRING, text);
}

typedef const char *(*name_of)(int value);

static const char *status_name(int value)
{
    return brdffit_status_string((brdffit_status)value);
}

static const char *stop_name(int value)
{
    return brdffit_stop_string((brdffit_stop)value);
}

static const char *skip_name(int value)
{
    return brdffit_skip_string((brdffit_skip)value);
}

static const char *distribution_name(int value)
{
    return brdffit_distribution_string((brdffit_distribution)value);
}

static const char *norm_name(int value)
{
    return brdffit_norm_string((brdffit_norm)value);
}

/* A name for every value, all different; and something printable for values that there are not. */
static void check_names(name_of name, int count, int snake_case)
{
    static const int strange[] = {-1, -2, INT_MIN, INT_MAX, 1000};
    int i, j;

    for (i = 0; i < count; i++) {
        const char *text = name(i);

        assert_non_null(text);
        assert_true(strlen(text) >= 2);
        assert_true(!snake_case || strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(text));
        assert_string_not_equal(text, name(count));
        for (j = 0; j < i; j++) {
            assert_string_not_equal(text, name(j));
        }
    }
    for (i = 0; i < 5; i++) {
        assert_non_null(name(strange[i]));
        assert_string_equal(name(strange[i]), name(count));
    }
}

static void test_names(void **state)
{
    (void)state;
    check_names(status_name, BRDFFIT_STATUS_COUNT, 0);
    check_names(stop_name, BRDFFIT_STOP_COUNT, 1);
    check_names(skip_name, BRDFFIT_SKIP_COUNT, 1);
    check_names(distribution_name, BRDFFIT_DISTRIBUTION_COUNT, 0);
    check_names(norm_name, BRDFFIT_NORM_COUNT, 1);
    assert_string_equal(brdffit_stop_string(BRDFFIT_STOP_RELATIVE_GAP), "relative_gap");
    assert_string_equal(brdffit_skip_string(BRDFFIT_SKIP_LIGHT_BELOW_HORIZON), "light_below_horizon");
    assert_string_equal(brdffit_distribution_string(BRDFFIT_GGX), "ggx");
    assert_string_equal(brdffit_norm_string(BRDFFIT_NORM_L2), "l2");
    assert_string_equal(brdffit_status_string(BRDFFIT_ERR_NO_SAMPLES), "no samples are left to fit");
}

/* ---- evaluation --------------------------------------------------------------------------------------- */

static long double lobe(brdffit_distribution distribution, long double c, double sigma)
{
    long double s = 1.0L / ((long double)sigma * sigma);

    return distribution == BRDFFIT_GGX ? s / ((1.0L + c * s) * (1.0L + c * s)) : s * expl(-c * s);
}

/* sum_p y_p b g_p + a x of one channel, in long double from the sample; *allowed: what rounding may do. */
static long double model_at(const struct brdffit_test_model *m, const struct verify_sample *at, size_t k,
                            long double *allowed)
{
    long double value = at->a * m->x[k];
    int p;

    *allowed = at->error_a * value;
    for (p = 0; p < m->lobes; p++) {
        long double s = 1.0L / ((long double)m->sigma[p] * m->sigma[p]);
        long double part = m->y[k * (size_t)m->lobes + (size_t)p] * at->b * lobe(m->distribution, at->c, m->sigma[p]);

        value += part;
        *allowed += part * (at->error_b + s * at->error_c * 2.0L + 8.0L * VERIFY_UNIT * (1.0L + at->c * s));
        /* A c off by error_c from c = 0 moves the exponent by more than its relative error says. */
        *allowed += part * expm1l(fminl(s * at->error_c, 50.0L));
    }
    return value;
}

static void check_eval(const struct brdffit_test_model *model, const brdffit_samples *at)
{
    double out[64 * 2];
    size_t i, k;

    assert_true(at->count <= 64 && model->channels == 2);
    assert_int_equal(brdffit_test_eval(model, at, out, NULL), BRDFFIT_OK);
    for (i = 0; i < at->count; i++) {
        struct verify_sample sample;
        brdffit_skip skip = verify_sample(at, 90.0, i, &sample);

        for (k = 0; k < 2; k++) {
            double got = out[2 * i + k];
            long double allowed = 0.0L, exact = 0.0L;

            if (skip == BRDFFIT_SKIP_COUNT) {
                exact = model_at(model, &sample, k, &allowed) / sample.to_radiance;
                allowed = allowed / sample.to_radiance + sample.error_radiance * exact;
            }
            if (!(fabsl(got - exact) <= allowed + 4.0L * VERIFY_UNIT * exact)) {
                fail_msg("sample %zu channel %zu: %.17g, exactly %.17Lg", i, k, got, exact);
            }
        }
    }
}

/* Every form, both quantities, both distributions, one and two lobes; a fifth of the directions below the horizon. */
static void test_eval_formula(void **state)
{
    struct brdffit_test_random random = {1};
    int i;
    size_t j;

    (void)state;
    for (i = 0; i < 400; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        struct brdffit_test_data data;
        double x[2], y[4];
        struct brdffit_test_model model = {
            i & 1 ? BRDFFIT_GGX : BRDFFIT_BECKMANN, 1 + (i >> 1 & 1), 2, {0.0, 0.0}, x, y, NULL};

        spec.seed = (uint64_t)i + 1;
        spec.count = 64;
        spec.layout = BRDFFIT_TEST_RANDOM;
        spec.form = (brdffit_form)(i % 3);
        spec.quantity = i % 3 < 2 && i & 4 ? BRDFFIT_QUANTITY_BRDF : BRDFFIT_QUANTITY_RADIANCE;
        spec.normals = i & 8;
        brdffit_test_data_new(&spec, &data);
        for (j = 0; j < 4; j++) {
            x[j / 2] = brdffit_test_uniform(&random, 0.0, 1.0);
            y[j] = brdffit_test_log_uniform(&random, 1e-6, 1.0);
            model.sigma[j / 2] = brdffit_test_log_uniform(&random, 0.01, 6.0);
        }
        data.samples.channels = 77; /* ignored */
        data.samples.values = NULL;
        if (spec.form == BRDFFIT_FORM_DIRECTIONS) {
            double *light = data.block;

            for (j = 0; j < 3 * 64; j++) {
                light[j] *= j / 3 % 5 ? 1.0 : -1.0;
            }
        }
        check_eval(&model, &data.samples);
        brdffit_test_data_free(&data);
    }
}

/* ---- allocation and progress -------------------------------------------------------------------------- */

static void test_fit_new_is_fit(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct brdffit_test_fit fit;
    const brdffit_result *result = NULL;

    (void)state;
    spec.noise = 0.02;
    brdffit_test_data_new(&spec, &data);
    brdffit_test_fit(&data.samples, NULL, &fit);
    assert_int_equal(brdffit_fit_new(&data.samples, NULL, &result, NULL), BRDFFIT_OK);
    assert_true(result->e2 == fit.result.e2 && result->lower_bound == fit.result.lower_bound);
    assert_true(result->model->sigma[0] == fit.result.model.sigma[0]);
    assert_memory_equal(result->model->x, fit.result.model.x, 3 * sizeof(double));
    assert_memory_equal(result->model->y, fit.result.model.y, 3 * sizeof(double));
    assert_memory_equal(result->rms, fit.result.rms, 3 * sizeof(double));
    brdffit_result_free(result);
    brdffit_result_free(NULL);
    data.values[5] = INFINITY;
    assert_int_equal(brdffit_fit_new(&data.samples, NULL, &result, NULL), BRDFFIT_ERR_VALUE);
    assert_null(result);
    brdffit_test_fit_free(&fit);
    brdffit_test_data_free(&data);
}

struct watch {
    int calls, stop_at;
    brdffit_progress last;
};

static int watch_progress(void *user, const brdffit_progress *p)
{
    struct watch *w = user;

    assert_int_equal(p->phase, w->calls ? BRDFFIT_PHASE_SEARCH : BRDFFIT_PHASE_REDUCED);
    assert_int_equal(p->boxes, 256 * w->calls);
    assert_true(p->lower_bound >= 0.0 && p->lower_bound <= p->e2);
    assert_true(w->calls == 0 || (p->e2 <= w->last.e2 && p->lower_bound >= w->last.lower_bound));
    w->last = *p;
    return ++w->calls == w->stop_at;
}

static void test_progress(void **state)
{
    int normalise, stop_at;

    (void)state;
    for (normalise = 0; normalise < 2; normalise++) {
        for (stop_at = 0; stop_at < 3; stop_at++) {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;
            struct brdffit_test_fit fit;
            struct watch w = {0, stop_at, {BRDFFIT_PHASE_REDUCED, 0, 0.0, 0.0}};
            brdffit_options options;

            spec.noise = 0.03;
            spec.distribution = BRDFFIT_GGX;
            brdffit_test_data_new(&spec, &data);
            brdffit_options_init(&options);
            options.lobes = 2;
            options.relative_gap = 1e-6;
            options.normalise = normalise ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
            options.progress = watch_progress;
            options.progress_user = &w;
            brdffit_test_fit(&data.samples, &options, &fit);
            assert_int_equal(w.calls, stop_at ? stop_at : (int)(1 + fit.result.boxes / 256));
            assert_int_equal(fit.result.stop == BRDFFIT_STOP_CANCELLED, stop_at != 0);
            assert_true(w.calls == 1 || w.last.e2 >= fit.result.e2 * (1.0 - 1e-12));
            assert_true(w.last.lower_bound <= fit.result.lower_bound * (1.0 + 1e-12));
            brdffit_test_fit_free(&fit);
            brdffit_test_data_free(&data);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_version),        cmocka_unit_test(test_names),    cmocka_unit_test(test_eval_formula),
        cmocka_unit_test(test_fit_new_is_fit), cmocka_unit_test(test_progress),
    };

    return cmocka_run_group_tests_name("api", tests, NULL, NULL);
}
