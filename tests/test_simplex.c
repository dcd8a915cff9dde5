/*
 * The restricted problem of norms l1 and linf against enumeration of every vertex in long double: random problems and
 * the degenerate ones (rounded data, repeated samples, exact fits, parallel or missing columns).
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nnls_case.h"
#include "solve/simplex.h"

#define ROWS 6
#define PROBLEMS 4000

struct problem {
    int rows, columns;
    double column[3][ROWS], data[ROWS];
};

static struct problem make(uint64_t seed)
{
    struct problem p = {0};
    uint64_t s = seed * 0x5851f42d4c957f2du + 3;
    int kind = (int)(seed % 8), i, j;

    p.rows = 1 + (int)(case_next(&s) % ROWS);
    p.columns = 1 + (int)(case_next(&s) % 3);
    for (i = 0; i < p.rows; i++) {
        for (j = 0; j < p.columns; j++) {
            p.column[j][i] = kind == 1 ? floor(3.0 * case_uniform(&s)) / 2.0
                                       : case_uniform(&s) * exp(-4.0 * j * case_uniform(&s));
            p.data[i] += p.column[j][i] * (kind == 5 && j ? 0.0 : 0.3 + j);
        }
        p.data[i] += kind == 2 ? 0.0 : 0.5 * case_signed(&s); /* 2: an exact fit */
        p.data[i] = kind == 1 ? floor(2.0 * p.data[i]) / 2.0 : kind == 3 && i % 2 ? 0.0 : p.data[i];
    }
    for (i = 0; i < p.rows; i++) {
        for (j = 0; j < p.columns; j++) {
            if (kind == 4 && i > 0) { /* every sample the same */
                p.column[j][i] = p.column[j][0];
            }
            if (kind == 6 && j > 0) { /* parallel columns, to rounding */
                p.column[j][i] = p.column[0][i] * (1.0 + 1e-16 * (double)(case_next(&s) % 3));
            }
            if (kind == 7 && j == p.columns - 1) {
                p.column[j][i] = 0.0;
            }
        }
    }
    return p;
}

/* Solve m unknowns, in place; 0 when singular. */
static int solve(int m, long double matrix[4][5])
{
    int i, j, k;

    for (k = 0; k < m; k++) {
        int pivot = k;

        for (i = k + 1; i < m; i++) {
            pivot = fabsl(matrix[i][k]) > fabsl(matrix[pivot][k]) ? i : pivot;
        }
        if (fabsl(matrix[pivot][k]) < 1e-14L) {
            return 0;
        }
        for (j = 0; j <= m; j++) {
            long double value = matrix[pivot][j];

            matrix[pivot][j] = matrix[k][j];
            matrix[k][j] = value;
        }
        for (i = 0; i < m; i++) {
            long double factor = i == k ? 0.0L : matrix[i][k] / matrix[k][k];

            for (j = k; j <= m; j++) {
                matrix[i][j] -= factor * matrix[k][j];
            }
        }
    }
    for (k = 0; k < m; k++) {
        matrix[k][m] /= matrix[k][k];
    }
    return 1;
}

static long double norm_at(const struct problem *p, const long double *z, int largest)
{
    long double sum = 0.0L, top = 0.0L;
    int i, j;

    for (i = 0; i < p->rows; i++) {
        long double r = p->data[i];

        for (j = 0; j < p->columns; j++) {
            r -= z[j] * p->column[j][i];
        }
        sum += fabsl(r);
        top = fmaxl(top, fabsl(r));
    }
    return largest ? top : sum;
}

/* Row of the system for constraint number c: z_c = 0, then r_i = 0 (l1) or +-r_i = t (linf). */
static void constraint(const struct problem *p, int c, int largest, long double *row)
{
    int m = p->columns + largest, j, i = (c - p->columns) / (1 + largest);
    long double sign = largest && (c - p->columns) % 2 ? -1.0L : 1.0L;

    for (j = 0; j <= m; j++) {
        row[j] = 0.0L;
    }
    if (c < p->columns) {
        row[c] = 1.0L;
        return;
    }
    for (j = 0; j < p->columns; j++) {
        row[j] = sign * p->column[j][i];
    }
    if (largest) {
        row[p->columns] = 1.0L;
    }
    row[m] = sign * p->data[i];
}

/* Smallest norm at any vertex, by every choice of as many constraints as unknowns; z >= 0 clipped from rounding. */
static long double enumerate(const struct problem *p, int largest)
{
    int m = p->columns + largest, all = p->columns + p->rows * (1 + largest), pick[4] = {0, 1, 2, 3}, at, j;
    long double zero[4] = {0.0L, 0.0L, 0.0L, 0.0L}, best = norm_at(p, zero, largest);

    while (pick[m - 1] < all) {
        long double matrix[4][5], z[4];
        int feasible = 1;

        for (j = 0; j < m; j++) {
            constraint(p, pick[j], largest, matrix[j]);
        }
        if (solve(m, matrix)) {
            for (j = 0; j < p->columns; j++) {
                feasible = feasible && matrix[j][m] >= -1e-15L;
                z[j] = fmaxl(0.0L, matrix[j][m]);
            }
            best = feasible ? fminl(best, norm_at(p, z, largest)) : best;
        }
        for (at = m - 1; at > 0 && pick[at] + 1 > all - m + at; at--) {
        }
        pick[at]++;
        for (j = at + 1; j < m; j++) {
            pick[j] = pick[j - 1] + 1;
        }
    }
    return best;
}

static void check(uint64_t seed, int largest)
{
    struct problem p = make(seed);
    double scratch[4][ROWS], z[SIMPLEX_UNKNOWNS], found;
    uint32_t owner[ROWS];
    long double zl[4] = {0.0L, 0.0L, 0.0L, 0.0L}, size = norm_at(&p, zl, largest), best = enumerate(&p, largest);
    struct simplex v = {.rows = (size_t)p.rows,
                        .columns = p.columns,
                        .data = p.data,
                        .moved = scratch[0],
                        .residual = scratch[1],
                        .along = scratch[2],
                        .place = scratch[3],
                        .owner = owner};
    int j;

    for (j = 0; j < 3; j++) {
        v.column[j] = p.column[j];
    }
    found = largest ? brdffit_simplex_linf(&v, z) : brdffit_simplex_l1(&v, z);
    for (j = 0; j < p.columns; j++) {
        assert_true(z[j] >= 0.0);
        zl[j] = z[j];
    }
    assert_true(fabsl(norm_at(&p, zl, largest) - (long double)found) <= 1e-14L * size);
    if (!((long double)found <= best + 1e-13L * size)) {
        fail_msg("seed %llu, %s: %.17g, a vertex has %.17Lg", (unsigned long long)seed, largest ? "linf" : "l1", found,
                 best);
    }
}

static void test_against_every_vertex(void **state)
{
    uint64_t seed;

    (void)state;
    for (seed = 0; seed < PROBLEMS; seed++) {
        check(seed, 0);
        check(seed, 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_every_vertex),
    };

    return cmocka_run_group_tests_name("vertex", tests, NULL, NULL);
}
