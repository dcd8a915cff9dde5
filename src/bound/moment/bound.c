/*
 * Engine `moment`: see bound.h and theory 4.2, 7.5. SPDX-License-Identifier: MIT
 *
 * For fixed coefficients z >= 0 let f_z(u) = sum_k 2 t.z_k - z_k'M z_k, so that J = max_z f_z is what a point
 * of the box gains: E^2 = T - J. Along one side of the box, at fraction x of it, f_z exceeds its chord by at most
 * w(x) D(z), w(x) = 4 x (1 - x), D(z) = (width^2 / 8) sup(-f_z''), which is linear in sup(-tau''), sup kappa'' and
 * sup mu''. So J(x) is at most the gain of the chord of (t, M) with w(x) times the (signed) shifts, the same x for all
 * channels; gains.h bounds that over x, and over all sides of a box, from the gains at the corners
 * with each subset of the sides shifted.
 *
 * A shifted off-diagonal may fall below 0, where R need not be finite. Clipping it at 0 corner by corner is no bound: the
 * chord through clipped corners can lie above the true curve. Here an entry that would fall below 0 at any corner is
 * replaced at all corners by its infimum over the box, a constant that minorises it. Raising an entry to at most 1 is
 * never needed: gains clip there, on the safe side.
 *
 * For wide boxes the monotone bound, every tau at its supremum and every cosine at its infimum, can be smaller. It is
 * looked at only when the other does not close the box.
 */
#include "bound/moment/view.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"

void brdffit_bound_moment_layout(struct bound_moment *e, struct arena *arena, const struct moments_room *room,
                                 const struct model *model)
{
    int kind;

    brdffit_moments_layout(&e->moments, arena, room, model);
    for (kind = 0; kind < model->kinds; kind++) {
        brdffit_intervals_layout(&e->intervals[kind], arena, AXIS_INTERVALS(room->nodes), room->channels,
                                 (size_t)model->fixed, kind >= model->axes);
    }
}

void brdffit_bound_moment_start(struct bound_moment *e, const struct reduced *data, const struct model *model,
                                const struct kernels *kernels, struct axis *axis)
{
    int kind;

    e->model = model;
    e->axis = axis;
    e->limits.on = 0;
    e->limits.raised = 0.0;
    brdffit_payment_start(&e->payment, data, model);
    brdffit_moments_start(&e->moments, data, model, kernels);
    for (kind = 0; kind < model->kinds; kind++) {
        brdffit_intervals_start(&e->intervals[kind], &e->moments, kind,
                                kind < model->axes ? NULL : &e->intervals[kind - model->axes]);
    }
}

/* Refine an interval by its halves, these refined `depth` - 1 times before, as far as there are nodes to spare. */
static struct interval *refined_side(struct bound_moment *e, int kind, uint32_t index, int depth)
{
    struct axis *axis = &e->axis[model_axis(e->model, kind)];
    struct interval *v = brdffit_interval(&e->intervals[kind], index, axis);

    if (v->refined < depth && axis->nodes < axis->node_capacity / 2) {
        uint32_t child = brdffit_axis_split(axis, index);

        if (child) { /* one after the other, in an order that no compiler chooses: each takes nodes */
            const struct interval *right = refined_side(e, kind, child + 1, depth - 1);
            const struct interval *left = refined_side(e, kind, child, depth - 1);

            brdffit_interval_refine(&e->intervals[kind], v, left, right);
            v->refined = depth;
        }
    }
    return v;
}

/* How much the mean exponent changes over an interval. */
static double change_over(const struct interval *v)
{
    return v->low->mean * (v->high->u - v->low->u);
}

const struct interval *brdffit_bound_moment_side(struct bound_moment *e, int kind, uint32_t index, int depth)
{
    const struct interval *v = brdffit_interval(&e->intervals[kind], index, &e->axis[model_axis(e->model, kind)]);
    int useful;

    if (v->refined >= depth) {
        return v;
    }
    useful = change_over(v) > REFINE_TWICE ? 2 : change_over(v) > REFINE_ONCE ? 1 : 0;
    return refined_side(e, kind, index, useful < depth ? useful : depth);
}

/* A gain, with what limits add. */
static double raised(const struct bound_moment *e, double gain)
{
    return gain + e->limits.raised;
}

/* Lower bound of E^2 of the columns that are there; never below 0, which is always true. */
static double objective_below(const struct bound_moment *e, double gain)
{
    double bound = e->moments.data->total - raised(e, gain) - e->moments.slack;

    return bound > 0.0 ? bound : 0.0;
}

/* ---- a box: what follows has the number of sides S as a constant, in an instance for each. So are F and Q, the fixed
 * columns and those of a side, of the plain model; the others share instances that know them at run time ---- */

INSTANCE double coordinate(const struct view *v, int p, int high)
{
    const struct model *model = v->engine->model;
    const struct interval *side = v->column[p * model->each];

    return v->engine->axis[model->lobe[p].kind].coordinate[high ? side->high_index : side->low_index];
}

/* The best corner, from true cosines. J is raised by epsilon: the true objective is not below T - J. */
INSTANCE double meet_corners(const struct view *v, const double *gain, struct point *met, const int S)
{
    double total = v->engine->moments.data->total, best = INFINITY;
    unsigned corner;
    int p;

    for (corner = 0; corner < 1u << S; corner++) {
        double objective = total - raised(v->engine, gain[corner]);

        if (!(objective < best) || mirrors(v, corner, S)) {
            continue;
        }
        best = objective;
        for (p = 0; p < S; p++) {
            met->theta[p] = coordinate(v, p, corner >> p & 1);
        }
    }
    return best;
}

/* Whether ranges are no rival to chords: the ends of every side nearly agree. */
INSTANCE int narrow(const struct view *v, const int S)
{
    double change = 0.0;
    int i;

    for (i = 0; i < S; i++) {
        change += change_over(v->column[i * v->engine->model->each]);
    }
    return change < MONOTONE_LEAST;
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

INSTANCE uint32_t widest(const struct view *v, const int S)
{
    int p, most = 0;

    for (p = 1; p < S; p++) {
        double width = coordinate(v, p, 1) - coordinate(v, p, 0);

        most = width > coordinate(v, most, 1) - coordinate(v, most, 0) ? p : most;
    }
    return (uint32_t)most;
}

static uint32_t most_lifted(const double *lift, int sides)
{
    int p, most = 0;

    for (p = 1; p < sides; p++) {
        most = lift[p] > lift[most] ? p : most;
    }
    return (uint32_t)most;
}

/* What a side's limits cost beside its shifts. */
static void add_losses(const struct bound_moment *e, double *lift, int sides)
{
    int p;

    for (p = 0; p < sides && e->limits.on; p++) {
        lift[p] += e->limits.loss[p];
    }
}

/*
 * The bound by shifts into box->bound: by the highest corner where that closes the box already, with no need to know the
 * maximum between them, nor which side to split. Returns the best objective met, 0 or more shifts usable in *lifts.
 */
INSTANCE double bound_view(const struct view *v, struct box *box, double cutoff, struct point *met, double *lift,
                           int *chords, const int F, const int Q, const int S)
{
    const struct kernels *kernels = v->engine->moments.kernels;
    double gain[GAINS(SIDES_MOST)], best;

    *chords = usable(v, F, Q, S);
    kernels->gains[F - 1][Q - 1][S - 1](&v->gains, *chords, gain);
    best = meet_corners(v, gain, met, S);
    box->bound = 0.0;
    if (*chords) {
        struct gains safe;

        if (make_constant(v, &safe, F, Q, S)) {
            kernels->gains[F - 1][Q - 1][S - 1](&safe, 1, gain);
        }
        box->bound = objective_below(v->engine, largest_of(gain, GAINS(S)));
        if (!(box->bound >= cutoff)) {
            box->bound = objective_below(v->engine, kernels->box_maximum[S - 1](gain, lift));
        }
    }
    return best;
}

/* One side: refined step by step as long as the box stays open, whose halves are needed then anyway. */
INSTANCE double bound_refining(struct bound_moment *e, struct box *box, double cutoff, struct point *met,
                               struct view *v, const int F, const int Q)
{
    double best, lift[SIDES_MOST], bound;
    int depth, chords;

    open_view(v, e, box, 0, F, Q, 1);
    best = bound_view(v, box, cutoff, met, lift, &chords, F, Q, 1);
    for (depth = 1; depth <= 2 && !(box->bound >= cutoff); depth++) {
        bound = box->bound;
        if (brdffit_bound_moment_side(e, e->model->lobe[0].kind, box->interval[0], depth)->refined == depth) {
            open_view(v, e, box, depth, F, Q, 1);
            best = bound_view(v, box, cutoff, met, lift, &chords, F, Q, 1);
            box->bound = larger(box->bound, bound);
        }
    }
    box->split = 0;
    return best;
}

INSTANCE double bound_sides(struct bound_moment *e, struct box *box, struct point *met, const int F, const int Q,
                            const int S)
{
    double cutoff = box->bound, best, lift[SIDES_MOST] = {0.0}, vertex;
    struct view v;
    int chords = 0;

    if (S == 1) {
        best = bound_refining(e, box, cutoff, met, &v, F, Q);
    } else {
        open_view(&v, e, box, 2, F, Q, S);
        best = bound_view(&v, box, cutoff, met, lift, &chords, F, Q, S);
    }
    vertex = box->bound;
    if (vertex >= cutoff) {
        return best;
    }
    if (S == 1 || !narrow(&v, S)) {
        box->bound = larger(vertex, objective_below(e, monotone(&v, F, Q, S)));
    }
    add_losses(e, lift, S);
    /* Split the side whose shift costs most at a corner; the widest one where the chord is useless. */
    box->split = chords && vertex == box->bound ? most_lifted(lift, S) : widest(&v, S);
    return best;
}

INSTANCE double bound_columns(struct bound_moment *e, struct box *box, struct point *met, const int F, const int Q)
{
    switch (e->model->sides) {
#if SIDES_MOST > 1
    case 2: return bound_sides(e, box, met, F, Q, 2);
#endif
#if SIDES_MOST > 2
    case 3: return bound_sides(e, box, met, F, Q, 3);
#endif
    default: return bound_sides(e, box, met, F, Q, 1);
    }
}

static double bound_plain(struct bound_moment *e, struct box *box, struct point *met)
{
    return bound_columns(e, box, met, 1, 1);
}

static double bound_box(struct bound_moment *e, struct box *box, struct point *met)
{
    const int fixed = e->model->fixed, each = e->model->each;

    if (FIXED_MOST * EACH_MOST == 1 || (fixed == 1 && each == 1)) {
        return bound_plain(e, box, met);
    }
    return bound_columns(e, box, met, fixed, each);
}

/* Inside, bounds are those of the columns that are there, and so is what closes the box. */
double brdffit_bound_moment(struct bound_moment *e, struct box *box, struct point *met)
{
    double best;
    struct doubt doubt;

    if (e->payment.doubt >= 0.0) {
        box->bound = brdffit_payment_raise(&e->payment, box->bound);
        best = bound_box(e, box, met);
        box->bound = brdffit_payment_pay(&e->payment, box->bound);
        return best;
    }
    doubt = box_doubt(e, box);
    box->bound = brdffit_charge_raise(e->moments.data, &doubt, box->bound);
    best = bound_box(e, box, met);
    box->bound = brdffit_charge_pay(e->moments.data, &doubt, box->bound);
    return best;
}
