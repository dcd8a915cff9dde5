/*
 * Weights of samples: the solid angles against integrals that are known, and every choice at its edges. tests/test_weights.py
 * has the same shares from a program of its own. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "brdffit.h"

#define PI 3.14159265358979323846
#define MOST 6000

static double light[3 * MOST], view[3 * MOST], values[2 * MOST], given[MOST], out[MOST];

static brdffit_samples samples_of(size_t count)
{
    brdffit_samples s;

    brdffit_samples_init(&s);
    s.count = count;
    s.channels = 1;
    s.light = light;
    s.view = view;
    s.values = values;
    return s;
}

/* In exactly as many bytes as asked for, at an odd address. */
static brdffit_status weigh(const brdffit_samples *s, brdffit_weighting weighting, double floor, brdffit_error *error)
{
    const size_t size = brdffit_weights_size(s->count, s->channels, weighting);
    unsigned char *memory = malloc(size + 1);
    brdffit_status status;

    assert_non_null(memory);
    status = brdffit_weights(s, weighting, floor, size ? memory + 1 : NULL, size, out, error);
    free(memory);
    return status;
}

/* ---- Where samples lie --------------------------------------------------- */

static uint64_t state = 1;

static double uniform(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static void direction(double *d, double cosine, double azimuth)
{
    const double sine = sqrt((1 - cosine) * (1 + cosine));

    d[0] = sine * cos(azimuth);
    d[1] = sine * sin(azimuth);
    d[2] = cosine;
}

static void draw_uniform(size_t i)
{
    direction(light + 3 * i, 1 - uniform(), 2 * PI * uniform());
    direction(view + 3 * i, 1 - uniform(), 2 * PI * uniform());
}

/* The mirror direction's surroundings: half vectors drawn from Beckmann's distribution. */
static void draw_crowded(size_t i, double sigma)
{
    double h[3], scale;
    int d;

    do {
        const double tangent = sigma * sqrt(-log(1 - uniform()));

        direction(light + 3 * i, 1 - uniform(), 2 * PI * uniform());
        direction(h, 1 / sqrt(1 + tangent * tangent), 2 * PI * uniform());
        scale = 2 * (h[0] * light[3 * i] + h[1] * light[3 * i + 1] + h[2] * light[3 * i + 2]);
        for (d = 0; d < 3; d++) {
            view[3 * i + (size_t)d] = scale * h[d] - light[3 * i + (size_t)d];
        }
    } while (!(view[3 * i + 2] > 0));
}

/* ---- Integrals ----------------------------------------------------------- */

enum { COSINE, PRODUCT, MIRROR, LOBE, FUNCTIONS };

static void integrands(size_t i, double f[FUNCTIONS])
{
    const double *l = light + 3 * i, *v = view + 3 * i;
    const double dot = l[0] * v[0] + l[1] * v[1] + l[2] * v[2];
    const double half = (l[2] + v[2]) * (l[2] + v[2]) / (2 + 2 * dot);

    f[COSINE] = l[2];
    f[PRODUCT] = l[2] * v[2];
    f[MIRROR] = dot * dot;
    f[LOBE] = exp(-(1 / half - 1) / 0.09);
}

/* Averages over all pairs of directions; the first three are exact, LOBE's is that of 4e6 points of a product rule. */
static void averages(double f[FUNCTIONS])
{
    enum { STEPS = 160 };
    int a, b, c;

    f[COSINE] = 0.5;
    f[PRODUCT] = 0.25;
    f[MIRROR] = 1.0 / 3;
    f[LOBE] = 0;
    for (a = 0; a < STEPS; a++) {
        for (b = 0; b < STEPS; b++) {
            for (c = 0; c < STEPS; c++) {
                double g[FUNCTIONS];

                direction(light, (a + 0.5) / STEPS, 0);
                direction(view, (b + 0.5) / STEPS, PI * (c + 0.5) / STEPS);
                integrands(0, g);
                f[LOBE] += g[LOBE] / ((double)STEPS * STEPS * STEPS);
            }
        }
    }
}

static void quadrature(size_t count, const double *weights, double f[FUNCTIONS])
{
    double sum = 0;
    size_t i;
    int k;

    for (k = 0; k < FUNCTIONS; k++) {
        f[k] = 0;
    }
    for (i = 0; i < count; i++) {
        double g[FUNCTIONS];

        integrands(i, g);
        for (k = 0; k < FUNCTIONS; k++) {
            f[k] += weights[i] * g[k];
        }
        sum += weights[i];
    }
    for (k = 0; k < FUNCTIONS; k++) {
        f[k] /= sum;
    }
}

static void check_quadrature(size_t count, const double limit[FUNCTIONS])
{
    const brdffit_samples s = samples_of(count);
    double exact[FUNCTIONS], found[FUNCTIONS], sum = 0;
    size_t i;
    int k;

    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    quadrature(count, out, found);
    for (i = 0; i < count; i++) {
        assert_true(out[i] > 0);
        sum += out[i];
    }
    assert_true(fabs(sum / (double)count - 1) < 1e-12); /* N roundings of numbers below N */
    averages(exact);
    for (k = 0; k < FUNCTIONS; k++) {
        if (!(fabs(found[k] / exact[k] - 1) <= limit[k])) {
            fail_msg("integral %d of %zu samples: %.17g instead of %.17g", k, count, found[k], exact[k]);
        }
    }
}

/* brdffit.h and docs/files.md say these figures. */
static void test_quadrature_uniform(void **unused)
{
    static const double limit[FUNCTIONS] = {0.01, 0.01, 0.01, 0.02};
    size_t i;

    (void)unused;
    for (i = 0; i < 5000; i++) {
        draw_uniform(i);
    }
    check_quadrature(5000, limit);
}

static void test_quadrature_crowded(void **unused)
{
    static const double limit[FUNCTIONS] = {0.02, 0.03, 0.03, 0.3};
    double ones[MOST], found[FUNCTIONS], exact[FUNCTIONS];
    size_t i;

    (void)unused;
    for (i = 0; i < 5000; i++) {
        ones[i] = 1;
        if (i % 10) {
            draw_crowded(i, 0.1);
        } else {
            draw_uniform(i);
        }
    }
    quadrature(5000, ones, found);
    check_quadrature(5000, limit);
    averages(exact);
    assert_true(found[LOBE] > 10 * exact[LOBE]); /* what it is without weights */
}

/* ---- Sets whose shares are known ------------------------------------------ */

/* Scans of a few lights: the bands between them, times the rings between views. */
static void test_scans(void **unused)
{
    enum { LIGHTS = 3, VIEWS = 40 };
    static const double tilt[LIGHTS] = {0.1, 0.7, 1.2};
    const brdffit_samples s = samples_of(LIGHTS * VIEWS);
    double band[LIGHTS], low[LIGHTS + 1] = {0}, ring[VIEWS + 1] = {0};
    size_t i, j;

    (void)unused;
    for (i = 0; i < LIGHTS; i++) {
        for (j = 0; j < VIEWS; j++) {
            direction(light + 3 * (i * VIEWS + j), cos(tilt[i]), 2);
            direction(view + 3 * (i * VIEWS + j), cos(0.03 * (double)j + 0.01), 2);
        }
    }
    low[LIGHTS] = ring[VIEWS] = 1;
    for (i = 1; i < LIGHTS; i++) {
        low[i] = pow(0.5 * (sqrt(1 - cos(tilt[i - 1])) + sqrt(1 - cos(tilt[i]))), 2);
    }
    for (j = 1; j < VIEWS; j++) {
        ring[j] = pow(0.5 * (sqrt(1 - cos(0.03 * (double)j - 0.02)) + sqrt(1 - cos(0.03 * (double)j + 0.01))), 2);
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    for (i = 0; i < LIGHTS; i++) {
        band[i] = low[i + 1] - low[i];
        for (j = 0; j < VIEWS; j++) {
            const double share = LIGHTS * VIEWS * band[i] * (ring[j + 1] - ring[j]);

            /* Places are known to 1e-8 radians (half the digits of 1 - cos), rings are 0.03 wide and no narrower. */
            assert_true(fabs(out[i * VIEWS + j] / share - 1) < 1e-6);
        }
    }
}

static void test_few(void **unused)
{
    size_t count, i;

    (void)unused;
    for (count = 1; count <= 3; count++) {
        brdffit_samples s = samples_of(count);

        for (i = 0; i < count; i++) {
            draw_uniform(0);
            memcpy(light + 3 * i, light, 3 * sizeof *light);
            memcpy(view + 3 * i, view, 3 * sizeof *view);
        }
        assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
        for (i = 1; i < count; i++) {
            out[0] += out[i];
        }
        assert_true(fabs(out[0] - (double)count) < 1e-14);
    }
}

/* Equal directions share one piece, whichever way they were turned or mirrored; thousands of them take no time squared. */
static void test_duplicates(void **unused)
{
    enum { COUNT = 5000 };
    const brdffit_samples s = samples_of(COUNT);
    size_t i;

    (void)unused;
    for (i = 0; i < COUNT; i++) {
        const double turn = 0.1 * (double)i, side = i % 2 ? 1 : -1;

        direction(light + 3 * i, 0.8, turn);
        direction(view + 3 * i, i < COUNT / 2 ? 0.6 : 0.3, turn + side * 2);
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    for (i = 0; i < COUNT; i++) {
        const double cut = 0.25 * pow(sqrt(0.4) + sqrt(0.7), 2), share = i < COUNT / 2 ? cut : 1 - cut;

        assert_true(fabs(out[i] - 2 * share) < 1e-6);
    }
}

static void test_normal_incidence(void **unused)
{
    enum { COUNT = 300 };
    const brdffit_samples s = samples_of(COUNT);
    size_t i;

    (void)unused;
    for (i = 0; i < COUNT; i++) { /* light along the normal: the azimuth means nothing */
        direction(light + 3 * i, 1, 0);
        direction(view + 3 * i, (double)(i / 100 + 1) / 4, 0.7 * (double)i);
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    for (i = 0; i < COUNT; i++) {
        assert_true(fabs(out[i] - out[i / 100 * 100]) < 1e-12 * out[i]);
    }
}

/* A sample that is left out is as good as not there. */
static void test_left_out(void **unused)
{
    enum { COUNT = 400 };
    brdffit_samples s = samples_of(COUNT);
    double expected[COUNT];
    size_t i;

    (void)unused;
    for (i = 0; i < COUNT; i++) {
        draw_uniform(i);
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    memcpy(expected, out, sizeof expected);
    s.count = COUNT + 20;
    s.weights = given;
    for (i = 0; i < s.count; i++) {
        given[i] = i < COUNT + 10 ? 1 : 0;
        if (i >= COUNT) {
            draw_uniform(i);
            view[3 * i + 2] *= -1;
        }
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    assert_memory_equal(out, expected, sizeof expected);
    for (i = COUNT; i < s.count; i++) {
        assert_true(out[i] == given[i]);
    }
}

static void test_angles_agree(void **unused)
{
    enum { COUNT = 500 };
    static double cosines[4][COUNT], expected[COUNT];
    brdffit_samples s = samples_of(COUNT);
    size_t i;

    (void)unused;
    for (i = 0; i < COUNT; i++) {
        const double *l = light + 3 * i, *v = view + 3 * i;
        double half;

        draw_uniform(i);
        cosines[3][i] = sqrt((1 + l[0] * v[0] + l[1] * v[1] + l[2] * v[2]) / 2);
        half = (l[2] + v[2]) / (2 * cosines[3][i]);
        cosines[0][i] = l[2];
        cosines[1][i] = v[2];
        cosines[2][i] = 1 / (half * half) - 1;
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    memcpy(expected, out, sizeof expected);
    s.form = BRDFFIT_FORM_ANGLES;
    s.cos_light = cosines[0];
    s.cos_view = cosines[1];
    s.tan2_half = cosines[2];
    s.cos_difference = cosines[3];
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL), BRDFFIT_OK);
    for (i = 0; i < COUNT; i++) {
        assert_true(fabs(out[i] - expected[i]) < 1e-6 * expected[i]);
    }
}

/* ---- The other choices --------------------------------------------------- */

static void test_simple(void **unused)
{
    brdffit_samples s = samples_of(3);
    size_t i;

    (void)unused;
    for (i = 0; i < 3; i++) {
        direction(light + 3 * i, 0.9 - 0.3 * (double)i, 1);
        direction(view + 3 * i, 0.5, 2);
        given[i] = (double)i * 1e300;
    }
    s.weights = given;
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_COLUMN, 0, NULL), BRDFFIT_OK);
    assert_memory_equal(out, given, 3 * sizeof *out);
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_NONE, 0, NULL), BRDFFIT_OK);
    assert_true(out[0] == 0 && out[1] == 1 && out[2] == 1);
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_COSINE, 0, NULL), BRDFFIT_OK);
    assert_true(out[0] == 0 && fabs(out[1] - 0.6) < 1e-15 && fabs(out[2] - 0.3) < 1e-15);
    assert_true(fabs(brdffit_weights_effective(given, 3) - 9.0 / 15) < 1e-15);
    assert_true(brdffit_weights_effective(NULL, 0) == 0 && brdffit_weights_effective(given, 1) == 0);
}

static void test_relative(void **unused)
{
    brdffit_samples s = samples_of(4);
    size_t i;

    (void)unused;
    s.channels = 2;
    for (i = 0; i < 4; i++) {
        direction(light + 3 * i, 0.5, 1);
        direction(view + 3 * i, 0.5, (double)i);
        values[2 * i] = 1e200 * pow(10, -(double)i);
        values[2 * i + 1] = -3e-200 * pow(10, -(double)i);
    }
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_RELATIVE, 0.01, NULL), BRDFFIT_OK);
    for (i = 0; i < 4; i++) { /* radiance is half of f_r throughout, and cancels */
        assert_true(fabs(out[i] * pow(10, -2 * (double)(i < 3 ? i : 2)) - 1) < 1e-12);
    }
    memset(values, 0, sizeof values);
    assert_int_equal(weigh(&s, BRDFFIT_WEIGHTING_RELATIVE, 0.5, NULL), BRDFFIT_OK);
    assert_true(out[0] == 4 && out[3] == 4);
}

/* ---- What is refused ----------------------------------------------------- */

static void refuse(const brdffit_samples *s, brdffit_weighting weighting, double floor, brdffit_status expected)
{
    brdffit_error error;

    assert_int_equal(weigh(s, weighting, floor, &error), expected);
    assert_int_equal(error.status, expected);
    assert_non_null(error.message);
}

static void test_refused(void **unused)
{
    brdffit_samples s = samples_of(3);
    const size_t size = brdffit_weights_size(3, 1, BRDFFIT_WEIGHTING_SOLID_ANGLE);
    unsigned char memory[4096];
    size_t i;

    (void)unused;
    for (i = 0; i < 3; i++) {
        draw_uniform(i);
        values[i] = 1;
    }
    assert_true(size > 64 && size <= sizeof memory);
    assert_int_equal(brdffit_weights(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, memory, size - 65, out, NULL),
                     BRDFFIT_ERR_WORKSPACE);
    assert_int_equal(brdffit_weights(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, NULL, 0, out, NULL), BRDFFIT_ERR_WORKSPACE);
    assert_int_equal(brdffit_weights(&s, BRDFFIT_WEIGHTING_NONE, 0, NULL, 0, NULL, NULL), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_weights(NULL, BRDFFIT_WEIGHTING_NONE, 0, NULL, 0, out, NULL), BRDFFIT_ERR_ARGUMENT);
    refuse(&s, BRDFFIT_WEIGHTING_COLUMN, 0, BRDFFIT_ERR_ARGUMENT);
    refuse(&s, BRDFFIT_WEIGHTING_COUNT, 0, BRDFFIT_ERR_ARGUMENT);
    refuse(&s, BRDFFIT_WEIGHTING_RELATIVE, 0, BRDFFIT_ERR_VALUE);
    refuse(&s, BRDFFIT_WEIGHTING_RELATIVE, NAN, BRDFFIT_ERR_VALUE);
    values[1] = INFINITY;
    refuse(&s, BRDFFIT_WEIGHTING_RELATIVE, 0.1, BRDFFIT_ERR_VALUE);
    light[4] = NAN;
    refuse(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, BRDFFIT_ERR_VALUE);
    s.form = BRDFFIT_FORM_COEFFICIENTS;
    s.quantity = BRDFFIT_QUANTITY_RADIANCE;
    s.a = s.b = s.c = given;
    refuse(&s, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, BRDFFIT_ERR_UNSUPPORTED);
    assert_int_equal(brdffit_weights_size(SIZE_MAX / 2, 1, BRDFFIT_WEIGHTING_SOLID_ANGLE), 0);
    assert_string_equal(brdffit_weighting_string(BRDFFIT_WEIGHTING_SOLID_ANGLE), "solid-angle");
    assert_string_equal(brdffit_weighting_string(BRDFFIT_WEIGHTING_COUNT), "unknown");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quadrature_uniform),
        cmocka_unit_test(test_quadrature_crowded),
        cmocka_unit_test(test_scans),
        cmocka_unit_test(test_few),
        cmocka_unit_test(test_duplicates),
        cmocka_unit_test(test_normal_incidence),
        cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_angles_agree),
        cmocka_unit_test(test_simple),
        cmocka_unit_test(test_relative),
        cmocka_unit_test(test_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
