/*
 * Double-double arithmetic for the few samples whose geometry cancels: x = high + low, |low| <= u |high|.
 *
 * Sums by TwoSum (Knuth), products by Veltkamp's splitting (no FMA: ieee.h forbids contraction, and bits are to be
 * the same everywhere); both are exact as long as nothing overflows (|x| < 2^995) or underflows. Sum, product, quotient
 * and root of two such numbers are within 2^-102 of the exact ones, sums relative to |x| + |y|: each step leaves out
 * products of two low parts, a few u^2, and u^2 = 2^-106. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TWOFOLD_H
#define BRDFFIT_TWOFOLD_H

#include <math.h>

#include "base/ieee.h"

struct twofold {
    double high, low;
};

static inline struct twofold twofold_of_sum(double x, double y)
{
    double sum = x + y, back = sum - x;
    struct twofold z = {sum, (x - (sum - back)) + (y - back)};

    return z;
}

/* x = high + low, each of 26 bits. */
static inline struct twofold twofold_split(double x)
{
    double scaled = 134217729.0 * x; /* 2^27 + 1 */
    struct twofold z;

    z.high = scaled - (scaled - x);
    z.low = x - z.high;
    return z;
}

static inline struct twofold twofold_of_product(double x, double y)
{
    struct twofold a = twofold_split(x), b = twofold_split(y), z;

    z.high = x * y;
    z.low = ((a.high * b.high - z.high) + a.high * b.low + a.low * b.high) + a.low * b.low;
    return z;
}

static inline struct twofold twofold_add(struct twofold x, struct twofold y)
{
    struct twofold high = twofold_of_sum(x.high, y.high), low = twofold_of_sum(x.low, y.low);

    high = twofold_of_sum(high.high, high.low + low.high);
    return twofold_of_sum(high.high, high.low + low.low);
}

static inline struct twofold twofold_negative(struct twofold x)
{
    struct twofold z = {-x.high, -x.low};

    return z;
}

static inline struct twofold twofold_subtract(struct twofold x, struct twofold y)
{
    return twofold_add(x, twofold_negative(y));
}

static inline struct twofold twofold_multiply(struct twofold x, struct twofold y)
{
    struct twofold z = twofold_of_product(x.high, y.high);

    return twofold_of_sum(z.high, z.low + (x.high * y.low + x.low * y.high));
}

/* y > 0: one step of long division, and one for what it leaves. */
static inline struct twofold twofold_divide(struct twofold x, struct twofold y)
{
    double first = x.high / y.high;
    struct twofold one = {first, 0.0}, rest = twofold_subtract(x, twofold_multiply(one, y));
    double second = rest.high / y.high;
    struct twofold two = {second, 0.0};

    rest = twofold_subtract(rest, twofold_multiply(two, y));
    one = twofold_of_sum(first, second);
    return twofold_of_sum(one.high, one.low + rest.high / y.high);
}

/* x >= 0: one of Newton's steps from the root of the high part. */
static inline struct twofold twofold_root(struct twofold x)
{
    double root = sqrt(x.high);
    struct twofold rest;

    if (!(root > 0.0)) {
        rest.high = rest.low = 0.0;
        return rest;
    }
    rest = twofold_subtract(x, twofold_of_product(root, root));
    return twofold_of_sum(root, rest.high / (2.0 * root));
}

/*
 * Sum of n terms (destroyed), `passes` times as precise as a plain one, and then once more: a pass moves each rounding to the
 * next lower term and leaves the sum as it is (VecSum of Ogita, Rump and Oishi), and each makes what is still lost smaller
 * by n u. After four it is below 2^-102 of the sum itself as long as that is above 2^-190 of the largest term.
 */
static inline struct twofold twofold_total(double *term, int n, int passes)
{
    struct twofold sum = {0.0, 0.0};
    int pass, i;

    for (pass = 0; pass < passes; pass++) {
        for (i = 1; i < n; i++) {
            struct twofold pair = twofold_of_sum(term[i], term[i - 1]);

            term[i] = pair.high;
            term[i - 1] = pair.low;
        }
    }
    for (i = 0; i < n; i++) {
        struct twofold next = {term[i], 0.0};

        sum = twofold_add(sum, next);
    }
    return sum;
}

#endif
