/*
 * The best point of a window, and the exact objective there. Part of batch_body.h; lanes are texels.
 * SPDX-License-Identifier: MIT
 *
 * Only a way to incumbents: the proof is in lanes_bound.h. The gain of channel k is f^2 / g with f = n, g = D
 * where that leaves x >= 0, else f = V = n + omega u, g = H = D + u^2; with y = f / g
 *
 *     J' = y (2 f' - y g'),    J'' = y' (2 f' - y g') + y (2 f'' - y' g' - y g''),    y' = (f' - y g') / g
 */
#ifndef BRDFFIT_BATCH_LANES_ASCEND_H
#define BRDFFIT_BATCH_LANES_ASCEND_H

#include "batch/fast.h"

/* Newton steps within a window; they converge quadratically. */
#define ASCENT_STEPS 5

/* Value, first derivative and half the second of a polynomial whose coefficient j is c[j]. */
struct taylor {
    vec f0, f1, f2;
};

/* c: rows of lanes. */
LANES_INLINE struct taylor taylor_rows(const double *c, int terms, vec t)
{
    struct taylor p = {vec_load(c + (terms - 1) * (int)LANES), vec_set(0.0), vec_set(0.0)};
    int j;

#pragma GCC unroll 16
    for (j = terms - 2; j >= 0; j--) {
        p.f2 = p.f2 * t + p.f1;
        p.f1 = p.f1 * t + p.f0;
        p.f0 = p.f0 * t + vec_load(c + j * (int)LANES);
    }
    return p;
}

/* n_k over a window for one texel, each channel's coefficients `stride` apart; with more terms or not. */
static void window_data(const struct batch_fast *f, const struct batch_tile *tile, size_t w, int more, size_t lane,
                        double *out)
{
    size_t M = f->distinct, K = f->channels, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS, m, k, part;

    for (part = 0; part < stride; part += VEC) {
        const double *shape = f->shape[more] + w * M * stride + part;

        for (k = 0; k < K; k++) {
            const double *sum = tile->sum + k * M * LANES + lane;
            vec first = vec_set(0.0), second = first, third = first, fourth = first;

            for (m = 0; m + 4 <= M; m += 4) {
                first += vec_load(shape + m * stride) * sum[m * LANES];
                second += vec_load(shape + (m + 1) * stride) * sum[(m + 1) * LANES];
                third += vec_load(shape + (m + 2) * stride) * sum[(m + 2) * LANES];
                fourth += vec_load(shape + (m + 3) * stride) * sum[(m + 3) * LANES];
            }
            for (; m < M; m++) {
                first += vec_load(shape + m * stride) * sum[m * LANES];
            }
            vec_store(out + k * stride + part, (first + second) + (third + fourth));
        }
    }
}

/* Where each texel is: a window, t in it, and polynomials there. */
struct ascent {
    size_t window[BATCH_TILE];
    double t[BATCH_TILE], slope[BATCH_TILE];
    double d[BATCH_TERMS_D * LANES], u[BATCH_TERMS * LANES];
};

static void enter_window(const struct batch_fast *f, struct batch_tile *tile, struct ascent *c, size_t lane)
{
    const struct batch_window *w = &f->window[c->window[lane]];
    size_t j, k;

    window_data(f, tile, c->window[lane], 0, lane, tile->work);
    for (j = 0; j < BATCH_TERMS_D; j++) {
        c->d[j * LANES + lane] = w->d[j];
    }
    for (j = 0; j < BATCH_TERMS; j++) {
        c->u[j * LANES + lane] = w->u[0][j];
        for (k = 0; k < f->channels; k++) {
            tile->n[(k * BATCH_TERMS + j) * LANES + lane] = tile->work[k * BATCH_TERMS + j];
        }
    }
}

/* Gain beyond sum omega^2, its slope and curvature by t. */
LANES_INLINE void gain_at(const struct batch_fast *f, const struct batch_tile *tile, const struct ascent *c,
                          size_t part, const vec *at, vec out[3])
{
    vec t = *at, zero = vec_set(0.0);
    struct taylor d = taylor_rows(c->d + part, BATCH_TERMS_D, t), u = taylor_rows(c->u + part, BATCH_TERMS, t), h;
    size_t k;

    h.f0 = d.f0 + u.f0 * u.f0;
    h.f1 = d.f1 + 2.0 * u.f0 * u.f1;
    h.f2 = d.f2 + u.f1 * u.f1 + 2.0 * u.f0 * u.f2;
    out[0] = out[1] = out[2] = zero;
    for (k = 0; k < f->channels; k++) {
        struct taylor n = taylor_rows(tile->n + k * BATCH_TERMS * LANES + part, BATCH_TERMS, t);
        vec omega = vec_load(tile->omega + k * LANES + part);
        vec_mask free = ~(omega * d.f0 < n.f0 * u.f0); /* x = omega - u n / D */
        vec f0 = n.f0 + vec_select(free, zero, omega * u.f0), f1 = n.f1 + vec_select(free, zero, omega * u.f1);
        vec f2 = n.f2 + vec_select(free, zero, omega * u.f2);
        vec g0 = vec_select(free, d.f0, h.f0), g1 = vec_select(free, d.f1, h.f1);
        vec g2 = vec_select(free, d.f2, h.f2);
        vec y = vec_max(f0, zero) / g0, dy = (f1 - y * g1) / g0, rise = 2.0 * f1 - y * g1;

        dy = vec_select((zero < y), dy, zero);
        out[0] += y * vec_max(f0, zero) - vec_select(free, zero, omega * omega);
        out[1] += y * rise;
        out[2] += dy * rise + y * (4.0 * f2 - dy * g1 - 2.0 * y * g2);
    }
}

/* Newton steps of the texels whose flag in `active` is 1, each inside its window. */
LANES_INLINE void ascend_part(const struct batch_fast *f, const struct batch_tile *tile, struct ascent *c,
                              const double *active, size_t part)
{
    vec t = vec_load(c->t + part), best = t, one = vec_set(1.0), zero = vec_set(0.0), most, value[3], slope;
    vec_mask moves = vec_load(active + part) > zero;
    int i;

    gain_at(f, tile, c, part, &t, value);
    most = value[0];
    slope = value[1];
    for (i = 0; i < ASCENT_STEPS; i++) {
        vec uphill = vec_select(value[1] > zero, vec_set(0.4), vec_set(-0.4));
        vec step = vec_select(value[2] < zero, -value[1] / value[2], uphill);
        vec_mask better;

        step = vec_max(vec_min(step, vec_set(0.8)), vec_set(-0.8));
        t = vec_max(vec_min(t + step, one), -one);
        gain_at(f, tile, c, part, &t, value);
        better = value[0] >= most;
        most = vec_select(better, value[0], most);
        best = vec_select(better, t, best);
        slope = vec_select(better, value[1], slope);
    }
    vec_store(c->t + part, vec_select(moves, best, vec_load(c->t + part)));
    vec_store(c->slope + part, vec_select(moves, slope, vec_load(c->slope + part)));
}

/* Shapes at s into tile->phi, and D there: a sum of squares, so that nothing cancels. */
LANES_INLINE void shapes_at(const struct batch_fast *f, struct batch_tile *tile, const double *at, size_t part, vec *u,
                            vec *h, vec *d)
{
    double inverse_a = f->root_a > 0.0 ? 1.0 / f->root_a : 0.0;
    vec s = vec_load(at + part);
    size_t M = f->distinct, m, i;

    *u = *h = *d = vec_set(0.0);
    for (m = 0; m < M; m++) {
        vec phi = vec_exp(s * -f->c[m]);

        vec_store(tile->phi + m * LANES + part, phi);
        *u += phi * f->ab[m];
        *h += (phi * phi) * f->bb[m];
    }
    for (m = 0; m <= M; m++) {
        vec phi = m < M ? vec_load(tile->phi + m * LANES + part) : vec_set(0.0);
        size_t end = m < M ? f->begin[m + 1] : f->used;

        for (i = f->begin[m]; i < end; i++) {
            vec rest = phi * f->b[i] - *u * (f->a[i] * inverse_a);

            *d += rest * rest;
        }
    }
}

/* Squared residuals of channel k with coefficients x of a / |a| and y of b phi. */
LANES_INLINE vec residual_at(const struct batch_fast *f, const struct batch_tile *tile, size_t k, size_t part, vec x,
                             vec y)
{
    double inverse_a = f->root_a > 0.0 ? 1.0 / f->root_a : 0.0;
    size_t K = f->channels, M = f->distinct, m, i;
    vec sum = vec_set(0.0);

    for (m = 0; m <= M; m++) {
        vec lobe = m < M ? y * vec_load(tile->phi + m * LANES + part) : vec_set(0.0);
        size_t end = m < M ? f->begin[m + 1] : f->used;

        for (i = f->begin[m]; i < end; i++) {
            vec rest = vec_load(tile->value + (i * K + k) * LANES + part) - x * (f->a[i] * inverse_a) - lobe * f->b[i];

            sum += rest * rest;
        }
    }
    return sum;
}

/* Exact objective at s, from the residuals of every sample, and the coefficients of a / |a| and b phi. */
static void evaluate(const struct batch_fast *f, struct batch_tile *tile, const double *at, double *x_out,
                     double *y_out, double *objective)
{
    size_t K = f->channels, M = f->distinct, m, k, part;

    for (part = 0; part < LANES; part += VEC) {
        vec zero = vec_set(0.0), u, h, d, e2 = zero;

        shapes_at(f, tile, at, part, &u, &h, &d);
        for (k = 0; k < K; k++) {
            const double *sum = tile->sum + k * M * LANES + part;
            vec n = zero, omega = vec_load(tile->omega + k * LANES + part), x, y;

            for (m = 0; m < M; m++) {
                n += vec_load(sum + m * LANES) * vec_load(tile->phi + m * LANES + part);
            }
            y = vec_max(n / d, zero);
            x = omega - y * u;
            y = vec_select(x < zero, vec_max((n + omega * u) / h, zero), y);
            x = vec_max(x, zero);
            vec_store(x_out + k * LANES + part, x);
            vec_store(y_out + k * LANES + part, y);
            e2 += residual_at(f, tile, k, part, x, y);
        }
        vec_store(objective + part, e2);
    }
}

#endif
