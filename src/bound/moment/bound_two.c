/*
 * Engine `moment`, two lobes: see bound.c for the argument. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "bound/moment/bound.h"
#include "solve/nnls.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* A box, its sides and what bounds it. Cosines: 0 = kappa of the first side, 1 = of the second, 2 = mu. */
struct view {
    struct bound_moment *engine;
    const struct interval *side[2];
    double cosine_inf[3];
    struct gains_two gains; /* as they are at the corners */
};

static uint32_t corner_node(const struct view *v, int side, int corner)
{
    return corner >> side & 1 ? v->side[side]->high_index : v->side[side]->low_index;
}

static void open_cosines(struct view *v)
{
    struct moments *m = &v->engine->moments;
    double (*cosine)[4] = v->gains.cosine;
    int c, i;

    for (c = 0; c < 4; c++) {
        for (i = 0; i < 2; i++) {
            cosine[i][c] = (c >> i & 1 ? v->side[i]->high : v->side[i]->low)->kappa;
        }
        /* On the diagonal (high, low) mirrors (low, high). */
        cosine[2][c] = c == 1 && v->side[0] == v->side[1]
                           ? brdffit_moments_pair(m, corner_node(v, 0, 2), corner_node(v, 1, 2))->mu
                           : brdffit_moments_pair(m, corner_node(v, 0, c), corner_node(v, 1, c))->mu;
    }
    v->cosine_inf[0] = v->side[0]->kappa_inf;
    v->cosine_inf[1] = v->side[1]->kappa_inf;
    v->cosine_inf[2] = larger(0.0, cosine[2][2]); /* mu falls with the distance of the lobes */
}

static void open_view(struct view *v, struct bound_moment *e, const struct box *box)
{
    struct gains_two *g = &v->gains;
    int i;

    v->engine = e;
    g->channels = e->moments.data->bounded;
    g->omega = e->moments.omega;
    for (i = 0; i < 2; i++) {
        const struct interval *s = brdffit_bound_moment_side(e, box->interval[i], 2);

        v->side[i] = s;
        g->tau[i][0] = s->low->tau;
        g->tau[i][1] = s->high->tau;
        g->shift[i] = s->tau_shift;
        g->fall[i][i] = s->kappa_shift;
        g->fall[i][!i] = 0.0;
    }
    open_cosines(v);
    g->fall[2][0] = brdffit_pair_shift(&e->intervals, v->side[0], v->side[1], 0);
    g->fall[2][1] = v->side[0] == v->side[1] ? g->fall[2][0]
                                             : brdffit_pair_shift(&e->intervals, v->side[0], v->side[1], 1);
}

static int finite_shifts(const struct view *v)
{
    const struct gains_two *g = &v->gains;
    int finite = isfinite(g->fall[0][0]) && isfinite(g->fall[1][1]) && isfinite(g->fall[2][0]) &&
                 isfinite(g->fall[2][1]);
    size_t k;

    for (k = 0; k < g->channels; k++) {
        finite = finite && isfinite(g->shift[0][k]) && isfinite(g->shift[1][k]);
    }
    return finite;
}

/* Entries that the shifts would push below 0 at some corner become their infimum. Returns how many. */
static int make_constant(const struct view *v, struct gains_two *g)
{
    int c, i, constants = 0;

    for (i = 0; i < 3; i++) {
        double fall = larger(g->fall[i][0], 0.0) + larger(g->fall[i][1], 0.0), least = INFINITY;

        for (c = 0; c < 4; c++) {
            least = smaller(least, g->cosine[i][c]);
        }
        if (least - fall >= 0.0) {
            continue;
        }
        for (c = 0; c < 4; c++) {
            g->cosine[i][c] = v->cosine_inf[i];
        }
        g->fall[i][0] = g->fall[i][1] = 0.0;
        constants++;
    }
    return constants;
}

static double monotone_two(const struct view *v)
{
    double sum = 0.0;
    size_t k;

    for (k = 0; k < v->gains.channels; k++) {
        double t[3] = {v->gains.omega[k], v->side[0]->tau_sup[k], v->side[1]->tau_sup[k]};

        sum += brdffit_nnls_gain3(v->cosine_inf, t);
    }
    return sum;
}

static double width(const struct view *v, int i)
{
    const double *theta = v->engine->axis->coordinate;

    return theta[v->side[i]->high_index] - theta[v->side[i]->low_index];
}

/* Offer the corners, from true cosines; the diagonal's second corner mirrors its third. */
static double meet_corners(const struct view *v, const double *gain, struct point *met)
{
    const double *coordinate = v->engine->axis->coordinate;
    double best = INFINITY;
    int c;

    for (c = 0; c < 4; c++) {
        double theta[2] = {coordinate[corner_node(v, 0, c)], coordinate[corner_node(v, 1, c)]};

        if (!(c == 1 && v->side[0] == v->side[1])) {
            brdffit_bound_moment_meet(v->engine, gain[c], theta, &best, met);
        }
    }
    return best;
}

/* Whether ranges are no rival to chords: both ends nearly agree. */
static int narrow(const struct view *v)
{
    double change = 0.0;
    int i;

    for (i = 0; i < 2; i++) {
        change += v->side[i]->low->mean * (v->side[i]->high->u - v->side[i]->low->u);
    }
    return change < MONOTONE_LEAST;
}

static double largest_of(const double gain[16])
{
    double largest = gain[0];
    int i;

    for (i = 1; i < 16; i++) {
        largest = larger(largest, gain[i]);
    }
    return largest;
}

double brdffit_bound_moment_two(void *self, struct box *box, struct point *met)
{
    struct bound_moment *e = self;
    const struct kernels *kernels = e->moments.kernels;
    struct view v;
    double cutoff = box->bound, best, gain[16], lift[2], vertex = 0.0;
    int finite;

    open_view(&v, e, box);
    brdffit_bound_moment_doubt(e, box, 2);
    finite = finite_shifts(&v);
    kernels->gains_two(&v.gains, !finite, gain);
    best = meet_corners(&v, gain, met);
    if (finite) {
        struct gains_two safe = v.gains;

        if (make_constant(&v, &safe)) {
            kernels->gains_two(&safe, 0, gain);
        }
        vertex = brdffit_bound_moment_objective(e, largest_of(gain));
        if (vertex >= cutoff) {
            box->bound = vertex; /* closed already: no need to climb, nor to know which side to split */
            return best;
        }
        vertex = brdffit_bound_moment_objective(e, kernels->climb_two(gain, lift));
    }
    box->bound = vertex;
    if (!(vertex >= cutoff) && !narrow(&v)) {
        box->bound = larger(vertex, brdffit_bound_moment_objective(e, monotone_two(&v)));
    }
    /* Split the side whose shift costs more at a corner; the wider one where the chord is useless. */
    box->split = finite && vertex == box->bound ? lift[1] > lift[0] : width(&v, 1) > width(&v, 0);
    return best;
}

double brdffit_bound_moment_start_two(void *self, struct point *met)
{
    struct bound_moment *e = self;
    struct moments *m = &e->moments;
    double best = INFINITY;
    uint32_t i, j;
    size_t k;

    for (i = 0; i <= e->axis->first; i++) {
        const struct node *q = brdffit_moments_node(m, i, e->axis->coordinate[i]);

        for (j = 0; j <= i; j++) {
            const struct node *p = &m->node[j];
            const double theta[2] = {e->axis->coordinate[j], e->axis->coordinate[i]};
            const double mu = brdffit_moments_pair(m, j, i)->mu;
            const double cosine[3] = {larger(p->kappa, 0.0), larger(q->kappa, 0.0), larger(mu, 0.0)};
            double sum = 0.0;

            for (k = 0; k < m->data->bounded; k++) {
                sum += brdffit_nnls_gain3(cosine, (double[3]){m->omega[k], p->tau[k], q->tau[k]});
            }
            brdffit_bound_moment_meet(e, sum, theta, &best, met);
        }
    }
    return best;
}
