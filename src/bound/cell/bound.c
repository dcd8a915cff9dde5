/*
 * Boxes of models with an anisotropic lobe: see cell.h, and bound/moment/bound.c for the argument. SPDX-License-Identifier: MIT
 *
 * Every gain of the box, at each corner with each subset of the sides shifted, is listed with its own data and cosines, as a
 * column may move with two sides and a pair with three; gains.h makes the maximum of them, side by side. An off-diagonal
 * that shifts would take below 0 at some corner is its infimum at all of them.
 */
#include "bound/cell/cell.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "solve/nnls.h"

/* A box being bounded. */
struct view {
    struct bound_cell *engine;
    const struct box *box;
    const struct cell *cell[BRDFFIT_MAX_LOBES];
    const struct cell_node *corner[BRDFFIT_MAX_LOBES][CORNERS_MOST];
    double *cosine, *t; /* the list */
    double least[COSINES(COLUMNS_MOST)];
    unsigned count; /* gains: all of the box */
    int constants;  /* off-diagonals that are their infimum */
};

static const uint32_t *interval_of(const struct view *v, int p)
{
    return v->box->interval + v->engine->lobe[p].side;
}

/* Bits of index i that are those of lobe p: of its corner, and of its shifts. */
static unsigned corner_bits(const struct view *v, int p, unsigned i)
{
    return i >> v->engine->lobe[p].side & ((1u << v->engine->lobe[p].shapes) - 1u);
}

static unsigned shift_bits(const struct view *v, int p, unsigned i)
{
    return corner_bits(v, p, i >> v->engine->model->sides);
}

/* The sum of the shifts that are on, `stride` apart. */
static double shifted(unsigned bits, int shapes, const double *shift, size_t stride)
{
    double sum = 0.0;
    int d;

    for (d = 0; d < shapes; d++) {
        sum += bits >> d & 1u ? shift[(size_t)d * stride] : 0.0;
    }
    return sum;
}

/* An entry whose shifts might take it below 0 becomes its infimum everywhere, as far as shifts are meant. */
static void keep_positive(struct view *v, int entry, double most)
{
    double *cosine = v->cosine + (size_t)entry * v->count, lowest = cosine[0];
    unsigned i, corners = 1u << v->engine->model->sides;

    for (i = 1; i < corners; i++) {
        lowest = smaller(lowest, cosine[i]);
    }
    if (lowest - most >= 0.0) {
        return;
    }
    v->constants++;
    for (i = corners; i < v->count; i++) {
        cosine[i] = v->least[entry];
    }
}

static double positive_part(const double *shift, size_t stride, int shapes)
{
    double sum = 0.0;
    int d;

    for (d = 0; d < shapes; d++) {
        sum += larger(0.0, shift[(size_t)d * stride]);
    }
    return sum;
}

/* Fixed column f with column j of lobe p. */
static void list_kappa(struct view *v, int f, int p, int j, int entry)
{
    const struct cell_lobe *lobe = &v->engine->lobe[p];
    const double *shift = v->cell[p]->kappa_shift[j] + f;
    size_t F = (size_t)v->engine->model->fixed;
    unsigned i;

    for (i = 0; i < v->count; i++) {
        v->cosine[(size_t)entry * v->count + i] = v->corner[p][corner_bits(v, p, i)]->kappa[j][f] -
                                                  shifted(shift_bits(v, p, i), lobe->shapes, shift, F);
    }
    v->least[entry] = v->cell[p]->kappa_inf[j][f];
    keep_positive(v, entry, positive_part(shift, F, lobe->shapes));
}

static void list_beside(struct view *v, int p, int entry)
{
    const struct cell *cell = v->cell[p];
    int shapes = v->engine->lobe[p].shapes;
    unsigned i;

    for (i = 0; i < v->count; i++) {
        v->cosine[(size_t)entry * v->count + i] = v->corner[p][corner_bits(v, p, i)]->beside -
                                                  shifted(shift_bits(v, p, i), shapes, cell->beside_shift, 1);
    }
    v->least[entry] = cell->beside_least;
    keep_positive(v, entry, positive_part(cell->beside_shift, 1, shapes));
}

/* Columns c of lobe p and d of lobe q. */
struct pair_of {
    int p, c, q, d;
};

/* sup of the second derivative of their cosine along coordinate `side` of the lobe `own`, times its eighth; the cosine is at
 * least `least`. */
static double pair_shift(struct view *v, const struct pair_of *pair, int own, int side, double least)
{
    struct bound_cell *e = v->engine;
    const struct moments *m = &e->moments;
    const int last = (1 << e->lobe[own].shapes) - 1, column = own == pair->p ? pair->c : pair->d;
    const struct cell *cell = v->cell[own];
    const struct cell *one = v->cell[pair->p], *two = v->cell[pair->q];
    const double *w = reduced_cross(m->data,
                                    e->model->geometry[model_kind_of(e->model, pair->p * e->model->each + pair->c)],
                                    e->model->geometry[model_kind_of(e->model, pair->q * e->model->each + pair->d)]);
    size_t n = m->data->stride;
    struct local at;
    double sum;

    at.x_low = brdffit_cell_slopes(e, own, v->corner[own][0], side, e->scratch, &at.slope_low);
    at.x_high = brdffit_cell_slopes(e, own, v->corner[own][last], side, e->scratch + 2 * n, &at.slope_high);
    at.mean_low = cell->mean[column][side][1];
    at.mean_high = cell->mean[column][side][0];
    sum = m->kernels->pair_curvature(w, one->sup, two->sup, &at, n);
    sum *= (1.0 + TOL_CURVATURE) / (one->root_inf[pair->c] * two->root_inf[pair->d]);
    return cell->eighth[side] * (sum - (1.0 - TOL_CURVATURE) * (cell->curvature[column][side] * least));
}

static double pair_least(const struct view *v, const struct pair_of *pair)
{
    const struct bound_cell *e = v->engine;
    const struct cell *one = v->cell[pair->p], *two = v->cell[pair->q];
    const double *w = reduced_cross(e->moments.data,
                                    e->model->geometry[model_kind_of(e->model, pair->p * e->model->each + pair->c)],
                                    e->model->geometry[model_kind_of(e->model, pair->q * e->model->each + pair->d)]);
    double sums[3];

    e->moments.kernels->pair(w, one->inf, two->inf, e->lobe[0].c[0], INFINITY, e->moments.data->stride, sums);
    return larger(0.0, sums[0] / (one->root_sup[pair->c] * two->root_sup[pair->d]) * (1.0 - TOL_CURVATURE) -
                           4.0 * larger(one->epsilon, two->epsilon));
}

static void list_pair(struct view *v, const struct pair_of *pair, int entry)
{
    struct bound_cell *e = v->engine;
    const int shapes[2] = {e->lobe[pair->p].shapes, e->lobe[pair->q].shapes};
    const unsigned last[2] = {(1u << shapes[0]) - 1u, (1u << shapes[1]) - 1u};
    double mu[CORNERS_MOST][CORNERS_MOST], shift[2][SHAPES_MOST] = {{0.0}}, least;
    unsigned i, j;
    int d;

    for (i = 0; i <= last[0]; i++) {
        for (j = 0; j <= last[1]; j++) {
            mu[i][j] = brdffit_cell_cosine(e, v->corner[pair->p][i], pair->c, v->corner[pair->q][j], pair->d);
        }
    }
    least = pair_least(v, pair);
    for (d = 0; d < shapes[0]; d++) {
        shift[0][d] = pair_shift(v, pair, pair->p, d, least);
    }
    for (d = 0; d < shapes[1]; d++) {
        shift[1][d] = pair_shift(v, pair, pair->q, d, least);
    }
    for (i = 0; i < v->count; i++) {
        v->cosine[(size_t)entry * v->count + i] = mu[corner_bits(v, pair->p, i)][corner_bits(v, pair->q, i)] -
                                                  shifted(shift_bits(v, pair->p, i), shapes[0], shift[0], 1) -
                                                  shifted(shift_bits(v, pair->q, i), shapes[1], shift[1], 1);
    }
    v->least[entry] = least;
    keep_positive(v, entry, positive_part(shift[0], 1, shapes[0]) + positive_part(shift[1], 1, shapes[1]));
}

static void list_fixed(struct view *v, int f, int g, int entry)
{
    unsigned i;

    v->least[entry] = v->engine->moments.fixed[f][g];
    for (i = 0; i < v->count; i++) {
        v->cosine[(size_t)entry * v->count + i] = v->least[entry];
    }
}

/* Entry i < j of the Gram matrix. */
static void list_entry(struct view *v, int i, int j, int entry)
{
    const int F = v->engine->model->fixed, each = v->engine->model->each;
    const int p = (i - F) / each, q = (j - F) / each;

    if (j < F) {
        list_fixed(v, i, j, entry);
    } else if (i < F) {
        list_kappa(v, i, q, (j - F) % each, entry);
    } else if (p == q) {
        list_beside(v, p, entry);
    } else {
        const struct pair_of pair = {p, (i - F) % each, q, (j - F) % each};

        list_pair(v, &pair, entry);
    }
}

/* Data along column c: of all gains, channel by channel. */
static void list_data(struct view *v, int c)
{
    const struct bound_cell *e = v->engine;
    const int F = e->model->fixed, p = (c - F) / e->model->each, j = (c - F) % e->model->each;
    size_t k, n = (size_t)e->model->columns;
    unsigned i;

    for (k = 0; k < e->moments.data->bounded; k++) {
        double *t = v->t + (k * n + (size_t)c) * v->count;

        for (i = 0; i < v->count && c < F; i++) {
            t[i] = e->moments.omega[c][k];
        }
        for (i = 0; i < v->count && c >= F; i++) {
            unsigned bits = shift_bits(v, p, i);

            t[i] = v->corner[p][corner_bits(v, p, i)]->tau[j][k] + (bits & 1u ? v->cell[p]->tau_shift[j][0][k] : 0.0) +
                   (bits & 2u ? v->cell[p]->tau_shift[j][1][k] : 0.0);
        }
    }
}

static void open_view(struct view *v, struct bound_cell *e, const struct box *box)
{
    const int n = e->model->columns;
    int p, i, j, entry = 0;
    unsigned corner;

    v->engine = e;
    v->box = box;
    v->constants = 0;
    v->count = GAINS(e->model->sides);
    v->cosine = e->list;
    v->t = e->list + (size_t)COSINES(n) * v->count;
    e->box++;
    for (p = 0; p < e->model->lobes; p++) {
        v->cell[p] = brdffit_cell_of(e, p, interval_of(v, p));
        for (corner = 0; corner < 1u << e->lobe[p].shapes; corner++) {
            v->corner[p][corner] = brdffit_cell_corner(e, p, interval_of(v, p), corner);
        }
    }
    for (i = 0; i < n; i++) {
        for (j = i + 1; j < n; j++, entry++) {
            list_entry(v, i, j, entry);
        }
        list_data(v, i);
    }
}

/* Every tau at its supremum, every cosine at its infimum. */
static double monotone(const struct view *v)
{
    const struct bound_cell *e = v->engine;
    const int F = e->model->fixed, each = e->model->each;
    double sum = 0.0, t[COLUMNS_MOST];
    size_t k;
    int c;

    for (k = 0; k < e->moments.data->bounded; k++) {
        for (c = 0; c < e->model->columns; c++) {
            t[c] = c < F ? e->moments.omega[c][k] : v->cell[(c - F) / each]->tau_sup[(c - F) % each][k];
        }
        sum += brdffit_nnls_gain(e->model->columns, v->least, t);
    }
    return sum;
}

static double coordinate(const struct view *v, int side, int high)
{
    const struct axis *axis = &v->engine->axis[side];
    const struct axis_interval *i = &axis->interval[v->box->interval[side]];

    return axis->coordinate[high ? i->high : i->low];
}

static double meet_corners(const struct view *v, const double *gain, struct point *met)
{
    double best = INFINITY;
    unsigned corner;
    int side;

    for (corner = 0; corner < 1u << v->engine->model->sides; corner++) {
        double objective = v->engine->moments.data->total - gain[corner];

        if (objective < best) {
            best = objective;
            for (side = 0; side < v->engine->model->sides; side++) {
                met->theta[side] = coordinate(v, side, (int)(corner >> side & 1u));
            }
        }
    }
    return best;
}

static int all_usable(const struct view *v)
{
    int p, fine = 1;

    for (p = 0; p < v->engine->model->lobes; p++) {
        fine = fine && v->cell[p]->usable;
    }
    return fine;
}

static uint32_t widest(const struct view *v)
{
    int side, most = 0;

    for (side = 1; side < v->engine->model->sides; side++) {
        double width = coordinate(v, side, 1) - coordinate(v, side, 0);

        most = width > coordinate(v, most, 1) - coordinate(v, most, 0) ? side : most;
    }
    return (uint32_t)most;
}

static double objective_below(const struct bound_cell *e, double gain)
{
    return larger(0.0, e->moments.data->total - gain - e->moments.slack);
}

static double largest_of(const double *gain, unsigned count)
{
    double largest = gain[0];
    unsigned i;

    for (i = 1; i < count; i++) {
        largest = larger(largest, gain[i]);
    }
    return largest;
}

/* Corners with their true cosines stay so in meet_corners(); what bounds the box has constants there, too. */
static double corners_with_constants(const struct view *v, double *gain)
{
    struct bound_cell *e = v->engine;
    const unsigned corners = 1u << e->model->sides;
    unsigned i;
    int entry;

    for (entry = 0; entry < COSINES(e->model->columns); entry++) {
        double *cosine = v->cosine + (size_t)entry * v->count;

        for (i = 0; i < corners && cosine[v->count - 1] == v->least[entry]; i++) {
            cosine[i] = v->least[entry];
        }
    }
    e->moments.kernels->gains_list(
        &(struct gains_list){e->moments.data->bounded, v->count, (unsigned)e->model->columns, v->cosine, v->t}, gain);
    return largest_of(gain, v->count);
}

static double bound_view(struct view *v, struct box *box, double cutoff, struct point *met)
{
    struct bound_cell *e = v->engine;
    const struct gains_list list = {e->moments.data->bounded, v->count, (unsigned)e->model->columns, v->cosine, v->t};
    double best, lift[SIDES_MOST] = {0.0}, largest, bound;
    int side, most = 0, chords = all_usable(v);

    e->moments.kernels->gains_list(&list, e->gain);
    best = meet_corners(v, e->gain, met);
    box->split = widest(v);
    box->bound = 0.0;
    if (chords) {
        largest = v->constants ? corners_with_constants(v, e->gain) : largest_of(e->gain, v->count);
        box->bound = objective_below(e, largest);
        if (box->bound >= cutoff) {
            return best;
        }
        box->bound = objective_below(e, e->moments.kernels->box_maximum[e->model->sides - 1](e->gain, lift));
        for (side = 1; side < e->model->sides; side++) {
            most = lift[side] > lift[most] ? side : most;
        }
    }
    bound = box->bound < cutoff ? objective_below(e, monotone(v)) : 0.0;
    if (chords && box->bound >= bound) {
        box->split = (uint32_t)most;
    }
    box->bound = larger(box->bound, bound);
    return best;
}

double brdffit_bound_cell(struct bound_cell *e, struct box *box, struct point *met)
{
    const struct reduced *data = e->moments.data;
    struct doubt doubt = {data->table[0].charge.diffuse, 0.0, 0.0};
    double best = INFINITY;
    struct view v;
    int p;

    open_view(&v, e, box);
    for (p = 0; p < e->model->lobes; p++) {
        doubt.error += v.cell[p]->error;
    }
    if (!(doubt.error < 1.0)) {
        box->bound = 0.0;
        box->split = widest(&v);
        for (p = 0; p < e->model->sides; p++) {
            met->theta[p] = coordinate(&v, p, 0);
        }
        return best;
    }
    best = bound_view(&v, box, brdffit_charge_raise(data, &doubt, box->bound), met);
    box->bound = brdffit_charge_pay(data, &doubt, box->bound);
    return best;
}
