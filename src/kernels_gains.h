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
LANES_INLINE vec cubic_at(vec start, vec slope, vec a, vec e, vec x)
{
    x = vec_min(vec_max(x, vec_set(0.0)), vec_set(1.0));
    return start + x * (slope + 4.0 * (1.0 - x) * (a + e * x));
}

LANES_INLINE vec climb(vec low, vec low_shifted, vec high, vec high_shifted)
{
    vec slope = high - low, a = low_shifted - low, b = high_shifted - high, e = b - a;
    vec c0 = slope + 4.0 * a, c1 = 8.0 * (e - a), c2 = -12.0 * e; /* the derivative c0 + c1 x + c2 x^2 */
    vec root = vec_sqrt(vec_max(c1 * c1 - 4.0 * c2 * c0, vec_set(0.0)));
    vec q = -0.5 * (c1 + vec_select(c1 < vec_set(0.0), -root, root));
    vec best = vec_max(cubic_at(low, slope, a, e, q / c2), cubic_at(low, slope, a, e, c0 / q));

    return vec_max(best, vec_max(low, high));
}

/* Four arguments of a climb in `count` lanes, a multiple of VEC: [low, low shifted, high, high shifted][lane]. */
LANES_INLINE void climbs(double (*argument)[LANES], size_t count, double *out)
{
    size_t part;

    for (part = 0; part < count; part += VEC) {
        vec_store(out + part, climb(vec_load(argument[0] + part), vec_load(argument[1] + part),
                                    vec_load(argument[2] + part), vec_load(argument[3] + part)));
    }
}

static void gains_one(const struct gains_one *in, double gain[4])
{
    const double fall[LANES] = {0.0, 0.0, in->fall, in->fall};
    const double cosine[LANES] = {in->cosine[0], in->cosine[1], in->cosine[0], in->cosine[1]};
    double out[LANES];
    size_t part, k;

    for (part = 0; part < 4; part += VEC) {
        vec kappa = gain_clip(vec_max(vec_load(cosine + part) - vec_load(fall + part), vec_set(0.0)));
        vec inverse = gain_inverse(kappa), sum = vec_set(0.0);

        for (k = 0; k < in->channels; k++) {
            double low = in->tau[0][k], high = in->tau[1][k];
            double tau[LANES] = {low, high, low + in->shift[k], high + in->shift[k]};

            sum += gain2_vec(vec_set(in->omega[k]), vec_load(tau + part), kappa, inverse);
        }
        vec_store(out + part, sum);
    }
    for (k = 0; k < 4; k++) {
        gain[k] = out[k];
    }
}

static double climb_one(const double gain[4])
{
    vec out = climb(vec_set(gain[0]), vec_set(gain[2]), vec_set(gain[1]), vec_set(gain[3]));

    return out[0];
}

/* Corners in lanes 0 to 3 and again, with side 0 shifted, in 4 to 7; with `second`, side 1 is shifted too. */
LANES_INLINE void gains_half(const struct gains_two *in, int second, double *gain)
{
    double cosine[3][LANES];
    size_t part, k;
    int i, c;

    for (i = 0; i < 3; i++) {
        double fall = second ? in->fall[i][1] : 0.0;

        for (c = 0; c < 4; c++) {
            cosine[i][c] = in->cosine[i][c] - fall;
            cosine[i][4 + c] = in->cosine[i][c] - in->fall[i][0] - fall;
        }
    }
    for (part = 0; part < LANES; part += VEC) {
        const vec zero = vec_set(0.0);
        struct gram3_vec gram = gram3_vec(vec_max(vec_load(cosine[0] + part), zero),
                                          vec_max(vec_load(cosine[1] + part), zero),
                                          vec_max(vec_load(cosine[2] + part), zero));
        vec sum = zero;

        for (k = 0; k < in->channels; k++) {
            double l0 = in->tau[0][0][k], h0 = in->tau[0][1][k], s0 = in->shift[0][k], s1 = second ? in->shift[1][k] : 0.0;
            double l1 = in->tau[1][0][k] + s1, h1 = in->tau[1][1][k] + s1;
            double t1[LANES] = {l0, h0, l0, h0, l0 + s0, h0 + s0, l0 + s0, h0 + s0};
            double t2[LANES] = {l1, l1, h1, h1, l1, l1, h1, h1};

            sum += gain3_vec(&gram, vec_set(in->omega[k]), vec_load(t1 + part), vec_load(t2 + part));
        }
        vec_store(gain + part, sum);
    }
}

static void gains_two(const struct gains_two *in, int only_first, double gain[16])
{
    gains_half(in, 0, gain);
    if (!only_first) {
        gains_half(in, 1, gain + LANES);
    }
}

static double climb_two(const double gain[16], double lift[2])
{
    /* Places in gain[c0 + 2 c1 + 4 s0 + 8 s1]: lanes 0 to 3 climb along side 0, for each (c1, s1); lanes 4 to 7 along
     * side 1, for each (c0, s0). */
    static const unsigned char place[4][LANES] = {
        {0, 2, 8, 10, 0, 1, 4, 5},     /* low */
        {4, 6, 12, 14, 8, 9, 12, 13},  /* low, shifted */
        {1, 3, 9, 11, 2, 3, 6, 7},     /* high */
        {5, 7, 13, 15, 10, 11, 14, 15} /* high, shifted */
    };
    double argument[4][LANES], inner[LANES], outer[LANES];
    size_t i, l;

    for (i = 0; i < 4; i++) {
        for (l = 0; l < LANES; l++) {
            argument[i][l] = gain[place[i][l]];
        }
    }
    for (i = 0; i < 2; i++) { /* the other side not shifted: the first two lanes of each four */
        lift[i] = 0.0;
        for (l = 4 * i; l < 4 * i + 2; l++) {
            double low = argument[1][l] - argument[0][l], high = argument[3][l] - argument[2][l];

            low = low < 0.0 ? -low : low;
            high = high < 0.0 ? -high : high;
            lift[i] = low > lift[i] ? low : lift[i];
            lift[i] = high > lift[i] ? high : lift[i];
        }
    }
    climbs(argument, LANES, inner);
    for (i = 0; i < 4; i++) { /* lane 0: along side 1 outside; lane 1: along side 0 */
        static const unsigned char of[4] = {0, 2, 1, 3};

        for (l = 0; l < LANES; l++) {
            argument[i][l] = inner[of[i] + 4 * (l & 1)];
        }
    }
    climbs(argument, VEC, outer);
    return outer[0] < outer[1] ? outer[0] : outer[1];
}

#endif
