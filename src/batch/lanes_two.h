/*
 * The proof for two lobes: what a box of (t1, t2) gains at most. Part of batch_body.h; the box of a lane is that of a piece of a
 * pair of windows of one texel, or a whole pair of windows of a texel of its own. SPDX-License-Identifier: MIT
 *
 * As in lanes_bound.h, with lobe j a column along its own coordinate: n_j, u_j and D_jj are functions of t_j, D_12 of both.
 * With d = (d1, d2) the step from the middle and rho1 = R d + sigma
 *
 *     lambda (2 omega + lambda) + 2 v.y0 - y0 D y0 + rho D^-1 rho   is at most   A0 + A1.d + d A2 d + A3,
 *
 * whose largest value over |d_j| <= h_j is at its stationary point, or on an edge, where it is one of one variable.
 *
 * Lobes that are nearly the same. y >= 0, so D_12 may be lowered by any epsilon. That costs 2 epsilon y1 y2, and makes of rho
 * along (1, -1), which the box makes as large as p = |residual . g'| h, p^2 / 2 (1 - cosine + epsilon): their sum is least where
 * 1 - cosine + epsilon is about p / Y. So near the diagonal a box is bounded to first order, and away from it to third.
 */
#ifndef BRDFFIT_BATCH_LANES_TWO_H
#define BRDFFIT_BATCH_LANES_TWO_H

#include "batch/lanes_bound.h"

/* Relative change of D in a box beyond which it is to be cut. */
#define CHANGE_MOST 0.75

/* D_12 at the middle: value, derivatives by t1 and t2, and half of the second ones (the mixed one whole). */
struct cross {
    vec at, one, two, one_one, one_two, two_two, error;
};

/* A box, in every lane. */
struct box_of_two {
    vec h[2];
    struct taylor d[2], u[2];
    vec d_error[2], u_error[2];
    struct cross c;
};

/* What it gains at most; at its middle; and there the slope by d1 and d2, and the coefficients of d1^2, d1 d2, d2^2. */
struct bound_of_two {
    vec upper, middle, hill[5];
};

/* Largest 2 x 2 eigenvalue of W m W^T, m = (a, c; c, b), in magnitude at most. */
LANES_INLINE vec whitened(const vec *w, vec a, vec c, vec b)
{
    vec first = a * w[0] * w[0], mixed = w[0] * (w[1] * a + w[2] * c);
    vec second = w[1] * w[1] * a + 2.0 * w[1] * w[2] * c + w[2] * w[2] * b;

    return vec_max(vec_abs(first), vec_abs(second)) + vec_abs(mixed);
}

/* How far D may be from that of the middle, relative to it, d0 its entries (lowered). */
LANES_INLINE vec change_of(const struct box_of_two *b, const struct quadratic *d0)
{
    vec zero = vec_set(0.0), share = d0->d[1] / d0->d[0], root = vec_sqrt(d0->d[2] - share * d0->d[1]), w[3];
    vec off = b->d_error[0] + b->d_error[1] + 2.0 * b->c.error;

    w[0] = 1.0 / vec_sqrt(d0->d[0]);
    w[2] = 1.0 / root;
    w[1] = -share * w[2];
    return b->h[0] * (whitened(w, b->d[0].f1, b->c.one, zero) + b->h[0] * whitened(w, b->d[0].f2, b->c.one_one, zero)) +
           b->h[1] * (whitened(w, zero, b->c.two, b->d[1].f1) + b->h[1] * whitened(w, zero, b->c.two_two, b->d[1].f2)) +
           b->h[0] * b->h[1] * whitened(w, zero, b->c.one_two, zero) +
           1.01 * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) * off;
}

/* D of the middle, lowered; n: two of each channel. */
LANES_INLINE void lower(const struct box_of_two *b, size_t K, const struct taylor *n, struct quadratic *d0)
{
    vec zero = vec_set(0.0), pull = zero, size = zero, scale, wanted;
    size_t k;

    for (k = 0; k < K; k++) {
        vec y = vec_max(vec_max(n[2 * k].f0, n[2 * k + 1].f0), zero);
        vec p = vec_abs(n[2 * k].f1 - b->d[0].f1 * y) * b->h[0] + vec_abs(n[2 * k + 1].f1 - b->d[1].f1 * y) * b->h[1];

        pull += p * p;
        size += y * y;
    }
    scale = vec_sqrt(b->d[0].f0 * b->d[1].f0);
    wanted = vec_sqrt(pull / vec_max(size, vec_set(1e-300)));
    wanted = vec_max(wanted, 16.0 * (b->d_error[0] + b->d_error[1] + 2.0 * b->c.error) / scale);
    wanted = vec_min(wanted - (1.0 - b->c.at / scale), b->c.at / scale + 0.5);
    d0->d[0] = b->d[0].f0;
    d0->d[1] = b->c.at - scale * vec_max(wanted, vec_set(BATCH_APART));
    d0->d[2] = b->d[1].f0;
}

/* Largest b d + a d^2 over |d| <= h. */
LANES_INLINE vec top_of_one(vec b, vec a, vec h)
{
    vec_mask inside = (a < vec_set(0.0)) & (vec_abs(b) < -2.0 * a * h);

    return vec_select(inside, -b * b / (4.0 * vec_min(a, vec_set(-1e-300))), vec_abs(b) * h + a * (h * h));
}

/* Largest A1.d + d A2 d over the box. */
LANES_INLINE vec top_of_two(const vec *slope, const vec *bend, const vec *h)
{
    vec det = 4.0 * bend[0] * bend[2] - bend[1] * bend[1], zero = vec_set(0.0), top, d1, d2, inverse;
    vec low = bend[0] * (h[0] * h[0]) - slope[0] * h[0], high = bend[0] * (h[0] * h[0]) + slope[0] * h[0];
    vec left = bend[2] * (h[1] * h[1]) - slope[1] * h[1], right = bend[2] * (h[1] * h[1]) + slope[1] * h[1];
    vec_mask inside;

    top = vec_max(low + top_of_one(slope[1] - bend[1] * h[0], bend[2], h[1]),
                  high + top_of_one(slope[1] + bend[1] * h[0], bend[2], h[1]));
    top = vec_max(top, left + top_of_one(slope[0] - bend[1] * h[1], bend[0], h[0]));
    top = vec_max(top, right + top_of_one(slope[0] + bend[1] * h[1], bend[0], h[0]));
    inside = (bend[0] < zero) & (det > zero);
    inverse = 1.0 / vec_select(inside, det, vec_set(1.0));
    d1 = (bend[1] * slope[1] - 2.0 * bend[2] * slope[0]) * inverse;
    d2 = (bend[1] * slope[0] - 2.0 * bend[0] * slope[1]) * inverse;
    inside = inside & (vec_abs(d1) <= h[0]) & (vec_abs(d2) <= h[1]);
    d1 = slope[0] * d1 + slope[1] * d2 + bend[0] * (d1 * d1) + bend[1] * (d1 * d2) + bend[2] * (d2 * d2);
    return vec_select(inside, vec_max(top, d1), top);
}

/* Sums over channels. */
struct summed_two {
    vec a0, a3, size, slope[2], bend[3], yy[3];
};

/* rho D^-1 rho: R in `rise` [row][step], sigma in `rest`. */
LANES_INLINE void add_rest_of_two(const struct box_of_two *b, const struct quadratic *inverse, vec rise[2][2],
                                  const vec *rest, struct summed_two *s)
{
    vec pull[2][2], size;
    int i;

    for (i = 0; i < 2; i++) { /* columns of B R */
        pull[0][i] = inverse->d[0] * rise[0][i] + inverse->d[1] * rise[1][i];
        pull[1][i] = inverse->d[1] * rise[0][i] + inverse->d[2] * rise[1][i];
    }
    s->bend[0] += rise[0][0] * pull[0][0] + rise[1][0] * pull[1][0];
    s->bend[1] += 2.0 * (rise[0][0] * pull[0][1] + rise[1][0] * pull[1][1]);
    s->bend[2] += rise[0][1] * pull[0][1] + rise[1][1] * pull[1][1];
    size = 2.0 * (vec_abs(pull[0][0]) * b->h[0] + vec_abs(pull[0][1]) * b->h[1]) * rest[0];
    size += 2.0 * (vec_abs(pull[1][0]) * b->h[0] + vec_abs(pull[1][1]) * b->h[1]) * rest[1];
    size += inverse->d[0] * (rest[0] * rest[0]) + inverse->d[2] * (rest[1] * rest[1]);
    s->a3 += size + 2.0 * vec_abs(inverse->d[1]) * (rest[0] * rest[1]);
}

/* The inverse over columns with y > 0 only: what a climb sees. */
LANES_INLINE struct quadratic supported(const struct quadratic *d0, const struct quadratic *inverse, const vec *y)
{
    vec zero = vec_set(0.0);
    vec_mask one = y[0] > zero, two = y[1] > zero, both = one & two;
    struct quadratic out;

    out.d[0] = vec_select(both, inverse->d[0], vec_select(one, 1.0 / d0->d[0], zero));
    out.d[1] = vec_select(both, inverse->d[1], zero);
    out.d[2] = vec_select(both, inverse->d[2], vec_select(two, 1.0 / d0->d[2], zero));
    return out;
}

/* One channel: n of both lobes, e their errors. */
LANES_INLINE void add_channel_of_two(const struct box_of_two *b, const struct quadratic *d0,
                                     const struct quadratic *inverse, const struct taylor *n, const vec *e, vec omega,
                                     int climb, struct summed_two *s)
{
    vec zero = vec_set(0.0), n0[2] = {n[0].f0, n[1].f0}, u0[2] = {b->u[0].f0, b->u[1].f0}, v0[2], v1[2], v2[2];
    vec rest[2], rise[2][2], left[2], off[2];
    struct solved z = solve_channel(n0, u0, d0, omega, 2);
    int j;

    s->a0 += z.lambda * (2.0 * omega + z.lambda);
    s->size += omega * omega + z.lambda * z.lambda;
    for (j = 0; j < 2; j++) {
        vec other = z.y[1 - j];

        v0[j] = n0[j] - z.lambda * u0[j];
        v1[j] = n[j].f1 - z.lambda * b->u[j].f1;
        v2[j] = n[j].f2 - z.lambda * b->u[j].f2;
        left[j] = v0[j] - (d0->d[2 * j] * z.y[j] + d0->d[1] * other);
        left[j] = vec_select(z.y[j] > zero, vec_abs(left[j]), vec_max(left[j], zero));
        off[j] = e[j] + z.lambda * b->u_error[j];
        rest[j] = left[j] + off[j] + b->d_error[j] * z.y[j] + b->c.error * other;
        s->a0 += 2.0 * v0[j] * z.y[j];
        s->slope[j] += 2.0 * v1[j] * z.y[j];
        s->bend[2 * j] += 2.0 * v2[j] * z.y[j];
        s->a3 += 2.0 * z.y[j] * off[j];
        s->size += v0[j] * v0[j] + 2.0 * z.y[j] * (vec_abs(v0[j]) + vec_abs(v1[j]) * b->h[j] + vec_abs(other));
    }
    s->yy[0] += z.y[0] * z.y[0];
    s->yy[1] += 2.0 * (z.y[0] * z.y[1]);
    s->yy[2] += z.y[1] * z.y[1];
    rise[0][0] = v1[0] - b->d[0].f1 * z.y[0] - b->c.one * z.y[1];
    rise[0][1] = -b->c.two * z.y[1];
    rise[1][0] = -b->c.one * z.y[0];
    rise[1][1] = v1[1] - b->d[1].f1 * z.y[1] - b->c.two * z.y[0];
    rest[0] += vec_abs(v2[0] - b->d[0].f2 * z.y[0] - b->c.one_one * z.y[1]) * (b->h[0] * b->h[0]) +
               vec_abs(b->c.two_two) * z.y[1] * (b->h[1] * b->h[1]) +
               vec_abs(b->c.one_two) * z.y[1] * (b->h[0] * b->h[1]);
    rest[1] += vec_abs(v2[1] - b->d[1].f2 * z.y[1] - b->c.two_two * z.y[0]) * (b->h[1] * b->h[1]) +
               vec_abs(b->c.one_one) * z.y[0] * (b->h[0] * b->h[0]) +
               vec_abs(b->c.one_two) * z.y[0] * (b->h[0] * b->h[1]);
    if (climb) {
        const struct quadratic seen = supported(d0, inverse, z.y);

        add_rest_of_two(b, &seen, rise, rest, s);
    } else {
        add_rest_of_two(b, inverse, rise, rest, s);
    }
}

/* n, e: two of each channel. */
LANES_INLINE void bound_two(const struct box_of_two *b, size_t K, const struct taylor *n, const vec *e,
                            const vec *omega, double slack, int climb, struct bound_of_two *out)
{
    vec zero = vec_set(0.0), change, stretch, top;
    struct summed_two s = {zero, zero, zero, {zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    struct quadratic d0, inverse;
    size_t k;

    lower(b, K, n, &d0);
    change = change_of(b, &d0);
    stretch = (1.0 + INVERSE_ROUNDING) / (1.0 - vec_min(change, vec_set(CHANGE_MOST)));
    stretch = stretch / (d0.d[0] * d0.d[2] - d0.d[1] * d0.d[1]);
    inverse.d[0] = d0.d[2] * stretch;
    inverse.d[1] = -d0.d[1] * stretch;
    inverse.d[2] = d0.d[0] * stretch;
    for (k = 0; k < K; k++) {
        add_channel_of_two(b, &d0, &inverse, n + 2 * k, e + 2 * k, omega[k], climb, &s);
    }
    s.a0 -= d0.d[0] * s.yy[0] + d0.d[1] * s.yy[1] + d0.d[2] * s.yy[2];
    s.slope[0] -= b->d[0].f1 * s.yy[0] + b->c.one * s.yy[1];
    s.slope[1] -= b->d[1].f1 * s.yy[2] + b->c.two * s.yy[1];
    s.bend[0] -= b->d[0].f2 * s.yy[0] + b->c.one_one * s.yy[1];
    s.bend[1] -= b->c.one_two * s.yy[1];
    s.bend[2] -= b->d[1].f2 * s.yy[2] + b->c.two_two * s.yy[1];
    s.a3 += b->d_error[0] * s.yy[0] + b->c.error * s.yy[1] + b->d_error[1] * s.yy[2];
    s.size += 2.0 * (s.yy[0] + s.yy[1] + s.yy[2]) + s.a3 + vec_abs(s.bend[0]) * (b->h[0] * b->h[0]) +
              vec_abs(s.bend[2]) * (b->h[1] * b->h[1]) + vec_abs(s.bend[1]) * (b->h[0] * b->h[1]);
    out->middle = s.a0 - (b->c.at - d0.d[1]) * s.yy[1]; /* with D_12 as it is */
    out->hill[0] = s.slope[0];
    out->hill[1] = s.slope[1];
    out->hill[2] = s.bend[0];
    out->hill[3] = s.bend[1];
    out->hill[4] = s.bend[2];
    top = top_of_two(s.slope, s.bend, b->h);
    out->upper = vec_select(change < vec_set(CHANGE_MOST), s.a0 + top + s.a3 + slack * s.size, vec_set(INFINITY));
}

#endif
