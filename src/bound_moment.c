/*
 * Engine `moment`: see bound_moment.h and theory 4.2. Layer 3. SPDX-License-Identifier: MIT
 *
 * For fixed coefficients z >= 0 let f_z(u) = sum_k 2 t.z_k - z_k'M z_k, so that J = max_z f_z is what a point
 * of the box gains: E^2 = T - J. Along one side of the box f_z exceeds its chord by at most
 * max(0, D(z)), D(z) = (width^2 / 8) sup(-f_z''), which is linear in sup(-tau''), sup kappa'' and sup mu''. So
 *
 *     J <= max over the corners and over the subsets of sides that are shifted, of R(t + shift, M - shift)
 *
 * with signed shifts, the same subset for all channels. R is finite only for off-diagonals >= 0; theory.md
 * clips a shifted off-diagonal at 0, which is not a bound when only some corners are clipped (the chord through
 * clipped corners can lie above the true curve). Here an entry that would fall below 0 at any corner is
 * replaced at all corners by its infimum over the box, a constant that minorises it. Raising an entry to at
 * most 1 is never needed: gains clip there, on the safe side.
 *
 * For wide boxes the monotone bound, every tau at its supremum and every cosine at its infimum, can be smaller.
 */
#include "bound_moment.h"

#include <math.h>

#include "nnls.h"
#include "tolerance.h"

void brdffit_bound_moment_layout(struct bound_moment *e, struct arena *arena, size_t count, size_t channels,
                                 uint32_t node_capacity, int lobes)
{
    brdffit_moments_layout(&e->moments, arena, count, channels, node_capacity, lobes);
    brdffit_intervals_layout(&e->intervals, arena, AXIS_INTERVALS(node_capacity), channels);
}

void brdffit_bound_moment_start(struct bound_moment *e, const struct reduced *data, const struct family *family,
                                const struct axis *axis, int lobes)
{
    e->axis = axis;
    brdffit_moments_start(&e->moments, data, family, lobes);
    brdffit_intervals_start(&e->intervals, &e->moments);
}

const struct interval *brdffit_bound_moment_side(struct bound_moment *e, uint32_t index)
{
    const struct axis_interval *i = &e->axis->interval[index];

    return brdffit_interval(&e->intervals, index, i->low, i->high, e->axis->coordinate[i->low],
                            e->axis->coordinate[i->high]);
}

double brdffit_bound_moment_objective(const struct bound_moment *e, double gain)
{
    double bound = e->moments.data->total - gain - e->moments.slack;

    return bound > 0.0 ? bound : 0.0;
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

/* Sum over channels; shift: 0 or 1 times the interval's tau shifts. */
static double gain_one(const struct bound_moment *e, const double *tau, const double *shift, double factor,
                       double kappa)
{
    double sum = 0.0;
    size_t k;

    for (k = 0; k < e->moments.data->channels; k++) {
        double t = factor != 0.0 ? tau[k] + factor * shift[k] : tau[k];

        sum += brdffit_nnls_gain2(e->moments.omega[k], t, kappa);
    }
    return sum;
}

double brdffit_bound_moment_one(void *self, struct box *box, struct point *met)
{
    struct bound_moment *e = self;
    const struct interval *v = brdffit_bound_moment_side(e, box->interval[0]);
    const struct node *corner[2] = {v->low, v->high};
    double best = INFINITY, vertex = 0.0, monotone;
    int constant = !(fmin(v->low->kappa, v->high->kappa) - fmax(v->kappa_shift, 0.0) >= 0.0);
    int i;

    box->split = 0;
    monotone = gain_one(e, v->tau_sup, v->tau_shift, 0.0, v->kappa_inf);
    for (i = 0; i < 2; i++) {
        const struct node *n = corner[i];
        uint32_t index = i ? v->high_index : v->low_index;
        double theta[2] = {e->axis->coordinate[index], e->axis->coordinate[index]};
        double plain = gain_one(e, n->tau, v->tau_shift, 0.0, fmax(n->kappa, 0.0));
        double shifted = gain_one(e, n->tau, v->tau_shift, 1.0,
                                  constant ? v->kappa_inf : n->kappa - v->kappa_shift);

        brdffit_bound_moment_meet(e, plain, theta, &best, met);
        if (constant) {
            plain = gain_one(e, n->tau, v->tau_shift, 0.0, v->kappa_inf);
        }
        vertex = fmax(vertex, fmax(plain, shifted));
        if (!isfinite(shifted) || !isfinite(v->kappa_shift)) {
            vertex = INFINITY;
        }
    }
    box->bound = brdffit_bound_moment_objective(e, fmin(vertex, monotone));
    return best;
}
