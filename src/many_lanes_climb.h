/*
 * The best point of a window, and the exact objective there. Part of many_kernels_body.h; lanes are texels. Layer 5.
 * SPDX-License-Identifier: MIT
 *
 * Only a way to incumbents: the proof is in many_lanes_bound.h. The gain of channel k is f^2 / g with f = n, g = D
 * where that leaves x >= 0, else f = V = n + omega u, g = H = D + u^2; with y = f / g
 *
 *     J' = y (2 f' - y g'),    J'' = y' (2 f' - y g') + y (2 f'' - y' g' - y g''),    y' = (f' - y g') / g
 */
#ifndef BRDFFIT_MANY_LANES_CLIMB_H
#define BRDFFIT_MANY_LANES_CLIMB_H

#include "many_fast.h"

/* Newton steps within a window; they converge quadratically. */
#define CLIMB_STEPS 6

/* Value, first derivative and half the second of a polynomial whose coefficient j is c[j]. */
struct taylor {
    lanes f0, f1, f2;
};

/* c: rows of lanes. */
LANES_INLINE struct taylor taylor_rows(const double *c, int terms, lanes t)
{
    struct taylor p = {lanes_load(c + (terms - 1) * (int)LANES), lanes_set(0.0), lanes_set(0.0)};
    int j;

#pragma GCC unroll 16
    for (j = terms - 2; j >= 0; j--) {
        p.f2 = p.f2 * t + p.f1;
        p.f1 = p.f1 * t + p.f0;
        p.f0 = p.f0 * t + lanes_load(c + j * (int)LANES);
    }
    return p;
}

/* n_k over a window for one texel: MANY_TERMS coefficients a channel into `out`. */
static void window_data(const struct many_fast *f, const struct many_tile *tile, size_t w, size_t lane, double *out)
{
    size_t M = f->distinct, K = f->channels, m, k;
    const double *shape = f->shape + w * M * MANY_TERMS;

    for (k = 0; k < K; k++) {
        const double *sum = tile->sum + k * M * LANES + lane;
        lanes even = lanes_set(0.0), odd = even, third = even, fourth = even;

        for (m = 0; m + 4 <= M; m += 4) {
            even += lanes_load(shape + m * MANY_TERMS) * sum[m * LANES];
            odd += lanes_load(shape + (m + 1) * MANY_TERMS) * sum[(m + 1) * LANES];
            third += lanes_load(shape + (m + 2) * MANY_TERMS) * sum[(m + 2) * LANES];
            fourth += lanes_load(shape + (m + 3) * MANY_TERMS) * sum[(m + 3) * LANES];
        }
        for (; m < M; m++) {
            even += lanes_load(shape + m * MANY_TERMS) * sum[m * LANES];
        }
        lanes_store(out + k * MANY_TERMS, (even + odd) + (third + fourth));
    }
}

/* Where each texel is: a window, t in it, and polynomials there. */
struct climb {
    size_t window[MANY_TILE];
    double t[MANY_TILE], slope[MANY_TILE];
    double d[MANY_TERMS_D * LANES], u[MANY_TERMS * LANES];
};

static void enter_window(const struct many_fast *f, struct many_tile *tile, struct climb *c, size_t lane)
{
    const struct many_window *w = &f->window[c->window[lane]];
    size_t j, k;

    window_data(f, tile, c->window[lane], lane, tile->work);
    for (j = 0; j < MANY_TERMS_D; j++) {
        c->d[j * LANES + lane] = w->d[j];
    }
    for (j = 0; j < MANY_TERMS; j++) {
        c->u[j * LANES + lane] = w->u[j];
        for (k = 0; k < f->channels; k++) {
            tile->n[(k * MANY_TERMS + j) * LANES + lane] = tile->work[k * MANY_TERMS + j];
        }
    }
}

/* Gain beyond sum omega^2, its slope and curvature by t. */
static void gain_at(const struct many_fast *f, const struct many_tile *tile, const struct climb *c, const lanes *at,
                    lanes out[3])
{
    lanes t = *at, zero = lanes_set(0.0);
    struct taylor d = taylor_rows(c->d, MANY_TERMS_D, t), u = taylor_rows(c->u, MANY_TERMS, t), h;
    size_t k;

    h.f0 = d.f0 + u.f0 * u.f0;
    h.f1 = d.f1 + 2.0 * u.f0 * u.f1;
    h.f2 = d.f2 + u.f1 * u.f1 + 2.0 * u.f0 * u.f2;
    out[0] = out[1] = out[2] = zero;
    for (k = 0; k < f->channels; k++) {
        struct taylor n = taylor_rows(tile->n + k * MANY_TERMS * LANES, MANY_TERMS, t);
        lanes omega = lanes_load(tile->omega + k * LANES);
        lanes_mask free = ~lanes_below(omega * d.f0, n.f0 * u.f0); /* x = omega - u n / D */
        lanes f0 = n.f0 + lanes_select(free, zero, omega * u.f0), f1 = n.f1 + lanes_select(free, zero, omega * u.f1);
        lanes f2 = n.f2 + lanes_select(free, zero, omega * u.f2);
        lanes g0 = lanes_select(free, d.f0, h.f0), g1 = lanes_select(free, d.f1, h.f1);
        lanes g2 = lanes_select(free, d.f2, h.f2);
        lanes y = lanes_max(f0, zero) / g0, dy = (f1 - y * g1) / g0, part = 2.0 * f1 - y * g1;

        dy = lanes_select(lanes_below(zero, y), dy, zero);
        out[0] += y * lanes_max(f0, zero) - lanes_select(free, zero, omega * omega);
        out[1] += y * part;
        out[2] += dy * part + y * (4.0 * f2 - dy * g1 - 2.0 * y * g2);
    }
}

/* Newton steps of the texels in `active`, each inside its window. */
static void climb_window(const struct many_fast *f, const struct many_tile *tile, struct climb *c,
                         const lanes_mask *active)
{
    lanes t = lanes_load(c->t), best = t, one = lanes_set(1.0), zero = lanes_set(0.0), most, value[3], slope;
    int i;

    gain_at(f, tile, c, &t, value);
    most = value[0];
    slope = value[1];
    for (i = 0; i < CLIMB_STEPS; i++) {
        lanes uphill = lanes_select(lanes_below(zero, value[1]), lanes_set(0.4), lanes_set(-0.4));
        lanes step = lanes_select(lanes_below(value[2], zero), -value[1] / value[2], uphill);
        lanes_mask better;

        step = lanes_max(lanes_min(step, lanes_set(0.8)), lanes_set(-0.8));
        t = lanes_max(lanes_min(t + step, one), -one);
        gain_at(f, tile, c, &t, value);
        better = ~lanes_below(value[0], most);
        most = lanes_select(better, value[0], most);
        best = lanes_select(better, t, best);
        slope = lanes_select(better, value[1], slope);
    }
    lanes_store(c->t, lanes_select(*active, best, lanes_load(c->t)));
    lanes_store(c->slope, lanes_select(*active, slope, lanes_load(c->slope)));
}

/* Exact objective at s, from the residuals of every sample, and the coefficients of a / |a| and b phi. */
static void evaluate(const struct many_fast *f, struct many_tile *tile, const double *at, double *x_out, double *y_out,
                     double *objective)
{
    size_t K = f->channels, M = f->distinct, m, k, i;
    lanes s = lanes_load(at), zero = lanes_set(0.0), u = zero, h = zero, d = zero, e2 = zero;
    double inverse_a = f->root_a > 0.0 ? 1.0 / f->root_a : 0.0;

    for (m = 0; m < M; m++) {
        lanes phi = lanes_exp(s * -f->c[m]);

        lanes_store(tile->phi + m * LANES, phi);
        u += phi * f->ab[m];
        h += (phi * phi) * f->bb[m];
    }
    for (m = 0; m <= M; m++) {
        lanes phi = m < M ? lanes_load(tile->phi + m * LANES) : zero;
        size_t end = m < M ? f->begin[m + 1] : f->used;

        for (i = f->begin[m]; i < end; i++) {
            lanes rest = phi * f->b[i] - u * (f->a[i] * inverse_a);

            d += rest * rest;
        }
    }
    for (k = 0; k < K; k++) {
        const double *sum = tile->sum + k * M * LANES;
        lanes n = zero, omega = lanes_load(tile->omega + k * LANES), x, y;

        for (m = 0; m < M; m++) {
            n += lanes_load(sum + m * LANES) * lanes_load(tile->phi + m * LANES);
        }
        y = lanes_max(n / d, zero);
        x = omega - y * u;
        y = lanes_select(lanes_below(x, zero), lanes_max((n + omega * u) / h, zero), y);
        x = lanes_max(x, zero);
        lanes_store(x_out + k * LANES, x);
        lanes_store(y_out + k * LANES, y);
        for (m = 0; m <= M; m++) {
            lanes lobe = m < M ? y * lanes_load(tile->phi + m * LANES) : zero;
            size_t end = m < M ? f->begin[m + 1] : f->used;

            for (i = f->begin[m]; i < end; i++) {
                lanes rest = lanes_load(tile->value + (i * K + k) * LANES) - x * (f->a[i] * inverse_a) -
                             lobe * f->b[i];

                e2 += rest * rest;
            }
        }
    }
    lanes_store(objective, e2);
}

#endif
