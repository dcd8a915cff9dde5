/*
 * Natural logarithm with the same bits on every platform, for positive normal x: x = m 2^e with m in
 * [sqrt(1/2), sqrt(2)), ln m = 2 atanh((m - 1) / (m + 1)) by its series (argument below 0.172, 14 terms:
 * remainder 1e-23). Error below 2 ulp. Used a few times a fit, so speed does not matter.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNEL_LOG_H
#define BRDFFIT_KERNEL_LOG_H

#include <math.h>

#include "base/ieee.h"

static inline double kernel_log(double x)
{
    const double ln2_hi = 6.93147180369123816490e-01;
    const double ln2_lo = 1.90821492927058770002e-10;
    double sum = 0.0, f, f2, m;
    int e = 0, i;

    m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2.0;
        e--;
    }
    f = (m - 1.0) / (m + 1.0);
    f2 = f * f;
    for (i = 27; i >= 3; i -= 2) {
        sum = (sum + 1.0 / (double)i) * f2;
    }
    return (double)e * ln2_hi + (2.0 * f + (2.0 * f * sum + (double)e * ln2_lo));
}

#endif
