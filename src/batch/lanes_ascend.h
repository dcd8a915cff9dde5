/*
 * The best point of a window, and the exact objective there. Part of batch_body.h; lanes are texels.
 * SPDX-License-Identifier: MIT
 *
 * Only a way to incumbents: the proof is in lanes_bound.h. The gain of channel k is 2 f.y - y G y with f = n, G = D where that
 * leaves x >= 0, else f = n + omega u, G = D + u u^T; with y of the restricted problem and rho = f' - G' y
 *
 *     J' = 2 f'.y - y G' y,    J'' = 2 f''.y - y G'' y + 2 rho G^-1 rho, the last over the columns with y > 0
 */
#ifndef BRDFFIT_BATCH_LANES_ASCEND_H
#define BRDFFIT_BATCH_LANES_ASCEND_H

#include "batch/fast.h"
#include "batch/lanes_restricted.h"

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

/* n_kj over a window for one texel, the coefficients of each channel and column `stride` apart; with more terms or not. */
static void window_data(const struct batch_fast *f, const struct batch_tile *tile, size_t w, int more, size_t lane,
                        double *out)
{
    size_t M = f->distinct, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS, C = (size_t)f->each, m, k, j, part;

    for (part = 0; part < stride; part += VEC) {
        for (j = 0; j < C; j++) {
            const double *shape = f->column[j].shape[more] + w * M * stride + part;

            for (k = 0; k < f->channels; k++) {
                const double *sum = tile->sum[j] + k * M * LANES + lane;
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
                vec_store(out + (k * C + j) * stride + part, (first + second) + (third + fourth));
            }
        }
    }
}

/* Where each texel is: a window, t in it, and polynomials there. */
struct ascent {
    size_t window[BATCH_TILE];
    double t[BATCH_TILE], slope[BATCH_TILE];
    double d[BATCH_PAIRS][BATCH_TERMS_D * LANES], u[EACH_MOST][BATCH_TERMS * LANES];
};

static void enter_window(const struct batch_fast *f, struct batch_tile *tile, struct ascent *c, size_t lane)
{
    const struct batch_window *w = &f->window[c->window[lane]];
    size_t q, i, C = (size_t)f->each;

    window_data(f, tile, c->window[lane], 0, lane, tile->work);
    for (i = 0; i < C * (C + 1) / 2; i++) {
        for (q = 0; q < BATCH_TERMS_D; q++) {
            c->d[i][q * LANES + lane] = w->d[i][q];
        }
    }
    for (q = 0; q < BATCH_TERMS; q++) {
        for (i = 0; i < C; i++) {
            c->u[i][q * LANES + lane] = w->u[i][0][q];
        }
        for (i = 0; i < f->channels * C; i++) {
            tile->n[(i * BATCH_TERMS + q) * LANES + lane] = tile->work[i * BATCH_TERMS + q];
        }
    }
}

/* Taylor series of f and G where x = 0, from those where it is free. */
LANES_INLINE void hold_x(struct taylor *n, struct taylor *d, const struct taylor *u, vec omega, vec_mask free, int each)
{
    vec zero = vec_set(0.0), part = vec_select(free, zero, omega), one = vec_select(free, zero, vec_set(1.0));
    int i, j;

    for (j = 0; j < each; j++) {
        n[j].f0 += part * u[j].f0;
        n[j].f1 += part * u[j].f1;
        n[j].f2 += part * u[j].f2;
        for (i = 0; i <= j; i++) {
            struct taylor *g = &d[BATCH_PAIR(i, j)];

            g->f0 += one * (u[i].f0 * u[j].f0);
            g->f1 += one * (u[i].f0 * u[j].f1 + u[i].f1 * u[j].f0);
            g->f2 += one * (u[i].f0 * u[j].f2 + u[i].f1 * u[j].f1 + u[i].f2 * u[j].f0);
        }
    }
}

/* rho G^-1 rho over the columns with y > 0. */
LANES_INLINE vec supported_rest(const struct taylor *d, const vec *rho, const vec *y, int each)
{
    vec zero = vec_set(0.0), one = rho[0] * rho[0] / d[0].f0, two, both;
    vec_mask first = y[0] > zero, second;

    if (each == 1) {
        return vec_select(first, one, zero);
    }
    second = y[1] > zero;
    two = rho[1] * rho[1] / d[2].f0;
    both = (rho[0] * rho[0] * d[2].f0 + rho[1] * rho[1] * d[0].f0 - 2.0 * (rho[0] * rho[1]) * d[1].f0) /
           (d[0].f0 * d[2].f0 - d[1].f0 * d[1].f0);
    return vec_select(first & second, both, vec_select(first, one, vec_select(second, two, zero)));
}

/* Gain beyond sum omega^2 of a channel, its slope and curvature by t, added to out. */
LANES_INLINE void add_gain(const struct taylor *d_free, const struct taylor *u, struct taylor *n, vec omega, int each,
                           vec out[3])
{
    struct taylor d[BATCH_PAIRS];
    struct quadratic d0;
    struct solved z;
    vec n0[EACH_MOST], u0[EACH_MOST], rho[EACH_MOST];
    int i, j;

    for (i = 0; i < each * (each + 1) / 2; i++) {
        d[i] = d_free[i];
        d0.d[i] = d[i].f0;
    }
    for (j = 0; j < each; j++) {
        n0[j] = n[j].f0;
        u0[j] = u[j].f0;
    }
    z = solve_channel(n0, u0, &d0, omega, each);
    hold_x(n, d, u, omega, z.free, each);
    out[0] -= vec_select(z.free, vec_set(0.0), omega * omega);
    for (j = 0; j < each; j++) {
        rho[j] = n[j].f1;
        out[0] += 2.0 * n[j].f0 * z.y[j];
        out[1] += 2.0 * n[j].f1 * z.y[j];
        out[2] += 4.0 * n[j].f2 * z.y[j];
        for (i = 0; i < each; i++) {
            const struct taylor *g = &d[i <= j ? BATCH_PAIR(i, j) : BATCH_PAIR(j, i)];
            vec yy = z.y[i] * z.y[j];

            rho[j] -= g->f1 * z.y[i];
            out[0] -= g->f0 * yy;
            out[1] -= g->f1 * yy;
            out[2] -= 2.0 * g->f2 * yy;
        }
    }
    out[2] += 2.0 * supported_rest(d, rho, z.y, each);
}

/* Gain beyond sum omega^2, its slope and curvature by t. */
LANES_INLINE void gain_at(const struct batch_fast *f, const struct batch_tile *tile, const struct ascent *c,
                          size_t part, const vec *at, int each, vec out[3])
{
    vec t = *at;
    struct taylor d[BATCH_PAIRS], u[EACH_MOST], n[EACH_MOST];
    size_t k;
    int j;

    for (j = 0; j < each * (each + 1) / 2; j++) {
        d[j] = taylor_rows(c->d[j] + part, BATCH_TERMS_D, t);
    }
    for (j = 0; j < each; j++) {
        u[j] = taylor_rows(c->u[j] + part, BATCH_TERMS, t);
    }
    out[0] = out[1] = out[2] = vec_set(0.0);
    for (k = 0; k < f->channels; k++) {
        for (j = 0; j < each; j++) {
            n[j] = taylor_rows(tile->n + (k * (size_t)each + (size_t)j) * BATCH_TERMS * LANES + part, BATCH_TERMS, t);
        }
        add_gain(d, u, n, vec_load(tile->omega + k * LANES + part), each, out);
    }
}

/* Newton steps of the texels whose flag in `active` is 1, each inside its window. */
LANES_INLINE void ascend_part(const struct batch_fast *f, const struct batch_tile *tile, struct ascent *c,
                              const double *active, size_t part, int each)
{
    vec t = vec_load(c->t + part), best = t, one = vec_set(1.0), zero = vec_set(0.0), most, value[3], slope;
    vec_mask moves = vec_load(active + part) > zero;
    int i;

    gain_at(f, tile, c, part, &t, each, value);
    most = value[0];
    slope = value[1];
    for (i = 0; i < ASCENT_STEPS; i++) {
        vec uphill = vec_select(value[1] > zero, vec_set(0.4), vec_set(-0.4));
        vec step = vec_select(value[2] < zero, -value[1] / value[2], uphill);
        vec_mask better;

        step = vec_max(vec_min(step, vec_set(0.8)), vec_set(-0.8));
        t = vec_max(vec_min(t + step, one), -one);
        gain_at(f, tile, c, part, &t, each, value);
        better = value[0] >= most;
        most = vec_select(better, value[0], most);
        best = vec_select(better, t, best);
        slope = vec_select(better, value[1], slope);
    }
    vec_store(c->t + part, vec_select(moves, best, vec_load(c->t + part)));
    vec_store(c->slope + part, vec_select(moves, slope, vec_load(c->slope + part)));
}

/* Shapes at each texel's s into tile->phi. */
static void shapes_at(const struct batch_fast *f, struct batch_tile *tile, const double *s)
{
    size_t M = f->distinct, m, l, j;

    if (f->alike) {
        tile->phi[1] = tile->phi[0];
    }
    for (j = 0; j < (f->alike ? 1 : (size_t)f->each); j++) {
        for (l = 0; l < LANES; l++) {
            brdffit_batch_shape(f, (int)j, s[l], tile->one);
            for (m = 0; m < M; m++) {
                tile->phi[j][m * LANES + l] = tile->one[m];
            }
        }
    }
}

/* u and D of those: a sum of squares, so that nothing cancels. */
LANES_INLINE void gram_at(const struct batch_fast *f, const struct batch_tile *tile, size_t part, int each, vec *u,
                          struct quadratic *d)
{
    double inverse_a = f->root_a > 0.0 ? 1.0 / f->root_a : 0.0;
    vec phi[EACH_MOST], rest[EACH_MOST], zero = vec_set(0.0);
    size_t M = f->distinct, m, i;
    int j;

    for (j = 0; j < each; j++) {
        u[j] = zero;
        for (m = 0; m < M; m++) {
            u[j] += vec_load(tile->phi[j] + m * LANES + part) * f->column[j].ab[m];
        }
    }
    for (j = 0; j < each * (each + 1) / 2; j++) {
        d->d[j] = zero;
    }
    for (m = 0; m <= M; m++) {
        size_t end = m < M ? f->begin[m + 1] : f->used;

        for (j = 0; j < each; j++) {
            phi[j] = m < M ? vec_load(tile->phi[j] + m * LANES + part) : zero;
        }
        for (i = f->begin[m]; i < end; i++) {
            for (j = 0; j < each; j++) {
                rest[j] = phi[j] * f->column[j].b[i] - u[j] * (f->a[i] * inverse_a);
            }
            d->d[0] += rest[0] * rest[0];
            if (each > 1) {
                d->d[1] += rest[0] * rest[1];
                d->d[2] += rest[1] * rest[1];
            }
        }
    }
}

/* Squared residuals of channel k with coefficients x of a / |a| and y of b phi. */
LANES_INLINE vec residual_at(const struct batch_fast *f, const struct batch_tile *tile, size_t k, size_t part, vec x,
                             const vec *y, int each)
{
    double inverse_a = f->root_a > 0.0 ? 1.0 / f->root_a : 0.0;
    size_t K = f->channels, M = f->distinct, m, i;
    vec sum = vec_set(0.0), lobe[EACH_MOST], zero = sum;
    int j;

    for (m = 0; m <= M; m++) {
        size_t end = m < M ? f->begin[m + 1] : f->used;

        for (j = 0; j < each; j++) {
            lobe[j] = m < M ? y[j] * vec_load(tile->phi[j] + m * LANES + part) : zero;
        }
        for (i = f->begin[m]; i < end; i++) {
            vec rest = vec_load(tile->value + (i * K + k) * LANES + part) - x * (f->a[i] * inverse_a);

            for (j = 0; j < each; j++) {
                rest -= lobe[j] * f->column[j].b[i];
            }
            sum += rest * rest;
        }
    }
    return sum;
}

/* Exact objective of a part, from the residuals of every sample, and the coefficients of a / |a| and b phi. */
LANES_INLINE void evaluate_part(const struct batch_fast *f, const struct batch_tile *tile, size_t part, int each,
                                double *x_out, double *y_out, double *objective)
{
    size_t M = f->distinct, m, k;
    vec zero = vec_set(0.0), e2 = zero, u[EACH_MOST];
    struct quadratic d;
    int j;

    gram_at(f, tile, part, each, u, &d);
    for (k = 0; k < f->channels; k++) {
        vec n[EACH_MOST], omega = vec_load(tile->omega + k * LANES + part), x;
        struct solved z;

        for (j = 0; j < each; j++) {
            const double *sum = tile->sum[j] + k * M * LANES + part;

            n[j] = zero;
            for (m = 0; m < M; m++) {
                n[j] += vec_load(sum + m * LANES) * vec_load(tile->phi[j] + m * LANES + part);
            }
        }
        z = solve_channel(n, u, &d, omega, each);
        x = omega - z.y[0] * u[0] - (each > 1 ? z.y[1] * u[1] : zero);
        x = vec_select(z.free, vec_max(x, zero), zero);
        vec_store(x_out + k * LANES + part, x);
        for (j = 0; j < each; j++) {
            vec_store(y_out + (k * (size_t)each + (size_t)j) * LANES + part, z.y[j]);
        }
        e2 += residual_at(f, tile, k, part, x, z.y, each);
    }
    vec_store(objective + part, e2);
}

/* The same of all texels, at s. */
static void evaluate(const struct batch_fast *f, struct batch_tile *tile, const double *s, double *x, double *y,
                     double *objective)
{
    size_t part;

    shapes_at(f, tile, s);
    for (part = 0; part < LANES; part += VEC) {
        if (EACH_MOST > 1 && f->each > 1) {
            evaluate_part(f, tile, part, 2, x, y, objective);
        } else {
            evaluate_part(f, tile, part, 1, x, y, objective);
        }
    }
}

#endif
