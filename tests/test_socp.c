/*
 * Second-order cone programs through ECOS (src/socp.c): known answers, verdicts, reuse, hostile scales, and
 * the traps that its header names. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "conic_cases.h"
#include "solve/conic/socp.h"

#ifdef BRDFFIT_NO_ECOS

static void test_unsupported(void **state)
{
    const struct conic_shape shape = {1, 1, 0, NULL, NULL, NULL}, none = {0, 1, 0, NULL, NULL, NULL};
    struct socp *socp = (struct socp *)&socp;

    (void)state;
    assert_int_equal(BRDFFIT_ERR_UNSUPPORTED, brdffit_socp_new(&shape, &socp));
    assert_null(socp);
    assert_int_equal(BRDFFIT_ERR_ARGUMENT, brdffit_socp_new(&none, &socp));
    assert_int_equal(BRDFFIT_ERR_UNSUPPORTED, brdffit_socp_solve(NULL, NULL, NULL, NULL, NULL));
    brdffit_socp_free(socp);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_unsupported)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

#define assert_near(expected, actual, tolerance) assert_true(fabs((actual) - (expected)) <= (tolerance))

/* ECOS stops at 1e-8 relative to norms of the scaled program; the worst of 10000 was 1e-7 of conic_case.scale. */
#define TOLERANCE 2e-7

static struct socp_result solve_once(const struct conic_shape *shape, const struct conic_data *data, double *x,
                                     double *z)
{
    struct socp *socp;
    struct socp_result result;

    assert_int_equal(BRDFFIT_OK, brdffit_socp_new(shape, &socp));
    assert_int_equal(BRDFFIT_OK, brdffit_socp_solve(socp, data, x, z, &result));
    brdffit_socp_free(socp);
    return result;
}

/* min t, |(x - 3, y - 4)| <= t, x <= 0: t = 3 at (0, 4); variables t, x, y. */
static void test_known_cone(void **state)
{
    static const double g[] = {0, -1, 0, 0, 1, 0, -1, 0, 0, 0, 0, -1};
    static const double c[] = {1, 0, 0}, h[] = {0, 0, -3, -4};
    static const double lower[] = {-9, -9, -9}, upper[] = {9, 9, 9};
    static const size_t cone[] = {3};
    const struct conic_shape shape = {3, 1, 1, cone, NULL, NULL};
    const struct conic_data data = {g, c, h};
    double x[3], z[4], bound;
    struct socp_result result = solve_once(&shape, &data, x, z);

    (void)state;
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    assert_near(3.0, x[0], 1e-7);
    assert_near(0.0, x[1], 1e-7);
    assert_near(4.0, x[2], 1e-4); /* the objective is flat in y to second order */
    assert_near(3.0, result.primal, 1e-7);
    assert_near(3.0, result.dual, 1e-7);
    assert_true(result.iterations >= 1 && result.iterations <= 100);
    bound = brdffit_socp_certified_bound(&shape, &data, lower, upper, z);
    assert_true(bound <= 3.0 && bound > 3.0 - 1e-6);
}

/* min -x - 2y, x + y <= 4, x + 3y <= 6, x, y >= 0: (3, 1), -5; sparse this time. */
static void test_known_linear_program(void **state)
{
    static const double g[] = {1, 1, -1, 1, 3, -1};
    static const size_t column[] = {0, 3, 6}, row[] = {0, 1, 2, 0, 1, 3};
    static const double c[] = {-1, -2}, h[] = {4, 6, 0, 0};
    const struct conic_shape shape = {2, 4, 0, NULL, column, row};
    const struct conic_data data = {g, c, h};
    double x[2], z[4];
    struct socp_result result = solve_once(&shape, &data, x, z);

    (void)state;
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    assert_near(3.0, x[0], 1e-7);
    assert_near(1.0, x[1], 1e-7);
    assert_near(0.5, z[0], 1e-7);
    assert_near(0.5, z[1], 1e-7);
    assert_near(-5.0, result.primal, 1e-7);
}

/* |(x - 1, y)| <= 1/2 and x <= 0: no point; the ray z proves it. */
static void test_infeasible(void **state)
{
    static const double g[] = {1, 0, -1, 0, 0, 0, 0, -1};
    static const double c[] = {1, 1}, zero[] = {0, 0}, h[] = {0, 0.5, -1, 0};
    static const double lower[] = {-1e3, -1e3}, upper[] = {1e3, 1e3};
    static const size_t cone[] = {3};
    const struct conic_shape shape = {2, 1, 1, cone, NULL, NULL};
    const struct conic_data data = {g, c, h}, feasibility = {g, zero, h};
    double x[2], z[4];
    struct socp_result result = solve_once(&shape, &data, x, z);

    (void)state;
    assert_int_equal(SOCP_PRIMAL_INFEASIBLE, result.outcome);
    assert_true(result.primal == INFINITY && result.dual == INFINITY);
    assert_near(-1.0, h[0] * z[0] + h[1] * z[1] + h[2] * z[2] + h[3] * z[3], 1e-12);
    assert_true(brdffit_socp_certified_bound(&shape, &feasibility, lower, upper, z) > 0.99);
}

/* min -x - y, |y| <= x (a cone of dimension 2). */
static void test_unbounded(void **state)
{
    static const double g[] = {-1, 0, 0, -1};
    static const double c[] = {-1, -1}, h[] = {0, 1};
    static const size_t cone[] = {2};
    const struct conic_shape shape = {2, 0, 1, cone, NULL, NULL};
    const struct conic_data data = {g, c, h};
    double x[2], z[2];
    struct socp_result result = solve_once(&shape, &data, x, z);

    (void)state;
    assert_int_equal(SOCP_DUAL_INFEASIBLE, result.outcome);
    assert_true(result.primal == -INFINITY && result.dual == -INFINITY);
    assert_near(-1.0, c[0] * x[0] + c[1] * x[1], 1e-12);
    assert_true(x[0] >= fabs(x[1]) - 1e-7);
}

/* One solver for problem after problem of a shape, against a new solver for each: the same bits. The
 * feasibility problem of a bound: min s, |r - A x| <= e'x + s, 0 <= x <= 4. */
#define REUSE_X 6
#define REUSE_N (REUSE_X + 1)
#define REUSE_CONE 9
#define REUSE_M (2 * REUSE_X + REUSE_CONE)

static double unit(uint64_t *seed)
{
    return (double)conic_case_random(seed, INT64_C(1) << 53) / 9007199254740992.0;
}

static void make_feasibility(double *g, double *c, double *h, uint64_t *seed)
{
    double size = pow(10.0, 24.0 * unit(seed) - 12.0);
    size_t i, j;

    memset(g, 0, REUSE_N * REUSE_M * sizeof *g);
    memset(c, 0, REUSE_N * sizeof *c);
    memset(h, 0, REUSE_M * sizeof *h);
    for (j = 0; j < REUSE_X; j++) {
        g[j * REUSE_M + j] = -1.0;
        g[j * REUSE_M + REUSE_X + j] = 1.0;
        h[REUSE_X + j] = 4.0;
        g[j * REUSE_M + 2 * REUSE_X] = -size * 0.1 * unit(seed);
        for (i = 1; i < REUSE_CONE; i++) {
            g[j * REUSE_M + 2 * REUSE_X + i] = size * (unit(seed) - 0.3);
        }
    }
    for (i = 1; i < REUSE_CONE; i++) {
        h[2 * REUSE_X + i] = size * (2.0 * unit(seed) - 0.2);
    }
    g[REUSE_X * REUSE_M + 2 * REUSE_X] = -1.0;
    c[REUSE_X] = 1.0;
}

static void check_feasibility(const struct conic_shape *shape, const struct conic_data *data,
                              const struct socp_result *result, const double *x, double *z)
{
    double lower[REUSE_N], upper[REUSE_N], bound, size = 0.0;
    size_t i;

    for (i = 0; i < REUSE_M; i++) {
        size = fmax(size, i < 2 * REUSE_X ? 0.0 : fabs(data->h[i]));
    }
    for (i = 0; i < REUSE_N; i++) {
        lower[i] = i < REUSE_X ? 0.0 : -100.0 * size;
        upper[i] = i < REUSE_X ? 4.0 : 100.0 * size;
    }
    assert_int_equal(SOCP_OPTIMAL, result->outcome);
    assert_true(fabs(result->primal - x[REUSE_X]) <= 1e-12 * size);
    bound = brdffit_socp_certified_bound(shape, data, lower, upper, z);
    if (!(bound <= result->primal + 1e-6 * size && bound >= result->primal - 1e-5 * size)) {
        printf("primal %.17g, certified %.17g, size %.17g\n", result->primal, bound, size);
        fail();
    }
}

static void test_reuse(void **state)
{
    static const size_t cone[] = {REUSE_CONE};
    const struct conic_shape shape = {REUSE_N, 2 * REUSE_X, 1, cone, NULL, NULL};
    double g[REUSE_N * REUSE_M], c[REUSE_N], h[REUSE_M];
    const struct conic_data data = {g, c, h};
    double x[REUSE_N], z[REUSE_M], fresh_x[REUSE_N], fresh_z[REUSE_M];
    uint64_t seed = 42;
    struct socp *socp;
    struct socp_result result, fresh;
    int trial;

    (void)state;
    assert_int_equal(BRDFFIT_OK, brdffit_socp_new(&shape, &socp));
    for (trial = 0; trial < 1000; trial++) {
        double kept[REUSE_N * REUSE_M + REUSE_N + REUSE_M];

        make_feasibility(g, c, h, &seed);
        memcpy(kept, g, sizeof g);
        memcpy(kept + REUSE_N * REUSE_M, c, sizeof c);
        memcpy(kept + REUSE_N * REUSE_M + REUSE_N, h, sizeof h);
        assert_int_equal(BRDFFIT_OK, brdffit_socp_solve(socp, &data, x, z, &result));
        /* the caller's numbers are left alone */
        assert_memory_equal(kept, g, sizeof g);
        assert_memory_equal(kept + REUSE_N * REUSE_M, c, sizeof c);
        assert_memory_equal(kept + REUSE_N * REUSE_M + REUSE_N, h, sizeof h);
        fresh = solve_once(&shape, &data, fresh_x, fresh_z);
        assert_memory_equal(fresh_x, x, sizeof x);
        assert_memory_equal(fresh_z, z, sizeof z);
        assert_int_equal(fresh.iterations, result.iterations);
        check_feasibility(&shape, &data, &result, x, z);
    }
    brdffit_socp_free(socp);
}

/* Every kind of problem in turn through one solver: no verdict leaks from one solve into the next. */
static void test_verdicts_do_not_leak(void **state)
{
    /* x in [0, 1] | x >= 1, x <= 0 | x >= 0 unlimited, for c = -1 */
    static const double box[] = {-1, 1}, open[] = {-1, 0};
    static const double inside[] = {0, 1}, empty[] = {-1, 0}, above[] = {0, 1};
    static const double c[] = {-1}, overflow[] = {-1e308, 1e308}, far[] = {1e308, -1e308};
    const struct conic_shape shape = {1, 2, 0, NULL, NULL, NULL};
    const struct conic_data optimal = {box, c, inside}, infeasible = {box, c, empty}, unbounded = {open, c, above};
    const struct conic_data extreme = {overflow, c, far};
    const struct conic_data *const order[] = {&optimal, &extreme, &infeasible, &extreme, &unbounded, &extreme};
    const int expected[] = {SOCP_OPTIMAL, -1, SOCP_PRIMAL_INFEASIBLE, -1, SOCP_DUAL_INFEASIBLE, -1};
    struct socp *socp;
    int round;
    size_t i;

    (void)state;
    assert_int_equal(BRDFFIT_OK, brdffit_socp_new(&shape, &socp));
    for (round = 0; round < 3; round++) {
        for (i = 0; i < 6; i++) {
            double x[1], z[2], fresh_x[1], fresh_z[2];
            struct socp_result result, fresh;

            assert_int_equal(BRDFFIT_OK, brdffit_socp_solve(socp, order[i], x, z, &result));
            fresh = solve_once(&shape, order[i], fresh_x, fresh_z);
            assert_int_equal(fresh.outcome, result.outcome);
            assert_memory_equal(fresh_x, x, sizeof x);
            assert_memory_equal(fresh_z, z, sizeof z);
            if (expected[i] >= 0) {
                assert_int_equal(expected[i], result.outcome);
            }
        }
    }
    brdffit_socp_free(socp);
}

/* Programs with integer data and an exactly known optimum, also with rows, columns, c and h scaled by powers
 * of two up to 2^+-60 on top of each other: the answer must follow. */
static void scale_case(struct conic_case *problem, uint64_t *seed, double *objective)
{
    int whole_h = (int)conic_case_random(seed, 121) - 60, whole_c = (int)conic_case_random(seed, 121) - 60;
    size_t i, j, row = 0;

    for (j = 0; j < problem->shape.variables; j++) {
        int by = (int)conic_case_random(seed, 81) - 40;

        problem->c[j] = ldexp(problem->c[j], by + whole_c);
        for (i = 0; i < problem->rows; i++) {
            problem->g[j * problem->rows + i] = ldexp(problem->g[j * problem->rows + i], by);
        }
    }
    while (row < problem->rows) {
        size_t end = row + 1, cone = 0, first = problem->shape.linear;
        int by = (int)conic_case_random(seed, 81) - 40;

        while (row >= problem->shape.linear && first < row) {
            first += problem->cone[cone++];
        }
        end = row < problem->shape.linear ? row + 1 : row + problem->cone[cone];
        for (; row < end; row++) {
            problem->h[row] = ldexp(problem->h[row], by + whole_h);
            for (j = 0; j < problem->shape.variables; j++) {
                problem->g[j * problem->rows + row] = ldexp(problem->g[j * problem->rows + row], by);
            }
        }
    }
    *objective = ldexp(1.0, whole_h + whole_c);
}

/* 1 for full accuracy, 0 for a result that ECOS itself calls inaccurate; nothing else will do. */
static int check_optimum(const struct conic_case *problem, const struct socp_result *result, double factor)
{
    double error = fabs(result->primal / factor - problem->optimum);

    if (!((result->outcome == SOCP_OPTIMAL || result->outcome == SOCP_INACCURATE) &&
          error <= TOLERANCE * problem->scale)) {
        printf("optimum %.17g, ECOS says %.17g, code %d\n", problem->optimum, result->primal / factor, result->code);
        conic_case_print(problem);
        fail();
    }
    return result->outcome == SOCP_OPTIMAL;
}

static void test_exact_optima_at_any_scale(void **state)
{
    uint64_t seed = 1234567;
    int trial, accurate = 0;

    (void)state;
    for (trial = 0; trial < 1000; trial++) {
        struct conic_case problem;
        struct socp_result result;
        double x[CASE_VARIABLES], z[CASE_ROWS], factor;

        conic_case_make(&problem, &seed);
        result = solve_once(&problem.shape, &problem.data, x, z);
        accurate += check_optimum(&problem, &result, 1.0);
        scale_case(&problem, &seed, &factor);
        result = solve_once(&problem.shape, &problem.data, x, z);
        accurate += check_optimum(&problem, &result, factor);
    }
    assert_true(accurate >= 1980);
}

static void test_refuses_what_is_not_finite(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    static const double good[] = {1, -1, 1, 1, 0}; /* g, c, h */
    const struct conic_shape shape = {1, 2, 0, NULL, NULL, NULL};
    struct socp_result result;
    struct socp *socp;
    size_t i, k;

    (void)state;
    assert_int_equal(BRDFFIT_OK, brdffit_socp_new(&shape, &socp));
    for (k = 0; k < 3; k++) {
        for (i = 0; i < 5; i++) {
            double number[5], x[1] = {7.0}, z[2];
            const struct conic_data data = {number, number + 2, number + 3};

            memcpy(number, good, sizeof number);
            assert_int_equal(BRDFFIT_OK, brdffit_socp_solve(socp, &data, x, z, &result));
            assert_int_equal(SOCP_OPTIMAL, result.outcome);
            number[i] = bad[k];
            x[0] = 7.0;
            assert_int_equal(BRDFFIT_ERR_VALUE, brdffit_socp_solve(socp, &data, x, z, &result));
            assert_true(x[0] == 7.0);
        }
    }
    brdffit_socp_free(socp);
}

/* Nothing but zeros; a variable that nothing holds; a row of zeros that cannot hold. */
static void test_degenerate(void **state)
{
    static const double zero[6], box[] = {-1, 1, 0, 0, 0, 0}, h[] = {0, 1, 0}, impossible[] = {0, 1, -1}, c[] = {1, 0};
    static const size_t column[] = {0, 2, 2}, row[] = {0, 1};
    const struct conic_shape shape = {2, 3, 0, NULL, NULL, NULL}, empty = {2, 3, 0, NULL, column, row};
    const struct conic_data nothing = {zero, zero, zero}, loose = {box, c, h}, never = {box, c, impossible};
    double x[2], z[3];
    struct socp_result result = solve_once(&shape, &nothing, x, z);

    (void)state;
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    assert_true(fabs(result.primal) <= TOLERANCE);
    result = solve_once(&shape, &loose, x, z);
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    assert_true(fabs(result.primal) <= TOLERANCE && isfinite(x[1]));
    result = solve_once(&shape, &never, x, z);
    assert_int_equal(SOCP_PRIMAL_INFEASIBLE, result.outcome);
    result = solve_once(&empty, &loose, x, z); /* a pattern with an empty row and an empty column */
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    assert_true(fabs(result.primal) <= TOLERANCE);
}

static void test_shape_is_checked(void **state)
{
    static const size_t flat[] = {1};
    static const size_t column[] = {0, 0};
    const struct conic_shape none = {0, 1, 0, NULL, NULL, NULL}, thin = {1, 0, 1, flat, NULL, NULL};
    const struct conic_shape empty = {1, 1, 0, NULL, column, column};
    struct socp *socp = (struct socp *)&socp;

    (void)state;
    assert_int_equal(BRDFFIT_ERR_ARGUMENT, brdffit_socp_new(&none, &socp));
    assert_null(socp);
    assert_int_equal(BRDFFIT_ERR_ARGUMENT, brdffit_socp_new(&thin, &socp));
    assert_int_equal(BRDFFIT_ERR_ARGUMENT, brdffit_socp_new(&empty, &socp));
    assert_int_equal(BRDFFIT_ERR_ARGUMENT, brdffit_socp_new(NULL, &socp));
    brdffit_socp_free(NULL);
}

static void on_interrupt(int number)
{
    (void)number;
}

/* What a solve writes to stdout and stderr, in bytes. */
static long bytes_written(const struct conic_shape *shape, const struct conic_data *data)
{
    int out = dup(STDOUT_FILENO), err = dup(STDERR_FILENO);
    FILE *caught = tmpfile();
    struct socp_result result;
    double x[1], z[1];
    long bytes;

    assert_true(out >= 0 && err >= 0 && caught);
    fflush(NULL);
    dup2(fileno(caught), STDOUT_FILENO);
    dup2(fileno(caught), STDERR_FILENO);
    result = solve_once(shape, data, x, z);
    fflush(NULL);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    assert_int_equal(0, fseek(caught, 0, SEEK_END));
    bytes = ftell(caught);
    fclose(caught);
    close(out);
    close(err);
    assert_int_equal(SOCP_OPTIMAL, result.outcome);
    return bytes;
}

static void test_signals_and_output_are_left_alone(void **state)
{
    static const double g[] = {-1}, c[] = {1}, h[] = {-2};
    const struct conic_shape shape = {1, 1, 0, NULL, NULL, NULL};
    const struct conic_data data = {g, c, h};
    struct sigaction ours, now;

    (void)state;
    memset(&ours, 0, sizeof ours);
    ours.sa_handler = on_interrupt;
    sigemptyset(&ours.sa_mask);
    assert_int_equal(0, sigaction(SIGINT, &ours, NULL));
    assert_int_equal(0, bytes_written(&shape, &data));
    assert_int_equal(0, sigaction(SIGINT, NULL, &now));
    assert_true(now.sa_handler == on_interrupt);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_cone),
        cmocka_unit_test(test_known_linear_program),
        cmocka_unit_test(test_infeasible),
        cmocka_unit_test(test_unbounded),
        cmocka_unit_test(test_reuse),
        cmocka_unit_test(test_verdicts_do_not_leak),
        cmocka_unit_test(test_exact_optima_at_any_scale),
        cmocka_unit_test(test_refuses_what_is_not_finite),
        cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_shape_is_checked),
        cmocka_unit_test(test_signals_and_output_are_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
