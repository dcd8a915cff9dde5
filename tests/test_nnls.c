/*
 * The restricted problem, dense form, against a long double reference on random and adversarial cases: collinear
 * to 1 ulp, zero columns, zero data, negative data, columns and data of any scale. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solve/nnls.h"
#include "nnls_case.h"

/* Smallest ||data - A z||^2 over z >= 0 by enumeration of supports with long double Gram-Schmidt. */
static long double reference_rss(const struct nnls_case *c)
{
    long double best = 0.0L, unit[NNLS_COLUMNS][CASE_ROWS], data[CASE_ROWS];
    unsigned bits;
    int i, j, k;

    for (i = 0; i < c->rows; i++) {
        data[i] = (long double)c->data[i] / c->data_scale;
        best += data[i] * data[i];
    }
    for (j = 0; j < c->columns; j++) {
        long double norm = 0.0L;

        for (i = 0; i < c->rows; i++) {
            unit[j][i] = (long double)c->column[j][i] / c->column_scale[j];
            norm += unit[j][i] * unit[j][i];
        }
        norm = sqrtl(norm);
        for (i = 0; i < c->rows && norm > 0.0L; i++) {
            unit[j][i] /= norm;
        }
    }
    for (bits = 1; bits < 1u << c->columns; bits++) {
        long double q[NNLS_COLUMNS][CASE_ROWS], r[NNLS_COLUMNS][NNLS_COLUMNS], t[NNLS_COLUMNS], z[NNLS_COLUMNS];
        long double rest[CASE_ROWS], rss = 0.0L;
        int index[NNLS_COLUMNS], n = 0, usable = 1;

        for (j = 0; j < c->columns; j++) {
            if (bits & (1u << j)) {
                index[n++] = j;
            }
        }
        for (j = 0; j < n && usable; j++) {
            long double norm = 0.0L;
            int pass;

            memcpy(q[j], unit[index[j]], sizeof q[j]);
            for (k = 0; k < j; k++) {
                r[k][j] = 0.0L;
            }
            for (pass = 0; pass < 2; pass++) {
                for (k = 0; k < j; k++) {
                    long double part = 0.0L;

                    for (i = 0; i < c->rows; i++) {
                        part += q[k][i] * q[j][i];
                    }
                    for (i = 0; i < c->rows; i++) {
                        q[j][i] -= part * q[k][i];
                    }
                    r[k][j] += part;
                }
            }
            for (i = 0; i < c->rows; i++) {
                norm += q[j][i] * q[j][i];
            }
            r[j][j] = sqrtl(norm);
            usable = r[j][j] > 1e-18L;
            for (i = 0; i < c->rows && usable; i++) {
                q[j][i] /= r[j][j];
            }
        }
        if (!usable) {
            continue;
        }
        memcpy(rest, data, sizeof rest);
        for (j = 0; j < n; j++) {
            t[j] = 0.0L;
            for (i = 0; i < c->rows; i++) {
                t[j] += q[j][i] * rest[i];
            }
            for (i = 0; i < c->rows; i++) {
                rest[i] -= t[j] * q[j][i];
            }
        }
        for (j = n - 1; j >= 0; j--) {
            z[j] = t[j];
            for (k = j + 1; k < n; k++) {
                z[j] -= r[j][k] * z[k];
            }
            z[j] /= r[j][j];
            usable = usable && z[j] >= 0.0L;
        }
        for (i = 0; i < c->rows; i++) {
            rss += rest[i] * rest[i];
        }
        if (usable && rss < best) {
            best = rss;
        }
    }
    return best;
}

/* Objective of an answer in long double, in the reference's units. */
static long double answer_rss(const struct nnls_case *c, const struct nnls *nnls, const struct nnls_answer *a)
{
    long double rss = 0.0L;
    int i, j;

    for (i = 0; i < c->rows; i++) {
        long double r = (long double)c->data[i] / c->data_scale;

        for (j = 0; j < c->columns; j++) {
            if (a->unit[j] > 0.0) {
                r -= (long double)a->unit[j] * (a->data_scale / c->data_scale) *
                     ((long double)c->column[j][i] / nnls->scale[j] / nnls->norm[j]);
            }
        }
        rss += r * r;
    }
    return rss;
}

/* slack: how far from the optimum, relative to the data's sum of squares, beside rounding. */
static void check_case(const struct nnls_case *c, long double slack)
{
    const double *column[NNLS_COLUMNS];
    double q[NNLS_COLUMNS * CASE_ROWS], residual[CASE_ROWS];
    struct nnls nnls;
    struct nnls_answer a;
    long double reference = reference_rss(c), data2 = 0.0L, mine;
    int i, j;

    for (j = 0; j < c->columns; j++) {
        column[j] = c->column[j];
    }
    for (i = 0; i < c->rows; i++) {
        data2 += ((long double)c->data[i] / c->data_scale) * ((long double)c->data[i] / c->data_scale);
    }
    brdffit_nnls_factor(&nnls, brdffit_kernels(BRDFFIT_ISA_AUTO), (size_t)c->rows, c->columns, column, q);
    brdffit_nnls_solve(&nnls, c->data, residual, &a);
    mine = answer_rss(c, &nnls, &a);
    for (j = 0; j < c->columns; j++) {
        assert_true(a.unit[j] >= 0.0 && isfinite(a.unit[j]));
        assert_true((a.unit[j] > 0.0) == ((a.support >> j) & 1u));
    }
    /* Never worse than the reference beyond rounding, and what it says of itself is true. */
    if (!(mine <= reference + (4e-16L + slack) * data2) || !(mine >= reference - 1e-18L * data2)) {
        nnls_case_print(c, stderr);
        fail_msg("kind %s: objective %.17Lg, reference %.17Lg, data %.3Lg", c->kind, mine, reference, data2);
    }
    {
        long double claimed = (long double)a.rss * (a.data_scale / c->data_scale) * (a.data_scale / c->data_scale);

        if (!(fabsl(claimed - mine) <= 4e-15L * sqrtl(data2 * mine) + 1e-30L * data2)) {
            nnls_case_print(c, stderr);
            fail_msg("kind %s: claims rss %.17Lg, has %.17Lg", c->kind, claimed, mine);
        }
    }
    assert_true(a.kkt >= 0.0);
    if (!(a.kkt <= 4e-15)) {
        nnls_case_print(c, stderr);
        fail_msg("kind %s: KKT residual %g", c->kind, a.kkt);
    }
}

static void test_cases(void **state)
{
    struct nnls_case c;
    uint64_t seed;

    (void)state;
    for (seed = 0; seed < 200000; seed++) {
        nnls_case_make(&c, seed, 1);
        check_case(&c, 0.0L);
    }
}

/*
 * An active set stops where no slope exceeds 16 u |t|_1 (nnls_active.c): no z of the optimum exceeds |t|, so that the
 * objective is 2 of that times sum z <= n |t| above the optimum at most, and |t|_1 <= sqrt(n) |t|.
 */
static long double steepest_slack(int columns)
{
    return 2.0L * 16.0L * 1.1102230246251565e-16L * columns * sqrtl((long double)columns);
}

/* Four columns by enumeration, five to seven by the active set. */
static void test_many_columns(void **state)
{
    static const uint64_t cases[NNLS_COLUMNS + 1] = {0, 0, 0, 0, 40000, 20000, 10000, 5000};
    struct nnls_case c;
    uint64_t seed;
    int columns;

    (void)state;
    for (columns = 4; columns <= NNLS_COLUMNS; columns++) {
        for (seed = 0; seed < cases[columns]; seed++) {
            nnls_case_many(&c, seed, columns, 1);
            check_case(&c, columns > NNLS_CLOSED ? steepest_slack(columns) : 0.0L);
        }
    }
}

/* Two columns by hand: I = 3 a + 2 g, and the boundary cases of the closed form. */
static void test_known(void **state)
{
    static const double a[3] = {1.0, 0.0, 0.0}, g[3] = {1.0, 1.0, 0.0};
    static const double both[3] = {5.0, 2.0, 0.0}, only_a[3] = {4.0, -1.0, 2.0}, none[3] = {-1.0, -1.0, 7.0};
    const double *column[2] = {a, g};
    double q[6], residual[3];
    struct nnls nnls;
    struct nnls_answer answer;

    (void)state;
    brdffit_nnls_factor(&nnls, brdffit_kernels(BRDFFIT_ISA_AUTO), 3, 2, column, q);
    brdffit_nnls_solve(&nnls, both, residual, &answer);
    assert_true(fabs(answer.z[0] - 3.0) < 1e-15 && fabs(answer.z[1] - 2.0) < 1e-15);
    assert_true(answer.rss < 1e-30);
    brdffit_nnls_solve(&nnls, only_a, residual, &answer);
    assert_int_equal(answer.support, 1);
    assert_true(fabs(answer.z[0] - 4.0) < 1e-15 && answer.z[1] == 0.0);
    brdffit_nnls_solve(&nnls, none, residual, &answer);
    assert_int_equal(answer.support, 0);
    assert_true(fabs(answer.rss * answer.data_scale * answer.data_scale - 51.0) < 1e-13);
}

/* Coefficients come back in the columns' own units whatever their scale. */
static void test_scales(void **state)
{
    int e, f;

    (void)state;
    for (e = -150; e <= 150; e += 25) {
        for (f = -150; f <= 150; f += 25) {
            double a[4] = {1.0, 0.5, 0.25, 0.125}, g[4] = {0.0, 1.0, 3.0, 9.0}, data[4], q[8], residual[4];
            const double *column[2] = {a, g};
            double sa = pow(10.0, e), sg = pow(10.0, f);
            struct nnls nnls;
            struct nnls_answer answer;
            int i;

            for (i = 0; i < 4; i++) {
                data[i] = 2.0 * a[i] + 0.5 * g[i];
                a[i] *= sa;
                g[i] *= sg;
            }
            brdffit_nnls_factor(&nnls, brdffit_kernels(BRDFFIT_ISA_AUTO), 4, 2, column, q);
            brdffit_nnls_solve(&nnls, data, residual, &answer);
            assert_true(fabs(answer.z[0] * sa - 2.0) < 1e-14);
            assert_true(fabs(answer.z[1] * sg - 0.5) < 1e-14);
            assert_true(answer.rss * answer.data_scale * answer.data_scale < 1e-28);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_cases),
        cmocka_unit_test(test_many_columns),
    };

    return cmocka_run_group_tests_name("nnls", tests, NULL, NULL);
}
