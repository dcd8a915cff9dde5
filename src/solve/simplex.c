/*
 * What both norms share: see simplex.h. SPDX-License-Identifier: MIT
 */
#include "solve/simplex.h"

#include <math.h>

#include "base/vector.h"
#include "solve/simplex_parts.h"

/* How far data are moved, relative to the largest: tens of roundings. */
#define APART 4e-15

void brdffit_simplex_layout(struct simplex *v, struct arena *arena, size_t count)
{
    v->moved = ARENA_DOUBLES(arena, count);
    v->residual = ARENA_DOUBLES(arena, count);
    v->along = ARENA_DOUBLES(arena, count);
    v->place = ARENA_DOUBLES(arena, count);
    v->owner = brdffit_arena_take(arena, count, sizeof *v->owner);
}

int brdffit_simplex_move_apart(struct simplex *v)
{
    double largest = vector_largest(v->data, v->rows);
    uint64_t state = 0x9e3779b97f4a7c15u;
    size_t i;

    for (i = 0; i < v->rows; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        v->moved[i] = v->data[i] + APART * largest * ((double)(state >> 40) * 0x1p-23 - 1.0);
    }
    return largest > 0.0;
}

/* Gauss-Jordan with partial pivoting; rows are brought to about 1 first, which their inverse columns undo. */
int brdffit_simplex_invert(struct simplex_system *s)
{
    double m[SIMPLEX_UNKNOWNS][2 * SIMPLEX_UNKNOWNS];
    int n = s->size, i, j, k;

    for (i = 0; i < n; i++) {
        double largest = vector_largest(s->matrix[i], (size_t)n);

        if (!(largest > 0.0)) {
            return 0;
        }
        for (j = 0; j < n; j++) {
            m[i][j] = s->matrix[i][j] / largest;
            m[i][n + j] = i == j ? 1.0 / largest : 0.0;
        }
    }
    for (k = 0; k < n; k++) {
        int pivot = k;

        for (i = k + 1; i < n; i++) {
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        }
        if (!(fabs(m[pivot][k]) > 1e-15)) {
            return 0;
        }
        for (j = 0; j < 2 * n; j++) {
            double value = m[pivot][j];

            m[pivot][j] = m[k][j];
            m[k][j] = value;
        }
        for (i = 0; i < n; i++) {
            double factor = i == k ? 0.0 : m[i][k] / m[k][k];

            for (j = k; j < 2 * n && factor != 0.0; j++) {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            s->inverse[i][j] = m[i][n + j] / m[i][i];
        }
    }
    return 1;
}

double brdffit_simplex_norm_l1(const struct simplex *v, const double *z)
{
    double sum = 0.0;
    size_t i;

    for (i = 0; i < v->rows; i++) {
        sum += fabs(v->data[i] - simplex_model(v, z, i));
    }
    return sum;
}

double brdffit_simplex_norm_linf(const struct simplex *v, const double *z)
{
    double largest = 0.0;
    size_t i;

    for (i = 0; i < v->rows; i++) {
        largest = fmax(largest, fabs(v->data[i] - simplex_model(v, z, i)));
    }
    return largest;
}
