/*
 * exp() with the same bits on every platform: no libm, no contraction (ieee.h), no branches, so that a
 * compiler may run it in lanes without changing a bit.
 *
 * x = k ln 2 + r with |r| <= ln(2)/2: k by adding 1.5 * 2^52 (round to nearest), k ln 2 in two parts so
 * that r is exact to about 1 ulp, exp(r) by its Taylor polynomial of degree 13 (remainder 4e-18), 2^k by
 * its bits. Error below 2 u for -708 < x < 709. Below -708 the result is 0 (flushed: exp(-708) = 3e-308
 * is nothing beside the terms that it is added to); above 709 the result is meaningless.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNEL_EXP_H
#define BRDFFIT_KERNEL_EXP_H

#include <stdint.h>
#include <string.h>

#include "base/ieee.h"

static inline double kernel_exp(double x)
{
    const double log2e = 1.4426950408889634;
    const double ln2_hi = 6.93147180369123816490e-01; /* 33 bits: k ln2_hi is exact */
    const double ln2_lo = 1.90821492927058770002e-10;
    const double shift = 6755399441055744.0; /* 1.5 * 2^52 */
    double clipped = x < -708.0 ? 0.0 : x; /* any number: -708 itself would underflow on its way */
    double t = clipped * log2e + shift;
    double k = t - shift;
    double r = (clipped - k * ln2_hi) - k * ln2_lo;
    double p = 1.0 / 6227020800.0;
    uint64_t bits;
    double two_k;

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
    memcpy(&bits, &t, sizeof bits);
    bits = (bits + 1023u) << 52; /* the low bits of t hold k */
    memcpy(&two_k, &bits, sizeof two_k);
    return x < -708.0 ? 0.0 : two_k + two_k * p;
}

#endif
