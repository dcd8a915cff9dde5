/*
 * References, shared part 2 of 2: the restricted problem in long double, from residual vectors.
 *
 * Every support (subset of the columns) is orthonormalised, the data are projected, and the residual vector is
 * squared and summed. The smallest residual whose coefficients are all >= 0 is the optimum: the optimum of a
 * convex problem with z >= 0 is the unconstrained optimum of its own support. Subsets of a support whose coefficients
 * are >= 0 have a larger residual and are not tried. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REF_EXACT_H
#define BRDFFIT_REF_EXACT_H

#include "ref_rows.h"

#define REF_COLUMNS 4
/* A column with less than this of its norm outside the others adds nothing. */
#define REF_DEPENDENT 1e-17L

static inline long double ref_dot(const long double *x, const long double *y, size_t count)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < count; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

/* Columns of one support as Q R, by Gram-Schmidt done twice. */
struct ref_support {
    int size, column[REF_COLUMNS];
    size_t count;
    long double *q; /* size x count */
    long double r[REF_COLUMNS][REF_COLUMNS];
};

/* 0 when the columns are dependent. */
static inline int ref_orthonormalise(const long double *const *column, struct ref_support *support)
{
    int i, j, pass;
    size_t n, count = support->count;

    for (j = 0; j < support->size; j++) {
        long double *mine = support->q + (size_t)j * count, norm, left;

        memcpy(mine, column[support->column[j]], count * sizeof *mine);
        norm = sqrtl(ref_dot(mine, mine, count));
        for (i = 0; i < j; i++) {
            support->r[i][j] = 0.0L;
        }
        for (pass = 0; pass < 2; pass++) {
            for (i = 0; i < j; i++) {
                const long double *other = support->q + (size_t)i * count;
                long double t = ref_dot(other, mine, count);

                support->r[i][j] += t;
                for (n = 0; n < count; n++) {
                    mine[n] -= t * other[n];
                }
            }
        }
        left = sqrtl(ref_dot(mine, mine, count));
        if (!(left > REF_DEPENDENT * norm)) {
            return 0;
        }
        support->r[j][j] = left;
        for (n = 0; n < count; n++) {
            mine[n] /= left;
        }
    }
    return 1;
}

/* Squared residual of `data` on the support; -1 when a coefficient is negative. `residual`: count of room. */
static inline long double ref_project(const struct ref_support *support, const long double *data,
                                      long double z[REF_COLUMNS], long double *residual)
{
    size_t n, count = support->count;
    int i, j;

    memcpy(residual, data, count * sizeof *residual);
    for (j = 0; j < support->size; j++) {
        const long double *mine = support->q + (size_t)j * count;

        z[j] = ref_dot(mine, residual, count);
        for (n = 0; n < count; n++) {
            residual[n] -= z[j] * mine[n];
        }
    }
    for (j = support->size; j-- > 0;) {
        for (i = j + 1; i < support->size; i++) {
            z[j] -= support->r[j][i] * z[i];
        }
        z[j] /= support->r[j][j];
        if (!(z[j] >= 0.0L)) {
            return -1.0L;
        }
    }
    return ref_dot(residual, residual, count);
}

/* The best of a channel, and as bits the supports that cannot be better: subsets of one whose coefficients are >= 0. */
struct ref_best {
    long double e2;
    unsigned covered;
};

/* Room that ref_exact() needs, in long doubles. */
static inline size_t ref_exact_room(const struct ref_rows *rows)
{
    return (REF_COLUMNS + 1) * rows->count + 2 * rows->channels;
}

/* Columns of a mask; 0 when no channel needs them, or they are dependent. */
static inline int ref_choose(const struct ref_rows *rows, const long double *const *column, int columns, int mask,
                             const struct ref_best *best, struct ref_support *support)
{
    size_t k;
    int j;

    for (k = 0; k < rows->channels && best[k].covered >> mask & 1; k++) {
    }
    for (support->size = 0, j = 0; j < columns; j++) {
        if (mask >> j & 1) {
            support->column[support->size++] = j;
        }
    }
    return k < rows->channels && ref_orthonormalise(column, support);
}

/* Take e2 >= 0 of a mask where it is less than what there is; whether it was. */
static inline int ref_take(struct ref_best *best, int mask, long double e2)
{
    int part, better = e2 < best->e2;

    for (part = mask; part > 0; part = (part - 1) & mask) {
        best->covered |= 1u << part;
    }
    best->e2 = better ? e2 : best->e2;
    return better;
}

/*
 * Smallest sum over channels of squared residuals. coefficients: channels x columns of the optimum, or NULL.
 */
static inline long double ref_exact(const struct ref_rows *rows, const long double *const *column, int columns,
                                    long double *room, long double *coefficients)
{
    struct ref_support support = {0, {0}, rows->count, room, {{0.0L}}};
    long double *residual = room + REF_COLUMNS * rows->count, total = 0.0L;
    struct ref_best *best = (struct ref_best *)(void *)(residual + rows->count);
    size_t k;
    int mask, j;

    for (k = 0; k < rows->channels; k++) {
        best[k].e2 = ref_dot(rows->data + k * rows->count, rows->data + k * rows->count, rows->count);
        best[k].covered = 0;
        for (j = 0; coefficients && j < columns; j++) {
            coefficients[k * (size_t)columns + (size_t)j] = 0.0L;
        }
    }
    for (mask = (1 << columns) - 1; mask > 0; mask--) { /* a set before its subsets */
        if (!ref_choose(rows, column, columns, mask, best, &support)) {
            continue;
        }
        for (k = 0; k < rows->channels; k++) {
            long double z[REF_COLUMNS], e2;

            if (best[k].covered >> mask & 1) {
                continue;
            }
            e2 = ref_project(&support, rows->data + k * rows->count, z, residual);
            if (!(e2 >= 0.0L && ref_take(&best[k], mask, e2))) {
                continue;
            }
            for (j = 0; coefficients && j < columns; j++) {
                coefficients[k * (size_t)columns + (size_t)j] = 0.0L;
            }
            for (j = 0; coefficients && j < support.size; j++) {
                coefficients[k * (size_t)columns + (size_t)support.column[j]] = z[j];
            }
        }
    }
    for (k = 0; k < rows->channels; k++) {
        total += best[k].e2;
    }
    return total;
}

#endif
