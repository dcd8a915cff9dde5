/*
 * Gains at the corners of a box and what they bound: a part of kernels_body.h. Layer 1. SPDX-License-Identifier: MIT
 *
 * The climb. Let one side run over fraction x of its interval, with w(x) = 4 x (1 - x), and let J_e(v) be the gain at
 * end e with v times the side's shifts. On the box J(x) is at most the gain of the chord of (t, M) with w(x) times the
 * shifts (bound_moment.c). The gain being convex in (t, M),
 *
 *     J(x) <= (1 - x) [(1 - w) J_0(0) + w J_0(1)] + x [(1 - w) J_1(0) + w J_1(1)],
 *
 * a cubic in x with four known numbers, whose weights are >= 0 and add up to 1; call its maximum over [0, 1] the
 * climb F(J_0(0), J_0(1), J_1(0), J_1(1)). F is convex and rises with each argument, so with a second side, along
 * which each of the four numbers is at most such a mean again, J <= F(F(..), F(..), F(..), F(..)): climbs along one
 * side inside, along the other outside, in either order.
 *
 * An interior maximum is a root of the quadratic derivative. Any x in [0, 1] gives a value of the cubic, so a root
 * that is off by d costs the second derivative times d^2 / 2; the values themselves carry a few u of the largest, and
 * the maximum is at least 0.35 of that (each number's weight reaches 16/27 along a side). TOL_GAIN covers both.
 */
#ifndef BRDFFIT_KERNELS_GAINS_H
#define BRDFFIT_KERNELS_GAINS_H

#include "gain.h"
#include "kernels.h"

/* The cubic at x, clipped to [0, 1]; a NaN counts as 0. */
LANES_INLINE lanes cubic_at(lanes start, lanes slope, lanes a, lanes e, lanes x)
{
    x = lanes_min(lanes_max(x, lanes_set(0.0)), lanes_set(1.0));
    return start + x * (slope + 4.0 * (1.0 - x) * (a + e * x));
}

LANES_INLINE lanes climb(lanes low, lanes low_shifted, lanes high, lanes high_shifted)
{
    lanes slope = high - low, a = low_shifted - low, b = high_shifted - high, e = b - a;
    lanes c0 = slope + 4.0 * a, c1 = 8.0 * (e - a), c2 = -12.0 * e; /* the derivative c0 + c1 x + c2 x^2 */
    lanes root = lanes_sqrt(lanes_max(c1 * c1 - 4.0 * c2 * c0, lanes_set(0.0)));
    lanes q = -0.5 * (c1 + lanes_select(c1 < lanes_set(0.0), -root, root));
    lanes best = lanes_max(cubic_at(low, slope, a, e, q / c2), cubic_at(low, slope, a, e, c0 / q));

    return lanes_max(best, lanes_max(low, high));
}

static double largest(const double *v, size_t n)
{
    double best = v[0];
    size_t i;

    for (i = 1; i < n; i++) {
        best = v[i] > best ? v[i] : best;
    }
    return best;
}

static void gains_one(const struct gains_one *in, double gain[4])
{
    double low = in->cosine[0], high = in->cosine[1], fall = in->fall;
    lanes on = {0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0}, sum = lanes_set(0.0), kappa, inverse;
    double out[LANES];
    size_t k;

    kappa = (lanes){low, high, low, high, low, low, low, low} - on * fall;
    kappa = gain_clip(lanes_max(kappa, lanes_set(0.0)));
    inverse = gain_inverse(kappa);
    for (k = 0; k < in->channels; k++) {
        double l = in->tau[0][k], h = in->tau[1][k];
        lanes tau = (lanes){l, h, l, h, l, l, l, l} + on * in->shift[k];

        sum += gain2_lanes(lanes_set(in->omega[k]), tau, kappa, inverse);
    }
    lanes_store(out, sum);
    for (k = 0; k < 4; k++) {
        gain[k] = out[k];
    }
}

static double climb_one(const double gain[4])
{
    return climb(lanes_set(gain[0]), lanes_set(gain[2]), lanes_set(gain[1]), lanes_set(gain[3]))[0];
}

/* Corners in lanes 0 to 3 and again, with side 0 shifted, in 4 to 7; `second`: with side 1 shifted. */
LANES_INLINE lanes gains_half(const struct gains_two *in, double second)
{
    const lanes first = {0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0};
    struct gram3_lanes gram;
    lanes cosine[3], sum = lanes_set(0.0);
    size_t k;
    int i;

    for (i = 0; i < 3; i++) {
        const double *v = in->cosine[i];

        cosine[i] = (lanes){v[0], v[1], v[2], v[3], v[0], v[1], v[2], v[3]} - first * in->fall[i][0];
        cosine[i] = lanes_max(cosine[i] - second * in->fall[i][1], lanes_set(0.0));
    }
    gram = gram3_lanes(cosine[0], cosine[1], cosine[2]);
    for (k = 0; k < in->channels; k++) {
        double l0 = in->tau[0][0][k], h0 = in->tau[0][1][k], l1 = in->tau[1][0][k], h1 = in->tau[1][1][k];
        lanes t1 = (lanes){l0, h0, l0, h0, l0, h0, l0, h0} + first * in->shift[0][k];
        lanes t2 = (lanes){l1, l1, h1, h1, l1, l1, h1, h1} + second * in->shift[1][k];

        sum += gain3_lanes(&gram, lanes_set(in->omega[k]), t1, t2);
    }
    return sum;
}

static void gains_two(const struct gains_two *in, int only_first, double gain[16])
{
    lanes_store(gain, gains_half(in, 0.0));
    if (!only_first) {
        lanes_store(gain + 8, gains_half(in, 1.0));
    }
}

/*
 * Where the four arguments of a climb stand in gain[c0 + 2 c1 + 4 s0 + 8 s1]: lanes 0 to 3 climb along side 0 for each
 * (c1, s1), lanes 4 to 7 along side 1 for each (c0, s0).
 */
LANES_INLINE lanes gather(const double *g, int end, int shifted)
{
    int i = end + 4 * shifted, j = 2 * end + 8 * shifted;

    return (lanes){g[i], g[i + 2], g[i + 8], g[i + 10], g[j], g[j + 1], g[j + 4], g[j + 5]};
}

static double climb_two(const double gain[16], double lift[2])
{
    lanes low = gather(gain, 0, 0), low_shifted = gather(gain, 0, 1);
    lanes high = gather(gain, 1, 0), high_shifted = gather(gain, 1, 1);
    lanes along = climb(low, low_shifted, high, high_shifted);
    lanes lifted = lanes_max(lanes_abs(low_shifted - low), lanes_abs(high_shifted - high));
    double v[LANES], up[LANES], outer[LANES];

    lanes_store(v, along);
    lanes_store(up, lifted);
    lift[0] = largest(up, 2);     /* the other side not shifted: lanes (c1, s1 = 0) */
    lift[1] = largest(up + 4, 2); /* lanes (c0, s0 = 0) */
    lanes_store(outer, climb((lanes){v[0], v[4]}, (lanes){v[2], v[6]}, (lanes){v[1], v[5]}, (lanes){v[3], v[7]}));
    return outer[0] < outer[1] ? outer[0] : outer[1];
}

#endif
