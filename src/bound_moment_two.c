/*
 * Engine `moment`, two lobes: see bound_moment.c for the argument. Layer 3. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "bound_moment.h"
#include "nnls.h"
#include "tolerance.h"

/* A box, its sides and how far each may leave its chord. Cosines: 0 = kappa first, 1 = kappa second, 2 = mu. */
struct view {
    struct bound_moment *engine;
    const struct interval *side[2];
    double mu_shift[2];
    double cosine_inf[3];
    int constant[3]; /* the cosine is replaced by its infimum */
    int diagonal;    /* both sides are the same interval */
    unsigned subsets; /* bit s: subset s of shifted sides can be the largest (bit 0 of s: first side) */
};

struct corner {
    const struct node *node[2];
    double theta[2];
    double mu;
};

static void load_corner(const struct view *v, int which, struct corner *c)
{
    const struct bound_moment *e = v->engine;
    uint32_t index[2];
    int i;

    for (i = 0; i < 2; i++) {
        int high = (which >> i) & 1;

        index[i] = high ? v->side[i]->high_index : v->side[i]->low_index;
        c->node[i] = high ? v->side[i]->high : v->side[i]->low;
        c->theta[i] = e->axis->coordinate[index[i]];
    }
    c->mu = brdffit_moments_pair(&v->engine->moments, index[0], index[1])->mu;
}

/* J with the sides of `subset` shifted. */
static double gain_two(const struct view *v, const struct corner *c, unsigned subset, const int *constant)
{
    const struct bound_moment *e = v->engine;
    const double *omega = e->moments.omega, *tau0 = c->node[0]->tau, *tau1 = c->node[1]->tau;
    double cosine[3] = {c->node[0]->kappa, c->node[1]->kappa, c->mu};
    double on[2] = {subset & 1u ? 1.0 : 0.0, subset & 2u ? 1.0 : 0.0};
    struct nnls_gram3 gram;
    double sum = 0.0;
    size_t k, K = e->moments.data->channels;
    int i;

    for (i = 0; i < 2; i++) {
        if (on[i] > 0.0) {
            cosine[i] -= v->side[i]->kappa_shift;
            cosine[2] -= v->mu_shift[i];
        }
    }
    for (i = 0; i < 3; i++) {
        cosine[i] = constant[i] ? v->cosine_inf[i] : fmax(cosine[i], 0.0);
    }
    brdffit_nnls_gram3(&gram, cosine[0], cosine[1], cosine[2]);
    for (k = 0; k < K; k++) {
        sum += brdffit_nnls_gain3(&gram, omega[k], tau0[k] + on[0] * v->side[0]->tau_shift[k],
                                  tau1[k] + on[1] * v->side[1]->tau_shift[k]);
    }
    return sum;
}

static double monotone_gain(const struct view *v)
{
    const struct bound_moment *e = v->engine;
    struct nnls_gram3 gram;
    double sum = 0.0;
    size_t k;

    brdffit_nnls_gram3(&gram, v->cosine_inf[0], v->cosine_inf[1], v->cosine_inf[2]);
    for (k = 0; k < e->moments.data->channels; k++) {
        sum += brdffit_nnls_gain3(&gram, e->moments.omega[k], v->side[0]->tau_sup[k], v->side[1]->tau_sup[k]);
    }
    return sum;
}

/* Whether all shifts of a side are finite; and whether they only raise (+1) or only lower (-1) J, or both (0). */
static int side_sign(const struct view *v, int i, int *finite)
{
    const struct interval *s = v->side[i];
    int raise = s->kappa_shift >= 0.0 && v->mu_shift[i] >= 0.0;
    int lower = s->kappa_shift <= 0.0 && v->mu_shift[i] <= 0.0;
    size_t k;

    *finite = *finite && isfinite(s->kappa_shift) && isfinite(v->mu_shift[i]);
    for (k = 0; k < v->engine->moments.data->channels; k++) {
        raise = raise && s->tau_shift[k] >= 0.0;
        lower = lower && s->tau_shift[k] <= 0.0;
        *finite = *finite && isfinite(s->tau_shift[k]);
    }
    return raise ? 1 : lower ? -1 : 0;
}

/* Subsets that can hold the maximum: a side that only raises is always shifted, one that only lowers never. */
static int choose_subsets(struct view *v)
{
    int finite = 1;
    int sign[2];
    unsigned s;

    sign[0] = side_sign(v, 0, &finite);
    sign[1] = side_sign(v, 1, &finite);
    v->subsets = 0;
    for (s = 0; s < 4; s++) {
        int on0 = (int)(s & 1u), on1 = (int)(s >> 1);

        if ((sign[0] == 0 || (sign[0] > 0) == on0) && (sign[1] == 0 || (sign[1] > 0) == on1)) {
            v->subsets |= 1u << s;
        }
    }
    return finite;
}

/* Entries that a shift would push below 0 at some corner: see bound_moment.c. */
static void choose_constants(struct view *v, const struct corner *corner, int corners)
{
    double shift[3];
    int c, i;

    shift[0] = fmax(v->side[0]->kappa_shift, 0.0);
    shift[1] = fmax(v->side[1]->kappa_shift, 0.0);
    shift[2] = fmax(v->mu_shift[0], 0.0) + fmax(v->mu_shift[1], 0.0);
    for (i = 0; i < 3; i++) {
        v->constant[i] = 0;
        for (c = 0; c < corners; c++) {
            double value = i == 2 ? corner[c].mu : corner[c].node[i]->kappa;

            v->constant[i] = v->constant[i] || !(value - shift[i] >= 0.0);
        }
    }
}

static void open_view(struct view *v, struct bound_moment *e, const struct box *box)
{
    int i;

    v->engine = e;
    for (i = 0; i < 2; i++) {
        v->side[i] = brdffit_bound_moment_side(e, box->interval[i]);
        v->cosine_inf[i] = v->side[i]->kappa_inf;
    }
    v->diagonal = box->interval[0] == box->interval[1];
    v->mu_shift[0] = brdffit_pair_shift(&e->intervals, v->side[0], v->side[1], 0);
    v->mu_shift[1] = v->diagonal ? v->mu_shift[0]
                                 : brdffit_pair_shift(&e->intervals, v->side[0], v->side[1], 1);
    v->cosine_inf[2] =
        fmax(0.0, brdffit_moments_pair(&e->moments, v->side[0]->low_index, v->side[1]->high_index)->mu);
}

static double width(const struct view *v, int i)
{
    const double *theta = v->engine->axis->coordinate;

    return theta[v->side[i]->high_index] - theta[v->side[i]->low_index];
}

/* Split the side whose shift costs more at the largest corner; the wider one where the chord is useless. */
static int choose_split(const struct view *v, const struct corner *worst, int chord)
{
    if (!chord) {
        return width(v, 1) > width(v, 0);
    }
    return gain_two(v, worst, 2u, v->constant) > gain_two(v, worst, 1u, v->constant);
}

double brdffit_bound_moment_two(void *self, struct box *box, struct point *met)
{
    static const int none[3] = {0, 0, 0};
    struct bound_moment *e = self;
    struct view v;
    struct corner corner[4];
    double best = INFINITY, vertex = 0.0, monotone;
    int c, corners = 0, finite, worst = 0;
    unsigned s;

    open_view(&v, e, box);
    finite = choose_subsets(&v);
    for (c = 0; c < 4; c++) {
        if (v.diagonal && c == 1) {
            continue; /* (high, low) mirrors (low, high) */
        }
        load_corner(&v, c, &corner[corners++]);
    }
    choose_constants(&v, corner, corners);
    for (c = 0; c < corners; c++) {
        brdffit_bound_moment_meet(e, gain_two(&v, &corner[c], 0u, none), corner[c].theta, &best, met);
        for (s = 0; s < 4 && finite; s++) {
            if (v.subsets & (1u << s)) {
                double gain = gain_two(&v, &corner[c], s, v.constant);

                if (!(gain <= vertex)) {
                    vertex = gain;
                    worst = c;
                }
            }
        }
    }
    monotone = monotone_gain(&v);
    finite = finite && vertex < monotone;
    box->bound = brdffit_bound_moment_objective(e, finite ? vertex : monotone);
    box->split = choose_split(&v, &corner[worst], finite);
    return best;
}
