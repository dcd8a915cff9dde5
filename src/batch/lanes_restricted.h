/*
 * The restricted problem of one or two columns beside a, in lanes. Part of batch_body.h, compiled once per instruction set.
 * Its answers are only good guesses: whatever they are, what is proven about them is checked where it is used.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_LANES_RESTRICTED_H
#define BRDFFIT_BATCH_LANES_RESTRICTED_H

#include "batch/fast.h"

LANES_INLINE int vec_any(vec_mask mask)
{
    int64_t any = 0;
    size_t l;

    for (l = 0; l < VEC; l++) {
        any |= mask[l];
    }
    return any != 0;
}

/* A symmetric matrix by columns: BATCH_PAIR. */
struct quadratic {
    vec d[BATCH_PAIRS];
};

/* D y. */
LANES_INLINE vec times(const struct quadratic *q, const vec *y, int row, int each)
{
    return each == 1 ? q->d[0] * y[0] : q->d[row] * y[0] + q->d[row + 1] * y[1];
}

/* The y >= 0 where 2 v.y - y D y is largest. */
LANES_INLINE void restricted(const vec *v, const struct quadratic *q, int each, vec *y)
{
    vec zero = vec_set(0.0), one, two, inverse, single;
    vec_mask both, first;

    if (each == 1) {
        y[0] = vec_max(v[0] / q->d[0], zero);
        return;
    }
    one = v[0] * q->d[2] - v[1] * q->d[1];
    two = v[1] * q->d[0] - v[0] * q->d[1];
    inverse = 1.0 / (q->d[0] * q->d[2] - q->d[1] * q->d[1]);
    both = (one > zero) & (two > zero) & (inverse > zero);
    single = vec_max(v[0], zero);
    y[0] = single / q->d[0];
    y[1] = vec_max(v[1], zero) / q->d[2];
    first = single * y[0] >= vec_max(v[1], zero) * y[1];
    y[0] = vec_select(both, one * inverse, vec_select(first, y[0], zero));
    y[1] = vec_select(both, two * inverse, vec_select(first, zero, y[1]));
}

/* A channel's best coefficients, and the multiplier of x >= 0. n: data along the columns beside a; u: their part along a. */
struct solved {
    vec y[EACH_MOST], lambda;
    vec_mask free; /* x > 0 */
};

LANES_INLINE struct solved solve_channel(const vec *n, const vec *u, const struct quadratic *d, vec omega, int each)
{
    struct solved s;
    struct quadratic h;
    vec v[EACH_MOST], bound[EACH_MOST], zero = vec_set(0.0), along;
    int j;

    restricted(n, d, each, s.y);
    along = u[0] * s.y[0] + (each > 1 ? u[1] * s.y[1] : zero);
    s.free = ~(omega < along);
    s.lambda = zero;
    if (!vec_any(~s.free)) {
        return s;
    }
    for (j = 0; j < each; j++) {
        v[j] = n[j] + omega * u[j];
    }
    h.d[0] = d->d[0] + u[0] * u[0];
    if (each > 1) {
        h.d[1] = d->d[1] + u[0] * u[1];
        h.d[2] = d->d[2] + u[1] * u[1];
    }
    restricted(v, &h, each, bound);
    along = u[0] * bound[0] + (each > 1 ? u[1] * bound[1] : zero);
    s.lambda = vec_select(s.free, zero, vec_max(along - omega, zero));
    for (j = 0; j < each; j++) {
        s.y[j] = vec_select(s.free, s.y[j], bound[j]);
    }
    return s;
}

#endif
