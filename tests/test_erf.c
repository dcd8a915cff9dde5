/*
 * Our erf against libquadmath's: a million arguments, subnormal and large ones included, one by one and in lanes.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/erf.h"
#include "quad/quad.h"
#include "support.h"

#define COUNT 1000000u

/* As base/erf.h says. */
#define ULPS 1.5
/* Of erf x - 2 x exp(-x^2) / sqrt(pi), in 2^-53 of it. */
#define REST_UNITS 8.0

/* A spacing of doubles at x >= 0. */
static double ulp_of(double x)
{
    return x >= 1.0 ? 0x1p-52 : nextafter(x, 2.0) - x;
}

/* All magnitudes; what is in between; neighbours of where the formula changes. */
static double draw(struct brdffit_test_random *random, size_t i)
{
    static const double edges[] = {1.0, ERF_LEVEL, 0x1p-1022, 0x1p-26};

    switch (i % 10) {
    case 0:
    case 1:
    case 2: return ldexp(brdffit_test_uniform(random, 1.0, 2.0), (int)brdffit_test_below(random, 2090) - 1074);
    case 3: {
        double edge = edges[brdffit_test_below(random, 4)];

        return edge + ((double)brdffit_test_below(random, 2000) - 1000.0) * ulp_of(edge < 1.0 ? edge : 1.0);
    }
    default: return brdffit_test_uniform(random, 0.0, 7.0);
    }
}

static void error_is_what_it_says(void **state)
{
    struct brdffit_test_random random = {1};
    size_t i;

    (void)state;
    for (i = 0; i < COUNT; i++) {
        double x = fabs(draw(&random, i)), got = kernel_erf(x), ulps = (double)(fabsq(erfq(x) - got) / ulp_of(got));

        if (!(ulps <= ULPS)) {
            fail_msg("erf(%a) = %a is off by %.3f ulp", x, got, ulps);
        }
    }
}

static void ends_are_exact(void **state)
{
    (void)state;
    assert_true(kernel_erf(0.0) == 0.0);
    assert_true(kernel_erf(ERF_LEVEL) == 1.0);
    assert_true(kernel_erf(1e308) == 1.0);
    assert_true(kernel_erf(INFINITY) == 1.0);
}

static void lanes_have_the_same_bits(void **state)
{
    struct brdffit_test_random random = {2};
    double x[VEC], got[VEC];
    size_t i, lane;

    (void)state;
    for (i = 0; i < 200000; i++) {
        for (lane = 0; lane < VEC; lane++) {
            x[lane] = fabs(draw(&random, brdffit_test_below(&random, 10)));
        }
        vec_store(got, vec_erf(vec_load(x)));
        for (lane = 0; lane < VEC; lane++) {
            double expected = kernel_erf(x[lane]);

            assert_memory_equal(&got[lane], &expected, sizeof expected);
        }
    }
}

/* 4 / sqrt(pi) x^3 times the integral of v^2 exp(-(x v)^2) over v from 0 to 1. */
static quad rest_of(quad x)
{
    quad z = x * x, term = 1, sum = 0, root = sqrtq(4 * atanq(1));
    int n;

    if (z > 0.01) {
        return erfq(x) - 2 * x * expq(-z) / root;
    }
    for (n = 0; n < 24; n++, term *= -z / n) {
        sum += term / (2 * n + 3);
    }
    return 4 * x * z * sum / root;
}

static void rest_does_not_cancel(void **state)
{
    struct brdffit_test_random random = {3};
    double got[VEC];
    size_t i;

    (void)state;
    for (i = 0; i < 200000; i++) {
        double x = i % 2 ? brdffit_test_uniform(&random, 0.0, 3.0)
                         : brdffit_test_log_uniform(&random, 1e-60, ERF_LEVEL);
        vec at = vec_set(x), z = at * at, gauss = vec_exp(-z);
        quad truth = rest_of(x);

        vec_store(got, vec_erf_rest(at, z, gauss, vec_erf_with(at, z, gauss)));
        if (!(fabsq(got[0] - truth) <= REST_UNITS * 0x1p-53 * truth)) {
            fail_msg("rest at %a: %a is off by %.3f u", x, got[0], (double)(fabsq(got[0] - truth) / truth * 0x1p53));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_is_what_it_says),
        cmocka_unit_test(ends_are_exact),
        cmocka_unit_test(lanes_have_the_same_bits),
        cmocka_unit_test(rest_does_not_cancel),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
