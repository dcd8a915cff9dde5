/*
 * The proof: no s of a window gains more than Gamma. Part of batch_body.h; lanes are pieces of the window of
 * one texel. SPDX-License-Identifier: MIT
 *
 * On a piece |t - t0| <= h write each polynomial f0 + f1 d + f2 d^2 + e, d = t - t0, with |e| <= sup |f'''| / 6 h^3
 * plus the error of the polynomial itself. With lambda_k >= 0 of t0 (fast.c) and v = n_k - lambda_k u,
 * |v| <= S:
 *
 *     max(0, v)^2 <= (v0 + v1 d + v2 d^2)^2 + 2 S e   when v0 > 0; 0 when v <= 0 all over; else (sup v)^2
 *
 * so that   sum max(0, v)^2 - G D <= A0 + A1 d + A2 d^2 + A3,   G = Gamma - sum lambda (2 omega + lambda),
 *
 * where A3 takes everything of third order. Its maximum over |d| <= h in closed form is the bound: right to third
 * order, so that near the optimum, where the gain falls with d^2, pieces of a fixed small share of d suffice. Where
 * x = 0 the fixed lambda costs a term of second order, which the next cut makes 64 times smaller. So a window near the
 * optimum is first cut at distances from it that grow threefold; a piece that is not discarded is cut into eight.
 */
#ifndef BRDFFIT_BATCH_LANES_BOUND_H
#define BRDFFIT_BATCH_LANES_BOUND_H

#include "batch/fast.h"
#include "base/tolerance.h"

/* Pieces waiting to be cut, and calls for one texel, before the general path takes over. */
#define WAITING 64
#define MOST_CALLS 300
/* First cut around the optimum, in t; windows whose middle is further than this from it are cut evenly. */
#define GRADE 0.05
#define NEAR 2.0
/* Pieces that are not cut any more. */
#define NARROW 1e-9

struct pieces {
    double center[LANES], half[LANES];
};

struct bound_texel {
    const struct batch_fast *fast;
    const struct batch_window *window;
    int more;             /* polynomials with more terms */
    const double *n;      /* K x BATCH_TERMS, or BATCH_STRIDE_MORE */
    const double *omega, *norm, *third; /* K: omega, |I_k|, sup |n'''| / 6 */
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

/* What of the pieces is not proven: sup > 0; and what their centres gain, as gained / d + lifted. */
struct bounded {
    double sup[LANES], gained[LANES], lifted[LANES], d[LANES];
};

LANES_INLINE void bound_part(const struct bound_texel *b, const struct pieces *pieces, size_t part, int more,
                             struct bounded *out)
{
    const int terms = more ? BATCH_TERMS_MORE : BATCH_TERMS;
    const size_t stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS;
    const struct batch_window *w = b->window;
    vec t = vec_load(pieces->center + part), zero = vec_set(0.0), h = vec_load(pieces->half + part) * (1.0 + 1e-9);
    vec h2 = h * h, h3 = h2 * h;
    struct taylor d = taylor_at(w->d, BATCH_TERMS_D, t), u = taylor_at(w->u[more], terms, t);
    vec hh = d.f0 + u.f0 * u.f0, a0 = zero, a1 = zero, a2 = zero, a3 = zero, lifted = zero, size = zero, gained = zero;
    vec d_error = w->d_third * h3 + w->d_error, u_error = w->u_third[more] * h3 + w->u_error[more];
    vec cosine = u.f0 / hh, g, end;
    vec_mask inside;
    size_t k;

    for (k = 0; k < b->fast->channels; k++) {
        struct taylor n = taylor_at(b->n + k * stride, terms, t);
        vec omega = vec_set(b->omega[k]);
        vec lambda = vec_max(cosine * vec_max(n.f0 + omega * u.f0, zero) - omega, zero);
        vec v0 = n.f0 - lambda * u.f0, v1 = n.f1 - lambda * u.f1, v2 = n.f2 - lambda * u.f2;
        vec e = b->third[k] * h3 + w->n_error[more] * b->norm[k] + lambda * u_error;
        vec spread = vec_abs(v1) * h + vec_abs(v2) * h2 + e, s = vec_abs(v0) + spread;
        vec top = vec_max(v0 + spread, zero), positive = vec_max(v0, zero);
        vec_mask square = v0 > zero;

        a0 += vec_select(square, v0 * v0 + 2.0 * s * e, top * top);
        a1 += vec_select(square, 2.0 * v0 * v1, zero);
        a2 += vec_select(square, v1 * v1 + 2.0 * v0 * v2, zero);
        a3 += vec_select(square, 2.0 * vec_abs(v1 * v2) * h3 + v2 * v2 * (h2 * h2), zero);
        lifted += lambda * (2.0 * omega + lambda);
        size += s * s + (lambda * lambda + omega * omega) * hh;
        gained += positive * positive;
    }
    g = b->gamma - lifted;
    a3 += vec_abs(g) * d_error + b->slack * (size + vec_abs(g) * hh + b->gamma * hh);
    a0 -= g * d.f0;
    a1 -= g * d.f1;
    a2 -= g * d.f2;
    inside = (a2 < zero) & (vec_abs(a1) < -2.0 * a2 * h);
    end = a0 + vec_abs(a1) * h + a2 * h2;
    vec_store(out->sup + part, vec_select(inside, a0 - a1 * a1 / (4.0 * vec_min(a2, vec_set(-1e-300))), end) + a3);
    vec_store(out->gained + part, gained);
    vec_store(out->lifted + part, lifted);
    vec_store(out->d + part, d.f0);
}

/* Bit l set when the piece |t - center[l]| <= half[l] is not discarded. */
static unsigned bound_pieces(struct bound_texel *b, const struct pieces *pieces)
{
    struct bounded out;
    unsigned left = 0;
    size_t l, part;

    for (part = 0; part < LANES; part += VEC) {
        if (b->more) {
            bound_part(b, pieces, part, 1, &out);
        } else {
            bound_part(b, pieces, part, 0, &out);
        }
    }
    for (l = 0; l < LANES; l++) {
        left |= (unsigned)!(out.sup[l] <= 0.0) << l;
    }
    for (l = 0; left && l < LANES; l++) {
        double gain = out.gained[l] / out.d[l] + out.lifted[l];

        if ((left >> l & 1) && gain > b->best) {
            b->best = gain;
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
