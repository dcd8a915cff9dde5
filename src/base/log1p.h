/*
 * ln(1 + x) with the same bits on every platform, for -1 < x <= 1e300. SPDX-License-Identifier: MIT
 *
 * u = fl(1 + x) and what that rounding lost, d = (1 + x) - u, exact by Fast2Sum. Then
 *
 *     ln(1 + x) = ln u + ln(1 + d / u) = ln u + d / u - ...,      |d / u| <= 2^-53
 *
 * Where u = 1 the result is x, off by x / 2 < 2^-54 relatively. Elsewhere |ln u| >= 2^-53, so that the term left
 * out, (d / u)^2 / 2 <= 2^-107, is below half an ulp of it; kernel_log is within 2 ulp and the sum rounds once.
 * Error below 3.5 ulp, near 0 as well: that is where -ln cos alpha of half vectors near the mirror comes from.
 */
#ifndef BRDFFIT_KERNEL_LOG1P_H
#define BRDFFIT_KERNEL_LOG1P_H

#include "base/log.h"

static inline double kernel_log1p(double x)
{
    double u = 1.0 + x;
    double lost = x < 1.0 ? x - (u - 1.0) : 1.0 - (u - x);

    return kernel_log(u) + lost / u;
}

#endif
