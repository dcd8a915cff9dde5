/*
 * Engine `moment`: see bound.h and theory 4.2. SPDX-License-Identifier: MIT
 *
 * For fixed coefficients z >= 0 let f_z(u) = sum_k 2 t.z_k - z_k'M z_k, so that J = max_z f_z is what a point
 * of the box gains: E^2 = T - J. Along one side of the box, at fraction x of it, f_z exceeds its chord by at most
 * w(x) D(z), w(x) = 4 x (1 - x), D(z) = (width^2 / 8) sup(-f_z''), which is linear in sup(-tau''), sup kappa'' and
 * sup mu''. So J(x) is at most the gain of the chord of (t, M) with w(x) times the (signed) shifts, the same x for all
 * channels; gains.h bounds that over x, and over both sides of a box with two lobes, from the gains at
 * the corners with each subset of the sides shifted.
 *
 * R is finite only for off-diagonals >= 0; theory.md clips a shifted off-diagonal at 0, which is not a bound when
 * only some corners are clipped (the chord through clipped corners can lie above the true curve). Here an entry
 * that would fall below 0 at any corner is replaced at all corners by its infimum over the box, a constant that
 * minorises it. Raising an entry to at most 1 is never needed: gains clip there, on the safe side.
 *
 * For wide boxes the monotone bound, every tau at its supremum and every cosine at its infimum, can be smaller. It is
 * looked at only when the other does not close the box.
 */
#include "bound/moment/bound.h"

#include <math.h>

#include "solve/nnls.h"
#include "base/tolerance.h"
#include "base/vector.h"

void brdffit_bound_moment_layout(struct bound_moment *e, struct arena *arena, size_t count, size_t channels,
                                 uint32_t node_capacity, int lobes)
{
    brdffit_moments_layout(&e->moments, arena, count, channels, node_capacity, lobes);
    brdffit_intervals_layout(&e->intervals, arena, AXIS_INTERVALS(node_capacity), channels);
}

void brdffit_bound_moment_start(struct bound_moment *e, const struct reduced *data, const struct lobe_kind *kind,
                                const struct kernels *kernels, struct axis *axis, int lobes)
{
    e->axis = axis;
    brdffit_moments_start(&e->moments, data, kind, kernels, lobes);
    brdffit_intervals_start(&e->intervals, &e->moments);
}

static struct interval *plain_side(struct bound_moment *e, uint32_t index)
{
    const struct axis_interval *i = &e->axis->interval[index];

    return brdffit_interval(&e->intervals, index, i->low, i->high, e->axis->coordinate[i->low],
                            e->axis->coordinate[i->high]);
}

/* Refine an interval by its halves, these refined `depth` - 1 times before, as far as there are nodes to spare. */
static struct interval *refined_side(struct bound_moment *e, uint32_t index, int depth)
{
    struct interval *v = plain_side(e, index);

    if (v->refined < depth && e->axis->nodes < e->axis->node_capacity / 2) {
        uint32_t child = brdffit_axis_split(e->axis, index);

        if (child) {
            brdffit_interval_refine(&e->intervals, v, refined_side(e, child, depth - 1),
                                    refined_side(e, child + 1, depth - 1));
            v->refined = depth;
        }
    }
    return v;
}

const struct interval *brdffit_bound_moment_side(struct bound_moment *e, uint32_t index, int depth)
{
    struct interval *v = plain_side(e, index);
    double change = v->low->mean * (v->high->u - v->low->u);
    int useful = change > REFINE_TWICE ? 2 : change > REFINE_ONCE ? 1 : 0;

    return refined_side(e, index, useful < depth ? useful : depth);
}

double brdffit_bound_moment_objective(const struct bound_moment *e, double gain)
{
    double bound = e->moments.data->total - gain - e->moments.slack;

    return bound > 0.0 ? brdffit_charge_pay(&e->moments.data->charge, &e->doubt, bound) : 0.0;
}

void brdffit_bound_moment_doubt(struct bound_moment *e, const struct box *box, int lobes)
{
    double low[2], high[2];
    int p;

    for (p = 0; p < lobes; p++) {
        const struct axis_interval *i = &e->axis->interval[box->interval[p]];

        low[p] = e->axis->coordinate[i->low];
        high[p] = e->axis->coordinate[i->high];
    }
    e->doubt = brdffit_charge_box(&e->moments.data->charge, lobes, low, high);
}

void brdffit_bound_moment_meet(const struct bound_moment *e, double gain, const double theta[2], double *best,
                               struct point *met)
{
    double objective = e->moments.data->total - gain;

    if (objective < *best) {
        *best = objective;
        met->theta[0] = theta[0];
        met->theta[1] = theta[1];
    }
}

/* ---- one lobe ---- */

static double monotone_one(const struct bound_moment *e, const struct interval *v)
{
    double sum = 0.0;
    size_t k;

    for (k = 0; k < e->moments.data->bounded; k++) {
        sum += brdffit_nnls_gain2(e->moments.omega[k], v->tau_sup[k], v->kappa_inf);
    }
    return sum;
}

static int finite_shifts(const struct bound_moment *e, const struct interval *v)
{
    int finite = isfinite(v->kappa_shift);
    size_t k;

    for (k = 0; k < e->moments.data->bounded; k++) {
        finite = finite && isfinite(v->tau_shift[k]);
    }
    return finite;
}

static void open_one(const struct bound_moment *e, const struct interval *v, struct gains_one *in)
{
    in->channels = e->moments.data->bounded;
    in->omega = e->moments.omega;
    in->tau[0] = v->low->tau;
    in->tau[1] = v->high->tau;
    in->shift = v->tau_shift;
    in->cosine[0] = v->low->kappa;
    in->cosine[1] = v->high->kappa;
    in->fall = v->kappa_shift;
}

/* The bound of one interval by its shifts, by the highest corner where that reaches `cutoff`; `gain`: of its ends, as they are. */
static double vertex_one(const struct bound_moment *e, const struct interval *v, double cutoff, double gain[4])
{
    const struct kernels *kernels = e->moments.kernels;
    struct gains_one in;
    double safe[4];

    open_one(e, v, &in);
    kernels->gains_one(&in, gain);
    if (!finite_shifts(e, v)) {
        return 0.0;
    }
    if (smaller(in.cosine[0], in.cosine[1]) - larger(in.fall, 0.0) >= 0.0) {
        double highest = larger(larger(gain[0], gain[1]), larger(gain[2], gain[3]));
        double bound = brdffit_bound_moment_objective(e, highest);

        return bound >= cutoff ? bound : brdffit_bound_moment_objective(e, kernels->climb_one(gain));
    }
    in.cosine[0] = in.cosine[1] = v->kappa_inf;
    in.fall = 0.0;
    kernels->gains_one(&in, safe);
    return brdffit_bound_moment_objective(e, kernels->climb_one(safe));
}

/* Refined step by step, as long as the box stays open: its halves are needed then anyway. */
double brdffit_bound_moment_one(void *self, struct box *box, struct point *met)
{
    struct bound_moment *e = self;
    double cutoff = box->bound, best = INFINITY, gain[4];
    const struct interval *v = brdffit_bound_moment_side(e, box->interval[0], 0);
    int i, depth;

    box->split = 0;
    brdffit_bound_moment_doubt(e, box, 1);
    box->bound = vertex_one(e, v, cutoff, gain);
    for (depth = 1; depth <= 2 && !(box->bound >= cutoff); depth++) {
        v = brdffit_bound_moment_side(e, box->interval[0], depth);
        if (v->refined == depth) {
            box->bound = larger(box->bound, vertex_one(e, v, cutoff, gain));
        }
    }
    for (i = 0; i < 2; i++) {
        double theta = e->axis->coordinate[i ? v->high_index : v->low_index];

        brdffit_bound_moment_meet(e, gain[i], (double[2]){theta, theta}, &best, met);
    }
    if (!(box->bound >= cutoff)) {
        box->bound = larger(box->bound, brdffit_bound_moment_objective(e, monotone_one(e, v)));
    }
    return best;
}

double brdffit_bound_moment_start_one(void *self, struct point *met)
{
    struct bound_moment *e = self;
    double best = INFINITY;
    uint32_t i;

    for (i = 0; i <= e->axis->first; i++) {
        const double theta[2] = {e->axis->coordinate[i], e->axis->coordinate[i]};
        const struct node *node = brdffit_moments_node(&e->moments, i, theta[0]);
        double sum = 0.0;
        size_t k;

        for (k = 0; k < e->moments.data->bounded; k++) {
            sum += brdffit_nnls_gain2(e->moments.omega[k], node->tau[k], larger(node->kappa, 0.0));
        }
        brdffit_bound_moment_meet(e, sum, theta, &best, met);
    }
    return best;
}
