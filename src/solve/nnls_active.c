/*
 * Restricted problem of more than four columns: an active set (Lawson and Hanson 1974, chapter 23) on the little triangle
 * that orthogonalisation leaves. SPDX-License-Identifier: MIT
 *
 * Where the least squares in all columns is feasible it is the answer. Otherwise columns enter one at a time, steepest
 * first, and leave when a step would make them negative. A column that is dependent on those of the support, or that
 * does not come out positive at once, is passed over. The answer of such a walk is a KKT point but for rounding; where
 * the walk does not end, every support is tried.
 */
#include "base/tolerance.h"
#include "solve/nnls_parts.h"

/* Changes of the support of one problem; twice the columns is usual. */
#define NNLS_CHANGES 60
/* An ascent below this part of |t| is none. */
#define NNLS_LEAST (16.0 * TOL_UNIT)

/* A support and its coefficients. */
struct walk {
    const struct nnls *nnls;
    const double *t;
    unsigned support;
    double unit[NNLS_COLUMNS];
};

/* Least squares in the columns of `support`: whether these are independent. */
static int solve_on(const struct nnls *nnls, const double *t, unsigned support, double *unit)
{
    struct nnls_support room;
    const struct nnls_support *s = brdffit_nnls_factored(nnls, support, &room);
    double z[NNLS_COLUMNS];
    int j;

    if (s->count == 0) {
        return 0;
    }
    (void)brdffit_nnls_support_solve(s, t, nnls->columns, z);
    for (j = 0; j < NNLS_COLUMNS; j++) {
        unit[j] = 0.0;
    }
    for (j = 0; j < s->count; j++) {
        unit[s->index[j]] = z[j];
    }
    return 1;
}

static int all_positive(const double *unit, unsigned support, int columns)
{
    int j, fine = 1;

    for (j = 0; j < columns; j++) {
        fine = fine && (!(support >> j & 1) || unit[j] > 0.0);
    }
    return fine;
}

/* The column that leads up most steeply, of those not passed over, or -1. */
static int steepest(const struct walk *w, unsigned passed)
{
    const struct nnls *nnls = w->nnls;
    double rest[NNLS_COLUMNS], size = 0.0, most;
    int i, j, best = -1;

    for (i = 0; i < nnls->columns; i++) {
        rest[i] = w->t[i];
        for (j = 0; j < nnls->columns; j++) {
            rest[i] -= nnls->r[i][j] * w->unit[j];
        }
        size += w->t[i] < 0.0 ? -w->t[i] : w->t[i];
    }
    most = NNLS_LEAST * size;
    for (j = 0; j < nnls->columns; j++) {
        double slope = 0.0;

        for (i = 0; i <= j; i++) {
            slope += nnls->r[i][j] * rest[i];
        }
        if (!((w->support | passed) >> j & 1) && slope > most) {
            most = slope;
            best = j;
        }
    }
    return best;
}

/* Move towards `next` until a coefficient is 0, and drop it. */
static void step_back(struct walk *w, const double *next)
{
    double share = 1.0;
    int j, first = -1;

    for (j = 0; j < w->nnls->columns; j++) {
        if ((w->support >> j & 1) && !(next[j] > 0.0)) {
            double here = w->unit[j] / (w->unit[j] - next[j]);

            if (first < 0 || here < share) {
                share = here;
                first = j;
            }
        }
    }
    for (j = 0; j < w->nnls->columns; j++) {
        w->unit[j] += share * (next[j] - w->unit[j]);
        if (j == first || ((w->support >> j & 1) && !(w->unit[j] > 0.0))) {
            w->unit[j] = 0.0;
            w->support &= ~(1u << j);
        }
    }
}

/* With `column` in the support, to the least squares there; 0 when it has to stay out. */
static int enter(struct walk *w, int column, int *changes)
{
    double next[NNLS_COLUMNS];
    int j;

    if (!solve_on(w->nnls, w->t, w->support | 1u << column, next) || !(next[column] > 0.0)) {
        return 0;
    }
    w->support |= 1u << column;
    while (!all_positive(next, w->support, w->nnls->columns) && ++*changes < NNLS_CHANGES) {
        step_back(w, next);
        if (w->support == 0 || !solve_on(w->nnls, w->t, w->support, next)) {
            *changes = NNLS_CHANGES;
        }
    }
    for (j = 0; j < NNLS_COLUMNS; j++) {
        w->unit[j] = next[j];
    }
    return 1;
}

unsigned brdffit_nnls_active(const struct nnls *nnls, const double *t, double *unit)
{
    struct walk w = {nnls, t, 0, {0.0}};
    unsigned all = (1u << nnls->columns) - 1, passed = 0;
    int column, j, changes = 0;

    if (solve_on(nnls, t, all, w.unit) && all_positive(w.unit, all, nnls->columns)) {
        w.support = all;
    } else {
        for (j = 0; j < NNLS_COLUMNS; j++) {
            w.unit[j] = 0.0;
        }
        while ((column = steepest(&w, passed)) >= 0 && changes++ < NNLS_CHANGES) {
            passed = enter(&w, column, &changes) ? 0 : passed | 1u << column;
        }
        if (changes >= NNLS_CHANGES) {
            return brdffit_nnls_enumerate(nnls, t, unit);
        }
    }
    for (j = 0; j < NNLS_COLUMNS; j++) {
        unit[j] = w.unit[j];
    }
    return w.support;
}
