/*
 * Lobes with Smith masking (src/model/smith.h) against 113 bits: values, that everything falls, ranges, tails.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/tolerance.h"
#include "smith_oracle.h"
#include "support.h"

#include "quad/quad.h"

#define FAMILIES 4
#define TRIPLES 30000 /* of each family */

/* src/model/smith.h, in 2^-53. */
#define UNITS_PHI 8.0
#define UNITS_GGX 2.0 /* of its shape */
#define UNITS_ELL 10.0
#define UNITS_SLOPE 20.0
#define UNITS_MASKING 8.0
#define UNITS_ACCURATE 12.0

struct draw {
    enum smith_family family;
    struct smith_scale scale;
    double s, c, light, view;
};

static double draw_tan2(struct brdffit_test_random *random, double s)
{
    switch (brdffit_test_below(random, 6)) {
    case 0: return 0.0;
    case 1: return brdffit_test_log_uniform(random, 1e-12, 1e12);
    case 2: return s * brdffit_test_log_uniform(random, 1e-3, 1e3);
    case 3: return fmin(s * brdffit_test_log_uniform(random, 0.05, 20.0), 1e12);
    default: return brdffit_test_log_uniform(random, 1e-4, 4e3); /* up to 89 degrees */
    }
}

static double draw_c(struct brdffit_test_random *random, double s)
{
    switch (brdffit_test_below(random, 4)) {
    case 0: return 0.0;
    case 1: return brdffit_test_log_uniform(random, 1e-30, LIMIT_C);
    default: return fmin(brdffit_test_log_uniform(random, 1e-3, 1e3) / s, LIMIT_C);
    }
}

static struct draw draw_at(struct brdffit_test_random *random, enum smith_family family)
{
    struct draw d;
    double c_min, widest;

    d.family = family;
    d.s = brdffit_test_below(random, 2) ? brdffit_test_log_uniform(random, 1.0 / 36.0, 1e24)
                                        : brdffit_test_log_uniform(random, 1e-6, 1e5);
    d.light = draw_tan2(random, d.s);
    d.view = brdffit_test_below(random, 6) ? draw_tan2(random, d.s) : d.light;
    d.c = draw_c(random, d.s);
    c_min = draw_c(random, d.s);
    widest = fmax(d.light, d.view);
    if (brdffit_test_below(random, 2)) {
        widest = fmax(widest, draw_tan2(random, d.s)); /* another sample's */
    }
    brdffit_smith_scale(family, c_min, widest, &d.scale);
    return d;
}

static void fail_at(const struct draw *d, const char *what, double got, quad truth)
{
    fail_msg("%s, family %d, s = %a, c = %a, c_min = %a, tan^2 = %a and %a, M = %a: %a instead of %a, %.3f u", what,
             (int)d->family, d->s, d->c, d->scale.c_min, d->light, d->view, d->scale.widest, got, (double)truth,
             (double)(fabsq(got - truth) / truth * 0x1p53));
}

/* Numbers below the normal ones have an absolute error. */
static void assert_units(const struct draw *d, const char *what, double got, quad truth, double units)
{
    if (!(fabsq(got - truth) <= units * 0x1p-53 * fabsq(truth) + units * 0x1p-1074)) {
        fail_at(d, what, got, truth);
    }
}

static void check_values(const struct draw *d)
{
    double u = brdffit_smith_argument(&d->scale, d->s), phi, minus_ell, slope, exponent = d->c * u, units = UNITS_PHI;
    struct jet truth = oracle_local(d->family, &d->scale, u, d->c, d->light, d->view);
    struct smith_point at;

    brdffit_smith_point(d->family, &d->scale, u, &at);
    brdffit_smith_shape(d->family, &at, &d->c, &d->light, &d->view, 1, &phi);
    brdffit_smith_slopes(d->family, &at, &d->c, &d->light, &d->view, 1, &minus_ell, &slope);
    units += oracle_exponential(d->family) ? exponent : UNITS_GGX;
    if (oracle_exponential(d->family) && exponent > 707.9) {
        assert_true(phi >= 0.0 && phi < 1e-307 * at.scale);
    } else {
        assert_units(d, "phi", phi, truth.f, units);
    }
    assert_units(d, "-ell", minus_ell, truth.d1, UNITS_ELL);
    assert_units(d, "slope", slope, truth.d2, UNITS_SLOPE);
}

static void values_are_what_they_say(void **state)
{
    struct brdffit_test_random random = {1};
    int i, family;

    (void)state;
    for (i = 0; i < TRIPLES; i++) {
        for (family = 0; family < FAMILIES; family++) {
            struct draw d = draw_at(&random, (enum smith_family)family);

            check_values(&d);
        }
    }
}

/* u without the rounding that ends its rise near 1 / kappa. */
static quad argument(const struct draw *d, quad s)
{
    return s / (1 + d->scale.kappa * s);
}

/* The proof of smith.h, attacked: in 113 bits every function is >= 0 and falls, for triples and u that are near or far. */
static void everything_falls(void **state)
{
    struct brdffit_test_random random = {2};
    const quad slack = 1 + (quad)1e-28;
    int i, family;

    (void)state;
    for (i = 0; i < TRIPLES; i++) {
        for (family = 0; family < FAMILIES; family++) {
            struct draw d = draw_at(&random, (enum smith_family)family);
            double ratio = 1.0 + brdffit_test_log_uniform(&random, 1e-9, 1e9);
            quad low = argument(&d, d.s), high = argument(&d, (quad)d.s * ratio);
            struct jet a = oracle_local(d.family, &d.scale, low, d.c, d.light, d.view);
            struct jet b = oracle_local(d.family, &d.scale, high, d.c, d.light, d.view);

            if (!(b.f <= a.f * slack && b.d1 <= a.d1 * slack && b.d2 <= a.d2 * slack && b.f >= 0 && b.d1 >= 0 &&
                  b.d2 >= 0)) {
                fail_at(&d, "does not fall", (double)b.d2, a.d2);
            }
        }
    }
}

static quad logarithm(const struct draw *d, quad u)
{
    return logq(oracle_local(d->family, &d->scale, u, d->c, d->light, d->view).f);
}

static quad minus_ell_at(const struct draw *d, quad u)
{
    return oracle_local(d->family, &d->scale, u, d->c, d->light, d->view).d1;
}

/* f' of fourth order; h^4 = 1e-20 of the fifth derivative. */
static quad difference(const struct draw *d, quad (*f)(const struct draw *, quad), quad u)
{
    quad h = u * 1e-5;

    return (8 * (f(d, u + h) - f(d, u - h)) - (f(d, u + 2 * h) - f(d, u - 2 * h))) / (12 * h);
}

/* The oracle is the definition times a scalar, and its derivatives are difference quotients: both to 1e-16 of 1/u. */
static void oracle_is_the_definition(void **state)
{
    struct brdffit_test_random random = {3};
    int i;

    (void)state;
    for (i = 0; i < 20000; i++) {
        struct draw d = draw_at(&random, (enum smith_family)(i % FAMILIES));
        quad u = brdffit_smith_argument(&d.scale, d.s), s = u / (1 - d.scale.kappa * u), part, product;
        struct jet at = oracle_local(d.family, &d.scale, u, d.c, d.light, d.view);

        if (!(d.c * u < 100) || !(d.scale.kappa * u < 0.999)) {
            continue;
        }
        part = s / (s + d.scale.widest);
        product = at.f * (oracle_separable(d.family) ? part : sqrtq(part));
        part = oracle_exponential(d.family) ? expq(-d.c * s)
                                            : oracle_normals(d.family, s, (quad)d.scale.c_min + d.c) /
                                                  oracle_normals(d.family, s, d.scale.c_min);
        product /= part * oracle_masking(d.family, s, d.light, d.view);
        assert_true(fabsq(product - 1) < 1e-26);
        assert_true(fabsq(difference(&d, logarithm, u) + at.d1) < 1e-16 * (at.d1 + 1e-6 / u));
        assert_true(fabsq(difference(&d, minus_ell_at, u) + at.d2) < 1e-15 * (at.d2 + 1e-6 / (u * u)));
    }
}

static void check_published(const struct draw *d)
{
    double masking = brdffit_smith_masking(d->family, d->s, d->light, d->view), c = d->c + d->scale.c_min;
    struct twofold s = {d->s, 0x1p-55 * d->s};
    quad wide_s = (quad)s.high + s.low, truth = oracle_masking(d->family, d->s, d->light, d->view), whole;
    struct wide phi = brdffit_smith_phi(d->family, s, c, d->light, d->view);

    assert_units(d, "G2", masking, truth, UNITS_MASKING);
    assert_units(d, "conversion", brdffit_smith_conversion(d->family, &d->scale, d->s),
                 powq(d->s / ((quad)d->s + d->scale.widest), oracle_separable(d->family) ? 1 : (quad)0.5), 3.0);
    if (oracle_exponential(d->family) && c * d->s > 1e4) {
        return; /* below any quad */
    }
    whole = oracle_normals(d->family, wide_s, c) * oracle_masking(d->family, wide_s, d->light, d->view);
    assert_units(d, "phi as published", 1.0, whole / scalbnq(phi.value, (int)phi.exponent), UNITS_ACCURATE);
}

static void published_values_are_accurate(void **state)
{
    struct brdffit_test_random random = {4};
    int i;

    (void)state;
    for (i = 0; i < TRIPLES; i++) {
        struct draw d = draw_at(&random, (enum smith_family)(i % FAMILIES));

        check_published(&d);
    }
}

/* -d ln G2 / d ln tan^2 by differences in 113 bits; never above what is promised, nor together where they share. */
static void tangents_are_derivatives(void **state)
{
    struct brdffit_test_random random = {5};
    int i;

    (void)state;
    for (i = 0; i < TRIPLES; i++) {
        struct draw d = draw_at(&random, (enum smith_family)(i % FAMILIES));
        quad h = 1e-8, up, down;
        double got[2];

        brdffit_smith_tangents(d.family, d.s, d.light, d.view, got);
        up = oracle_masking(d.family, d.s, d.light * (1 + h), d.view);
        down = oracle_masking(d.family, d.s, d.light * (1 - h), d.view);
        up = logq(down / up) / (2 * h);
        if (!(fabsq(up - got[0]) <= 1e-13 * up + 1e-18)) {
            fail_at(&d, "tangent", got[0], up);
        }
        assert_true(got[0] >= 0.0 && got[0] <= 0.5 && got[1] >= 0.0 && got[1] <= 0.5);
        assert_true(got[0] <= (1.0 + 0x1p-50) * (d.light / d.s / 4.0) &&
                    got[1] <= (1.0 + 0x1p-50) * (d.view / d.s / 4.0));
        assert_true(oracle_separable(d.family) || got[0] + got[1] <= 0.5 + 0x1p-52);
    }
}

/* Normal incidence, a problem of nothing else, and samples that sit on M. */
static void normal_incidence_is_exact(void **state)
{
    static const double zero = 0.0, c = 0.25;
    double s, phi, x, slope, expected;
    int family;

    (void)state;
    for (family = 0; family < FAMILIES; family++) {
        struct smith_scale scale;
        struct smith_point at;

        brdffit_smith_scale((enum smith_family)family, 0.0, 0.0, &scale);
        for (s = 1e-6; s < 1e24; s *= 7.0) {
            assert_true(brdffit_smith_masking((enum smith_family)family, s, 0.0, 0.0) == 1.0);
            assert_true(brdffit_smith_conversion((enum smith_family)family, &scale, s) == 1.0);
            brdffit_smith_point((enum smith_family)family, &scale, s, &at);
            brdffit_smith_shape((enum smith_family)family, &at, &zero, &zero, &zero, 1, &phi);
            assert_true(fabs(phi - 1.0) <= 0x1p-51);
            brdffit_smith_slopes((enum smith_family)family, &at, &zero, &zero, &zero, 1, &x, &slope);
            assert_true(x == 0.0 && slope == 0.0);
            brdffit_smith_slopes((enum smith_family)family, &at, &c, &zero, &zero, 1, &x, &slope);
            expected = oracle_exponential((enum smith_family)family) ? c : 2.0 * c / (1.0 + c * s);
            assert_true(fabs(x - expected) <= 4.0 * 0x1p-53 * expected);
        }
    }
}

/* As far as geometry and options let anything go: no infinity, no NaN, nothing below 0, phi at least 1 at c' = 0. */
static void corners_are_finite(void **state)
{
    static const double s[] = {1e-6, 1.0 / 36.0, 1.0, 1e12, 1e24}, c[] = {0.0, 1e-300, 1e-20, 1.0, LIMIT_C};
    static const double tan2[] = {0.0, 5e-324, 1e-300, 1e-30, 1.0, 1e12, 1e60};
    size_t i, j, k, l, m, family;

    (void)state;
    for (family = 0; family < FAMILIES; family++) {
        for (i = 0; i < 5 * 5; i++) {
            for (j = 0; j < 5; j++) {
                for (m = 0; m < 7 * 7 * 7; m++) {
                    struct draw d = {(enum smith_family)family, {0.0, 0.0, 0.0}, s[i % 5], c[j], 0.0, 0.0};
                    double phi, x, slope;
                    struct smith_point at;

                    k = m % 7;
                    l = m / 7 % 7;
                    d.light = tan2[k];
                    d.view = tan2[l];
                    brdffit_smith_scale(d.family, c[i / 5], fmax(fmax(tan2[k], tan2[l]), tan2[m / 49]), &d.scale);
                    brdffit_smith_point(d.family, &d.scale, brdffit_smith_argument(&d.scale, d.s), &at);
                    brdffit_smith_shape(d.family, &at, &d.c, &d.light, &d.view, 1, &phi);
                    brdffit_smith_slopes(d.family, &at, &d.c, &d.light, &d.view, 1, &x, &slope);
                    if (!(phi >= 0.0 && x >= 0.0 && slope >= 0.0 && phi < 1e140 && x < INFINITY && slope < INFINITY) ||
                        (d.c == 0.0 && !(phi >= 1.0 - 0x1p-50))) {
                        fail_at(&d, "corner", phi, x);
                    }
                }
            }
        }
    }
}

/* A sample has the same bits alone and in any company, and with light and viewer exchanged. */
static void samples_do_not_see_each_other(void **state)
{
    struct brdffit_test_random random = {6};
    double c[13], light[13], view[13], phi[13], x[13], slope[13], one[3];
    int i, family;
    size_t j;

    (void)state;
    for (i = 0; i < 400; i++) {
        struct draw d = draw_at(&random, SMITH_GGX);

        for (j = 0; j < 13; j++) {
            c[j] = draw_c(&random, d.s);
            light[j] = fmin(draw_tan2(&random, d.s), d.scale.widest);
            view[j] = fmin(draw_tan2(&random, d.s), d.scale.widest);
        }
        for (family = 0; family < FAMILIES; family++) {
            struct smith_point at;

            brdffit_smith_scale((enum smith_family)family, d.scale.c_min, d.scale.widest, &d.scale);
            brdffit_smith_point((enum smith_family)family, &d.scale, brdffit_smith_argument(&d.scale, d.s), &at);
            brdffit_smith_shape((enum smith_family)family, &at, c, light, view, 13, phi);
            brdffit_smith_slopes((enum smith_family)family, &at, c, light, view, 13, x, slope);
            for (j = 0; j < 13; j++) {
                brdffit_smith_shape((enum smith_family)family, &at, c + j, view + j, light + j, 1, one);
                brdffit_smith_slopes((enum smith_family)family, &at, c + j, view + j, light + j, 1, one + 1, one + 2);
                assert_memory_equal(one, &phi[j], sizeof *one);
                assert_memory_equal(one + 1, &x[j], sizeof *one);
                assert_memory_equal(one + 2, &slope[j], sizeof *one);
            }
        }
    }
}

/* Of equal weights: beyond the tail, phi over that of a sample of c = c_min stays where it is. */
static void nothing_changes_in_the_tail(void **state)
{
    struct brdffit_test_random random = {7};
    const double bb[2] = {1.0, 1.0};
    int i;

    (void)state;
    for (i = 0; i < 20000; i++) {
        struct draw d = draw_at(&random, (enum smith_family)(i % FAMILIES));
        double c[2] = {0.0, d.c}, tail;
        quad ratio[2], u;
        int far;

        tail = brdffit_smith_tail(d.family, &d.scale, c, bb, 2);
        for (far = 0; far < 2 && tail > 0.0 && tail < 1e200; far++) {
            u = argument(&d, far ? 1e6 * tail : tail);
            ratio[far] = oracle_local(d.family, &d.scale, u, c[1], d.light, d.view).f /
                         oracle_local(d.family, &d.scale, u, c[0], d.view, d.scale.widest / 4).f;
        }
        if (far == 2 && !(fabsq(ratio[0] - ratio[1]) < 4 * expq(-TAIL_EXPONENT))) {
            fail_at(&d, "tail", (double)ratio[0], ratio[1]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_what_they_say),    cmocka_unit_test(everything_falls),
        cmocka_unit_test(oracle_is_the_definition),    cmocka_unit_test(published_values_are_accurate),
        cmocka_unit_test(tangents_are_derivatives),    cmocka_unit_test(normal_incidence_is_exact),
        cmocka_unit_test(corners_are_finite),          cmocka_unit_test(samples_do_not_see_each_other),
        cmocka_unit_test(nothing_changes_in_the_tail),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
