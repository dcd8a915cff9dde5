/*
 * Sums over distinct c, and vectors of rows: a part of kernels_body.h. Lane l of a sum takes places l, l + LANES, ...;
 * the lanes of one register at a time. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_SUMS_H
#define BRDFFIT_KERNELS_SUMS_H

#include "kernels/kernels.h"
#include "base/lanes.h"

#define EACH_PART(part) for (part = 0; part < LANES; part += VEC)

static void exponential_shape(const double *c, size_t n, double u, double *phi)
{
    vec minus_u = vec_set(-u);
    size_t j;

    for (j = 0; j < n; j += VEC) {
        vec_store(phi + j, vec_exp(vec_load(c + j) * minus_u));
    }
}

static void ggx_shape(const double *c, size_t n, double u, double *phi)
{
    size_t j;

    for (j = 0; j < n; j += VEC) {
        vec root = 1.0 / (1.0 + vec_load(c + j) * u);

        vec_store(phi + j, root * root);
    }
}

static void ggx_slopes(const double *c, size_t n, double u, double *minus_ell, double *slope)
{
    size_t j;

    for (j = 0; j < n; j += VEC) {
        vec at = vec_load(c + j), x = 2.0 * at / (1.0 + at * u);

        vec_store(minus_ell + j, x);
        vec_store(slope + j, 0.5 * x * x);
    }
}

/*
 * bb phi^2 at j and on. A product that underflows costs a hundred cycles; phi below 1e-150 counts as 0 here, which moves
 * sum bb phi^2, at least the bb of phi = 1, by less than 1e-20 of itself (LIMIT_COEFFICIENT_RATIO).
 */
LANES_INLINE vec weight_at(const double *bb, const double *phi, size_t j)
{
    vec f = vec_load(phi + j);

    f = vec_select(f > vec_set(1e-150), f, vec_set(0.0));
    return vec_load(bb + j) * (f * f);
}

/* bb phi psi, 0 where c is beyond `limit`: the same for two shapes. */
LANES_INLINE vec pair_weight_at(const double *bb, const double *phi, const double *psi, const double *c, double limit,
                                size_t j)
{
    vec q = vec_load(psi + j);

    q = vec_select(vec_load(c + j) < vec_set(limit), q, vec_set(0.0));
    return vec_load(bb + j) * (vec_load(phi + j) * q);
}

static double weigh(const double *bb, const double *phi, const double *x, size_t n, double *first)
{
    double h[LANES], h1[LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec sum = vec_set(0.0), moment = sum;

        for (j = part; j < n; j += LANES) {
            vec p = weight_at(bb, phi, j);

            sum += p;
            moment += p * vec_load(x + j);
        }
        vec_store(h + part, sum);
        vec_store(h1 + part, moment);
    }
    *first = lanes_total_of(h1);
    return lanes_total_of(h);
}

static void central(const double *bb, const double *phi, const double *x, double mean, size_t n, double m[3])
{
    double out[3][LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec m2 = vec_set(0.0), m3 = m2, m4 = m2;

        for (j = part; j < n; j += LANES) {
            vec d = vec_load(x + j) - mean, d2 = d * d, pd2 = weight_at(bb, phi, j) * d2;

            m2 += pd2;
            m3 += pd2 * d;
            m4 += pd2 * d2;
        }
        vec_store(out[0] + part, m2);
        vec_store(out[1] + part, m3);
        vec_store(out[2] + part, m4);
    }
    for (j = 0; j < 3; j++) {
        m[j] = lanes_total_of(out[j]);
    }
}

static void functional(const double *w, const double *phi, const double *x, double mean, size_t n,
                       struct functional *out)
{
    double f[3][LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec f0 = vec_set(0.0), f1 = f0, f2 = f0;

        for (j = part; j < n; j += LANES) {
            vec d = vec_load(x + j) - mean, term = vec_load(w + j) * vec_load(phi + j), moment = term * d;

            f0 += term;
            f1 += moment;
            f2 += moment * d;
        }
        vec_store(f[0] + part, f0);
        vec_store(f[1] + part, f1);
        vec_store(f[2] + part, f2);
    }
    out->f0 = lanes_total_of(f[0]);
    out->f1 = lanes_total_of(f[1]);
    out->f2 = lanes_total_of(f[2]);
}

static void functionals(const double *linear, size_t count, const double *phi, const double *x, double mean, size_t n,
                        struct functional *out)
{
    size_t f;

    for (f = 0; f < count; f++) {
        functional(linear + f * n, phi, x, mean, n, &out[f]);
    }
}

static void pair(const double *bb, const double *phi, const double *psi, const double *c, double limit, size_t n,
                 double out[3])
{
    double sum[LANES], first[LANES], second[LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec s = vec_set(0.0), f = s;

        for (j = part; j < n; j += LANES) {
            vec p = pair_weight_at(bb, phi, psi, c, limit, j);

            s += p;
            f += p * vec_load(c + j);
        }
        vec_store(sum + part, s);
        vec_store(first + part, f);
    }
    out[0] = lanes_total_of(sum);
    out[1] = out[2] = 0.0;
    if (!(out[0] > 0.0)) {
        return;
    }
    out[1] = lanes_total_of(first) / out[0];
    EACH_PART(part)
    {
        vec s = vec_set(0.0);

        for (j = part; j < n; j += LANES) {
            vec p = pair_weight_at(bb, phi, psi, c, limit, j), d = vec_load(c + j) - out[1];

            s += p * (d * d);
        }
        vec_store(second + part, s);
    }
    out[2] = lanes_total_of(second) / out[0];
}

/* Ranges over an interval of (x - mean)^2 at places j and on; both x and the mean fall. */
LANES_INLINE void square_range(const struct local *at, size_t j, vec *low, vec *high)
{
    const vec zero = vec_set(0.0);
    vec down = vec_load(at->x_high + j) - at->mean_low, up = vec_load(at->x_low + j) - at->mean_high;
    vec a = down * down, b = up * up;

    *high = vec_max(a, b);
    *low = vec_select(down > zero, a, vec_select(up < zero, b, zero));
}

LANES_INLINE vec load_or_zero(const double *v, size_t j)
{
    return v ? vec_load(v + j) : vec_set(0.0);
}

static void curvature(const double *bb, const double *phi_low, const double *phi_high, const struct local *at, size_t n,
                      double out[2])
{
    double below[LANES], above[LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec least = vec_set(0.0), most = least, low, high;

        for (j = part; j < n; j += LANES) {
            vec w = vec_load(bb + j), f = vec_load(phi_high + j), g = vec_load(phi_low + j);

            square_range(at, j, &low, &high);
            least += w * (f * f) * (load_or_zero(at->slope_high, j) + 2.0 * low);
            most += w * (g * g) * (load_or_zero(at->slope_low, j) + 2.0 * high);
        }
        vec_store(below + part, least);
        vec_store(above + part, most);
    }
    out[0] = lanes_total_of(below);
    out[1] = lanes_total_of(above);
}

static void functional_curvature(const double *w, const double *phi_low, const double *phi_high, const struct local *at,
                                 size_t n, double out[2])
{
    double below[LANES], above[LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec least = vec_set(0.0), most = least, low, high;

        for (j = part; j < n; j += LANES) {
            vec weight = vec_load(w + j);

            square_range(at, j, &low, &high);
            least += weight * vec_load(phi_high + j) * (low + load_or_zero(at->slope_high, j));
            most += weight * vec_load(phi_low + j) * (high + load_or_zero(at->slope_low, j));
        }
        vec_store(below + part, least);
        vec_store(above + part, most);
    }
    out[0] = lanes_total_of(below);
    out[1] = lanes_total_of(above);
}

static double pair_curvature(const double *w, const double *phi, const double *psi, const struct local *at, size_t n)
{
    double above[LANES];
    size_t part, j;

    EACH_PART(part)
    {
        vec most = vec_set(0.0), low, high;

        for (j = part; j < n; j += LANES) {
            square_range(at, j, &low, &high);
            most += vec_load(w + j) * (vec_load(phi + j) * vec_load(psi + j)) * (high + load_or_zero(at->slope_low, j));
        }
        vec_store(above + part, most);
    }
    return lanes_total_of(above);
}

static double dot(const double *u, const double *v, size_t n)
{
    size_t whole = n / LANES * LANES, part, i;
    double sum[LANES], total;

    EACH_PART(part)
    {
        vec s = vec_set(0.0);

        for (i = part; i < whole; i += LANES) {
            s += vec_load(u + i) * vec_load(v + i);
        }
        vec_store(sum + part, s);
    }
    total = lanes_total_of(sum);
    for (i = whole; i < n; i++) {
        total += u[i] * v[i];
    }
    return total;
}

static double magnitude(const double *v, size_t n)
{
    vec most = vec_set(0.0);
    double lane[VEC], largest = 0.0;
    size_t i = 0;

    for (; i + VEC <= n; i += VEC) {
        most = vec_max(vec_abs(vec_load(v + i)), most);
    }
    vec_store(lane, most);
    for (; i < n; i++) {
        double last = v[i] < 0.0 ? -v[i] : v[i];

        largest = last > largest ? last : largest;
    }
    for (i = 0; i < VEC; i++) {
        largest = lane[i] > largest ? lane[i] : largest;
    }
    return largest;
}

static void subtract(double *v, const double *u, double inner, double factor, size_t n)
{
    size_t i = 0;

    for (; i + VEC <= n; i += VEC) {
        vec_store(v + i, vec_load(v + i) - factor * (inner * vec_load(u + i)));
    }
    for (; i < n; i++) {
        v[i] -= factor * (inner * u[i]);
    }
}

static void scale(double *v, const double *u, double factor, size_t n)
{
    size_t i = 0;

    for (; i + VEC <= n; i += VEC) {
        vec_store(v + i, factor * vec_load(u + i));
    }
    for (; i < n; i++) {
        v[i] = factor * u[i];
    }
}

#endif
