/*
 * Gains at the corners of a box and what they bound: a part of kernels_body.h. SPDX-License-Identifier: MIT
 *
 * The maximum over a box. Let one side run over fraction x of its interval, with w(x) = 4 x (1 - x), and let J_e(v) be
 * the gain at end e with v times the side's shifts. On the box J(x) is at most the gain of the chord of (t, M) with w(x)
 * times the shifts (bound/moment/bound.c). The gain being convex in (t, M),
 *
 *     J(x) <= (1 - x) [(1 - w) J_0(0) + w J_0(1)] + x [(1 - w) J_1(0) + w J_1(1)],
 *
 * a cubic in x with four known numbers, whose weights are >= 0 and add up to 1; call its maximum over [0, 1]
 * F(J_0(0), J_0(1), J_1(0), J_1(1)). F is convex and rises with each argument, so with a second side, along which each
 * of the four numbers is at most such a mean again, J <= F(F(..), F(..), F(..), F(..)): the maximum along one side
 * inside, along the other outside, in either order; and so on with a third.
 *
 * An interior maximum is a root of the quadratic derivative. Any x in [0, 1] gives a value of the cubic, so a root
 * that is off by d costs the second derivative times d^2 / 2; the values themselves carry a few u of the largest, and
 * the maximum is at least 0.35 of that (each number's weight reaches 16/27 along a side). TOL_GAIN covers both.
 *
 * Range. The sum of squares of the data is about 1 (reduce.h), so that gains at true (t, M) are at most that; shifts
 * beyond LIMIT_SHIFT are not used (bound.c), so that no gain exceeds LIMIT_SHIFT^2 times a small number, and the
 * discriminant is far from overflow. Where it underflows, the four numbers are below 1e-150, and what is lost of a
 * mean of them is less than the slack, a part of the sum of squares, by a hundred orders of magnitude.
 */
#ifndef BRDFFIT_GAINS_H
#define BRDFFIT_GAINS_H

#include "kernels/gain_n.h"
#include "kernels/kernels.h"

/* The cubic at x, clipped to [0, 1]; a NaN counts as 0. */
LANES_INLINE vec cubic_at(vec start, vec slope, vec a, vec e, vec x)
{
    x = vec_min(vec_max(x, vec_set(0.0)), vec_set(1.0));
    return start + x * (slope + 4.0 * (1.0 - x) * (a + e * x));
}

LANES_INLINE vec side_maximum(vec low, vec low_shifted, vec high, vec high_shifted)
{
    vec slope = high - low, a = low_shifted - low, b = high_shifted - high, e = b - a;
    vec c0 = slope + 4.0 * a, c1 = 8.0 * (e - a), c2 = -12.0 * e; /* the derivative c0 + c1 x + c2 x^2 */
    vec root = vec_sqrt(vec_max(c1 * c1 - 4.0 * c2 * c0, vec_set(0.0)));
    vec q = -0.5 * (c1 + vec_select(c1 < vec_set(0.0), -root, root));
    vec best = vec_max(cubic_at(low, slope, a, e, q / c2), cubic_at(low, slope, a, e, c0 / q));

    return vec_max(best, vec_max(low, high));
}

/* Four arguments of side_maximum() in `count` lanes, a multiple of VEC: [low, low shifted, high, high shifted][lane]. */
LANES_INLINE void side_maxima(double (*argument)[LANES], size_t count, double *out)
{
    size_t part;

    for (part = 0; part < count; part += VEC) {
        vec_store(out + part, side_maximum(vec_load(argument[0] + part), vec_load(argument[1] + part),
                                           vec_load(argument[2] + part), vec_load(argument[3] + part)));
    }
}

/*
 * Index i of a gain is corner bits, then shift bits; its low three bits are the lane. A lane's numbers are chosen by masks
 * from registers that hold one number each: an array filled by scalars and read as a vector would wait for memory.
 */
static const int64_t lane_bit[3][LANES] = {
    {0, -1, 0, -1, 0, -1, 0, -1}, {0, 0, -1, -1, 0, 0, -1, -1}, {0, 0, 0, 0, -1, -1, -1, -1}};

/* In lanes from `part` on of that block: `on` where bit `b` of the index is set, else `off`. */
LANES_INLINE vec by_bit(unsigned b, unsigned block, size_t part, double off, double on)
{
    if (b < 3) {
        return vec_select(vec_load_mask(lane_bit[b] + part), vec_set(on), vec_set(off));
    }
    return vec_set(block >> (b - 3) & 1 ? on : off);
}

/* The one of four numbers that bits b0 and b1 of the index name. */
LANES_INLINE vec by_bits(unsigned b0, unsigned b1, unsigned block, size_t part, const double v[4])
{
    if (b1 < 3) {
        return vec_select(vec_load_mask(lane_bit[b1] + part), by_bit(b0, block, part, v[2], v[3]),
                          by_bit(b0, block, part, v[0], v[1]));
    }
    return block >> (b1 - 3) & 1 ? by_bit(b0, block, part, v[2], v[3]) : by_bit(b0, block, part, v[0], v[1]);
}

/* The side of column c. */
#define SIDE_OF(c) (((c) - F) / Q)

/*
 * Off-diagonals 01, 02, .., 12, .. of the Gram matrix of F fixed columns and Q of each of S sides (see struct gains). These
 * three are constants of each instance.
 */
LANES_INLINE void cosines_at(const struct gains *in, const unsigned F, const unsigned Q, const unsigned S,
                             unsigned block, size_t part, vec *cosine)
{
    const unsigned n = F + Q * S;
    unsigned i, j, e = 0;

#pragma GCC unroll 8
    for (i = 0; i < n; i++) {
#pragma GCC unroll 8
        for (j = i + 1; j < n; j++, e++) {
            unsigned q = j < F ? 0 : SIDE_OF(j), p = i < F ? q : SIDE_OF(i);

            if (j < F) {
                cosine[e] = vec_set(in->cosine[e][0]);
            } else if (p == q) {
                cosine[e] = by_bit(q, block, part, in->cosine[e][0], in->cosine[e][1]) -
                            by_bit(S + q, block, part, 0.0, in->fall[e][0]);
            } else {
                cosine[e] = by_bits(p, q, block, part, in->cosine[e]) -
                            by_bit(S + p, block, part, 0.0, in->fall[e][0]) -
                            by_bit(S + q, block, part, 0.0, in->fall[e][1]);
            }
            cosine[e] = vec_max(cosine[e], vec_set(0.0));
        }
    }
}

/* Gram matrix of n columns: closed forms up to three. */
struct gram {
    vec kappa, inverse;
    struct gram3_vec three;
    struct gram_n n;
};

LANES_INLINE void gram_make(struct gram *g, const vec *cosine, const unsigned n)
{
    if (n == 2) {
        g->kappa = gain_clip(cosine[0]);
        g->inverse = gain_inverse(g->kappa);
    } else if (n == 3) {
        g->three = gram3_vec(cosine[0], cosine[1], cosine[2]);
    } else {
        gram_n_make(&g->n, cosine, n);
    }
}

LANES_INLINE vec gram_gain(const struct gram *g, const vec *t, const unsigned n)
{
    return n == 2   ? gain2_vec(t[0], t[1], g->kappa, g->inverse)
           : n == 3 ? gain3_vec(&g->three, t[0], t[1], t[2])
                    : gain_n_vec(&g->n, t, n);
}

/* One body for any number of columns and sides. */
LANES_INLINE void gains_body(const struct gains *in, int shifted, double *gain, const unsigned F, const unsigned Q,
                             const unsigned S)
{
    const unsigned values = GAINS(S), width = values < LANES ? values : LANES, n = F + Q * S;
    const unsigned blocks = shifted ? values / width : ((1u << S) + width - 1) / width;
    unsigned block, c;
    size_t part, k;

    for (block = 0; block < blocks; block++) {
        for (part = 0; part < width; part += VEC) {
            vec cosine[COSINES(COLUMNS_MOST)], sum = vec_set(0.0);
            struct gram gram;

            cosines_at(in, F, Q, S, block, part, cosine);
            gram_make(&gram, cosine, n);
            for (k = 0; k < in->channels; k++) {
                vec t[COLUMNS_MOST];

#pragma GCC unroll 8
                for (c = 0; c < F; c++) {
                    t[c] = vec_set(in->omega[c][k]);
                }
#pragma GCC unroll 8
                for (c = 0; c < n - F; c++) {
                    t[F + c] = by_bit(c / Q, block, part, in->tau[c][0][k], in->tau[c][1][k]) +
                               by_bit(S + c / Q, block, part, 0.0, in->shift[c][k]);
                }
                sum += gram_gain(&gram, t, n);
            }
            vec_store(gain + block * LANES + part, sum);
        }
    }
}

/* One side: all four gains fit one register. */
LANES_INLINE void gains_one(const struct gains *in, double *gain, const unsigned F, const unsigned Q)
{
    double out[LANES];
    size_t i;

    gains_body(in, 1, out, F, Q, 1);
    for (i = 0; i < GAINS(1); i++) {
        gain[i] = out[i];
    }
}

/* An instance for each model of at most COLUMNS_MOST columns. */
#define GAINS_OF(F, Q)                                                                                                 \
    static void gains_##F##_##Q##_1(const struct gains *in, int shifted, double *gain)                                 \
    {                                                                                                                  \
        (void)shifted;                                                                                                 \
        gains_one(in, gain, F, Q);                                                                                     \
    }                                                                                                                  \
    static void gains_##F##_##Q##_2(const struct gains *in, int shifted, double *gain)                                 \
    {                                                                                                                  \
        gains_body(in, shifted, gain, F, Q, 2);                                                                        \
    }
#define GAINS_OF_THREE(F, Q)                                                                                           \
    static void gains_##F##_##Q##_3(const struct gains *in, int shifted, double *gain)                                 \
    {                                                                                                                  \
        gains_body(in, shifted, gain, F, Q, 3);                                                                        \
    }
GAINS_OF(1, 1)
GAINS_OF(2, 1)
GAINS_OF(3, 1)
GAINS_OF(1, 2)
GAINS_OF(3, 2)
GAINS_OF_THREE(1, 1)
GAINS_OF_THREE(2, 1)
GAINS_OF_THREE(3, 1)
GAINS_OF_THREE(1, 2)
GAINS_OF(2, 2)

static void gains_list(const struct gains_list *in, double *gain)
{
    const unsigned n = in->columns;
    size_t i, k;
    unsigned c;

    for (i = 0; i < in->count; i += VEC) {
        vec cosine[COSINES(COLUMNS_MOST)], t[COLUMNS_MOST], sum = vec_set(0.0);
        struct gram gram;

        for (c = 0; c < COSINES(n); c++) {
            cosine[c] = vec_max(vec_load(in->cosine + c * in->count + i), vec_set(0.0));
        }
        gram_make(&gram, cosine, n);
        for (k = 0; k < in->channels; k++) {
            for (c = 0; c < n; c++) {
                t[c] = vec_load(in->t + (k * n + c) * in->count + i);
            }
            sum += gram_gain(&gram, t, n);
        }
        vec_store(gain + i, sum);
    }
}

static double box_maximum_1(const double *gain, double *lift)
{
    vec out = side_maximum(vec_set(gain[0]), vec_set(gain[2]), vec_set(gain[1]), vec_set(gain[3]));

    lift[0] = 0.0;
    return out[0];
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

static double box_maximum_2(const double *gain, double *lift)
{
    /* Places in gain[c0 + 2 c1 + 4 s0 + 8 s1] of low, low shifted, high, high shifted: lanes 0 to 3 go along side 0,
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
    side_maxima(argument, LANES, inner);
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
    side_maxima(argument, VEC, outer);
    return outer[0] < outer[1] ? outer[0] : outer[1];
}

/* Along each side inside, the other two as a box of two sides; the least of the three is as good a bound. */
static double box_maximum_3(const double *gain, double *lift)
{
    /* [side][low, low shifted, high, high shifted]: places in gain[c + 8 s] for number c' + 4 s' of the other two. */
    static const uint8_t place[3][4][16] = {
        {{0, 2, 4, 6, 16, 18, 20, 22, 32, 34, 36, 38, 48, 50, 52, 54},
         {8, 10, 12, 14, 24, 26, 28, 30, 40, 42, 44, 46, 56, 58, 60, 62},
         {1, 3, 5, 7, 17, 19, 21, 23, 33, 35, 37, 39, 49, 51, 53, 55},
         {9, 11, 13, 15, 25, 27, 29, 31, 41, 43, 45, 47, 57, 59, 61, 63}},
        {{0, 1, 4, 5, 8, 9, 12, 13, 32, 33, 36, 37, 40, 41, 44, 45},
         {16, 17, 20, 21, 24, 25, 28, 29, 48, 49, 52, 53, 56, 57, 60, 61},
         {2, 3, 6, 7, 10, 11, 14, 15, 34, 35, 38, 39, 42, 43, 46, 47},
         {18, 19, 22, 23, 26, 27, 30, 31, 50, 51, 54, 55, 58, 59, 62, 63}},
        {{0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27},
         {32, 33, 34, 35, 40, 41, 42, 43, 48, 49, 50, 51, 56, 57, 58, 59},
         {4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31},
         {36, 37, 38, 39, 44, 45, 46, 47, 52, 53, 54, 55, 60, 61, 62, 63}},
    };
    double argument[4][LANES], rest[16], unused[2], least = 0.0;
    size_t side, half, i, l;

    for (side = 0; side < 3; side++) {
        double most = 0.0, value;

        for (half = 0; half < 16; half += LANES) {
            for (i = 0; i < 4; i++) {
                for (l = 0; l < LANES; l++) {
                    argument[i][l] = gain[place[side][i][half + l]];
                }
            }
            side_maxima(argument, LANES, rest + half);
            for (l = 0; l < LANES; l++) { /* whatever else is shifted: two shifts may only together open a face */
                double low = argument[1][l] - argument[0][l], high = argument[3][l] - argument[2][l];

                low = low < 0.0 ? -low : low;
                high = high < 0.0 ? -high : high;
                most = low > most ? low : most;
                most = high > most ? high : most;
            }
        }
        lift[side] = most;
        value = box_maximum_2(rest, unused);
        least = side == 0 || value < least ? value : least;
    }
    return least;
}

#endif
