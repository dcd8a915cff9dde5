/*
 * What the rounding of geometry costs a proof (src/data/charge.c), judged in 113 bits: whole fits of data whose half angles
 * nearly agree, whose r.v is about 0, whose viewers and lights graze. No lower bound is above an E^2 of the directions as
 * doubles, of the angles that they were made from, or of others within what directions are known to. LDFLAGS: -lquadmath
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/tolerance.h"
#include "fewer.h"
#include "rounding_problem.h"

/* Fit and compare: as doubles, and moved `moves` times by what directions are known to. e2 is that of the doubles. */
static void check_fit(struct brdffit_test_random *random, const struct problem *p, int moves, int exact, int *certified)
{
    static struct reading r;
    const brdffit_result *result;
    brdffit_error error;
    brdffit_status status = brdffit_fit_new(&p->samples, &p->options, &result, &error);
    quad e2;
    int i;

    if (status == BRDFFIT_ERR_UNSUPPORTED) {
        return; /* without ECOS */
    }
    if (status != BRDFFIT_OK) {
        fail_msg("%s (sample %zu)", error.message, error.sample);
    }
    *certified += result->certified;
    r.scale = result->channel_scale[0];
    read_doubles(random, p, 0, &r);
    check_bound(p, result, &r, "as doubles");
    e2 = at_model(&r, p, result);
    if (exact && !(fabsq(e2 - result->e2) <= (quad)1e-9 * e2 + (quad)1e-13 * (quad)result->sum_of_squares)) {
        fail_msg("%s: e2 %.17g, of its model %.17g", brdffit_distribution_string(p->options.distribution), result->e2,
                 (double)e2);
    }
    for (i = 0; i < moves; i++) {
        read_doubles(random, p, TOL_ANGLE, &r);
        check_bound(p, result, &r, "moved");
    }
    brdffit_result_free(result);
}

/* ---- Lafortune at 90 degrees ------------------------------------------------------------------------------------ */

static void quad_direction(double theta, double phi, quad *out)
{
    quad t = theta * oracle_pi() / 180, f = phi * oracle_pi() / 180;

    out[0] = sinq(t) * cosq(f);
    out[1] = sinq(t) * sinq(f);
    out[2] = cosq(t);
}

/* In plane, every 10 degrees: 90 degrees off the mirror direction where theta_i + theta_o = 90 on the light's side. */
static void lafortune_case(struct problem *p, struct reading *degrees, double at_right_angles)
{
    int ti, to;
    size_t n = 0;

    problem_start(p);
    p->options.distribution = BRDFFIT_LAFORTUNE;
    p->options.max_incidence = 60.0;
    p->samples.quantity = BRDFFIT_QUANTITY_BRDF;
    for (ti = 10; ti <= 60; ti += 10) {
        for (to = -80; to <= 80; to += 10) {
            brdffit_io_direction(ti, 0.0, p->light[n]);
            brdffit_io_direction(abs(to), to < 0 ? 180.0 : 0.0, p->view[n]);
            quad_direction(ti, 0.0, degrees->light[n]);
            quad_direction(abs(to), to < 0 ? 180.0 : 0.0, degrees->view[n]);
            degrees->normal[n][0] = degrees->normal[n][1] = 0;
            degrees->normal[n][2] = 1;
            p->value[n] = ti + to == 90 ? at_right_angles : ti + to > 90 ? 0.0 : 1.0;
            degrees->value[n] = p->value[n];
            n++;
        }
    }
    p->samples.count = degrees->count = n;
    degrees->brdf = 1;
}

static void check_lafortune(struct brdffit_test_random *random, struct problem *p, struct reading *degrees)
{
    const brdffit_result *result;
    brdffit_error error;
    struct reading zero;
    size_t i;
    int certified = 0;

    if (brdffit_fit_new(&p->samples, &p->options, &result, &error) != BRDFFIT_OK) {
        assert_int_equal(error.status, BRDFFIT_ERR_UNSUPPORTED);
        return;
    }
    degrees->scale = result->channel_scale[0];
    check_bound(p, result, degrees, "as degrees");
    zero = *degrees; /* exactly 90 degrees is none of ours: 1e-15 more, or less */
    for (i = 0; i < zero.count; i++) {
        zero.view[i][0] -= (quad)1e-15 * zero.view[i][2];
    }
    check_bound(p, result, &zero, "as degrees, towards the mirror direction");
    for (i = 0; i < zero.count; i++) {
        zero.view[i][0] += (quad)2e-15 * zero.view[i][2];
    }
    check_bound(p, result, &zero, "as degrees, away from it");
    brdffit_result_free(result);
    check_fit(random, p, 2, 0, &certified);
}

static void test_lafortune(void **state)
{
    static const double value[3] = {0.0, 1.0, 0.02}, least[3] = {0.1, 1e-3, 1e-6};
    static struct problem p;
    static struct reading degrees;
    struct brdffit_test_random random = {10};
    int i, j, k;

    (void)state;
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            for (k = 0; k < 4; k++) {
                lafortune_case(&p, &degrees, value[i]);
                p.options.exponent_min = least[j];
                p.options.relative_gap = k ? 1e-3 : 1e-6;
                p.options.engine = k == 1 ? BRDFFIT_ENGINE_SOCP : BRDFFIT_ENGINE_MOMENT;
                p.options.norm = k == 2 ? BRDFFIT_NORM_L1 : k == 3 ? BRDFFIT_NORM_LINF : BRDFFIT_NORM_L2;
                p.options.box_budget = k ? FEWER(300, 30) : FEWER(20000, 2000);
                check_lafortune(&random, &p, &degrees);
            }
        }
    }
}

/* ---- Half angles that nearly agree ------------------------------------------------------------------------------ */

/* Half angles of 5e-16 to 1e-8 rad from a table of angles: two that merged at a loss, and e2 said so. */
static void test_snapped(void **state)
{
    static const double angle[10][4] = {
        {44.491334676726751, 180, 44.491335676726749, 0},
        {51.0643664322007, 180, 51.0643664322007, 0},
        {13.547535678625897, 180, 13.547535678626897, 0},
        {17.447000763684233, 41.690045262265471, 17.447001763684234, 221.69004526226547},
        {39.248685264139823, 180, 39.24868626413982, 0},
        {21.411624188275795, 90, 21.411624189275795, 270},
        {28.868319230262156, 0, 28.868319230262155, 180},
        {29.055471136983357, 90, 29.055472136983358, 270},
        {23.160435208379774, 260.80629022718068, 23.160435208379873, 80.806290227180682},
        {21.17431660195119, 180, 21.17431660195119, 0},
    };
    static const double value[10] = {6.4, 1.9, 16.5, 1.5e-3, 2e-4, 0.72, 0.65, 0.044, 8.8, 8.9};
    static struct problem p;
    struct brdffit_test_random random = {11};
    size_t i;
    int d, certified = 0;

    (void)state;
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        problem_start(&p);
        p.samples.quantity = BRDFFIT_QUANTITY_BRDF;
        p.samples.count = 10;
        p.options.distribution = (brdffit_distribution)d;
        p.options.exponent_max = 1e24;
        for (i = 0; i < 10; i++) {
            brdffit_io_direction(angle[i][0], angle[i][1], p.light[i]);
            brdffit_io_direction(angle[i][2], angle[i][3], p.view[i]);
            p.value[i] = value[i];
        }
        check_fit(&random, &p, 4, 1, &certified);
    }
    assert_true(certified >= 4);
}

/* Samples near the mirror direction at all scales, values of a lobe that tells them apart, and noise. */
static void near_mirror_case(struct brdffit_test_random *random, struct problem *p, double finest)
{
    double width = power(random, finest, -3.0), noise = power(random, -4.0, -0.5);
    size_t i, n = 5 + brdffit_test_below(random, 8);

    problem_start(p);
    p->samples.count = n;
    p->options.exponent_max = 1e24;
    for (i = 0; i < n; i++) {
        double theta = brdffit_test_uniform(random, 0.05, 1.0), phi = brdffit_test_uniform(random, 0.0, 6.3);
        double tilt = width * brdffit_test_uniform(random, 0.0, 3.0), x;

        spherical(theta, phi, p->light[i]);
        spherical(theta, phi, p->view[i]);
        p->view[i][0] = -p->view[i][0];
        p->view[i][1] = -p->view[i][1];
        if (i % 4) { /* by the half angle tilt / 2 in plane */
            double cosine = cos(theta), sine = sin(theta);

            p->view[i][0] -= tilt * cosine * cos(phi);
            p->view[i][1] -= tilt * cosine * sin(phi);
            p->view[i][2] -= tilt * sine;
        } else {
            tilt = 0.0;
        }
        x = 0.5 * tilt / width;
        p->value[i] = 0.1 * cos(theta) + exp(-2.0 * x * x) * (1.0 + noise * brdffit_test_uniform(random, -1.0, 1.0));
    }
}

static void test_near_mirror(void **state)
{
    struct brdffit_test_random random = {12};
    static struct problem p;
    int i, certified = 0, count = FEWER(400, 112);

    (void)state;
    for (i = 0; i < count; i++) {
        near_mirror_case(&random, &p, i % 2 ? -12.0 : -9.0);
        p.options.distribution = (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.relative_gap = i % 3 ? 1e-3 : 1e-8;
        p.options.engine = i % 8 == 7 ? BRDFFIT_ENGINE_SOCP : BRDFFIT_ENGINE_MOMENT;
        p.options.norm = i % 16 == 3 ? BRDFFIT_NORM_L1 : i % 16 == 11 ? BRDFFIT_NORM_LINF : BRDFFIT_NORM_L2;
        p.options.box_budget = i % 8 == 7 || p.options.norm != BRDFFIT_NORM_L2 ? 200 : 2000;
        check_fit(&random, &p, 3, 1, &certified);
    }
    assert_true(certified > count * 3 / 8);
}

/* Two lobes: both are charged. */
static void test_near_mirror_two(void **state)
{
    struct brdffit_test_random random = {14};
    static struct problem p;
    int i, certified = 0, count = FEWER(60, 14);

    (void)state;
    for (i = 0; i < count; i++) {
        near_mirror_case(&random, &p, i % 2 ? -12.0 : -9.0);
        p.options.distribution = (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.lobes = 2;
        p.options.relative_gap = 1e-6;
        p.options.box_budget = 3000;
        check_fit(&random, &p, 2, 1, &certified);
    }
    assert_true(certified > count / 6);
}

/* Mirror images but for 1e-15 rad, which are one half angle to the search: lobes of 1e-12 tell them apart. */
static void test_mirror_images(void **state)
{
    static const double tilt[5] = {0.0, 7e-16, 0.0, 9e-16, 5e-16}, far[3] = {0.3, 0.5, 0.8};
    struct brdffit_test_random random = {15};
    static struct problem p;
    int certified = 0, i, k;

    (void)state;
    for (k = 0; k < FEWER(40, 14); k++) {
        problem_start(&p);
        p.samples.count = 8;
        p.options.distribution = (brdffit_distribution)(k % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.exponent_max = 1e24;
        p.options.relative_gap = p.options.absolute_gap = 1e-12;
        for (i = 0; i < 8; i++) {
            double theta = brdffit_test_uniform(&random, 0.2, 0.7);

            spherical(theta, 0.0, p.light[i]);
            spherical(theta + (i < 5 ? 0.0 : far[i - 5]), 0.0, p.view[i]);
            p.view[i][0] = -p.view[i][0];
            p.view[i][2] -= i < 5 ? tilt[i] * brdffit_test_uniform(&random, 0.8, 1.2) : 0.0;
            p.value[i] = i < 5 ? (tilt[i] > 0.0 ? 0.5 : 1.0) * brdffit_test_uniform(&random, 0.9, 1.1) : 1e-3;
        }
        check_fit(&random, &p, 0, 1, &certified);
    }
    assert_true(certified > 0);
}

/* ---- Grazing ---------------------------------------------------------------------------------------------------- */

/* One viewer (kind 0) or light (kind 1) that grazes, with a given normal, and data that it matters to. */
static void grazing_case(struct brdffit_test_random *random, struct problem *p, int kind)
{
    double graze = power(random, -9.0, -3.0);
    size_t i, n = 8;

    problem_start(p);
    p->samples.count = n;
    p->samples.normal = &p->normal[0][0];
    p->samples.quantity = kind ? BRDFFIT_QUANTITY_BRDF : BRDFFIT_QUANTITY_RADIANCE;
    for (i = 0; i < n; i++) {
        struct scene s;

        make_upright(random, 0, &s);
        if (i < 2) {
            (kind ? s.light : s.view)[2] = graze * (1.0 + (double)i);
        }
        turn(random, &s);
        memcpy(p->light[i], s.light, sizeof s.light);
        memcpy(p->view[i], s.view, sizeof s.view);
        memcpy(p->normal[i], s.normal, sizeof s.normal);
        p->value[i] = brdffit_test_uniform(random, 0.2, 1.0) / (i < 2 && kind ? graze : 1.0);
    }
}

static void test_grazing(void **state)
{
    struct brdffit_test_random random = {13};
    static struct problem p;
    int i, certified = 0;

    (void)state;
    for (i = 0; i < FEWER(300, 56); i++) {
        grazing_case(&random, &p, i % 2);
        p.options.distribution = i % 4 == 0 ? BRDFFIT_WARD : (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.relative_gap = 1e-11;
        p.options.absolute_gap = 1e-14;
        check_fit(&random, &p, 6, 1, &certified);
    }
    assert_true(certified > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lafortune),     cmocka_unit_test(test_snapped),
        cmocka_unit_test(test_near_mirror),   cmocka_unit_test(test_near_mirror_two),
        cmocka_unit_test(test_mirror_images), cmocka_unit_test(test_grazing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
