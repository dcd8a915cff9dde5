/*
 * Sums over distinct c, the inner loops of the peers that minimise the reduced problem: they vectorise where the compiler
 * is asked to (bench.mk), for several instruction sets. SPDX-License-Identifier: MIT
 */
#ifndef CURVES_SUMS_H
#define CURVES_SUMS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define CLONES __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define CLONES
#endif

/* shape = exp(-c s): to 1 ulp or so for exponents to -700, tiny beyond. Vectorises. */
static inline __attribute__((always_inline)) void shape_of(size_t count, const double *restrict c, double s,
                                                           double *restrict shape)
{
    const double magic = 0x1.8p52;
    size_t i;

    for (i = 0; i < count; i++) {
        double x = -c[i] * s > -700.0 ? -c[i] * s : -700.0, t = x * 0x1.71547652b82fep0 + magic, k = t - magic, r, y;
        uint64_t bits;

        r = x - k * 0x1.62e42fefa0000p-1 - k * 0x1.cf79abc9e3b3ap-40;
        y = 1.0 / 6227020800.0;
        y = y * r + 1.0 / 479001600.0;
        y = y * r + 1.0 / 39916800.0;
        y = y * r + 1.0 / 3628800.0;
        y = y * r + 1.0 / 362880.0;
        y = y * r + 1.0 / 40320.0;
        y = y * r + 1.0 / 5040.0;
        y = y * r + 1.0 / 720.0;
        y = y * r + 1.0 / 120.0;
        y = y * r + 1.0 / 24.0;
        y = y * r + 1.0 / 6.0;
        y = y * r + 0.5;
        y = y * r + 1.0;
        y = y * r + 1.0;
        memcpy(&bits, &t, sizeof bits);
        bits = (bits + 1023) << 52;
        memcpy(&t, &bits, sizeof t);
        shape[i] = y * t;
    }
}

/* sum x y z, in eight partial sums so that it vectorises without -ffast-math. */
static inline __attribute__((always_inline)) double sum3(size_t count, const double *restrict x,
                                                         const double *restrict y, const double *restrict z)
{
    double part[8] = {0.0};
    size_t i, j;

    for (i = 0; i < count; i += 8) {
        for (j = 0; j < 8; j++) {
            part[j] += x[i + j] * y[i + j] * z[i + j];
        }
    }
    return (part[0] + part[4]) + (part[1] + part[5]) + ((part[2] + part[6]) + (part[3] + part[7]));
}

static inline __attribute__((always_inline)) double sum2(size_t count, const double *restrict x,
                                                         const double *restrict y)
{
    double part[8] = {0.0};
    size_t i, j;

    for (i = 0; i < count; i += 8) {
        for (j = 0; j < 8; j++) {
            part[j] += x[i + j] * y[i + j];
        }
    }
    return (part[0] + part[4]) + (part[1] + part[5]) + ((part[2] + part[6]) + (part[3] + part[7]));
}

#endif
