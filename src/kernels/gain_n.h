/*
 * The gain R(t, M) of any number of columns in lanes (theory 2, 7.5); gain.h has the closed forms for two and three.
 * SPDX-License-Identifier: MIT
 *
 * Every support is looked at, all lanes at a time, which is exact for any M with a unit diagonal and off-diagonals in
 * [0, 1) (gain.h): the maximum is the best of the stationary points with z > 0 on supports whose M_S is definite.
 *
 * A support s is a set of columns, as bits; its last column is j = the highest bit, and what is left without it is a support
 * that came before. So L D L' of M_s is that of the rest and one more row,
 *
 *     w_i = M_ij - sum_{k < i} L_ik w_k,    L_ji = w_i / d_i,    d_j = 1 - sum w_i L_ji,        i, k in s before j
 *
 * where row i of L is that of the support of the members up to i. Rows are made once for M, and for each t the forward
 * substitution y_j = t_j - sum L_ji y_i, and the stationary value
 *
 *     2 t.z - z'M z at z = M_s^-1 t  =  sum over the members of y_i^2 / d_i  =  that of the rest + y_j^2 / d_j.
 *
 * Only where that is above the best so far in some lane is z itself needed, for its signs; the full support comes first,
 * so that most others never are.
 *
 * Rounding: L D L' is backward stable, with an error of n^2 u in M at most, and z <= |t| where z >= 0.
 */
#ifndef BRDFFIT_GAIN_N_H
#define BRDFFIT_GAIN_N_H

#include "kernels/gain.h"
#include "kernels/kernels.h"

/* Most columns. */
#define GAIN_COLUMNS COLUMNS_MOST
#define GAIN_SUPPORTS (1u << GAIN_COLUMNS)

struct gram_n {
    vec lower[GAIN_SUPPORTS][GAIN_COLUMNS - 1]; /* row of the last column, by column */
    vec inverse[GAIN_SUPPORTS];                 /* 1 / d of it; 0 where M_s is not definite */
};

/* The last column of a support that is not empty, and the support of its members up to column i. */
LANES_INLINE unsigned gain_last(unsigned s)
{
    return 31u - (unsigned)__builtin_clz(s);
}

LANES_INLINE unsigned gain_up_to(unsigned s, unsigned i)
{
    return s & ((2u << i) - 1u);
}

LANES_INLINE int vec_any(vec_mask mask)
{
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX__)
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    int64_t any = 0;
    size_t lane;

    for (lane = 0; lane < VEC; lane++) {
        any |= mask[lane];
    }
    return any != 0;
#endif
}

#define GAIN_NAME(part) gain_##part##_unrolled
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
#define GAIN_UNROLL /* compiled for other things than speed, loops may be gone before they are unrolled */
#else
#define GAIN_UNROLL _Pragma("GCC unroll 32")
#endif
#include "kernels/gain_n_loops.h"
#define GAIN_NAME(part) gain_##part##_rolled
#define GAIN_UNROLL
#include "kernels/gain_n_loops.h"

/* One function for each number of columns that is worth unrolling, and one for the others; vectors cross in memory. */
#define GAIN_N(name, columns, how)                                                                                     \
    static __attribute__((noinline, unused)) void gain_rows_##name(struct gram_n *g, const vec *cosine, unsigned n)    \
    {                                                                                                                  \
        (void)n;                                                                                                       \
        gain_rows_##how(g, cosine, columns);                                                                           \
    }                                                                                                                  \
    static __attribute__((noinline, unused)) void gain_best_##name(const struct gram_n *g, const vec *t, unsigned n,   \
                                                                   double *out)                                        \
    {                                                                                                                  \
        (void)n;                                                                                                       \
        vec_store(out, gain_best_##how(g, t, columns));                                                                \
    }
GAIN_N(four, 4, unrolled)
GAIN_N(five, 5, unrolled)
GAIN_N(more, n, rolled)

LANES_INLINE void gram_n_make(struct gram_n *g, const vec *cosine, const unsigned n)
{
    if (n == 4) {
        gain_rows_four(g, cosine, n);
    } else if (n == 5) {
        gain_rows_five(g, cosine, n);
    } else {
        gain_rows_more(g, cosine, n);
    }
}

LANES_INLINE vec gain_n_vec(const struct gram_n *g, const vec *t, const unsigned n)
{
    double out[VEC];

    if (n == 4) {
        gain_best_four(g, t, n, out);
    } else if (n == 5) {
        gain_best_five(g, t, n, out);
    } else {
        gain_best_more(g, t, n, out);
    }
    return vec_load(out);
}

#endif
