/*
 * Arc tangent with the same bits on every platform, for x >= 0. SPDX-License-Identifier: MIT
 *
 * atan x = atan m + atan t with t = (x - m) / (1 + m x) and m the nearest of 0, 1/2, 1, 3/2 and infinity
 * (t = -1 / x), so that |t| <= 7/16. The series t - t^3/3 + t^5/5 - ... to t^45 leaves 7e-19 relative to t. For
 * m = 0 the argument is exact and the result within 1 ulp. Elsewhere x - m (2 x - 1 and so on) is exact where it is
 * small, so t has two roundings of its own size, below 0.44 ulp of atan m together with those of the series; the
 * low part of atan m joins before the last addition. Error below 2 ulp.
 */
#ifndef BRDFFIT_KERNEL_ATAN_H
#define BRDFFIT_KERNEL_ATAN_H

#include "base/ieee.h"

static inline double kernel_atan(double x)
{
    double high = 0.0, low = 0.0, t = x, square, sum = 0.0;
    int i;

    if (x >= 2.4375) {
        high = 1.5707963267948966;
        low = 6.123233995736766e-17;
        t = -1.0 / x;
    } else if (x >= 1.1875) {
        high = 0.982793723247329;
        low = 1.3903311031230998e-17;
        t = (x - 1.5) / (1.0 + 1.5 * x);
    } else if (x >= 0.6875) {
        high = 0.7853981633974483;
        low = 3.061616997868383e-17;
        t = (x - 1.0) / (1.0 + x);
    } else if (x >= 0.4375) {
        high = 0.4636476090008061;
        low = 2.2698777452961687e-17;
        t = (2.0 * x - 1.0) / (2.0 + x);
    }
    square = t * t;
    for (i = 45; i >= 3; i -= 2) {
        sum = (1.0 / (double)i - sum) * square;
    }
    return high + (t - (t * sum - low));
}

#endif
