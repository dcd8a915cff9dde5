/*
 * What the arithmetic of every file rests on: doubles that are IEEE doubles, each operation rounded once and by itself.
 * SPDX-License-Identifier: MIT
 *
 * A product that is not rounded before it is added to (contraction into a multiply-add: GCC's default wherever the
 * processor has one, Clang's within an expression) gives other bits, and rounding that the bounds do not allow for. The
 * Makefile forbids it; sources that are compiled in another way forbid it here, for everything that follows: each file
 * that computes includes this before its first function. Where neither is obeyed (Clang's -ffp-contract=fast), or where
 * products carry more digits than a double, ieee_contracts() tells, and every fit is refused.
 */
#ifndef BRDFFIT_IEEE_H
#define BRDFFIT_IEEE_H

#include <float.h>

#ifdef __FAST_MATH__
#error "brdffit's proofs need IEEE arithmetic: do not build with -ffast-math"
#endif
#if FLT_RADIX != 2 || DBL_MANT_DIG != 53 || DBL_MAX_EXP != 1024
#error "brdffit's proofs need IEEE doubles: this compiler's double is another type (AVR: -mdouble=64)"
#endif
/* 1 (s390x) and 16 (processors with half precision) concern narrower types only: doubles are doubles. */
#if FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 1 && FLT_EVAL_METHOD != 16
#if defined(__i386__)
#error "brdffit's proofs need doubles that are doubles: on 32-bit x86 build with -msse2 -mfpmath=sse"
#else
#error "brdffit's proofs need doubles that are doubles: this compiler evaluates them with more digits"
#endif
#endif

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

/* Whether products of doubles are added to before they are rounded: (1 + 2^-27)^2 has the digit 2^-54 then. */
static inline int ieee_contracts(void)
{
    volatile double given = 1.0 + 0x1p-27, rounded = 1.0 + 0x1p-26;
    double x = given, y = rounded;

    return x * x - y != 0.0;
}

#endif
