/*
 * Samples to (a, b, c): against the paper's formulas in long double, written with its angles; which samples count,
 * and why the others do not. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "io/csv/angle.h"
#include "model/geometry.h"
#include "support.h"
#include "base/tolerance.h"

#define PI_L 3.14159265358979323846264338327950288L
#define DEGREE ((double)(PI_L / 180.0L))

/* One sample and where its arrays point. */
struct one {
    brdffit_samples samples;
    double light[3], view[3], normal[3], weight;
    double cos_light, cos_view, tan2_half, cos_difference;
    double a, b, c;
};

static void one_new(struct one *one, brdffit_form form)
{
    memset(one, 0, sizeof *one);
    brdffit_samples_init(&one->samples);
    one->samples.count = 1;
    one->samples.channels = 1;
    one->samples.form = form;
    one->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    one->samples.light = one->light;
    one->samples.view = one->view;
    one->samples.cos_light = &one->cos_light;
    one->samples.cos_view = &one->cos_view;
    one->samples.tan2_half = &one->tan2_half;
    one->samples.cos_difference = &one->cos_difference;
    one->samples.a = &one->a;
    one->samples.b = &one->b;
    one->samples.c = &one->c;
    one->normal[2] = one->light[2] = one->view[2] = 1.0;
    one->cos_light = one->cos_view = one->cos_difference = one->weight = 1.0;
    one->tan2_half = one->a = one->b = one->c = 0.1;
}

static void direction(double theta, double phi, double *out)
{
    out[0] = sin(theta * DEGREE) * cos(phi * DEGREE);
    out[1] = sin(theta * DEGREE) * sin(phi * DEGREE);
    out[2] = cos(theta * DEGREE);
}

static brdffit_skip sample(const struct one *one, double max_incidence, struct geometry *out)
{
    brdffit_status status;
    brdffit_error error;
    brdffit_skip skip = brdffit_geometry_sample(&one->samples, BRDFFIT_BECKMANN,
                                                brdffit_geometry_min_cosine(max_incidence), 0, out, &status, &error);

    assert_int_equal(status, BRDFFIT_OK);
    return skip;
}

/* The angles of the paper: of light and view with n, of h with n (alpha), of view with h. */
struct angles {
    long double light, view, alpha, difference;
};

static long double angle_between(const long double *u, const long double *v)
{
    long double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];

    return atan2l(sqrtl(x * x + y * y + z * z), u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
}

static struct angles reference_angles(const struct one *one)
{
    long double l[3], v[3], n[3], h[3], l_length = 0.0L, v_length = 0.0L;
    struct angles angles;
    int j;

    for (j = 0; j < 3; j++) {
        l[j] = one->light[j];
        v[j] = one->view[j];
        n[j] = one->samples.normal ? one->normal[j] : j == 2;
        l_length += l[j] * l[j];
        v_length += v[j] * v[j];
    }
    for (j = 0; j < 3; j++) {
        h[j] = l[j] / sqrtl(l_length) + v[j] / sqrtl(v_length);
    }
    angles.light = angle_between(n, l);
    angles.view = angle_between(n, v);
    angles.alpha = angle_between(n, h);
    angles.difference = angle_between(v, h);
    return angles;
}

/* Allowed: unit vectors are good to a few u, and so every cosine and tan alpha / (1 + tan^2 alpha), absolutely. */
static void check_against_angles(const struct one *one)
{
    struct angles t = reference_angles(one);
    long double nl = cosl(t.light), nv = cosl(t.view), nh = cosl(t.alpha), vh = cosl(t.difference), g, b, tangent;
    long double u = TOL_UNIT, allowed_b;
    struct geometry got;

    assert_int_equal(sample(one, 90.0, &got), BRDFFIT_SKIP_COUNT);
    g = fminl(1.0L, fminl(2.0L * nh * nv / vh, 2.0L * nh * nl / vh));
    b = g / (PI_L * nv * nh * nh * nh * nh);
    tangent = tanl(t.alpha);
    allowed_b = u * (16.0L + 8.0L * (1.0L / nl + 1.0L / nv + 1.0L / vh) + 32.0L * tangent / vh);
    assert_true(fabsl(got.a - nl / PI_L) <= 4.0L * u * (nl + 1.0L));
    assert_true(fabsl(got.cos_light - nl) <= 4.0L * u * (nl + 1.0L));
    assert_true(fabsl(sqrtl((long double)got.c) - tangent) <= 8.0L * u * (1.0L + tangent * tangent) / vh);
    if (!(fabsl(got.b / b - 1.0L) <= allowed_b)) {
        fail_msg("b = %.17g, not %.17Lg (light %a,%a,%a view %a,%a,%a)", got.b, b, one->light[0], one->light[1],
                 one->light[2], one->view[0], one->view[1], one->view[2]);
    }
}

static void test_random_directions(void **state)
{
    struct brdffit_test_random random = {1};
    struct one one;
    int i;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    for (i = 0; i < 40000; i++) {
        double limit = i % 5 ? 75.0 : 89.9;

        direction(brdffit_test_uniform(&random, 0.0, limit), brdffit_test_uniform(&random, 0.0, 360.0), one.light);
        direction(brdffit_test_uniform(&random, 0.0, limit), brdffit_test_uniform(&random, 0.0, 360.0), one.view);
        check_against_angles(&one);
    }
}

/* Near the mirror direction tan^2 alpha falls to 1e-30 and keeps its digits: alpha is good to 1e-15. */
static void test_near_mirror(void **state)
{
    struct brdffit_test_random random = {2};
    struct one one;
    struct geometry got;
    int i;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    for (i = 0; i < 40000; i++) {
        double theta = brdffit_test_uniform(&random, 0.0, 60.0), phi = brdffit_test_uniform(&random, 0.0, 360.0);
        double tilt = brdffit_test_log_uniform(&random, 1e-15, 1.0);

        direction(theta, phi, one.light);
        direction(theta + tilt * brdffit_test_uniform(&random, -1.0, 1.0),
                  phi + 180.0 + tilt * brdffit_test_uniform(&random, -1.0, 1.0), one.view);
        assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_COUNT);
        assert_true(fabsl(atanl(sqrtl((long double)got.c)) - reference_angles(&one).alpha) <= 1e-15L);
    }
    memcpy(one.view, one.light, sizeof one.view);
    one.view[0] = -one.view[0];
    one.view[1] = -one.view[1];
    assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_COUNT);
    assert_true(got.c == 0.0);
}

static void scale(const double *from, double factor, double *to)
{
    int j;

    for (j = 0; j < 3; j++) {
        to[j] = from[j] * factor;
    }
}

/* A length that is a power of two changes no bit; any other only rounds. */
static void test_lengths(void **state)
{
    static const double factor[] = {
        0x1p-900, 0x1p-90, 0x1p1000, 0x1p1022, 3.0, 0x1p-1000, 1e-300, 1e300, 1.7e308, 1e-307,
    };
    struct brdffit_test_random random = {3};
    struct one one, longer;
    struct geometry unit, got;
    size_t i, j;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    one.samples.normal = one.normal;
    for (i = 0; i < 300; i++) {
        direction(brdffit_test_uniform(&random, 0.0, 70.0), brdffit_test_uniform(&random, 0.0, 360.0), one.light);
        direction(brdffit_test_uniform(&random, 0.0, 70.0), brdffit_test_uniform(&random, 0.0, 360.0), one.view);
        direction(brdffit_test_uniform(&random, 0.0, 15.0), brdffit_test_uniform(&random, 0.0, 360.0), one.normal);
        assert_int_equal(sample(&one, 90.0, &unit), BRDFFIT_SKIP_COUNT);
        for (j = 0; j < 3 * sizeof factor / sizeof factor[0]; j++) {
            double *part[3];
            double by = factor[j / 3];

            one_new(&longer, BRDFFIT_FORM_DIRECTIONS);
            longer.samples.normal = longer.normal;
            memcpy(longer.light, one.light, sizeof one.light);
            memcpy(longer.view, one.view, sizeof one.view);
            memcpy(longer.normal, one.normal, sizeof one.normal);
            part[0] = longer.light;
            part[1] = longer.view;
            part[2] = longer.normal;
            scale(part[j % 3], by, part[j % 3]);
            assert_int_equal(sample(&longer, 90.0, &got), BRDFFIT_SKIP_COUNT);
            if (j / 3 < 4) {
                assert_true(got.a == unit.a && got.b == unit.b && got.c == unit.c);
            }
            check_against_angles(&longer);
        }
    }
}

/* Turn light, view and normal together by a random rotation: a, b, c stay. */
static void test_normals(void **state)
{
    struct brdffit_test_random random = {4};
    struct one one, turned;
    struct geometry flat, got;
    int i, j;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    one_new(&turned, BRDFFIT_FORM_DIRECTIONS);
    turned.samples.normal = turned.normal;
    for (i = 0; i < 20000; i++) {
        double theta = brdffit_test_uniform(&random, 0.0, 180.0), phi = brdffit_test_uniform(&random, 0.0, 360.0);
        double frame[3][3];

        direction(brdffit_test_uniform(&random, 0.0, 70.0), brdffit_test_uniform(&random, 0.0, 360.0), one.light);
        direction(brdffit_test_uniform(&random, 0.0, 70.0), brdffit_test_uniform(&random, 0.0, 360.0), one.view);
        direction(theta + 90.0, phi, frame[0]);
        direction(90.0, phi + 90.0, frame[1]);
        direction(theta, phi, frame[2]);
        for (j = 0; j < 3; j++) {
            turned.light[j] = one.light[0] * frame[0][j] + one.light[1] * frame[1][j] + one.light[2] * frame[2][j];
            turned.view[j] = one.view[0] * frame[0][j] + one.view[1] * frame[1][j] + one.view[2] * frame[2][j];
            turned.normal[j] = 7.0 * frame[2][j];
        }
        assert_int_equal(sample(&one, 90.0, &flat), BRDFFIT_SKIP_COUNT);
        assert_int_equal(sample(&turned, 90.0, &got), BRDFFIT_SKIP_COUNT);
        check_against_angles(&turned);
        assert_true(fabs(got.a - flat.a) <= 1e-15);
        assert_true(fabs(sqrt(got.c) - sqrt(flat.c)) <= 1e-14 * (1.0 + flat.c));
        assert_true(fabs(got.b / flat.b - 1.0) <= 1e-13);
    }
}

/* The same sample as angles: same coefficients to rounding. */
static void test_angles_form(void **state)
{
    struct brdffit_test_random random = {5};
    struct one one, angles;
    struct geometry from_directions, got;
    int i;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    one_new(&angles, BRDFFIT_FORM_ANGLES);
    for (i = 0; i < 20000; i++) {
        struct angles t;

        direction(brdffit_test_uniform(&random, 0.0, 80.0), brdffit_test_uniform(&random, 0.0, 360.0), one.light);
        direction(brdffit_test_uniform(&random, 0.0, 80.0), brdffit_test_uniform(&random, 0.0, 360.0), one.view);
        t = reference_angles(&one);
        angles.cos_light = (double)cosl(t.light);
        angles.cos_view = (double)cosl(t.view);
        angles.tan2_half = (double)(tanl(t.alpha) * tanl(t.alpha));
        angles.cos_difference = (double)cosl(t.difference);
        assert_int_equal(sample(&one, 90.0, &from_directions), BRDFFIT_SKIP_COUNT);
        assert_int_equal(sample(&angles, 90.0, &got), BRDFFIT_SKIP_COUNT);
        assert_true(got.c == angles.tan2_half);
        assert_true(got.cos_light == angles.cos_light);
        assert_true(fabs(got.a - from_directions.a) <= 1e-15);
        assert_true(fabs(got.b / from_directions.b - 1.0) <= 1e-13 * (1.0 + got.c));
    }
}

static void test_incidence_limit(void **state)
{
    static const double limit[] = {60.0, 10.0, 45.0, 75.0, 89.0};
    struct one one;
    struct geometry got;
    size_t i;
    int azimuth;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    for (i = 0; i < sizeof limit / sizeof limit[0]; i++) {
        for (azimuth = -180; azimuth <= 360; azimuth += 15) {
            direction(limit[i], azimuth, one.light);
            assert_int_equal(sample(&one, limit[i], &got), BRDFFIT_SKIP_COUNT);
            scale(one.light, 0.3, one.light);
            assert_int_equal(sample(&one, limit[i], &got), BRDFFIT_SKIP_COUNT);
            direction(limit[i] + 1e-6, azimuth, one.light);
            assert_int_equal(sample(&one, limit[i], &got), BRDFFIT_SKIP_INCIDENCE);
            direction(89.999, azimuth, one.light);
            assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_COUNT);
            assert_int_equal(sample(&one, INFINITY, &got), BRDFFIT_SKIP_COUNT);
        }
    }
}

/* The limit is the cosine of degrees, exact where it is rational, and that of nobody's libm. */
static void test_limit_is_exact(void **state)
{
    double degrees, sine, cosine;

    (void)state;
    assert_true(brdffit_geometry_min_cosine(60.0) == 0.5 - TOL_INCIDENCE);
    assert_true(brdffit_geometry_min_cosine(90.0) == 0.0);
    assert_true(brdffit_geometry_min_cosine(INFINITY) == 0.0);
    for (degrees = 0.25; degrees < 90.0; degrees += 0.25) {
        brdffit_io_sincos_degrees(degrees, &sine, &cosine);
        assert_true(brdffit_geometry_min_cosine(degrees) == cosine - TOL_INCIDENCE);
        assert_true(fabs(cosine - cos(degrees * DEGREE)) < 4e-16);
    }
}

/* Each reason, and which comes first when several hold. */
static void test_skips(void **state)
{
    struct one one;
    struct geometry got;

    (void)state;
    one_new(&one, BRDFFIT_FORM_DIRECTIONS);
    one.samples.weights = &one.weight;
    direction(70.0, 10.0, one.light);
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_INCIDENCE);
    one.view[2] = -1.0;
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_VIEW_BELOW_HORIZON);
    one.light[2] = 0.0;
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_LIGHT_BELOW_HORIZON);
    one.weight = 0.0;
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_ZERO_WEIGHT);
    one.light[0] = NAN;
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_ZERO_WEIGHT);
    one_new(&one, BRDFFIT_FORM_ANGLES);
    one.cos_light = 0.0;
    assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_LIGHT_BELOW_HORIZON);
    one.cos_light = -1.0;
    one.cos_view = 0.0;
    assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_LIGHT_BELOW_HORIZON);
    one.cos_light = 0.3;
    assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_VIEW_BELOW_HORIZON);
    one.cos_view = 1.0;
    assert_int_equal(sample(&one, 90.0, &got), BRDFFIT_SKIP_COUNT);
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_INCIDENCE);
    one.cos_light = 0.5;
    assert_int_equal(sample(&one, 60.0, &got), BRDFFIT_SKIP_COUNT);
}

/* At the horizon to the last bit: everything stays finite, or the sample does not count. */
static void test_grazing(void **state)
{
    static const double height[] = {5e-324, 1e-300, 1e-200, 1e-100, 1e-40, 1e-31, 1e-29, 1e-20, 1e-10};
    struct one one;
    struct geometry got;
    size_t i, j, k;

    (void)state;
    for (i = 0; i < sizeof height / sizeof height[0]; i++) {
        for (j = 0; j < sizeof height / sizeof height[0]; j++) {
            for (k = 0; k < 3; k++) {
                one_new(&one, BRDFFIT_FORM_DIRECTIONS);
                one.light[0] = 1.0;
                one.light[2] = height[i];
                one.view[0] = k == 0 ? 1.0 : k == 1 ? -1.0 : 0.0;
                one.view[1] = k == 2;
                one.view[2] = height[j];
                if (sample(&one, 90.0, &got) == BRDFFIT_SKIP_COUNT) {
                    assert_true(isfinite(got.a) && isfinite(got.b) && isfinite(got.c));
                    assert_true(got.a > 0.0 && got.b > 0.0 && got.c >= 0.0);
                }
            }
        }
    }
}

static brdffit_status status_of(const struct one *one, struct geometry *got)
{
    brdffit_status status;

    (void)brdffit_geometry_sample(&one->samples, BRDFFIT_BECKMANN, 0.0, 0, got, &status, NULL);
    return status;
}

/* Half vectors at the horizon: cos^4 alpha underflows long before tan^2 alpha overflows, hence LIMIT_C. */
static void test_c_of_any_size(void **state)
{
    static const double c[] = {0.0, 5e-324, 1e20, 1e60, LIMIT_C, 1.0000001 * LIMIT_C, 1e160, 1e200, 1.7e308};
    struct one one;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof c / sizeof c[0]; i++) {
        brdffit_status expected = c[i] <= LIMIT_C ? BRDFFIT_OK : BRDFFIT_ERR_VALUE;
        struct geometry got = {.cos_light = 0.0};

        one_new(&one, BRDFFIT_FORM_ANGLES);
        one.cos_view = one.cos_light = 1e-29;
        one.tan2_half = c[i];
        assert_int_equal(status_of(&one, &got), expected);
        assert_true(isfinite(got.a) && isfinite(got.b) && isfinite(got.c));
        one_new(&one, BRDFFIT_FORM_COEFFICIENTS);
        one.c = c[i];
        assert_int_equal(status_of(&one, &got), expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_directions), cmocka_unit_test(test_near_mirror),
        cmocka_unit_test(test_lengths),           cmocka_unit_test(test_normals),
        cmocka_unit_test(test_angles_form),       cmocka_unit_test(test_incidence_limit),
        cmocka_unit_test(test_limit_is_exact),    cmocka_unit_test(test_skips),
        cmocka_unit_test(test_grazing),           cmocka_unit_test(test_c_of_any_size),
    };

    return cmocka_run_group_tests_name("geometry", tests, NULL, NULL);
}
