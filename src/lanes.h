/*
 * Doubles side by side, by the compiler's vector extension: the same operation in every lane. Two types:
 *
 *   lanes  LANES of them, split into as many registers as the instruction set needs (which GCC keeps in memory
 *          where that is more than one);
 *   vec    VEC of them, one register of the instruction set: loops go over the parts 0, VEC, 2 VEC, ... of LANES.
 *
 * No operation crosses lanes but lanes_total(), which adds in one fixed order, and -ffp-contract=off keeps
 * multiplications and additions apart: so every instruction set gives the same bits. Files that are compiled once per
 * instruction set (kernels_*.c) are made of these. Layer 0. SPDX-License-Identifier: MIT
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

#define OPS_TYPE lanes
#define OPS_MASK lanes_mask
#define OPS_MEMORY lanes_memory
#define OPS_COUNT 8
#define OPS(name) lanes_##name
#include "lanes_ops.h"

#define OPS_TYPE vec
#define OPS_MASK vec_mask
#define OPS_MEMORY vec_memory
#define OPS_COUNT VEC
#define OPS(name) vec_##name
#include "lanes_ops.h"

/* The sum of LANES lanes. */
LANES_INLINE double lanes_total_of(const double *v)
{
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

LANES_INLINE double lanes_total(lanes v)
{
    double lane[LANES];

    lanes_store(lane, v);
    return lanes_total_of(lane);
}

#endif
