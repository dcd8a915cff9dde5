/*
 * Gains at the corners of a box and what they bound: a part of kernels_body.h. SPDX-License-Identifier: MIT
 *
 * The climb. Let one side run over fraction x of its interval, with w(x) = 4 x (1 - x), and let J_e(v) be the gain at
 * end e with v times the side's shifts. On the box J(x) is at most the gain of the chord of (t, M) with w(x) times the
 * shifts (bound.c). The gain being convex in (t, M),
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

#include "kernels/gain.h"
#include "kernels/kernels.h"

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

/*
 * Lane l = c0 + 2 c1 + 4 s0 of two lobes; with one, lane c0 + 2 s0. A lane's numbers are chosen by masks from registers
 * that hold one number each: an array filled by scalars and read as a vector would wait for memory.
 */
static const int64_t lane_bit[3][LANES] = {
    {0, -1, 0, -1, 0, -1, 0, -1}, {0, 0, -1, -1, 0, 0, -1, -1}, {0, 0, 0, 0, -1, -1, -1, -1}};

/* In lanes from `part` on: `on` where bit `b` of the lane is set, else `off`. */
LANES_INLINE vec by_bit(int b, size_t part, double off, double on)
{
    return vec_select(vec_load_mask(lane_bit[b] + part), vec_set(on), vec_set(off));
}

static void gains_one(const struct gains_one *in, double gain[4])
{
    double out[LANES];
    size_t part, k;

    for (part = 0; part < 4; part += VEC) {
        vec kappa = by_bit(0, part, in->cosine[0], in->cosine[1]) - by_bit(1, part, 0.0, in->fall), inverse, sum;

        kappa = gain_clip(vec_max(kappa, vec_set(0.0)));
        inverse = gain_inverse(kappa);
        sum = vec_set(0.0);
        for (k = 0; k < in->channels; k++) {
            vec tau = by_bit(0, part, in->tau[0][k], in->tau[1][k]) + by_bit(1, part, 0.0, in->shift[k]);

            sum += gain2_vec(vec_set(in->omega[k]), tau, kappa, inverse);
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

/* With `second`, side 1 is shifted too. */
LANES_INLINE void gains_half(const struct gains_two *in, int second, double *gain)
{
    size_t part, k;

    for (part = 0; part < LANES; part += VEC) {
        const vec zero = vec_set(0.0);
        struct gram3_vec gram;
        vec cosine[3], sum = zero;
        int i;

        cosine[0] = by_bit(0, part, in->cosine[0][0], in->cosine[0][1]);
        cosine[1] = by_bit(1, part, in->cosine[1][0], in->cosine[1][2]);
        cosine[2] = vec_select(vec_load_mask(lane_bit[1] + part), by_bit(0, part, in->cosine[2][2], in->cosine[2][3]),
                               by_bit(0, part, in->cosine[2][0], in->cosine[2][1]));
        for (i = 0; i < 3; i++) {
            cosine[i] = cosine[i] - by_bit(2, part, 0.0, in->fall[i][0]) - (second ? in->fall[i][1] : 0.0);
            cosine[i] = vec_max(cosine[i], zero);
        }
        gram = gram3_vec(cosine[0], cosine[1], cosine[2]);
        for (k = 0; k < in->channels; k++) {
            vec t1 = by_bit(0, part, in->tau[0][0][k], in->tau[0][1][k]) + by_bit(2, part, 0.0, in->shift[0][k]);
            vec t2 = by_bit(1, part, in->tau[1][0][k], in->tau[1][1][k]) + (second ? in->shift[1][k] : 0.0);

            sum += gain3_vec(&gram, vec_set(in->omega[k]), t1, t2);
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

/* The numbers of `from` (16, or 8 of them) at the given places, below 16. */
LANES_INLINE void pick(const double *from, size_t count, const int64_t place[LANES], double *to)
{
#if VEC == 8 && !defined(__clang__)
    vec low = vec_load(from), high = count > VEC ? vec_load(from + VEC) : low;

    vec_store(to, __builtin_shuffle(low, high, vec_load_mask(place)));
#else
    size_t l;

    (void)count;
    for (l = 0; l < LANES; l++) {
        to[l] = from[place[l]];
    }
#endif
}

static double climb_two(const double gain[16], double lift[2])
{
    /* Places in gain[c0 + 2 c1 + 4 s0 + 8 s1] of low, low shifted, high, high shifted: lanes 0 to 3 climb along side 0,
     * for each (c1, s1); lanes 4 to 7 along side 1, for each (c0, s0). */
    static const int64_t place[4][LANES] = {{0, 2, 8, 10, 0, 1, 4, 5},
                                            {4, 6, 12, 14, 8, 9, 12, 13},
                                            {1, 3, 9, 11, 2, 3, 6, 7},
                                            {5, 7, 13, 15, 10, 11, 14, 15}};
    /* Lane 0: along side 1 outside; lane 1: along side 0. */
    static const int64_t outside[4][LANES] = {{0, 4}, {2, 6}, {1, 5}, {3, 7}};
    double argument[4][LANES], inner[LANES], outer[LANES];
    size_t i, l;

    for (i = 0; i < 4; i++) {
        pick(gain, 16, place[i], argument[i]);
    }
    climbs(argument, LANES, inner);
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
    for (i = 0; i < 4; i++) {
        pick(inner, LANES, outside[i], argument[i]);
    }
    climbs(argument, VEC, outer);
    return outer[0] < outer[1] ? outer[0] : outer[1];
}

#endif
