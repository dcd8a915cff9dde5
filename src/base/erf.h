/*
 * The error function with the same bits on every platform, for x >= 0, in one double and in lanes.
 * SPDX-License-Identifier: MIT
 *
 * With z = x^2 and fitted polynomials (weighted least squares at Chebyshev points in 50 digits, then rounded):
 *
 *     x < 1:  erf x = x + x NEAR(z)                    2^-53 times 0.15 beside 1
 *     x >= 1: erf x = 1 - exp(-z) FAR(t)               t = (x - 3) / (x + 3); 0.11 times 2^-53 of 1 in all, as FAR itself
 *                                                      need not be better than 2^-53 exp(z); from x = 6 on it is 1
 *     erf x - 2 x exp(-z) / sqrt(pi) = x z REST(z)     x < 1, where the two cancel; 0.33 times 2^-53 relatively
 *
 * Near: z is off by u, NEAR <= 0.16 ends on a difference of numbers below 0.4; together some 0.9 u beside erf in [1/2, 0.85),
 * and the sum rounds once: below 1.5 ulp, subnormal numbers included (there by half the least of them). Far: at 1 erfc is
 * 0.19 of erf, so that 2 u of exp, x^2 u of its argument and 1.5 u of FAR come to 0.8 u, and the subtraction rounds once:
 * below 1.5 ulp. Computed values of neighbouring x may fall by as much; nothing here relies on their order.
 */
#ifndef BRDFFIT_KERNEL_ERF_H
#define BRDFFIT_KERNEL_ERF_H

#include "base/exp.h"
#include "base/lanes.h"

/* Of a double or of lanes; the argument is a name. */
/* clang-format off */
#define ERF_NEAR(z)                                                                                                    \
    ((((((((((((5.958930743134941e-11 * (z) - 1.1373902296430911e-09) * (z) + 1.4660051998394848e-08)                  \
      * (z) - 1.6350354461959655e-07) * (z) + 1.6461004480962034e-06) * (z) - 1.4925595519506043e-05)                  \
      * (z) + 0.00012055331122299266) * (z) - 0.0008548326981129666) * (z) + 0.005223977624823223)                     \
      * (z) - 0.026866170645077334) * (z) + 0.11283791670954882) * (z) - 0.3761263890318375)                           \
      * (z) + 0.1283791670955126)
#define ERF_REST(z)                                                                                                    \
    (((((((((((((-7.825689446194304e-12 * (z) + 1.6093127567167805e-10) * (z) - 2.2372630894570102e-09)                \
      * (z) + 2.7010476699648375e-08) * (z) - 2.961201816468261e-07) * (z) + 2.9458382790102684e-06)                   \
      * (z) - 2.6339377322354063e-05) * (z) + 0.0002089591033882066) * (z) - 0.001446639957495443)                     \
      * (z) + 0.008548327023410176) * (z) - 0.04179182100353439) * (z) + 0.16119702387078738)                          \
      * (z) - 0.45135166683820505) * (z) + 0.7522527780636751)
#define ERF_FAR(t)                                                                                                     \
    (((((((((((1.5220228832789172e-05 * (t) + 0.00010300191252225647) * (t) + 7.645798301271161e-05)                   \
      * (t) - 0.000581046224666129) * (t) + 0.0007131955271893495) * (t) + 0.004270359321699167)                       \
      * (t) - 0.024392327001799437) * (t) + 0.07166585018950543) * (t) - 0.15011593634702985)                          \
      * (t) + 0.24560380166346335) * (t) - 0.32623356004594783) * (t) + 0.17900115118135318)
/* clang-format on */

/* From here on erf is 1 to rounding. */
#define ERF_LEVEL 6.0

static inline double kernel_erf(double x)
{
    double y = x < ERF_LEVEL ? x : ERF_LEVEL, z = y * y, t;

    if (y < 1.0) {
        return y + y * ERF_NEAR(z);
    }
    t = (y - 3.0) / (y + 3.0);
    return 1.0 - kernel_exp(-z) * ERF_FAR(t);
}

/* kernel_erf() in each lane, bit for bit, given x < ERF_LEVEL, z = x^2 and gauss = exp(-z). */
LANES_INLINE vec vec_erf_with(vec x, vec z, vec gauss)
{
    vec t = (x - 3.0) / (x + 3.0), near = x + x * ERF_NEAR(z);

    return vec_select(x < vec_set(1.0), near, 1.0 - gauss * ERF_FAR(t));
}

LANES_INLINE vec vec_erf(vec x)
{
    vec y = vec_min(x, vec_set(ERF_LEVEL)), z = y * y;

    return vec_erf_with(y, z, vec_exp(-z));
}

/* erf x - 2 x exp(-z) / sqrt(pi) in each lane, given these: within 8 u of it. */
LANES_INLINE vec vec_erf_rest(vec x, vec z, vec gauss, vec erf)
{
    vec far = erf - 1.1283791670955126 * (x * gauss);

    return vec_select(x < vec_set(1.0), x * z * ERF_REST(z), far);
}

#endif
