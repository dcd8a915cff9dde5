/*
 * L1 and LINF of one channel at given roughnesses. Both are linear programs, whose optimum is reached at a vertex: with
 * m coefficients positive, m residuals are 0 (L1), or m + 1 residuals are the largest, with some signs (LINF). All of
 * them are tried, so this is for a dozen rows. SPDX-License-Identifier: MIT
 */
#include "quad.h"

#include <string.h>

#define STRIDE (QUAD_COLUMNS + 1)

struct vertex {
    const struct quad_problem *problem;
    const quad *column;
    size_t channel;
    int linf;
    int columns, member[QUAD_COLUMNS]; /* the support */
    int signs;
    size_t row[QUAD_COLUMNS + 1];
    quad best, z[QUAD_COLUMNS];
};

static void try_vertex(struct vertex *v)
{
    const struct quad_problem *p = v->problem;
    int n = v->columns + v->linf, i, j;
    quad matrix[STRIDE * STRIDE], right[STRIDE], z[QUAD_COLUMNS], e;

    for (i = 0; i < n; i++) {
        for (j = 0; j < v->columns; j++) {
            matrix[i * STRIDE + j] = v->column[(size_t)v->member[j] * p->count + v->row[i]];
        }
        if (v->linf) {
            matrix[i * STRIDE + v->columns] = v->signs & (1 << i) ? -1 : 1;
        }
        right[i] = p->data[v->channel * p->count + v->row[i]];
    }
    if (!quad_solve(matrix, right, n)) {
        return;
    }
    memset(z, 0, sizeof z);
    for (j = 0; j < v->columns; j++) {
        if (!(right[j] >= 0) || !finiteq(right[j])) {
            return;
        }
        z[v->member[j]] = right[j];
    }
    if (v->linf && !(fabsq(right[v->columns]) < v->best)) {
        return;
    }
    e = quad_residual(p, v->column, v->channel, z);
    if (e < v->best) {
        v->best = e;
        memcpy(v->z, z, sizeof z);
    }
}

/* Every choice of rows from `first` on; the sign of the last one is free to be +. */
static void choose_rows(struct vertex *v, int chosen, size_t first)
{
    size_t i;

    if (chosen == v->columns + v->linf) {
        for (v->signs = 0; v->signs < (v->linf ? 1 << v->columns : 1); v->signs++) {
            try_vertex(v);
        }
        return;
    }
    for (i = first; i < v->problem->count; i++) {
        v->row[chosen] = i;
        choose_rows(v, chosen + 1, i + 1);
    }
}

static quad best_vertex(const struct quad_problem *p, const quad *column, size_t channel, quad *z, int linf)
{
    struct vertex v;
    int support, j;

    memset(&v, 0, sizeof v);
    v.problem = p;
    v.column = column;
    v.channel = channel;
    v.linf = linf;
    v.best = quad_residual(p, column, channel, v.z);
    for (support = 1; support < 1 << p->columns; support++) {
        v.columns = 0;
        for (j = 0; j < p->columns; j++) {
            if (support & (1 << j)) {
                v.member[v.columns++] = j;
            }
        }
        choose_rows(&v, 0, 0);
    }
    memcpy(z, v.z, sizeof v.z);
    return v.best;
}

quad quad_channel_l1(const struct quad_problem *p, const quad *column, size_t channel, quad *z)
{
    return best_vertex(p, column, channel, z, 0);
}

quad quad_channel_linf(const struct quad_problem *p, const quad *column, size_t channel, quad *z)
{
    return best_vertex(p, column, channel, z, 1);
}
