/*
 * The reduction at its edges: which c merge, samples without a lobe, data of any size.
 * SPDX-License-Identifier: MIT
 */
#include "model/geometry.h"
#include "reduce_case.h"

/* ---- merging ------------------------------------------------------------------------------------------ */

/* Given c merge to the bit, and only to the bit. */
static void test_given_c_merge_exactly(void **state)
{
    static const double a[6] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1}, b[6] = {1, 1, 1, 1, 1, 0};
    static const double values[6] = {1, 1, 1, 1, 1, 1}, cosines[6] = {0.9, 0.9, 0.9, 0.9, 0.9, 0.9};
    double c[6] = {0.0};
    brdffit_samples s = brdffit_test_coefficients(6, 1, a, b, c, values);
    struct outcome o;

    (void)state;
    c[0] = c[3] = 0.3;
    c[1] = c[4] = nextafter(0.3, 1.0);
    c[2] = 0.0;
    c[5] = 77.0; /* b = 0: no lobe, no c */
    reduce(&o, &s);
    assert_int_equal(o.r.distinct, 3);
    assert_true(o.r.table[0].bb[0] == 1.0 / (o.r.table[0].scale_b * o.r.table[0].scale_b));
    assert_true(o.r.table[0].c[2] - o.r.table[0].c[1] == nextafter(0.3, 1.0) - 0.3);
    free(o.block);
    s.form = BRDFFIT_FORM_ANGLES;
    s.cos_light = s.cos_view = s.cos_difference = cosines;
    s.tan2_half = c;
    c[5] = 0.3;
    reduce(&o, &s);
    assert_int_equal(o.r.distinct, 3);
    free(o.block);
}

/*
 * c from directions carries rounding: equal angles seen from several sides are one c. No sample is moved further
 * than `snapped`, relative to its c - c_min.
 */
static void test_directions_merge_to_rounding(void **state)
{
    double light[72 * 3], view[72 * 3], values[72];
    size_t i, j, tilted = 0;
    brdffit_samples s;
    struct outcome o;

    (void)state;
    for (i = 0; i < 72; i++) {
        double phi = 0.087266462599716477 * (double)i, theta = 0.1 * (double)(1 + i % 4), tilt = i % 2 ? 0.4 : 0.0;

        light[3 * i] = sin(theta + tilt) * cos(phi);
        light[3 * i + 1] = sin(theta + tilt) * sin(phi);
        light[3 * i + 2] = cos(theta + tilt);
        view[3 * i] = -sin(theta - tilt) * cos(phi);
        view[3 * i + 1] = -sin(theta - tilt) * sin(phi);
        view[3 * i + 2] = cos(theta - tilt);
        values[i] = 1.0;
    }
    brdffit_samples_init(&s);
    s.count = 72;
    s.channels = 1;
    s.light = light;
    s.view = view;
    s.values = values;
    reduce(&o, &s);
    for (j = 0; j < o.r.distinct; j++) {
        /* alpha is half the difference of the angles, 0 or 0.4, whatever theta. */
        tilted += o.r.table[0].c[j] > 1e-20;
        assert_true(fabs(sqrt(o.r.table[0].c[j] + o.r.table[0].c_min) - (o.r.table[0].c[j] > 1e-20 ? tan(0.4) : 0.0)) <=
                    2e-15);
    }
    assert_int_equal(tilted, 1);
    assert_true(o.r.table[0].snapped > 0.0 && o.r.table[0].snapped <= TOL_SNAP);
    for (i = 0; i < 72; i++) {
        struct geometry g;
        brdffit_status status;
        double nearest = INFINITY;

        (void)brdffit_geometry_sample(&s, BRDFFIT_BECKMANN, 0.0, i, &g, &status, NULL);
        for (j = 0; j < o.r.distinct; j++) {
            double change = fabs(g.c - o.r.table[0].c_min - o.r.table[0].c[j]);

            nearest = fmin(nearest, change > 0.0 ? change / o.r.table[0].c[j] : 0.0);
        }
        assert_true(nearest <= o.r.table[0].snapped * (1.0 + 1e-10) + 2.0 * TOL_UNIT);
    }
    free(o.block);
}

/* ---- edges -------------------------------------------------------------------------------------------- */

static void test_no_lobe_at_all(void **state)
{
    struct problem p;
    struct outcome o;
    size_t i;

    (void)state;
    problem_new(&p, 9, 2);
    problem_fill(&p, 3, 0, 0, 0, 1);
    for (i = 0; i < 9; i++) {
        p.b[i] = 0.0;
    }
    reduce(&o, &p.samples);
    assert_int_equal(o.r.distinct, 1);
    assert_true(o.r.table[0].bb[0] == 0.0 && o.r.table[0].linear[0] == 0.0);
    check_rows(&p, &o.r, 1);
    free(o.block);
    free(p.a);
}

/* Units: scales are powers of two, whatever the size of a, b and the weights; sums stay as good. */
static void test_scales(void **state)
{
    static const double size[] = {1e-300, 1e-150, 1e-20, 1.0, 1e20, 1e150, 1e300};
    size_t i, j;
    int exponent;

    (void)state;
    for (i = 0; i < 7; i++) {
        for (j = 0; j < 40; j++) {
            struct problem p;
            struct outcome o;
            size_t n;

            problem_new(&p, 40, 1);
            problem_fill(&p, 6, (int)(j & 1), 0, 1, j + 1);
            for (n = 0; n < 40; n++) {
                p.a[n] *= size[i];
                p.b[n] *= size[j % 7];
                p.weights[n] *= size[(i + j) % 7];
                p.values[n] *= size[(i + 3 * j) % 7];
            }
            reduce(&o, &p.samples);
            assert_true(frexp(o.r.scale_a[0], &exponent) == 0.5 && frexp(o.r.table[0].scale_b, &exponent) == 0.5);
            assert_true(frexp(o.r.scale_w, &exponent) == 0.5);
            check_sums(&p, &o.r);
            check_rows(&p, &o.r, j);
            free(o.block);
            free(p.a);
        }
    }
}

/* Each channel has its own unit, so one may be 1e-200 of another. */
static void test_channels_of_any_ratio(void **state)
{
    struct problem p;
    struct outcome o;
    brdffit_error error = {0};
    size_t i;

    (void)state;
    problem_new(&p, 30, 2);
    problem_fill(&p, 6, 0, 0, 0, 5);
    for (i = 0; i < 30; i++) {
        p.values[2 * i] *= 1e100;
        p.values[2 * i + 1] *= 1e-100;
    }
    if (try_reduce(&o, &p.samples, &error) != BRDFFIT_OK) {
        fail_msg("%s (%g)", error.message, error.value);
    }
    check_sums(&p, &o.r);
    free(o.block);
    free(p.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_given_c_merge_exactly), cmocka_unit_test(test_directions_merge_to_rounding),
        cmocka_unit_test(test_no_lobe_at_all),        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_channels_of_any_ratio),
    };

    return cmocka_run_group_tests_name("reduce_edges", tests, NULL, NULL);
}
