/*
 * Least sum of absolute residuals: see simplex.h. SPDX-License-Identifier: MIT
 *
 * At a vertex as many constraints hold as there are columns d: rows whose residual is zero, or coefficients that are
 * zero. Leaving one of them while the others hold gives 2 d edges at most. The objective is convex and piecewise
 * linear along each, so an edge's best point is a weighted median of the places where residuals change sign, and is a
 * vertex again (Barrodale and Roberts 1973). The walk starts at z = 0 and ends where no edge leads down.
 */
#include <math.h>

#include "solve/simplex_parts.h"

struct walk {
    struct simplex *v;
    size_t active[SIMPLEX_COLUMNS]; /* row i, or v->rows + j for z_j = 0 */
    struct simplex_system system;
    double z[SIMPLEX_COLUMNS];
};

static int factor(struct walk *w)
{
    int q, j;

    w->system.size = w->v->columns;
    for (q = 0; q < w->v->columns; q++) {
        for (j = 0; j < w->v->columns; j++) {
            size_t bound = w->v->rows + (size_t)j;

            w->system.matrix[q][j] = w->active[q] < w->v->rows ? w->v->column[j][w->active[q]]
                                                               : (w->active[q] == bound ? 1.0 : 0.0);
        }
    }
    return brdffit_simplex_invert(&w->system);
}

/* z of the vertex for these data. */
static void solve(const struct walk *w, const double *data, double *z)
{
    int q, j;

    for (j = 0; j < w->v->columns; j++) {
        z[j] = 0.0;
        for (q = 0; q < w->v->columns; q++) {
            z[j] += w->active[q] < w->v->rows ? w->system.inverse[j][q] * data[w->active[q]] : 0.0;
        }
        z[j] = z[j] > 0.0 ? z[j] : 0.0;
    }
    for (q = 0; q < w->v->columns; q++) {
        if (w->active[q] >= w->v->rows) {
            z[w->active[q] - w->v->rows] = 0.0;
        }
    }
}

static void residuals(struct walk *w)
{
    struct simplex *v = w->v;
    size_t i;
    int q;

    for (i = 0; i < v->rows; i++) {
        v->residual[i] = v->moved[i] - simplex_model(v, w->z, i);
    }
    for (q = 0; q < v->columns; q++) {
        if (w->active[q] < v->rows) {
            v->residual[w->active[q]] = 0.0;
        }
    }
}

static void direction_of(const struct walk *w, int q, int sign, double *direction)
{
    int j;

    for (j = 0; j < w->v->columns; j++) {
        direction[j] = sign * w->system.inverse[j][q];
    }
}

/* Slope along an edge, relative to the largest it could be. */
static double slope_of(const struct walk *w, int q, int sign, double *slope)
{
    const struct simplex *v = w->v;
    double direction[SIMPLEX_COLUMNS], all = 0.0, sum = 0.0;
    size_t i;

    direction_of(w, q, sign, direction);
    for (i = 0; i < v->rows; i++) {
        double along = simplex_model(v, direction, i);

        all += fabs(along);
        sum += v->residual[i] > 0.0 ? -along : v->residual[i] < 0.0 ? along : fabs(along);
    }
    *slope = sum;
    return all > 0.0 ? sum / all : 0.0;
}

static void sift(struct simplex *v, size_t at, size_t count)
{
    for (;;) {
        size_t least = at, child = 2 * at + 1, c;
        double place = v->place[at];
        uint32_t owner = v->owner[at];

        for (c = child; c < count && c < child + 2; c++) {
            least = v->place[c] < v->place[least] ? c : least;
        }
        if (least == at) {
            return;
        }
        v->place[at] = v->place[least];
        v->owner[at] = v->owner[least];
        v->place[least] = place;
        v->owner[least] = owner;
        at = least;
    }
}

/* Places ahead where a residual changes sign; a heap. */
static size_t breakpoints(struct simplex *v, const double *direction)
{
    size_t count = 0, i;

    for (i = 0; i < v->rows; i++) {
        v->along[i] = simplex_model(v, direction, i);
        if (v->residual[i] * v->along[i] > 0.0) {
            v->place[count] = v->residual[i] / v->along[i];
            v->owner[count++] = (uint32_t)i;
        }
    }
    for (i = count / 2; i-- > 0;) {
        sift(v, i, count);
    }
    return count;
}

/* The constraint at the end of the edge's downhill part; `rows + columns` when there is none. */
static size_t end_of(struct simplex *v, const double *direction, double slope, const double *z)
{
    size_t count = breakpoints(v, direction), found = v->rows + (size_t)v->columns;
    double limit = INFINITY;
    int j;

    for (j = 0; j < v->columns; j++) {
        if (direction[j] < 0.0 && z[j] / -direction[j] < limit) {
            limit = z[j] / -direction[j];
            found = v->rows + (size_t)j;
        }
    }
    while (count > 0 && v->place[0] < limit) {
        size_t row = v->owner[0];

        slope += 2.0 * fabs(v->along[row]);
        if (slope >= 0.0) {
            return row;
        }
        count--;
        v->place[0] = v->place[count];
        v->owner[0] = v->owner[count];
        sift(v, 0, count);
    }
    return found;
}

/* One edge down; 0 at the optimum. */
static int step(struct walk *w)
{
    double best = -SIMPLEX_DOWNHILL, slope = 0.0, direction[SIMPLEX_COLUMNS];
    int q, leave = -1, way = 0, sign;
    size_t next;

    for (q = 0; q < w->v->columns; q++) {
        for (sign = 1; sign >= (w->active[q] < w->v->rows ? -1 : 1); sign -= 2) {
            double here, relative = slope_of(w, q, sign, &here);

            if (relative < best) {
                best = relative;
                slope = here;
                leave = q;
                way = sign;
            }
        }
    }
    if (leave < 0) {
        return 0;
    }
    direction_of(w, leave, way, direction);
    next = end_of(w->v, direction, slope, w->z);
    if (next >= w->v->rows + (size_t)w->v->columns) {
        return 0;
    }
    w->active[leave] = next;
    return factor(w);
}

double brdffit_simplex_l1(struct simplex *v, double *z)
{
    struct walk w = {.v = v};
    double exact[SIMPLEX_COLUMNS], here, there;
    int i, j, usable;

    for (j = 0; j < v->columns; j++) {
        z[j] = 0.0;
        w.active[j] = v->rows + (size_t)j;
    }
    if (!brdffit_simplex_move_apart(v)) {
        return 0.0;
    }
    here = brdffit_simplex_norm_l1(v, z);
    usable = factor(&w);
    for (i = 0; usable && i < SIMPLEX_PIVOTS; i++) {
        solve(&w, v->moved, w.z);
        residuals(&w);
        there = brdffit_simplex_norm_l1(v, w.z);
        if (there < here) {
            here = there;
            for (j = 0; j < v->columns; j++) {
                z[j] = w.z[j];
            }
        }
        solve(&w, v->data, exact);
        there = brdffit_simplex_norm_l1(v, exact);
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
