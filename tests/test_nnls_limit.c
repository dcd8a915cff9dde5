/*
 * The restricted problem with a limit a.z <= 1 against brute force in long double: never worse than the best point that
 * elimination of every support finds, feasible, a KKT point; where the limit does not bind, the bits of the plain solution.
 * SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "physical_oracle.h"
#include "solve/nnls.h"
#include "support.h"

#define PROBLEMS FEWER(20000, 2000)
#define ROWS 24

struct problem {
    size_t rows;
    int columns;
    double column[NNLS_COLUMNS][ROWS], data[ROWS], a[NNLS_COLUMNS], q[NNLS_COLUMNS * ROWS], residual[ROWS];
    const double *pointer[NNLS_COLUMNS];
};

/* Columns >= 0, some nearly equal or the same, of any size; a that binds, hardly, hugely, or is infinite for a column. */
static void draw(struct problem *p, struct brdffit_test_random *r)
{
    double size = brdffit_test_below(r, 4) ? 1.0 : brdffit_test_log_uniform(r, 1e-120, 1e120);
    double tight = brdffit_test_log_uniform(r, 1e-3, 1e4), close = brdffit_test_log_uniform(r, 1e-15, 1.0);
    int alike = brdffit_test_below(r, 3) == 0, negative = brdffit_test_below(r, 3) == 0, j;
    size_t i;

    p->rows = 8 + 8 * brdffit_test_below(r, 3);
    p->columns = 1 + (int)brdffit_test_below(r, NNLS_COLUMNS);
    for (j = 0; j < p->columns; j++) {
        double scale = size == 1.0 ? 1.0 : brdffit_test_log_uniform(r, 1e-120, 1e120);
        int same = alike && j > 0 && brdffit_test_below(r, 4) == 0;

        for (i = 0; i < p->rows; i++) {
            double v = brdffit_test_uniform(r, 0.0, 1.0);

            p->column[j][i] = same ? p->column[j - 1][i] * (1.0 + close * v) : scale * v * v * v;
        }
        p->pointer[j] = p->column[j];
        p->a[j] = tight / size * brdffit_test_log_uniform(r, 0.01, 10.0);
        p->a[j] = brdffit_test_below(r, 20) == 0 ? (double)INFINITY : brdffit_test_below(r, 20) == 0 ? 0.0 : p->a[j];
    }
    for (i = 0; i < p->rows; i++) {
        p->data[i] = size * brdffit_test_uniform(r, negative ? -0.5 : 0.0, 1.0);
    }
}

/* The same with unit columns and data of about 1, in long double. */
static void oracle_of(const struct problem *p, const struct nnls *nnls, double data_scale, struct physical_oracle *o)
{
    size_t i;
    int j;

    o->rows = p->rows;
    o->columns = p->columns;
    for (i = 0; i < p->rows; i++) {
        o->data[i] = (long double)p->data[i] / data_scale;
        for (j = 0; j < p->columns; j++) {
            o->column[j][i] = nnls->norm[j] > 0.0 ? (long double)p->column[j][i] / nnls->scale[j] / nnls->norm[j]
                                                  : 0.0L;
        }
    }
    for (j = 0; j < p->columns; j++) {
        o->a[j] = isinf(p->a[j]) ? 1e40L : (long double)p->a[j] * data_scale;
    }
}

/* Rounding of sums over the data's norm; near-collinear columns make no difference to residuals. */
#define TOLERANCE 1e-13L

static int judge(struct problem *p, unsigned seed)
{
    struct nnls nnls;
    struct nnls_answer answer, plain;
    struct physical_oracle o;
    long double z[PO_COLUMNS], best, here, norm2, counts = 0.0L;
    int j;

    brdffit_nnls_factor(&nnls, brdffit_kernels(BRDFFIT_ISA_AUTO), p->rows, p->columns, p->pointer, p->q);
    brdffit_nnls_solve(&nnls, p->data, p->residual, &plain);
    brdffit_nnls_solve_limited(&nnls, p->data, p->a, p->residual, &answer);
    oracle_of(p, &nnls, answer.data_scale, &o);
    best = physical_best(&o, z);
    norm2 = po_dot(o.data, o.data, o.rows);
    for (j = 0; j < p->columns; j++) {
        assert_true(answer.unit[j] >= 0.0);
        z[j] = answer.unit[j];
        counts += answer.unit[j] > 0.0 ? o.a[j] * z[j] : 0.0L;
    }
    here = po_objective(&o, z);
    if (!(counts <= 1.0L + 1e-12L) || !(here <= best + TOLERANCE * norm2) ||
        !(fabsl(here - answer.rss) <= TOLERANCE * norm2) || !(answer.kkt <= 1e-12) ||
        (answer.multiplier > 0.0 && !(fabsl(counts - 1.0L) <= 1e-12L))) {
        fail_msg("seed %u, %d columns: %.17Lg (%.17g) where %.17Lg is possible, a.z %.17Lg, kkt %g, multiplier %g",
                 seed, p->columns, here, answer.rss, best, counts, answer.kkt, answer.multiplier);
    }
    return answer.multiplier > 0.0;
}

static void test_against_brute_force(void **state)
{
    static struct problem p;
    unsigned seed, binding = 0;

    (void)state;
    for (seed = 1; seed <= PROBLEMS; seed++) {
        struct brdffit_test_random random = {seed};

        draw(&p, &random);
        binding += (unsigned)judge(&p, seed);
    }
    assert_true(binding > PROBLEMS / 5 && binding < PROBLEMS - PROBLEMS / 10);
}

/* Columns that depend on each other: the one that counts for less is taken. */
static void test_dependent_columns(void **state)
{
    static struct problem p;
    size_t i;

    (void)state;
    p.rows = 8;
    p.columns = 2;
    for (i = 0; i < p.rows; i++) {
        p.column[0][i] = p.column[1][i] = p.data[i] = 1.0 + (double)i;
    }
    p.pointer[0] = p.column[0];
    p.pointer[1] = p.column[1];
    p.a[0] = 1e3;
    p.a[1] = 1e-3;
    assert_int_equal(judge(&p, 0), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_brute_force),
        cmocka_unit_test(test_dependent_columns),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
