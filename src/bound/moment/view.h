/*
 * What bounds a box in engine `moment`: its columns, their cosines and shifts, opened from intervals and pairs. A part of
 * bound.c, whose instances for each number of columns and sides it is compiled into. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_MOMENT_VIEW_H
#define BRDFFIT_BOUND_MOMENT_VIEW_H

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "bound/moment/bound.h"
#include "solve/nnls.h"

#define INSTANCE static inline __attribute__((always_inline))

/* A box: what bounds each of its columns, and all of them together. */
struct view {
    struct bound_moment *engine;
    const struct interval *column[MOVING_MOST]; /* of each column of a side, those of one side together */
    const double *sup[MOVING_MOST]; /* K: what tau is not above */
    int alike[SIDES_MOST]; /* whether the side before it is the same interval of the same kind */
    double least[COSINES(COLUMNS_MOST)]; /* infimum of each cosine */
    struct gains gains; /* as they are at the corners */
};

INSTANCE struct sides sides_of(const struct view *v, int c, int d)
{
    const struct model *model = v->engine->model;
    const struct sides s = {
        &v->engine->moments, {model_kind_of(model, c), model_kind_of(model, d)}, {v->column[c], v->column[d]}};

    return s;
}

/* mu of columns c < d of different sides at the corners, how far it falls, and its infimum. */
INSTANCE void open_pair(struct view *v, int c, int d, int entry)
{
    const struct sides s = sides_of(v, c, d);
    int same = s.side[0] == s.side[1], corner;

    for (corner = 0; corner < 4; corner++) {
        /* On the diagonal (high, low) mirrors (low, high). */
        v->gains.cosine[entry][corner] = brdffit_pair_corner(&s, corner == 1 && same ? 2 : corner)->mu;
    }
    v->least[entry] = brdffit_pair_least(&s);
    v->gains.fall[entry][0] = brdffit_pair_shift(&s, 0, v->least[entry]);
    v->gains.fall[entry][1] = same ? v->gains.fall[entry][0] : brdffit_pair_shift(&s, 1, v->least[entry]);
}

/* An entry that one side moves: its ends, how far it falls, and its infimum. */
INSTANCE void open_entry(struct view *v, int entry, double low, double high, double fall, double least)
{
    v->gains.cosine[entry][0] = low;
    v->gains.cosine[entry][1] = high;
    v->gains.fall[entry][0] = fall;
    v->gains.fall[entry][1] = 0.0;
    v->least[entry] = least;
}

/* Column c of the sides against the fixed ones and the data. */
INSTANCE void open_column(struct view *v, const struct box *box, int c, int depth, const int F, const int Q,
                          const int S)
{
    const struct model *model = v->engine->model;
    const int n = F + Q * S, p = c / Q;
    const struct interval *s = brdffit_bound_moment_side(v->engine, model->lobe[p].kind + c % Q * model->axes,
                                                         box->interval[p], depth);
    struct gains *g = &v->gains;
    int f;

    v->column[c] = s;
    g->tau[c][0] = s->low->tau;
    g->tau[c][1] = s->high->tau;
    g->shift[c] = s->tau_shift;
    v->sup[c] = s->tau_sup;
    for (f = 0; f < F; f++) {
        open_entry(v, COSINE(n, f, F + c), s->low->kappa[f], s->high->kappa[f], s->kappa_shift[f], s->kappa_inf[f]);
    }
    if (c % Q == 0) {
        v->alike[p] = c >= Q && p > model->lobe[p].first && v->column[c - Q] == s;
    } else {
        open_entry(v, COSINE(n, F + c - 1, F + c), s->beside->end[0], s->beside->end[1], s->beside->shift,
                   s->beside->least);
    }
}

INSTANCE void open_fixed(struct view *v, const int F, const int n)
{
    const struct moments *m = &v->engine->moments;
    int f, g;

    for (f = 0; f < F; f++) {
        v->gains.omega[f] = m->omega[f];
        for (g = f + 1; g < F; g++) {
            open_entry(v, COSINE(n, f, g), m->fixed[f][g], m->fixed[f][g], 0.0, m->fixed[f][g]);
        }
    }
}

INSTANCE void open_view(struct view *v, struct bound_moment *e, const struct box *box, int depth, const int F,
                        const int Q, const int S)
{
    const int n = F + Q * S;
    int c, d;

    v->engine = e;
    v->gains.channels = e->moments.data->bounded;
    open_fixed(v, F, n);
    for (c = 0; c < Q * S; c++) {
        open_column(v, box, c, depth, F, Q, S);
    }
    for (c = 0; c < Q * S; c++) {
        for (d = (c / Q + 1) * Q; d < Q * S; d++) {
            open_pair(v, c, d, COSINE(n, F + c, F + d));
        }
    }
    if (e->limits.on) {
        brdffit_limits_apply(v);
    }
}

/* Whether columns i < j belong to two sides. */
INSTANCE int of_two_sides(int i, int j, const int F, const int Q)
{
    return i >= F && (i - F) / Q != (j - F) / Q;
}

/* Whether shifts may be used: those of intervals, and of pairs, which LIMIT_SHIFT covers too. */
INSTANCE int usable(const struct view *v, const int F, const int Q, const int S)
{
    const int n = F + Q * S;
    int fine = 1, i, j;

    for (i = 0; i < Q * S; i++) {
        fine = fine && v->column[i]->usable;
    }
    for (i = F; i < n; i++) {
        for (j = i + 1; j < n; j++) {
            const double *fall = v->gains.fall[COSINE(n, i, j)];

            fine = fine &&
                   (!of_two_sides(i, j, F, Q) || (fabs(fall[0]) <= LIMIT_SHIFT && fabs(fall[1]) <= LIMIT_SHIFT));
        }
    }
    return fine;
}

/* Whether the shifts would push an entry below 0 at some corner. */
INSTANCE int sinks(const struct view *v, int entry, int two)
{
    const double *cosine = v->gains.cosine[entry], *fall = v->gains.fall[entry];
    double lowest = smaller(cosine[0], cosine[1]), most = larger(fall[0], 0.0);

    if (two) {
        lowest = smaller(lowest, smaller(cosine[2], cosine[3]));
        most += larger(fall[1], 0.0);
    }
    return !(lowest - most >= 0.0);
}

/* Such entries become their infimum in *safe, a copy of the gains, when there are any. Returns how many. */
INSTANCE int make_constant(const struct view *v, struct gains *safe, const int F, const int Q, const int S)
{
    const int n = F + Q * S;
    int corner, i, j, entry = 0, constants = 0;

    for (i = 0; i < n; i++) {
        for (j = i + 1; j < n; j++, entry++) {
            if (j < F || !sinks(v, entry, of_two_sides(i, j, F, Q))) {
                continue;
            }
            if (constants++ == 0) {
                *safe = v->gains;
            }
            for (corner = 0; corner < 4; corner++) {
                safe->cosine[entry][corner] = v->least[entry];
            }
            safe->fall[entry][0] = safe->fall[entry][1] = 0.0;
        }
    }
    return constants;
}

/* Every tau at its supremum, every cosine at its infimum. */
INSTANCE double monotone(const struct view *v, const int F, const int Q, const int S)
{
    const int n = F + Q * S;
    double sum = 0.0, t[COLUMNS_MOST];
    size_t k;
    int c;

    for (k = 0; k < v->gains.channels; k++) {
        for (c = 0; c < F; c++) {
            t[c] = v->gains.omega[c][k];
        }
        for (c = 0; c < n - F; c++) {
            t[F + c] = v->sup[c][k];
        }
        sum += brdffit_nnls_gain(n, v->least, t);
    }
    return sum;
}

/* Whether a corner mirrors one that has its high ends at later sides. */
INSTANCE int mirrors(const struct view *v, unsigned corner, const int S)
{
    int p, mirror = 0;

    for (p = 1; p < S; p++) {
        mirror = mirror || (v->alike[p] && (corner >> (p - 1) & 1) && !(corner >> p & 1));
    }
    return mirror;
}

/* What the geometry's rounding costs this box. */
static inline struct doubt box_doubt(const struct bound_moment *e, const struct box *box)
{
    double low[SIDES_MOST], high[SIDES_MOST];
    int p;

    for (p = 0; p < e->model->sides; p++) {
        brdffit_axis_ends(&e->axis[e->model->lobe[p].kind], box->interval[p], &low[p], &high[p]);
    }
    return brdffit_charge_box(e->moments.data, e->model, low, high);
}

#endif
