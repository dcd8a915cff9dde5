/*
 * LANES doubles as one value, by the compiler's vector extension: the same operation in every lane, split into as
 * many registers as the instruction set needs. No operation crosses lanes but lanes_total(), which adds in one fixed
 * order, and -ffp-contract=off keeps multiplications and additions apart: so every instruction set gives the same
 * bits. Files that are compiled once per instruction set (kernels_*.c) are made of these. Layer 0.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_LANES_H
#define BRDFFIT_LANES_H

#include <stddef.h>
#include <stdint.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "kernel_exp.h"

#ifndef __GNUC__
#error "brdffit needs the vector extension of GCC or Clang"
#endif

/* Lanes of every sum over distinct c; arrays of that length are padded with zeros to a multiple. */
#define LANES 8u
#define PADDED(n) (((size_t)(n) + LANES - 1) / LANES * LANES)

typedef double lanes __attribute__((vector_size(64)));
typedef int64_t lanes_mask __attribute__((vector_size(64)));
typedef double lanes_memory __attribute__((vector_size(64), aligned(8), may_alias));

/* Inlined whatever the optimisation level: a vector that crosses a call would change the ABI between files. */
#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE lanes lanes_load(const double *p)
{
    return *(const lanes_memory *)p;
}

LANES_INLINE void lanes_store(double *p, lanes v)
{
    *(lanes_memory *)p = v;
}

LANES_INLINE lanes lanes_set(double x)
{
    return (lanes){x, x, x, x, x, x, x, x};
}

/* mask ? yes : no; a mask comes from a comparison of lanes. */
LANES_INLINE lanes lanes_select(lanes_mask mask, lanes yes, lanes no)
{
    return (lanes)((mask & (lanes_mask)yes) | (~mask & (lanes_mask)no));
}

/* x > y ? x : y, so a NaN in x gives y. */
LANES_INLINE lanes lanes_max(lanes x, lanes y)
{
    return lanes_select(x > y, x, y);
}

LANES_INLINE lanes lanes_min(lanes x, lanes y)
{
    return lanes_select(x < y, x, y);
}

LANES_INLINE lanes lanes_abs(lanes x)
{
    return (lanes)((lanes_mask)x & INT64_MAX);
}

/* Correctly rounded, as each instruction set has it. */
LANES_INLINE lanes lanes_sqrt(lanes x)
{
#if defined(__AVX512F__)
    return (lanes)_mm512_sqrt_pd((__m512d)x);
#else
    double v[LANES];
    size_t i = 0;

    lanes_store(v, x);
#if defined(__AVX__)
    for (; i < LANES; i += 4) {
        _mm256_storeu_pd(v + i, _mm256_sqrt_pd(_mm256_loadu_pd(v + i)));
    }
#elif defined(__SSE2__)
    for (; i < LANES; i += 2) {
        _mm_storeu_pd(v + i, _mm_sqrt_pd(_mm_loadu_pd(v + i)));
    }
#endif
    for (; i < LANES; i++) {
        v[i] = __builtin_sqrt(v[i]);
    }
    return lanes_load(v);
#endif
}

/* The sum of the lanes. */
LANES_INLINE double lanes_total(lanes v)
{
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/* kernel_exp() in each lane, bit for bit (kernel_exp.h has the argument). */
LANES_INLINE lanes lanes_exp(lanes x)
{
    const lanes shift = lanes_set(6755399441055744.0);
    lanes_mask low = x < lanes_set(-708.0);
    lanes clipped = lanes_select(low, lanes_set(-708.0), x);
    lanes t = clipped * 1.4426950408889634 + shift;
    lanes k = t - shift;
    lanes r = (clipped - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    lanes p = lanes_set(1.0 / 6227020800.0), two_k;

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
    two_k = (lanes)(((lanes_mask)t + 1023) << 52); /* the low bits of t hold k */
    return (lanes)(~low & (lanes_mask)(two_k + two_k * p));
}

#endif
