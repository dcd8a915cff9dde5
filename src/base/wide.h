/*
 * Doubles with twice the digits, or with an exponent of their own, for the few places where a product of three factors
 * is an ordinary number and the product of two of them is not: coefficients y = z / (lambda(s) exp(-c_min s)) and what
 * they give when multiplied out again. Same bits on every platform: no FMA, no libm but frexp and ldexp.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_WIDE_H
#define BRDFFIT_WIDE_H

#include <math.h>

#include "base/exp.h"
#include "base/twofold.h"

/* x y, exactly (Dekker, Veltkamp) while nothing underflows; `low` is 0 where splitting would overflow. */
static inline struct twofold twofold_product(double x, double y)
{
    const double split = 134217729.0; /* 2^27 + 1 */
    struct twofold p = {x * y, 0.0};
    double x1, x2, y1, y2;

    if (!(fabs(x) < 1e290 && fabs(y) < 1e290 && fabs(p.high) < 1e300)) {
        return p;
    }
    x1 = split * x - (split * x - x);
    y1 = split * y - (split * y - y);
    x2 = x - x1;
    y2 = y - y1;
    p.low = ((x1 * y1 - p.high) + x1 * y2 + x2 * y1) + x2 * y2;
    return p;
}

/* 1 / sigma^2 within 1e-30 of it, for sigma whose square and its inverse are far from the ends of a double. */
static inline struct twofold twofold_inverse_square(double sigma)
{
    struct twofold square = twofold_product(sigma, sigma), inverse = {1.0 / square.high, 0.0}, back;

    back = twofold_product(inverse.high, square.high);
    inverse.low = inverse.high * (((1.0 - back.high) - back.low) - inverse.high * square.low);
    if (!(fabs(inverse.low) <= 1e-15 * inverse.high)) {
        inverse.low = 0.0; /* something overflowed or vanished on the way */
    }
    return inverse;
}

/* c s for a plain c. */
static inline struct twofold twofold_times(struct twofold s, double c)
{
    struct twofold p = twofold_product(s.high, c);

    p.low += s.low * c;
    return p;
}

/* value 2^exponent; |value| in [1/2, 1), or 0. */
struct wide {
    double value;
    long exponent;
};

static inline struct wide wide_of(double x)
{
    int exponent = 0;
    struct wide w;

    w.value = frexp(x, &exponent);
    w.exponent = exponent;
    return w;
}

static inline struct wide wide_times(struct wide x, struct wide y)
{
    struct wide w = wide_of(x.value * y.value);

    w.exponent += x.exponent + y.exponent;
    return w;
}

/* y must not be 0. */
static inline struct wide wide_over(struct wide x, struct wide y)
{
    struct wide w = wide_of(x.value / y.value);

    w.exponent += x.exponent - y.exponent;
    return w;
}

/* The double next to it, rounded once; infinite beyond the largest. */
static inline double wide_value(struct wide x)
{
    return ldexp(x.value, x.exponent > 4000 ? 4000 : x.exponent < -4000 ? -4000 : (int)x.exponent);
}

/* Largest x of which exp(-x) is told from 0. */
#define WIDE_EXPONENT 1e5

/*
 * exp(-x), x >= 0, within 3 u of it; 0 beyond WIDE_EXPONENT, where no factor that is a double makes an ordinary number
 * of it. k ln 2 in two parts as in exp.h: k < 2^18, so that its product with 33 bits is exact.
 */
static inline struct wide wide_exp_minus(struct twofold x)
{
    const double ln2_hi = 6.93147180369123816490e-01, ln2_lo = 1.90821492927058770002e-10;
    struct wide w = {0.0, 0};
    double k;

    if (!(x.high <= WIDE_EXPONENT)) {
        return w;
    }
    k = floor(x.high * 1.4426950408889634 + 0.5);
    w = wide_of(kernel_exp(((k * ln2_hi - x.high) + k * ln2_lo) - x.low));
    w.exponent -= (long)k;
    return w;
}

#endif
