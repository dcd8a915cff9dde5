/*
 * Least squares over z >= 0, a.z <= 1 by brute force in long double: every support, free and with the limit met, by elimination
 * of its KKT system. Whatever that makes of z, what counts is the objective at a z that is feasible: never below the optimum.
 * Shared by test_nnls_limit.c and test_physical.c. SPDX-License-Identifier: MIT
 */
#ifndef PHYSICAL_ORACLE_H
#define PHYSICAL_ORACLE_H

#include <math.h>
#include <stddef.h>

#define PO_COLUMNS 7
#define PO_ROWS 64

struct physical_oracle {
    size_t rows;
    int columns;
    long double column[PO_COLUMNS][PO_ROWS], data[PO_ROWS], a[PO_COLUMNS];
};

static inline long double po_dot(const long double *u, const long double *v, size_t n)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

static inline long double po_objective(const struct physical_oracle *o, const long double *z)
{
    long double sum = 0.0L;
    size_t i;
    int j;

    for (i = 0; i < o->rows; i++) {
        long double residual = o->data[i];

        for (j = 0; j < o->columns; j++) {
            residual -= z[j] * o->column[j][i];
        }
        sum += residual * residual;
    }
    return sum;
}

/* n equations in n unknowns by elimination with pivots, in place; 0 when they are singular. */
static inline int po_eliminate(long double m[PO_COLUMNS + 1][PO_COLUMNS + 2], int n, long double *out)
{
    int i, j, k;

    for (j = 0; j < n; j++) {
        int best = j;

        for (i = j + 1; i < n; i++) {
            best = fabsl(m[i][j]) > fabsl(m[best][j]) ? i : best;
        }
        if (!(fabsl(m[best][j]) > 0.0L)) {
            return 0;
        }
        for (k = j; k <= n; k++) {
            long double keep = m[j][k];

            m[j][k] = m[best][k];
            m[best][k] = keep;
        }
        for (i = j + 1; i < n; i++) {
            long double factor = m[i][j] / m[j][j];

            for (k = j; k <= n; k++) {
                m[i][k] -= factor * m[j][k];
            }
        }
    }
    for (j = n - 1; j >= 0; j--) {
        out[j] = m[j][n];
        for (k = j + 1; k < n; k++) {
            out[j] -= m[j][k] * out[k];
        }
        out[j] /= m[j][j];
    }
    return 1;
}

/* The stationary point of a support, on the limit or off it, into z, entries >= 0 and within the limit; 0 when there is none. */
static inline int po_candidate(const struct physical_oracle *o, unsigned support, int met, long double *z)
{
    long double m[PO_COLUMNS + 1][PO_COLUMNS + 2], out[PO_COLUMNS + 1], counts = 0.0L;
    int index[PO_COLUMNS], n = 0, i, j;

    for (j = 0; j < o->columns; j++) {
        z[j] = 0.0L;
        if (support >> j & 1) {
            index[n++] = j;
        }
    }
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            m[i][j] = po_dot(o->column[index[i]], o->column[index[j]], o->rows);
        }
        m[i][n] = m[n][i] = o->a[index[i]];
        m[i][n + met] = po_dot(o->column[index[i]], o->data, o->rows);
    }
    m[n][n] = 0.0L;
    m[n][n + 1] = 1.0L;
    if (!po_eliminate(m, n + met, out)) {
        return 0;
    }
    for (i = 0; i < n; i++) {
        if (!(out[i] >= 0.0L)) {
            return 0;
        }
        z[index[i]] = out[i];
        counts += out[i] > 0.0L ? o->a[index[i]] * out[i] : 0.0L;
    }
    for (i = 0; i < n && counts > 1.0L; i++) {
        z[index[i]] /= counts;
    }
    return 1;
}

/* The best of all, and its z. */
static inline long double physical_best(const struct physical_oracle *o, long double *z)
{
    long double best = po_dot(o->data, o->data, o->rows), here, at[PO_COLUMNS];
    unsigned support;
    int met, j;

    for (j = 0; j < o->columns; j++) {
        z[j] = 0.0L;
    }
    for (support = 1; support < 1u << o->columns; support++) {
        for (met = 0; met < 2; met++) {
            if (po_candidate(o, support, met, at) && (here = po_objective(o, at)) < best) {
                best = here;
                for (j = 0; j < o->columns; j++) {
                    z[j] = at[j];
                }
            }
        }
    }
    return best;
}

#endif
