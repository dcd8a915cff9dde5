/*
 * Extremes of coefficients over a box: see extreme.h. SPDX-License-Identifier: MIT
 *
 * Let C be a set of coefficients z >= 0, the same for every point of the box, and f_z(theta) = sum_k 2 t.z_k - z_k'M z_k. For
 * each z of C, f_z is at most a mean of its values at the corners with subsets of the sides shifted (theory 4.2, 7.5), so that
 *
 *     max over z in C of f_z  <=  the largest, over corners and subsets, of  max over z in C of the shifted f_z.
 *
 * With C = {z_j of channel k at least v} and "gains at least g in all" this says: v is possible in the box only if it is at
 * one of the shifted corners, where the other channels gain R and channel k has to gain the rest. How far z_j reaches there is
 * level.h's question. So it is for sums and shares of two columns. Where shifts are of no use, or where that says
 * less, one "corner" has every tau at its supremum and every cosine at its infimum.
 *
 * Channels with the same sums stand in the bounds as one with sqrt(m) times these, and gain the same: one of them has to gain
 * what the others, and m - 1 of its like at their best, leave.
 *
 * True coefficients. What directions are rounded to costs a model delta |A z| (theory 8.5), and coefficients that are not
 * optimal obey |z_j A_j| <= |A z| <= |I| + sqrt(threshold) instead of |I|: so the charge counts 1 + sqrt(threshold) / |I| times.
 */
#include "bound/moment/extreme.h"

#include <math.h>

#include "bound/moment/view.h"
#include "solve/level.h"

/* A box opened, and the model's numbers. */
struct opened {
    struct view view;
    int F, Q, S, n;
};

static void open_box(struct opened *o, struct bound_moment *e, const struct box *box)
{
    o->F = e->model->fixed;
    o->Q = e->model->each;
    o->S = e->model->sides;
    o->n = e->model->columns;
    open_view(&o->view, e, box, 2, o->F, o->Q, o->S);
}

static int bit(unsigned index, int b)
{
    return (int)(index >> b & 1u);
}

static int side_of_column(const struct opened *o, int j)
{
    return (j - o->F) / o->Q;
}

/* The cosine of columns i < j at a corner (low S bits of index) with sides shifted (the next S bits). */
static double cosine_at(const struct opened *o, const struct gains *g, int i, int j, unsigned index)
{
    int e = COSINE(o->n, i, j), p, q;
    double cosine;

    if (j < o->F) {
        return g->cosine[e][0];
    }
    q = side_of_column(o, j);
    p = i < o->F ? q : side_of_column(o, i);
    if (p == q) {
        cosine = g->cosine[e][bit(index, q)] - (bit(index, o->S + q) ? g->fall[e][0] : 0.0);
    } else {
        cosine = g->cosine[e][bit(index, p) + 2 * bit(index, q)] - (bit(index, o->S + p) ? g->fall[e][0] : 0.0) -
                 (bit(index, o->S + q) ? g->fall[e][1] : 0.0);
    }
    return larger(cosine, 0.0);
}

static void cosines_at(const struct opened *o, const struct gains *g, unsigned index, double *cosine)
{
    int i, j;

    for (i = 0; i < o->n; i++) {
        for (j = i + 1; j < o->n; j++) {
            cosine[COSINE(o->n, i, j)] = cosine_at(o, g, i, j, index);
        }
    }
}

/* t of channel k there; `monotone`: at its supremum. */
static void projections_at(const struct opened *o, const struct gains *g, size_t k, unsigned index, int monotone,
                           double *t)
{
    int c;

    for (c = 0; c < o->F; c++) {
        t[c] = g->omega[c][k];
    }
    for (c = 0; c < o->n - o->F; c++) {
        int q = c / o->Q;

        t[o->F + c] = monotone ? o->view.column[c]->tau_sup[k]
                               : g->tau[c][bit(index, q)][k] + (bit(index, o->S + q) ? g->shift[c][k] : 0.0);
    }
}

/* What channel x->channel has to gain where all others gain what they can, and its own t; both for one of its like. */
static double left_to_gain(const struct opened *o, const struct gains *g, const struct extreme *x, const double *cosine,
                           unsigned index, int monotone, double *own)
{
    const struct reduced *data = o->view.engine->moments.data;
    double left = x->total_gain, t[COLUMNS_MOST], root;
    size_t k;
    int c;

    for (c = 0; c < o->n; c++) {
        own[c] = 0.0;
    }
    for (k = 0; k < data->bounded; k++) {
        projections_at(o, g, k, index, monotone, t);
        root = data->bound_root[k];
        if (k != x->channel) {
            left -= brdffit_nnls_gain(o->n, cosine, t);
            continue;
        }
        for (c = 0; c < o->n; c++) {
            own[c] = t[c] / root;
        }
        if (root > 1.0) {
            left -= (root * root - 1.0) * brdffit_nnls_gain(o->n, cosine, own);
        }
    }
    return left;
}

/* The reach at one corner, no less than the true one if that is above `enough`. */
static double reach_at(const struct opened *o, const struct gains *g, const struct extreme *x, unsigned index,
                       const double *monotone, double enough, double *multiplier)
{
    double room[COSINES(COLUMNS_MOST)], t[COLUMNS_MOST];
    struct level level = {.columns = o->n, .t = t, .asked = {x->column[0], x->column[1]}, .second = x->second};

    level.cosine = monotone ? monotone : room;
    if (!monotone) {
        cosines_at(o, g, index, room);
    }
    level.gain = left_to_gain(o, g, x, level.cosine, index, monotone != NULL, t);
    return x->share ? brdffit_level_share(&level, x->second, enough)
                    : brdffit_level_reach(&level, x->sense, enough, multiplier);
}

/* Shifted corners; entries that would fall below 0 are constants (theory 4.2). */
static double reach_by_shifts(const struct opened *o, const struct extreme *x, double enough)
{
    struct gains safe;
    const struct gains *g = make_constant(&o->view, &safe, o->F, o->Q, o->S) ? &safe : &o->view.gains;
    double best = -INFINITY, multiplier = 0.0;
    unsigned index;

    for (index = 0; index < GAINS(o->S); index++) {
        best = larger(best, reach_at(o, g, x, index, NULL, larger(best, enough), &multiplier));
    }
    return best;
}

double brdffit_moment_extreme(struct bound_moment *e, const struct box *box, const struct extreme *x,
                              double corner[1u << SIDES_MOST])
{
    struct opened o;
    double multiplier = 0.0, most, least;
    unsigned c;

    open_box(&o, e, box);
    for (c = 0; c < 1u << o.S; c++) {
        corner[c] = mirrors(&o.view, c, o.S) ? -(double)INFINITY
                                             : reach_at(&o, &o.view.gains, x, c, NULL, -(double)INFINITY, &multiplier);
    }
    multiplier = 0.0;
    most = reach_at(&o, &o.view.gains, x, 0, o.view.least, -(double)INFINITY, &multiplier);
    if (!usable(&o.view, o.F, o.Q, o.S)) {
        return most;
    }
    least = reach_by_shifts(&o, x, -(double)INFINITY);
    return smaller(most, least);
}

void brdffit_moment_corners(struct bound_moment *e, const struct box *box, double gain[1u << SIDES_MOST])
{
    double cosine[COSINES(COLUMNS_MOST)], t[COLUMNS_MOST];
    struct opened o;
    unsigned c;
    size_t k;

    open_box(&o, e, box);
    for (c = 0; c < 1u << o.S; c++) {
        gain[c] = mirrors(&o.view, c, o.S) ? -(double)INFINITY : 0.0;
        cosines_at(&o, &o.view.gains, c, cosine);
        for (k = 0; k < e->moments.data->bounded; k++) {
            projections_at(&o, &o.view.gains, k, c, 0, t);
            gain[c] += brdffit_nnls_gain(o.n, cosine, t);
        }
    }
}

double brdffit_moment_least_gain(const struct bound_moment *e, const struct box *box, double threshold)
{
    const struct reduced *data = e->moments.data;
    double root = data->table[0].charge.root, paid = e->payment.doubt, level;

    if (!(paid >= 0.0)) {
        struct doubt doubt = box_doubt(e, box);

        paid = (doubt.error + doubt.hidden) * root;
    }
    level = sqrt(threshold);
    if (paid > 0.0) {
        level += paid * (root > 0.0 ? 1.0 + level / root : 1.0);
    }
    level = level * level * (1.0 + 32.0 * TOL_UNIT);
    level = data->total - level - e->moments.slack;
    return level == level ? level : -(double)INFINITY;
}
