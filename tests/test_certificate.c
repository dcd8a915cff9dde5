/*
 * Certified bounds of conic programs (src/certificate.c), attacked where the truth is known exactly: the
 * programs are made of small integers around an optimum (x, s, z) with s and z complementary, so h, c and
 * the optimal value c'x = -h'z are integers without rounding. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "solve/conic/certificate.h"
#include "conic_cases.h"

/* Room for rounding below a bound of a few units with limits of 10: see sum_error(). */
#define SLACK 1e-12

/* min -x - 2y, x + y <= 4, x + 3y <= 6, x, y >= 0: (3, 1), -5, multipliers (1/2, 1/2, 0, 0). */
static void test_known_linear_program(void **state)
{
    static const double g[] = {1, 1, -1, 0, 1, 3, 0, -1};
    static const double c[] = {-1, -2}, h[] = {4, 6, 0, 0};
    static const double lower[] = {-10, -10}, upper[] = {10, 10};
    const struct conic_shape shape = {2, 4, 0, NULL, NULL, NULL};
    const struct conic_data data = {g, c, h};
    double z[] = {0.5, 0.5, 0, 0};
    double bound = brdffit_socp_certified_bound(&shape, &data, lower, upper, z);
    double nothing[] = {0, 0, 0, 0};
    double off[] = {0.5, 0.5, 0.25, 0};

    (void)state;
    assert_true(bound <= -5.0 && bound > -5.0 - SLACK);
    /* z = 0: the worst corner of the limits. */
    bound = brdffit_socp_certified_bound(&shape, &data, lower, upper, nothing);
    assert_true(bound <= -30.0 && bound > -30.0 - SLACK);
    /* A residual of -1/4 in x is charged at x = 10. */
    bound = brdffit_socp_certified_bound(&shape, &data, lower, upper, off);
    assert_true(bound <= -7.5 && bound > -7.5 - SLACK);
}

/* min x + y over the unit disc: -sqrt 2. */
static void test_known_cone(void **state)
{
    static const double g[] = {0, -1, 0, 0, 0, -1};
    static const double c[] = {1, 1}, h[] = {1, 0, 0};
    static const double limit[] = {INFINITY, INFINITY}, under[] = {-INFINITY, -INFINITY};
    static const size_t cone[] = {3};
    const struct conic_shape shape = {2, 0, 1, cone, NULL, NULL};
    const struct conic_data data = {g, c, h};
    const double lower[] = {-1, -1}, upper[] = {1, 1};
    double z[] = {0, 1, 1}; /* raised to sqrt 2 */
    double bound = brdffit_socp_certified_bound(&shape, &data, lower, upper, z);

    (void)state;
    assert_true(bound <= -sqrt(2.0) && bound > -sqrt(2.0) - SLACK);
    assert_true(z[0] >= sqrt(2.0) && z[0] < sqrt(2.0) + 1e-14);
    /* The residual is known only to rounding, and x is not limited: nothing is proven. */
    assert_true(brdffit_socp_certified_bound(&shape, &data, under, limit, z) == -INFINITY);
}

/* x >= 1 and x <= 0 cannot both hold. */
static void test_infeasibility_is_proven(void **state)
{
    static const double g[] = {-1, 1}, zero[] = {0}, h[] = {-1, 0};
    static const double lower[] = {-1e6}, upper[] = {1e6};
    const struct conic_shape shape = {1, 2, 0, NULL, NULL, NULL};
    const struct conic_data data = {g, zero, h};
    double z[] = {1, 1};

    (void)state;
    assert_true(brdffit_socp_certified_bound(&shape, &data, lower, upper, z) > 0.999);
}

static void test_refuses_what_is_not_finite(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    const struct conic_shape shape = {1, 1, 0, NULL, NULL, NULL};
    double number[6];
    size_t i, k;

    (void)state;
    for (k = 0; k < 3; k++) {
        for (i = 0; i < 6; i++) {
            /* g, c, h, lower, upper, z */
            const struct conic_data data = {number, number + 1, number + 2};

            number[0] = -1;
            number[1] = 1;
            number[2] = 0;
            number[3] = 0;
            number[4] = 1;
            number[5] = 1;
            assert_true(brdffit_socp_certified_bound(&shape, &data, number + 3, number + 4, number + 5) <= 0.0);
            number[5] = 2; /* residual 1 - 2 = -1, so that the upper limit matters */
            number[i] = bad[k];
            if ((i == 3 && k == 2)) {
                continue; /* a lower limit of -infinity is one, and the residual does not meet it */
            }
            assert_true(brdffit_socp_certified_bound(&shape, &data, number + 3, number + 4, number + 5) == -INFINITY);
        }
    }
}

static void test_overflow_proves_nothing(void **state)
{
    static const double g[] = {1e200}, c[] = {1}, h[] = {1e200}, lower[] = {-1}, upper[] = {1};
    const struct conic_shape shape = {1, 1, 0, NULL, NULL, NULL};
    const struct conic_data data = {g, c, h};
    double z[] = {1e200};

    (void)state;
    assert_true(brdffit_socp_certified_bound(&shape, &data, lower, upper, z) == -INFINITY);
}

static void check_shape(int expected, size_t variables, size_t linear, size_t cones, const size_t *cone,
                        const size_t *column, const size_t *row)
{
    const struct conic_shape shape = {variables, linear, cones, cone, column, row};

    assert_int_equal(expected, brdffit_conic_valid(&shape));
}

static void test_shapes(void **state)
{
    static const size_t cone[] = {3, 2}, flat[] = {3, 1}, huge[] = {3, SIZE_MAX - 1};
    static const size_t column[] = {0, 2, 3}, backwards[] = {0, 2, 1}, late[] = {1, 2, 3};
    static const size_t row[] = {0, 1, 0}, twice[] = {1, 1, 0}, outside[] = {0, 2, 0};

    (void)state;
    assert_int_equal(0, brdffit_conic_valid(NULL));
    check_shape(1, 2, 0, 2, cone, NULL, NULL);
    check_shape(0, 0, 2, 0, NULL, NULL, NULL);
    check_shape(0, 2, 0, 0, NULL, NULL, NULL);
    check_shape(0, 2, 0, 2, NULL, NULL, NULL);
    check_shape(0, 2, 0, 2, flat, NULL, NULL);
    check_shape(0, 2, 0, 2, huge, NULL, NULL);
    check_shape(0, SIZE_MAX / 8, 16, 0, NULL, NULL, NULL);
    check_shape(0, 2, SIZE_MAX, 0, NULL, NULL, NULL);
    check_shape(1, 2, 2, 0, NULL, column, row);
    check_shape(0, 2, 2, 0, NULL, column, NULL);
    check_shape(0, 2, 2, 0, NULL, NULL, row);
    check_shape(0, 2, 2, 0, NULL, backwards, row);
    check_shape(0, 2, 2, 0, NULL, late, row);
    check_shape(0, 2, 2, 0, NULL, column, twice);
    check_shape(0, 2, 2, 0, NULL, column, outside);
}

/* The same program, dense and sparse: only the number of terms that are charged for rounding differs. */
static void test_sparse_equals_dense(void **state)
{
    static const double g[] = {1, 0, -1, 0, 3, 0}, entries[] = {1, -1, 3};
    static const size_t column[] = {0, 2, 3}, row[] = {0, 2, 1};
    static const double c[] = {-1, -3}, h[] = {4, 6, 1}, lower[] = {-2, -3}, upper[] = {5, 7};
    const struct conic_shape dense = {2, 3, 0, NULL, NULL, NULL}, sparse = {2, 3, 0, NULL, column, row};
    const struct conic_data full = {g, c, h}, packed = {entries, c, h};
    double z[] = {0.7, 0.9, 0.1}, again[] = {0.7, 0.9, 0.1};

    (void)state;
    assert_true(fabs(brdffit_socp_certified_bound(&dense, &full, lower, upper, z) -
                     brdffit_socp_certified_bound(&sparse, &packed, lower, upper, again)) < SLACK);
    assert_memory_equal(z, again, sizeof z);
}

/* Whatever z is, its bound must not exceed the exact optimum; at the exact z it must reach it. */
static void attack(uint64_t *seed)
{
    struct conic_case problem;
    double lower[CASE_VARIABLES], upper[CASE_VARIABLES], z[CASE_ROWS];
    size_t i;
    int trial;

    conic_case_make(&problem, seed);
    for (i = 0; i < problem.shape.variables; i++) {
        lower[i] = problem.x[i] - (double)conic_case_random(seed, 3);
        upper[i] = problem.x[i] + (double)conic_case_random(seed, 3);
    }
    for (trial = 0; trial < 24; trial++) {
        /* none, then relative noise of 1e-17 (nothing, or an ulp) to 1e3 */
        double noise = trial == 0 ? 0.0 : pow(10.0, trial - 20);
        double bound;

        for (i = 0; i < problem.rows; i++) {
            double wobble = (double)conic_case_random(seed, 2001) / 1000.0 - 1.0;

            z[i] = problem.z[i] * (1.0 + noise * wobble) + (trial > 12 ? noise * wobble : 0.0);
        }
        bound = brdffit_socp_certified_bound(&problem.shape, &problem.data, lower, upper, z);
        if (!(bound <= problem.optimum) || (trial == 0 && !(bound >= problem.optimum - 1e-11 * problem.scale))) {
            printf("optimum %.17g, bound %.17g, noise %g\n", problem.optimum, bound, noise);
            conic_case_print(&problem);
            fail();
        }
    }
}

static void test_bounds_hold(void **state)
{
    uint64_t seed = 20160229;
    int i;

    (void)state;
    for (i = 0; i < 50000; i++) {
        attack(&seed);
    }
}

static double any_double(uint64_t *seed)
{
    return ldexp((double)conic_case_random(seed, INT64_C(1) << 53) - 4503599627370496.0,
                 (int)conic_case_random(seed, 8) - 56);
}

/* -h'z alone, against sums in long double (64 bits, errors 2000 times smaller). */
static void test_objective_is_rounded_down(void **state)
{
    static const double g[24], c[1], limit[1];
    const struct conic_shape shape = {1, 24, 0, NULL, NULL, NULL};
    uint64_t seed = 7;
    double h[24], z[24];
    const struct conic_data data = {g, c, h};
    int trial;
    size_t i;

    (void)state;
    for (trial = 0; trial < 20000; trial++) {
        long double exact = 0.0L, magnitude = 0.0L;
        double bound;

        for (i = 0; i < 24; i++) {
            h[i] = any_double(&seed);
            z[i] = fabs(any_double(&seed));
            exact -= (long double)h[i] * (long double)z[i];
            magnitude += fabsl((long double)h[i] * (long double)z[i]);
        }
        bound = brdffit_socp_certified_bound(&shape, &data, limit, limit, z);
        assert_true((long double)bound <= exact + 1e-18L * magnitude);
        assert_true((long double)bound >= exact - 1e-13L * magnitude);
    }
}

static void test_cone_is_reached(void **state)
{
    static const double zero[16], c[1], limit[1];
    const struct conic_data data = {zero, c, zero};
    uint64_t seed = 11;
    int trial;

    (void)state;
    for (trial = 0; trial < 20000; trial++) {
        size_t dimension = 2 + (size_t)conic_case_random(&seed, 15), i;
        const struct conic_shape shape = {1, 0, 1, &dimension, NULL, NULL};
        int exponent = (int)conic_case_random(&seed, 1800) - 900;
        long double squares = 0.0L;
        double z[16] = {0};

        for (i = 1; i < dimension; i++) {
            z[i] = any_double(&seed);
            squares += (long double)z[i] * (long double)z[i];
            z[i] = ldexp(z[i], exponent);
        }
        assert_true(brdffit_socp_certified_bound(&shape, &data, limit, limit, z) <= 0.0);
        assert_true(ldexpl((long double)z[0], -exponent) >= sqrtl(squares) * (1.0L - 1e-18L));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_linear_program),    cmocka_unit_test(test_known_cone),
        cmocka_unit_test(test_infeasibility_is_proven), cmocka_unit_test(test_refuses_what_is_not_finite),
        cmocka_unit_test(test_overflow_proves_nothing), cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_sparse_equals_dense),     cmocka_unit_test(test_objective_is_rounded_down),
        cmocka_unit_test(test_cone_is_reached),         cmocka_unit_test(test_bounds_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
