/*
 * The restricted problem: non-negative least squares with at most 7 columns: up to 4 by enumeration of
 * supports (theory, section 2), beyond by an active set (nnls_active.c). Two forms:
 *
 *   - dense: from the columns themselves, by orthogonalisation. Stable for columns of any scale and however
 *     close to collinear; used for every number that a user sees.
 *   - Gram: the gain R(t, M) = max_{z >= 0} 2 t.z - z'Mz from unit-diagonal M; used inside bounds, where t and
 *     M are perturbed and M need not be positive semidefinite.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_NNLS_H
#define BRDFFIT_NNLS_H

#include <stddef.h>

#include "kernels/kernels.h"

#define NNLS_COLUMNS COLUMNS_MOST
/* Up to so many columns every support is factored once, and tried. */
#define NNLS_CLOSED 4
/* A column whose entry in the limit a.z <= 1 is above this, unit columns and data, is left out: what it could gain is
 * below rounding. */
#define NNLS_LIMIT_MOST 1e30

/* One support's little least squares: orthonormal basis of its columns of R. */
struct nnls_support {
    int count, index[NNLS_COLUMNS]; /* count 0: its columns are dependent, or there are none */
    double basis[NNLS_COLUMNS][NNLS_COLUMNS]; /* [column of the support][row] */
    double upper[NNLS_COLUMNS][NNLS_COLUMNS];
};

/* U'^-1 v on the support, U its upper triangle; v by column, out by place. */
static inline void nnls_transposed_solve(const struct nnls_support *s, const double *v, double *out)
{
    int i, j;

    for (j = 0; j < s->count; j++) {
        out[j] = v[s->index[j]];
        for (i = 0; i < j; i++) {
            out[j] -= s->upper[i][j] * out[i];
        }
        out[j] /= s->upper[j][j];
    }
}

/* Columns scaled to unit norm and factored as Q R; pointers belong to the caller. */
struct nnls {
    const struct kernels *kernels;
    size_t rows;
    int columns;
    const double *column[NNLS_COLUMNS];
    double *q[NNLS_COLUMNS];                /* rows each: orthonormal, or zero for a dependent column */
    double scale[NNLS_COLUMNS];             /* power of two that brings the column to about 1 */
    double norm[NNLS_COLUMNS];              /* of the scaled column; 0 for a zero column */
    double r[NNLS_COLUMNS][NNLS_COLUMNS];   /* upper triangular, unit columns */
    struct nnls_support support[1u << NNLS_CLOSED]; /* [bits of its columns], if these are few */
};

#define NNLS_ANSWER_BYTES 192u /* what one is counted as, the same on every processor */
struct nnls_answer {
    double z[NNLS_COLUMNS]; /* coefficients of the caller's columns; may overflow where no double holds them */
    double unit[NNLS_COLUMNS]; /* the same for columns of unit norm and data divided by `data_scale` */
    double data_scale;      /* power of two that brings the data to about 1 */
    double rss;             /* sum of squared residuals of data / data_scale */
    double multiplier; /* of the limit a.z <= 1, unit columns and data; 0 where it does not bind, or there is none */
    double kkt; /* largest violation of the KKT conditions, relative to the data's norm */
    unsigned support; /* bit j: column j is used */
};

/* Factor `columns` (1 to 7) columns of `rows` finite values; q: columns x rows doubles of the caller's. */
void brdffit_nnls_factor(struct nnls *nnls, const struct kernels *kernels, size_t rows, int columns,
                         const double *const *column, double *q);

/* min ||data - A z||, z >= 0. residual: rows doubles, receives (data - A z) / data_scale. */
void brdffit_nnls_solve(const struct nnls *nnls, const double *data, double *residual, struct nnls_answer *answer);

/*
 * The same with one more row, a.z <= 1: a >= 0, an entry for each column at unit norm, in units of the data; infinite
 * where the coefficient is to be 0.
 */
void brdffit_nnls_solve_limited(const struct nnls *nnls, const double *data, const double *a, double *residual,
                                struct nnls_answer *answer);

/* The factorisation of a support: kept, or made into *room. */
const struct nnls_support *brdffit_nnls_factored(const struct nnls *nnls, unsigned support, struct nnls_support *room);

/*
 * The same from cosines [i][j], i < j, of unit columns, without the columns: brdffit_nnls_support() is then the answer to
 * t = column . data of each. Accurate as far as the cosines are.
 */
void brdffit_nnls_factor_gram(struct nnls *nnls, int columns, double cosine[NNLS_COLUMNS][NNLS_COLUMNS]);

/* Writes unit-column coefficients and returns their support. */
unsigned brdffit_nnls_support(const struct nnls *nnls, const double *t, double unit[NNLS_COLUMNS]);

/* The same with a.unit <= 1; returns the multiplier of that, 0 where it does not bind. */
double brdffit_nnls_multiplier(const struct nnls *nnls, const double *t, const double *a, double unit[NNLS_COLUMNS]);

/* R(t, M); cosines 01, 02, .., 12, .., each in [0, 1]. 2 to 7 columns. */
double brdffit_nnls_gain(int columns, const double *cosine, const double *t);

#endif
