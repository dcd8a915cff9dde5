/*
 * The proof: no s of a window gains more than Gamma. Part of batch_body.h; lanes are pieces of the window of
 * one texel. SPDX-License-Identifier: MIT
 *
 * On a piece |t - t0| <= h write each polynomial as f0 + f1 d + f2 d^2 + e, d = t - t0, with |e| <= sup |f'''| / 6 h^3 plus the
 * error of the polynomial itself. With y0, lambda of t0 (lanes_restricted.h), l = max(0, D y0 - v) of t0 where y0 = 0, and
 * v = n - lambda u, a channel gains at most (fast.c)
 *
 *     lambda (2 omega + lambda) + 2 v.y0 - y0 D y0 + rho D^-1 rho + omega^2,    rho = v + l - D y0 = rho1 d + sigma
 *
 * where sigma is of second order, and what is left of rho at t0. D is at least (1 - rate h) D(t0) (screen.c), so with
 * B = D(t0)^-1 / (1 - rate h)
 *
 *     rho D^-1 rho <= d^2 rho1 B rho1 + 2 h |B rho1| |sigma| + |sigma| |B| |sigma| .
 *
 * So the sum over channels is at most A0 + A1 d + A2 d^2 + A3, where A3 takes everything of third order: near the
 * optimum, where the gain falls with d^2, pieces of a fixed small share of d suffice. Multipliers that are held cost a term
 * of second order, which the next cut makes 64 times smaller. So a window near the optimum is first cut at distances from it
 * that grow threefold; a piece that is not discarded is cut into eight.
 */
#ifndef BRDFFIT_BATCH_LANES_BOUND_H
#define BRDFFIT_BATCH_LANES_BOUND_H

#include "batch/fast.h"
#include "batch/lanes_restricted.h"
#include "base/tolerance.h"

/* Pieces waiting to be cut, and calls for one texel, before the general path takes over. */
#define WAITING 64
#define MOST_CALLS 300
/* First cut around the optimum, in t; windows whose middle is further than this from it are cut evenly. */
#define GRADE 0.05
#define NEAR 2.0
/* Pieces that are not cut any more. */
#define NARROW 1e-9
/* What rounding makes of an inverse of D: its determinant is at least about 1e-8 of the product of its diagonal (window.c). */
#define INVERSE_ROUNDING 1e-5

struct pieces {
    double center[LANES], half[LANES];
};

struct bound_texel {
    const struct batch_fast *fast;
    const struct batch_window *window;
    int more;        /* polynomials with more terms */
    const double *n; /* K x each x BATCH_TERMS, or BATCH_STRIDE_MORE */
    const double *omega, *norm, *third; /* K, K, K x each: omega, |I_k|, sup |n'''| / 6 */
    double gamma, slack;
    double best, best_t; /* gain at the centre of pieces: above the incumbent's, the ascent was in the wrong valley */
};

/* c: scalars. */
LANES_INLINE struct taylor taylor_at(const double *c, int terms, vec t)
{
    struct taylor p = {vec_set(c[terms - 1]), vec_set(0.0), vec_set(0.0)};
    int j;

#pragma GCC unroll 16
    for (j = terms - 2; j >= 0; j--) {
        p.f2 = p.f2 * t + p.f1;
        p.f1 = p.f1 * t + p.f0;
        p.f0 = p.f0 * t + c[j];
    }
    return p;
}

/* D, u and their derivatives at t0 of every piece, and how far they may be off over it. */
struct at_pieces {
    vec h, h2, h3, stretch; /* 1 / (1 - rate h), errors of D and rounding */
    struct taylor d[BATCH_PAIRS], u[EACH_MOST];
    vec d_error[BATCH_PAIRS], u_error[EACH_MOST];
    struct quadratic d0, d1, inverse;
};

LANES_INLINE void open_pieces(const struct batch_window *w, const struct pieces *pieces, size_t part, int more,
                              int each, struct at_pieces *at)
{
    vec t = vec_load(pieces->center + part);
    int j, pairs = each * (each + 1) / 2;

    at->h = vec_load(pieces->half + part) * (1.0 + 1e-9);
    at->h2 = at->h * at->h;
    at->h3 = at->h2 * at->h;
    for (j = 0; j < pairs; j++) {
        at->d[j] = taylor_at(w->d[j], BATCH_TERMS_D, t);
        at->d_error[j] = w->d_third[j] * at->h3 + w->d_error[j];
        at->d0.d[j] = at->d[j].f0;
        at->d1.d[j] = at->d[j].f1;
    }
    for (j = 0; j < each; j++) {
        at->u[j] = taylor_at(w->u[j][more], more ? BATCH_TERMS_MORE : BATCH_TERMS, t);
        at->u_error[j] = w->u_third[j][more] * at->h3 + w->u_error[j][more];
    }
    at->stretch = ((1.0 + INVERSE_ROUNDING) * (1.0 + 2.0 * w->excess)) / (1.0 - w->rate * at->h);
    if (each == 1) {
        at->inverse.d[0] = at->stretch / at->d0.d[0];
    } else {
        vec inverse = at->stretch / (at->d0.d[0] * at->d0.d[2] - at->d0.d[1] * at->d0.d[1]);

        at->inverse.d[0] = at->d0.d[2] * inverse;
        at->inverse.d[1] = -at->d0.d[1] * inverse;
        at->inverse.d[2] = at->d0.d[0] * inverse;
    }
}

/* What of the pieces is not proven: sup > 0; and what their centres gain. */
struct bounded {
    double sup[LANES], gained[LANES];
};

/* Sums over channels: A0 .. A3 but for y0 D y0, y0 y0^T, and what rounding is relative to. */
struct summed {
    vec a0, a1, a2, a3, size, yy[BATCH_PAIRS];
};

/* rho D^-1 rho of one channel, and its part in A3. */
LANES_INLINE void add_rest(const struct at_pieces *at, const vec *rise, const vec *rest, int each, struct summed *s)
{
    vec pull[EACH_MOST], size = vec_set(0.0);
    int j;

    for (j = 0; j < each; j++) {
        pull[j] = times(&at->inverse, rise, j, each);
        s->a2 += rise[j] * pull[j];
        size += 2.0 * at->h * vec_abs(pull[j]) * rest[j];
    }
    if (each == 1) {
        size += at->inverse.d[0] * (rest[0] * rest[0]);
    } else {
        size += at->inverse.d[0] * (rest[0] * rest[0]) + at->inverse.d[2] * (rest[1] * rest[1]) +
                2.0 * vec_abs(at->inverse.d[1]) * (rest[0] * rest[1]);
    }
    s->a3 += size;
}

LANES_INLINE void add_channel(const struct bound_texel *b, const struct at_pieces *at, vec t, size_t k, int more,
                              int each, struct summed *s)
{
    const int terms = more ? BATCH_TERMS_MORE : BATCH_TERMS;
    const size_t stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS;
    struct taylor n[EACH_MOST];
    struct solved z;
    vec omega = vec_set(b->omega[k]), zero = vec_set(0.0), n0[EACH_MOST], u0[EACH_MOST];
    vec rise[EACH_MOST], rest[EACH_MOST];
    int j, i;

    for (j = 0; j < each; j++) {
        n[j] = taylor_at(b->n + (k * (size_t)each + (size_t)j) * stride, terms, t);
        n0[j] = n[j].f0;
        u0[j] = at->u[j].f0;
    }
    z = solve_channel(n0, u0, &at->d0, omega, each);
    s->a0 += z.lambda * (2.0 * omega + z.lambda);
    s->size += omega * omega + z.lambda * z.lambda;
    for (j = 0; j < each; j++) {
        vec v0 = n0[j] - z.lambda * u0[j], v1 = n[j].f1 - z.lambda * at->u[j].f1;
        vec v2 = n[j].f2 - z.lambda * at->u[j].f2;
        vec e = b->third[k * (size_t)each + (size_t)j] * at->h3 + b->window->n_error[j][more] * b->norm[k] +
                z.lambda * at->u_error[j];
        vec left = v0 - times(&at->d0, z.y, j, each);
        vec bend = v2, off = e, model = zero;

        rise[j] = v1 - times(&at->d1, z.y, j, each);
        for (i = 0; i < each; i++) {
            int pair = i <= j ? BATCH_PAIR(i, j) : BATCH_PAIR(j, i);

            bend -= at->d[pair].f2 * z.y[i];
            off += at->d_error[pair] * z.y[i];
            model += vec_abs(at->d[pair].f0) * z.y[i];
        }
        left = vec_select(z.y[j] > zero, vec_abs(left), vec_max(left, zero));
        rest[j] = left + vec_abs(bend) * at->h2 + off;
        s->a0 += 2.0 * v0 * z.y[j];
        s->a1 += 2.0 * v1 * z.y[j];
        s->a2 += 2.0 * v2 * z.y[j];
        s->a3 += 2.0 * z.y[j] * e;
        s->size += 2.0 * z.y[j] * (vec_abs(v0) + vec_abs(v1) * at->h + vec_abs(v2) * at->h2 + model) + vec_abs(v0 * v0);
        for (i = 0; i <= j; i++) {
            s->yy[BATCH_PAIR(i, j)] += (i < j ? 2.0 : 1.0) * (z.y[i] * z.y[j]);
        }
    }
    add_rest(at, rise, rest, each, s);
}

LANES_INLINE void bound_part(const struct bound_texel *b, const struct pieces *pieces, size_t part, int more, int each,
                             struct bounded *out)
{
    vec t = vec_load(pieces->center + part), zero = vec_set(0.0), end, rounding;
    struct summed s = {zero, zero, zero, zero, zero, {zero}};
    struct at_pieces at;
    vec_mask inside;
    size_t k;
    int j;

    open_pieces(b->window, pieces, part, more, each, &at);
    for (j = 0; j < each * (each + 1) / 2; j++) {
        s.yy[j] = zero;
    }
    for (k = 0; k < b->fast->channels; k++) {
        add_channel(b, &at, t, k, more, each, &s);
    }
    for (j = 0; j < each * (each + 1) / 2; j++) {
        s.a0 -= at.d[j].f0 * s.yy[j];
        s.a1 -= at.d[j].f1 * s.yy[j];
        s.a2 -= at.d[j].f2 * s.yy[j];
        s.a3 += at.d_error[j] * s.yy[j];
        s.size += vec_abs(at.d[j].f1 * at.h) * s.yy[j];
    }
    vec_store(out->gained + part, s.a0);
    rounding = b->slack * (s.size + vec_abs(s.a2) * at.h2 + s.a3 + vec_set(b->gamma));
    s.a0 += s.a3 + rounding - b->gamma;
    inside = (s.a2 < zero) & (vec_abs(s.a1) < -2.0 * s.a2 * at.h);
    end = s.a0 + vec_abs(s.a1) * at.h + s.a2 * at.h2;
    end = vec_select(inside, s.a0 - s.a1 * s.a1 / (4.0 * vec_min(s.a2, vec_set(-1e-300))), end);
    vec_store(out->sup + part, vec_select(b->window->rate * at.h < vec_set(0.5), end, vec_set(INFINITY)));
}

/* Bit l set when the piece |t - center[l]| <= half[l] is not discarded. */
static unsigned bound_pieces(struct bound_texel *b, const struct pieces *pieces)
{
    struct bounded out;
    unsigned left = 0;
    size_t l, part;

    for (part = 0; part < LANES; part += VEC) {
        if (EACH_MOST > 1 && b->fast->each > 1) {
            if (b->more) {
                bound_part(b, pieces, part, 1, 2, &out);
            } else {
                bound_part(b, pieces, part, 0, 2, &out);
            }
        } else if (b->more) {
            bound_part(b, pieces, part, 1, 1, &out);
        } else {
            bound_part(b, pieces, part, 0, 1, &out);
        }
    }
    for (l = 0; l < LANES; l++) {
        left |= (unsigned)!(out.sup[l] <= 0.0) << l;
    }
    for (l = 0; left && l < LANES; l++) {
        if ((left >> l & 1) && out.gained[l] > b->best) {
            b->best = out.gained[l];
            b->best_t = pieces->center[l];
        }
    }
    return left;
}
static void cut_evenly(double center, double half, struct pieces *p)
{
    size_t l;

    half *= 1.0 / LANES;
    for (l = 0; l < LANES; l++) {
        p->center[l] = center + (2.0 * (double)l - 7.0) * half;
        p->half[l] = half;
    }
}

/* The window [-1, 1] cut at GRADE, 3 GRADE, 9 GRADE ... on both sides of t; the long side has one cut more. */
static void cut_around(double t, struct pieces *p)
{
    double far = 27.0 * GRADE;
    const double cut[LANES + 1] = {-1.0,
                                   t > 0.0 ? t - far : t - 9.0 * GRADE,
                                   t > 0.0 ? t - 9.0 * GRADE : t - 3.0 * GRADE,
                                   t > 0.0 ? t - 3.0 * GRADE : t - GRADE,
                                   t > 0.0 ? t - GRADE : t + GRADE,
                                   t > 0.0 ? t + GRADE : t + 3.0 * GRADE,
                                   t > 0.0 ? t + 3.0 * GRADE : t + 9.0 * GRADE,
                                   t > 0.0 ? t + 9.0 * GRADE : t + far,
                                   1.0};
    double low = -1.0;
    size_t l;

    for (l = 0; l < LANES; l++) {
        double high = l + 1 < LANES ? cut[l + 1] : 1.0;

        high = high < low ? low : high > 1.0 ? 1.0 : high;
        p->center[l] = 0.5 * (low + high);
        p->half[l] = 0.5 * (high - low) + 1e-15;
        low = high;
    }
}

/* Cut the window until everything is discarded: 1; 0 when that takes too long or a better point was met. */
static int bound_window(struct bound_texel *b, double optimum, size_t *calls)
{
    double middle[WAITING], half[WAITING], incumbent = b->best;
    struct pieces pieces;
    int waiting = 0, l;

    if (optimum > -NEAR && optimum < NEAR) {
        cut_around(optimum, &pieces);
    } else {
        cut_evenly(0.0, 1.0, &pieces);
    }
    for (;;) {
        unsigned left;

        if (++*calls > MOST_CALLS) {
            return 0;
        }
        left = bound_pieces(b, &pieces);
        if (b->best > incumbent) {
            return 0;
        }
        for (l = 0; left && l < (int)LANES; l++) {
            if (!(left >> l & 1)) {
                continue;
            }
            if (waiting >= WAITING || pieces.half[l] < NARROW) {
                return 0;
            }
            middle[waiting] = pieces.center[l];
            half[waiting++] = pieces.half[l];
        }
        if (waiting == 0) {
            return 1;
        }
        waiting--;
        cut_evenly(middle[waiting], half[waiting], &pieces);
    }
}

#endif
