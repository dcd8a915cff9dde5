/*
 * How much a sample can matter beside the sharpest one: for tails. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_WEIGHT_H
#define BRDFFIT_WEIGHT_H

#include <math.h>
#include <stddef.h>

#include "base/log.h"

/* ln of sqrt(m bb_j / bb_0): what a sample weighs against the sharpest one. */
static inline double weight_exponent(double bb_j, double bb_0, size_t m)
{
    return 0.5 * (kernel_log((double)m) + kernel_log(bb_j) - kernel_log(bb_0));
}

/* The least c that counts: 0, but that second columns need not see the sharpest samples. Some bb > 0. */
static inline double weight_least_c(const double *c, const double *bb, size_t m)
{
    double least = INFINITY;
    size_t j;

    for (j = 0; j < m; j++) {
        least = bb[j] > 0.0 && c[j] < least ? c[j] : least;
    }
    return least;
}

/* bb_0: of a group with the least c, the heaviest where another geometry tells several apart. */
static inline double weight_sharpest(const double *c, const double *bb, size_t m, double least)
{
    double sharpest = 0.0;
    size_t j;

    for (j = 0; j < m; j++) {
        sharpest = c[j] == least && bb[j] > sharpest ? bb[j] : sharpest;
    }
    return sharpest;
}

#endif
