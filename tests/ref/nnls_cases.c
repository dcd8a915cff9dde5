/*
 * Writes restricted problems and brdffit's answers as records of doubles, for an independent solver to judge
 * (tests/test_oracles.py): rows, columns, A (12 x 3), data (12), z (3), rss and KKT residual in data units.
 * Usage: nnls_cases COUNT > FILE. SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "solve/nnls.h"
#include "nnls_case.h"

#define RECORD (2 + 3 * CASE_ROWS + CASE_ROWS + 3 + 2)

static void write_case(const struct nnls_case *c)
{
    const double *column[NNLS_COLUMNS];
    double q[NNLS_COLUMNS * CASE_ROWS], residual[CASE_ROWS], record[RECORD];
    struct nnls nnls;
    struct nnls_answer a;
    int i, j, n = 0;

    for (j = 0; j < c->columns; j++) {
        column[j] = c->column[j];
    }
    brdffit_nnls_factor(&nnls, brdffit_kernels(BRDFFIT_ISA_AUTO), (size_t)c->rows, c->columns, column, q);
    brdffit_nnls_solve(&nnls, c->data, residual, &a);
    record[n++] = c->rows;
    record[n++] = c->columns;
    for (i = 0; i < CASE_ROWS; i++) {
        for (j = 0; j < 3; j++) {
            record[n++] = c->column[j][i];
        }
    }
    for (i = 0; i < CASE_ROWS; i++) {
        record[n++] = c->data[i];
    }
    for (j = 0; j < 3; j++) {
        record[n++] = a.z[j];
    }
    record[n++] = a.rss * a.data_scale * a.data_scale;
    record[n++] = a.kkt;
    fwrite(record, sizeof record, 1, stdout);
}

int main(int argc, char **argv)
{
    struct nnls_case c;
    unsigned long long seed, count = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000;

    for (seed = 0; seed < count; seed++) {
        nnls_case_make(&c, 1000000 + seed, 0);
        write_case(&c);
    }
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
