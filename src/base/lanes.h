/*
 * Doubles side by side, by the compiler's vector extension: the same operation in every lane. A `vec` is one register of
 * the instruction set, VEC doubles; sums have LANES lanes, and loops over them go over the parts 0, VEC, 2 VEC, ...
 * (A vector of all LANES would do in fewer lines, but GCC keeps vectors of more than one register in memory.)
 *
 * No operation crosses lanes but lanes_total_of(), which adds in one fixed order, and contraction is forbidden (ieee.h), which
 * keeps multiplications and additions apart: so every instruction set gives the same bits. Files that are compiled once per
 * instruction set (kernels_*.c) are made of these. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_LANES_H
#define BRDFFIT_LANES_H

#include <stddef.h>
#include <stdint.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "base/exp.h"

#ifndef __GNUC__
#error "brdffit needs the vector extension of GCC or Clang"
#endif

/* Lanes of every sum over distinct c; arrays of that length are padded with zeros to a multiple. */
#define LANES 8u
#define PADDED(n) (((size_t)(n) + LANES - 1) / LANES * LANES)

#if defined(__AVX512F__)
#define VEC 8u
#elif defined(__AVX__)
#define VEC 4u
#else
#define VEC 2u
#endif

/* Inlined whatever the optimisation level: a vector that crosses a call would change the ABI between files. */
#define LANES_INLINE static inline __attribute__((always_inline))

/* Square roots are correctly rounded, as each instruction set has it. */
LANES_INLINE void lanes_sqrt_array(double *v, size_t n)
{
    size_t i = 0;

#if defined(__AVX512F__)
    for (; i + 8 <= n; i += 8) {
        _mm512_storeu_pd(v + i, _mm512_sqrt_pd(_mm512_loadu_pd(v + i)));
    }
#endif
#if defined(__AVX__)
    for (; i + 4 <= n; i += 4) {
        _mm256_storeu_pd(v + i, _mm256_sqrt_pd(_mm256_loadu_pd(v + i)));
    }
#endif
#if defined(__SSE2__)
    for (; i + 2 <= n; i += 2) {
        _mm_storeu_pd(v + i, _mm_sqrt_pd(_mm_loadu_pd(v + i)));
    }
#endif
    for (; i < n; i++) {
        v[i] = __builtin_sqrt(v[i]);
    }
}

typedef double vec __attribute__((vector_size(8 * VEC)));
typedef int64_t vec_mask __attribute__((vector_size(8 * VEC)));
typedef double vec_memory __attribute__((vector_size(8 * VEC), aligned(8), may_alias));
typedef int64_t vec_mask_memory __attribute__((vector_size(8 * VEC), aligned(8), may_alias));

LANES_INLINE vec vec_load(const double *p)
{
    return *(const vec_memory *)p;
}

LANES_INLINE vec_mask vec_load_mask(const int64_t *p)
{
    return *(const vec_mask_memory *)p;
}

LANES_INLINE void vec_store(double *p, vec v)
{
    *(vec_memory *)p = v;
}

LANES_INLINE vec vec_set(double x)
{
    return x - (vec){0.0};
}

/* mask ? yes : no; a mask comes from a comparison. */
LANES_INLINE vec vec_select(vec_mask mask, vec yes, vec no)
{
    return (vec)((mask & (vec_mask)yes) | (~mask & (vec_mask)no));
}

/* x > y ? x : y, so a NaN in x gives y. */
LANES_INLINE vec vec_max(vec x, vec y)
{
    return vec_select(x > y, x, y);
}

LANES_INLINE vec vec_min(vec x, vec y)
{
    return vec_select(x < y, x, y);
}

LANES_INLINE vec vec_abs(vec x)
{
    return (vec)((vec_mask)x & INT64_MAX);
}

/* Correctly rounded, as each instruction set has it. */
LANES_INLINE vec vec_sqrt(vec x)
{
    double v[VEC];

    vec_store(v, x);
    lanes_sqrt_array(v, VEC);
    return vec_load(v);
}

/* kernel_exp() in each lane, bit for bit (exp.h has the argument). */
LANES_INLINE vec vec_exp(vec x)
{
    const vec shift = vec_set(6755399441055744.0);
    vec_mask low = x < vec_set(-708.0);
    vec clipped = vec_select(low, vec_set(0.0), x); /* any number: -708 itself would underflow on its way */
    vec t = clipped * 1.4426950408889634 + shift;
    vec k = t - shift;
    vec r = (clipped - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    vec p = vec_set(1.0 / 6227020800.0), two_k;

    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = (p * r) * r + r;
    two_k = (vec)(((vec_mask)t + 1023) << 52); /* the low bits of t hold k */
    return (vec)(~low & (vec_mask)(two_k + two_k * p));
}

/* The sum of LANES lanes. */
LANES_INLINE double lanes_total_of(const double *v)
{
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

#endif
