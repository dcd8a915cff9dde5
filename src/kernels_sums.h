/*
 * Sums over distinct c, and vectors of rows: a part of kernels_body.h. Layer 1. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_SUMS_H
#define BRDFFIT_KERNELS_SUMS_H

#include "kernels.h"
#include "lanes.h"

static void exponential_shape(const double *c, size_t n, double u, double *phi)
{
    lanes minus_u = lanes_set(-u);
    size_t j;

    for (j = 0; j < n; j += LANES) {
        lanes_store(phi + j, lanes_exp(lanes_load(c + j) * minus_u));
    }
}

/* bb phi^2 at j .. j + 7. */
LANES_INLINE lanes weight_at(const double *bb, const double *phi, size_t j)
{
    lanes f = lanes_load(phi + j);

    return lanes_load(bb + j) * (f * f);
}

static double weigh(const double *bb, const double *phi, const double *x, size_t n, double *first)
{
    lanes h = lanes_set(0.0), h1 = h;
    size_t j;

    for (j = 0; j < n; j += LANES) {
        lanes p = weight_at(bb, phi, j);

        h += p;
        h1 += p * lanes_load(x + j);
    }
    *first = lanes_total(h1);
    return lanes_total(h);
}

static void central(const double *bb, const double *phi, const double *x, double mean, size_t n, double m[3])
{
    lanes m2 = lanes_set(0.0), m3 = m2, m4 = m2;
    size_t j;

    for (j = 0; j < n; j += LANES) {
        lanes d = lanes_load(x + j) - mean, d2 = d * d, pd2 = weight_at(bb, phi, j) * d2;

        m2 += pd2;
        m3 += pd2 * d;
        m4 += pd2 * d2;
    }
    m[0] = lanes_total(m2);
    m[1] = lanes_total(m3);
    m[2] = lanes_total(m4);
}

static void functionals(const double *linear, size_t count, const double *phi, const double *x, double mean, size_t n,
                        struct functional *out)
{
    size_t f, j;

    for (f = 0; f < count; f++) {
        const double *w = linear + f * n;
        lanes f0 = lanes_set(0.0), f1 = f0, f2 = f0;

        for (j = 0; j < n; j += LANES) {
            lanes d = lanes_load(x + j) - mean, term = lanes_load(w + j) * lanes_load(phi + j), moment = term * d;

            f0 += term;
            f1 += moment;
            f2 += moment * d;
        }
        out[f].f0 = lanes_total(f0);
        out[f].f1 = lanes_total(f1);
        out[f].f2 = lanes_total(f2);
    }
}

static void pair(const double *bb, const double *phi, const double *psi, const double *c, size_t n, double out[3])
{
    lanes sum = lanes_set(0.0), first = sum, second = sum;
    size_t j;

    for (j = 0; j < n; j += LANES) {
        lanes p = lanes_load(bb + j) * (lanes_load(phi + j) * lanes_load(psi + j));

        sum += p;
        first += p * lanes_load(c + j);
    }
    out[0] = lanes_total(sum);
    out[1] = out[2] = 0.0;
    if (!(out[0] > 0.0)) {
        return;
    }
    out[1] = lanes_total(first) / out[0];
    for (j = 0; j < n; j += LANES) {
        lanes p = lanes_load(bb + j) * (lanes_load(phi + j) * lanes_load(psi + j)), d = lanes_load(c + j) - out[1];

        second += p * (d * d);
    }
    out[2] = lanes_total(second) / out[0];
}

static double dot(const double *u, const double *v, size_t n)
{
    lanes sum = lanes_set(0.0);
    double total;
    size_t i = 0;

    for (; i + LANES <= n; i += LANES) {
        sum += lanes_load(u + i) * lanes_load(v + i);
    }
    total = lanes_total(sum);
    for (; i < n; i++) {
        total += u[i] * v[i];
    }
    return total;
}

static double magnitude(const double *v, size_t n)
{
    lanes most = lanes_set(0.0);
    double lane[LANES], largest = 0.0;
    size_t i = 0;

    for (; i + LANES <= n; i += LANES) {
        most = lanes_max(lanes_abs(lanes_load(v + i)), most);
    }
    lanes_store(lane, most);
    for (; i < n; i++) {
        double last = v[i] < 0.0 ? -v[i] : v[i];

        largest = last > largest ? last : largest;
    }
    for (i = 0; i < LANES; i++) {
        largest = lane[i] > largest ? lane[i] : largest;
    }
    return largest;
}

static void subtract(double *v, const double *u, double inner, double factor, size_t n)
{
    size_t i = 0;

    for (; i + LANES <= n; i += LANES) {
        lanes_store(v + i, lanes_load(v + i) - factor * (inner * lanes_load(u + i)));
    }
    for (; i < n; i++) {
        v[i] -= factor * (inner * u[i]);
    }
}

static void scale(double *v, const double *u, double factor, size_t n)
{
    size_t i = 0;

    for (; i + LANES <= n; i += LANES) {
        lanes_store(v + i, factor * lanes_load(u + i));
    }
    for (; i < n; i++) {
        v[i] = factor * u[i];
    }
}

#endif
