/*
 * The restricted gain R(t, M) inside bounds: never below what any z reaches beyond its stated rounding, for
 * matrices that are positive semidefinite, nearly singular and indefinite; and attained.
 * SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "fewer.h"
#include "solve/nnls.h"
#include "nnls_case.h"
#include "base/tolerance.h"

struct gram_case {
    double t[3], cosine[3]; /* cosines 01, 02, 12 */
};

static double draw_cosine(uint64_t *s)
{
    switch (case_next(s) % 6) {
    case 0: return 0.0;
    case 1: return 1.0 - pow(10.0, -16.0 * case_uniform(s));
    case 2: return LIMIT_COSINE;
    case 3: return 1.0;
    default: return case_uniform(s);
    }
}

/* Gram matrices of real vectors (semidefinite), and arbitrary ones as perturbed bounds have them. */
static void draw(struct gram_case *c, uint64_t *s)
{
    int i, j;

    if (case_next(s) % 2) {
        double v[3][3], norm;

        for (i = 0; i < 3; i++) {
            for (norm = 0.0, j = 0; j < 3; j++) {
                double near = case_next(s) % 3 && i ? v[0][j] : 0.0;

                v[i][j] = fabs(near + pow(10.0, -15.0 * case_uniform(s)) * case_uniform(s));
                norm += v[i][j] * v[i][j];
            }
            for (j = 0; j < 3; j++) {
                v[i][j] /= sqrt(norm);
            }
        }
        for (i = 0; i < 3; i++) {
            int p = i == 2, q = i == 0 ? 1 : 2;

            c->cosine[i] = fmin(1.0, v[p][0] * v[q][0] + v[p][1] * v[q][1] + v[p][2] * v[q][2]);
        }
    } else {
        for (i = 0; i < 3; i++) {
            c->cosine[i] = draw_cosine(s);
        }
    }
    for (i = 0; i < 3; i++) {
        c->t[i] = case_next(s) % 8 ? case_uniform(s) : case_signed(s);
    }
    if (case_next(s) % 3 == 0) { /* on the edge between supports */
        c->t[1] = c->t[0] * c->cosine[0];
    }
}

static long double value_at(const struct gram_case *c, const long double *z)
{
    long double m01 = c->cosine[0], m02 = c->cosine[1], m12 = c->cosine[2];

    return z[0] * (2.0L * c->t[0] - z[0]) + z[1] * (2.0L * c->t[1] - z[1]) + z[2] * (2.0L * c->t[2] - z[2]) -
           2.0L * (m01 * z[0] * z[1] + m02 * z[0] * z[2] + m12 * z[1] * z[2]);
}

/* Coordinate ascent from z, feasible all the way: a lower bound of R that shares nothing with the code. */
static long double ascend(const struct gram_case *c, long double *z)
{
    int i;

    for (i = 0; i < 300; i++) {
        int j = i % 3;
        long double m[3] = {j == 0 ? 1.0L : c->cosine[j - 1], j == 1 ? 1.0L : c->cosine[j == 0 ? 0 : 2],
                            j == 2 ? 1.0L : c->cosine[j == 0 ? 1 : 2]};
        long double best = c->t[j], other;
        int k;

        for (k = 0; k < 3; k++) {
            other = k == j ? 0.0L : z[k];
            best -= m[k] * other;
        }
        z[j] = best > 0.0L ? best : 0.0L;
    }
    return value_at(c, z);
}

static void test_gain3(void **state)
{
    uint64_t s = 7;
    long trial;

    (void)state;
    for (trial = 0; trial < FEWER(200000, 20000); trial++) {
        struct gram_case c;
        long double z[3], best = 0.0L, norm2;
        double gain;
        int start;

        draw(&c, &s);
        norm2 = (long double)c.t[0] * c.t[0] + (long double)c.t[1] * c.t[1] + (long double)c.t[2] * c.t[2];
        gain = brdffit_nnls_gain(3, c.cosine, c.t);
        for (start = 0; start < 4; start++) {
            int j;
            long double here;

            for (j = 0; j < 3; j++) {
                z[j] = start == j ? fmaxl(c.t[j], 0.0L) : start == 3 ? case_uniform(&s) : 0.0L;
            }
            here = ascend(&c, z);
            best = here > best ? here : best;
        }
        if (!((long double)gain >= best - TOL_GAIN * TOL_UNIT * norm2)) {
            fail_msg("t %a %a %a cosines %a %a %a: gain %.17g below %.17Lg", c.t[0], c.t[1], c.t[2], c.cosine[0],
                     c.cosine[1], c.cosine[2], gain, best);
        }
        assert_true((long double)gain <= norm2 * (1.0L + 1e-15L));
        /* Attained where ascent converges fast: strictly diagonally dominant M. */
        if (c.cosine[0] < 0.45 && c.cosine[1] < 0.45 && c.cosine[2] < 0.45) {
            assert_true((long double)gain <= best + 1e-9L * norm2);
        }
    }
}

static void test_gain2(void **state)
{
    uint64_t s = 11;
    long trial;

    (void)state;
    for (trial = 0; trial < FEWER(200000, 20000); trial++) {
        struct gram_case c;
        long double z[3] = {0.0L, 0.0L, 0.0L}, best, norm2;
        double gain;

        draw(&c, &s);
        c.t[2] = -1.0;
        c.cosine[1] = c.cosine[2] = 0.0;
        norm2 = (long double)c.t[0] * c.t[0] + (long double)c.t[1] * c.t[1];
        gain = brdffit_nnls_gain(2, c.cosine, c.t);
        best = ascend(&c, z);
        assert_true((long double)gain >= best - TOL_GAIN * TOL_UNIT * norm2);
        assert_true((long double)gain <= norm2 * (1.0L + 1e-15L));
        if (c.cosine[0] < 0.8) {
            assert_true((long double)gain <= best + 1e-12L * norm2);
        }
    }
}

/* Larger t or smaller cosines never lower the gain beyond rounding: the bound rests on it. */
static void test_monotone(void **state)
{
    uint64_t s = 13;
    long trial;

    (void)state;
    for (trial = 0; trial < FEWER(200000, 20000); trial++) {
        struct gram_case c, d;
        double before, after, norm2;
        int i;

        draw(&c, &s);
        d = c;
        for (i = 0; i < 3; i++) {
            d.t[i] += case_next(&s) % 2 ? 0.1 * case_uniform(&s) : 0.0;
            d.cosine[i] *= case_next(&s) % 2 ? 1.0 - pow(10.0, -12.0 * case_uniform(&s)) : 1.0;
        }
        norm2 = d.t[0] * d.t[0] + d.t[1] * d.t[1] + d.t[2] * d.t[2];
        before = brdffit_nnls_gain(3, c.cosine, c.t);
        after = brdffit_nnls_gain(3, d.cosine, d.t);
        assert_true(after >= before - TOL_GAIN * TOL_UNIT * norm2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gain2),
        cmocka_unit_test(test_gain3),
        cmocka_unit_test(test_monotone),
    };

    return cmocka_run_group_tests_name("gain", tests, NULL, NULL);
}
