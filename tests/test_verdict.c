/*
 * What is claimed of a fit follows from its final numbers: every combination of telling ones, judged again in exact
 * arithmetic of another kind (long double after scaling). SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "fit/verdict.h"
#include "support.h"

static int number(double x)
{
    return isfinite(x) && x >= 0.0;
}

/* Whether the numbers prove the gap, within `slack` relative to what is compared. */
static int gap_holds(const struct evidence *v, int relative, long double slack)
{
    long double bound = number(v->bound) ? v->bound : 0.0; /* no E^2 is negative: 0 is always proven */
    long double most = ((long double)v->e2 + v->error) * (1.0L + slack);
    long double room = relative ? (long double)v->relative_gap * bound : (long double)v->absolute_gap * v->total;

    return number(v->e2) && number(v->error) && number(relative ? v->relative_gap : v->total) &&
           number(relative ? v->relative_gap : v->absolute_gap) && most - bound <= room * (1.0L - slack);
}

static void tell(const struct evidence *v, const struct verdict *out, const char *why)
{
    fail_msg("%s: e2 %a error %a bound %a total %a gaps %a %a ended %d -> stop %d certified %d bound %a gap %a", why,
             v->e2, v->error, v->bound, v->total, v->relative_gap, v->absolute_gap, v->ended, out->stop, out->certified,
             out->lower_bound, out->gap);
}

#define CLAIM(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            tell(&v, &out, #condition);                                                                                \
        }                                                                                                              \
    } while (0)

static void check(struct evidence v)
{
    struct verdict out = brdffit_verdict(&v);
    int contradicted = v.ended == BRDFFIT_STOP_CONTRADICTION;

    CLAIM((unsigned)out.stop < BRDFFIT_STOP_COUNT);
    CLAIM(number(out.lower_bound));
    CLAIM(out.lower_bound == 0.0 || (out.lower_bound <= v.bound && out.lower_bound <= v.e2));
    CLAIM(!number(v.e2) || out.gap == v.e2 - out.lower_bound);
    CLAIM(out.gap >= 0.0);
    CLAIM(out.certified == (out.stop == BRDFFIT_STOP_RELATIVE_GAP || out.stop == BRDFFIT_STOP_ABSOLUTE_GAP));
    CLAIM(!(out.certified && contradicted));
    CLAIM(out.stop != BRDFFIT_STOP_RELATIVE_GAP || gap_holds(&v, 1, 0.0L));
    CLAIM(out.stop != BRDFFIT_STOP_ABSOLUTE_GAP || (gap_holds(&v, 0, 0.0L) && !gap_holds(&v, 1, 1e-14L)));
    CLAIM(out.certified || out.stop == BRDFFIT_STOP_CONTRADICTION ||
          !(gap_holds(&v, 1, 1e-14L) || gap_holds(&v, 0, 1e-14L)) || v.e2 + v.error > DBL_MAX / 2.0);
    if (number(v.e2) && number(v.error) && v.bound > (v.e2 + v.error) * (1.0 + 1e-14)) {
        CLAIM(out.stop == BRDFFIT_STOP_CONTRADICTION && out.lower_bound == 0.0);
    }
    if (out.stop == BRDFFIT_STOP_CONTRADICTION) {
        CLAIM(out.lower_bound == 0.0 && !out.certified);
        CLAIM(contradicted || v.bound > v.e2 + v.error);
    }
    if (!out.certified && out.stop != BRDFFIT_STOP_CONTRADICTION) {
        CLAIM(out.stop == v.ended || out.stop == BRDFFIT_STOP_ROUNDING);
        CLAIM(out.stop == v.ended || v.ended == BRDFFIT_STOP_RELATIVE_GAP || v.ended == BRDFFIT_STOP_ABSOLUTE_GAP ||
              !((unsigned)v.ended < BRDFFIT_STOP_COUNT));
    }
}

static void test_combinations(void **state)
{
    static const double number_of[] = {0.0,         5e-324, 1e-323, 1e-310, DBL_MIN, 1e-200,  0.999,
                                       1.0,         1.001,  1.0011, 2.0,    1e200,   DBL_MAX, (double)INFINITY,
                                       (double)NAN, -1.0,   -0.0};
    static const double gaps[] = {0.0, 1e-16, 1e-3, 0.6, 1e300, (double)NAN, (double)INFINITY, -1.0};
    static const size_t n = sizeof number_of / sizeof *number_of, m = sizeof gaps / sizeof *gaps;
    size_t i, j, k, l, g, a;
    int ended;

    (void)state;
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            for (k = 0; k < n; k++) {
                for (l = 0; l < n; l++) {
                    for (g = 0; g < m; g++) {
                        for (a = 0; a < m; a++) {
                            ended = (int)((i + j + k + l + g + a) % (BRDFFIT_STOP_COUNT + 1));
                            check((struct evidence){number_of[i], number_of[j], number_of[k], number_of[l], gaps[g],
                                                    gaps[a], (brdffit_stop)ended});
                        }
                    }
                }
            }
        }
    }
}

/* Numbers at the edge of each comparison. */
static void test_edges(void **state)
{
    struct brdffit_test_random random = {20};
    size_t i;

    (void)state;
    for (i = 0; i < 400000; i++) {
        double size = i % 3 == 0 ? 5e-324 * (double)brdffit_test_below(&random, 40)
                                 : brdffit_test_log_uniform(&random, 1e-320, 1e300);
        double gap = brdffit_test_log_uniform(&random, 1e-15, 2.0), e2 = size, error, bound;
        double off = brdffit_test_log_uniform(&random, 1e-17, 1e-12) * (brdffit_test_below(&random, 2) ? 1.0 : -1.0);

        error = brdffit_test_below(&random, 2) ? 0.0 : e2 * brdffit_test_log_uniform(&random, 1e-17, 1e-10);
        bound = (i % 2 ? (e2 + error) / (1.0 + gap) : e2 + error) * (1.0 + off);
        check((struct evidence){e2, error, bound, 10.0 * e2, gap, i % 5 == 0 ? gap : 0.0,
                                (brdffit_stop)brdffit_test_below(&random, BRDFFIT_STOP_COUNT)});
    }
}

/* A verdict that is judged again, with other numbers, as sums do: never more than what the first left. */
static void test_again(void **state)
{
    struct evidence v = {1.0, 0.0, 0.9999, 2.0, 1e-3, 1e-12, BRDFFIT_STOP_RELATIVE_GAP};
    struct verdict out = brdffit_verdict(&v);

    (void)state;
    assert_int_equal(out.certified, 1);
    v.ended = out.stop;
    v.error = 0.1;
    out = brdffit_verdict(&v);
    assert_int_equal(out.certified, 0);
    assert_int_equal(out.stop, BRDFFIT_STOP_ROUNDING);
    v.bound = 1.2;
    out = brdffit_verdict(&v);
    assert_int_equal(out.stop, BRDFFIT_STOP_CONTRADICTION);
    v.ended = out.stop;
    v.bound = out.lower_bound;
    v.error = 0.0;
    out = brdffit_verdict(&v);
    assert_int_equal(out.stop, BRDFFIT_STOP_CONTRADICTION);
    assert_int_equal(out.certified, 0);
    assert_string_equal(brdffit_stop_string(BRDFFIT_STOP_CONTRADICTION), "contradiction");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_combinations),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_again),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
