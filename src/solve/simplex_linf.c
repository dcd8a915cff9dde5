/*
 * Least largest absolute residual: see simplex.h. SPDX-License-Identifier: MIT
 *
 * minimise t subject to t + s A_i z - s I_i >= 0 for s = 1, -1 and every row i, and z >= 0. At a vertex d + 1 of these
 * hold with equality; column q of the inverse of their matrix is the edge that leaves constraint q, and its entry of t
 * is the multiplier of q: where none is negative, the vertex is the optimum. Starts at z = 0, t = largest |I|.
 */
#include <math.h>

#include "solve/simplex_parts.h"

struct walk {
    struct simplex *v;
    size_t active[SIMPLEX_UNKNOWNS]; /* 2 i for s = 1, 2 i + 1 for s = -1, 2 rows + j for z_j = 0 */
    struct simplex_system system;
    double z[SIMPLEX_UNKNOWNS]; /* the last is t */
};

static double sign_of(size_t constraint)
{
    return constraint % 2 ? -1.0 : 1.0;
}

static int factor(struct walk *w)
{
    int d = w->v->columns, q, j;

    w->system.size = d + 1;
    for (q = 0; q <= d; q++) {
        size_t active = w->active[q];
        int row = active < 2 * w->v->rows;

        for (j = 0; j < d; j++) {
            w->system.matrix[q][j] = row ? sign_of(active) * w->v->column[j][active / 2]
                                         : (active == 2 * w->v->rows + (size_t)j ? 1.0 : 0.0);
        }
        w->system.matrix[q][d] = row ? 1.0 : 0.0;
    }
    return brdffit_simplex_invert(&w->system);
}

static void solve(const struct walk *w, const double *data, double *z)
{
    int d = w->v->columns, q, j;

    for (j = 0; j <= d; j++) {
        z[j] = 0.0;
        for (q = 0; q <= d; q++) {
            size_t active = w->active[q];

            z[j] += active < 2 * w->v->rows ? w->system.inverse[j][q] * (sign_of(active) * data[active / 2]) : 0.0;
        }
        z[j] = z[j] > 0.0 ? z[j] : 0.0;
    }
    for (q = 0; q <= d; q++) {
        if (w->active[q] >= 2 * w->v->rows) {
            z[w->active[q] - 2 * w->v->rows] = 0.0;
        }
    }
}

static int is_active(const struct walk *w, size_t constraint)
{
    int q;

    for (q = 0; q <= w->v->columns; q++) {
        if (w->active[q] == constraint) {
            return 1;
        }
    }
    return 0;
}

/* First constraint that an edge meets; `2 rows + columns` when there is none. */
static size_t end_of(const struct walk *w, const double *direction)
{
    const struct simplex *v = w->v;
    int d = v->columns, j;
    size_t found = 2 * v->rows + (size_t)d, i, s;
    double limit = INFINITY, t = w->z[d];

    for (j = 0; j < d; j++) {
        size_t bound = 2 * v->rows + (size_t)j;

        if (direction[j] < 0.0 && w->z[j] / -direction[j] < limit && !is_active(w, bound)) {
            limit = w->z[j] / -direction[j];
            found = bound;
        }
    }
    for (i = 0; i < v->rows; i++) {
        double along = simplex_model(v, direction, i), residual = v->moved[i] - simplex_model(v, w->z, i);

        for (s = 0; s < 2; s++) {
            double rate = direction[d] + sign_of(s) * along, slack = fmax(0.0, t - sign_of(s) * residual);

            if (rate < -SIMPLEX_DOWNHILL * fabs(direction[d]) && slack < limit * -rate && !is_active(w, 2 * i + s)) {
                limit = slack / -rate;
                found = 2 * i + s;
            }
        }
    }
    return found;
}

/* One edge down; 0 at the optimum. */
static int step(struct walk *w)
{
    double best = -SIMPLEX_DOWNHILL, direction[SIMPLEX_UNKNOWNS];
    int d = w->v->columns, q, j, leave = -1;
    size_t next;

    for (q = 0; q <= d; q++) {
        double size = 0.0;

        for (j = 0; j <= d; j++) {
            size += fabs(w->system.inverse[j][q]);
        }
        if (w->system.inverse[d][q] < best * size) {
            best = w->system.inverse[d][q] / size;
            leave = q;
        }
    }
    if (leave < 0) {
        return 0;
    }
    for (j = 0; j <= d; j++) {
        direction[j] = w->system.inverse[j][leave];
    }
    next = end_of(w, direction);
    if (next >= 2 * w->v->rows + (size_t)d) {
        return 0;
    }
    w->active[leave] = next;
    return factor(w);
}

static void start(struct walk *w)
{
    const struct simplex *v = w->v;
    size_t largest = 0, i;
    int j;

    for (i = 1; i < v->rows; i++) {
        largest = fabs(v->moved[i]) > fabs(v->moved[largest]) ? i : largest;
    }
    for (j = 0; j < v->columns; j++) {
        w->active[j] = 2 * v->rows + (size_t)j;
    }
    w->active[v->columns] = 2 * largest + (v->moved[largest] < 0.0);
}

double brdffit_simplex_linf(struct simplex *v, double *z)
{
    struct walk w = {.v = v};
    double exact[SIMPLEX_UNKNOWNS], here, there;
    int i, j, usable;

    for (j = 0; j < v->columns; j++) {
        z[j] = 0.0;
    }
    if (!brdffit_simplex_move_apart(v)) {
        return 0.0;
    }
    start(&w);
    here = brdffit_simplex_norm_linf(v, z);
    usable = factor(&w);
    for (i = 0; usable && i < SIMPLEX_PIVOTS; i++) {
        solve(&w, v->moved, w.z);
        solve(&w, v->data, exact);
        there = brdffit_simplex_norm_linf(v, exact);
        if (there < here) {
            here = there;
            for (j = 0; j < v->columns; j++) {
                z[j] = exact[j];
            }
        }
        usable = step(&w);
    }
    return here;
}
