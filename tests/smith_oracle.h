/*
 * Lobes with Smith masking in 113 bits, from the definitions of Walter et al. 2007 and Heitz 2014 and plain calculus;
 * shares no formula with src/kernels/smith_loops.h but the scalars by which model/smith.h divides.
 * SPDX-License-Identifier: MIT
 *
 * masking() and normals() are the definition. local() gives phi, -ell and slope by u, from H = numerator and its two
 * derivatives with the quotient rule: GGX from w = h^2, Beckmann from d and its derivatives by s, where what cancels is
 * taken from a series or, where exp(-s / tau^2) is 0 even here, from d = sqrt s.
 */
#ifndef BRDFFIT_TESTS_SMITH_ORACLE_H
#define BRDFFIT_TESTS_SMITH_ORACLE_H

#include "model/smith.h"
#include "quad/quad.h"

/* A function with two derivatives. */
struct jet {
    quad f, d1, d2;
};

static inline int oracle_separable(enum smith_family family)
{
    return family == SMITH_GGX_SEPARABLE || family == SMITH_BECKMANN_SEPARABLE;
}

static inline int oracle_exponential(enum smith_family family)
{
    return family == SMITH_BECKMANN || family == SMITH_BECKMANN_SEPARABLE;
}

/* ---- The definition -------------------------------------------------------------------------------------- */

/* Lambda of Heitz, a = 1 / (sigma tan theta). */
static inline quad oracle_lambda(enum smith_family family, quad s, quad tan2)
{
    quad root_pi = sqrtq(4 * atanq(1)), a;

    if (!(tan2 > 0)) {
        return 0;
    }
    a = sqrtq(s / tan2);
    if (!oracle_exponential(family)) {
        return (sqrtq(1 + tan2 / s) - 1) / 2;
    }
    return (expq(-a * a) / (a * root_pi) - erfcq(a)) / 2;
}

static inline quad oracle_masking(enum smith_family family, quad s, quad light, quad view)
{
    quad l = oracle_lambda(family, s, light), v = oracle_lambda(family, s, view);

    return oracle_separable(family) ? 1 / ((1 + l) * (1 + v)) : 1 / (1 + l + v);
}

static inline quad oracle_normals(enum smith_family family, quad s, quad c)
{
    return oracle_exponential(family) ? expq(-c * s) : 1 / ((1 + c * s) * (1 + c * s));
}

/* ---- h = d / sqrt(s + M) by u ------------------------------------------------------------------------------ */

static inline struct jet oracle_root(struct jet w)
{
    struct jet h = {sqrtq(w.f), 0, 0};

    h.d1 = w.d1 / (2 * h.f);
    h.d2 = (w.d2 / 2 - h.d1 * h.d1) / h.f;
    return h;
}

/* h^2 of GGX, or of any d^2 = s + tan2: a Moebius function of u. */
static inline struct jet oracle_moebius(const struct smith_scale *scale, quad u, quad tan2)
{
    quad M = scale->widest, rate = 1 - scale->kappa * M, level = M + rate * u;
    struct jet w = {(tan2 + (1 - scale->kappa * tan2) * u) / level, (M - tan2) / (level * level), 0};

    w.d2 = -2 * w.d1 * rate / level;
    return w;
}

/* r by s. r' is the mean of exp(-s v^2 / tan2) over v in [0, 1] over tan sqrt(pi), and r'' its derivative. */
static inline struct jet oracle_r(quad s, quad tan2)
{
    quad tangent = sqrtq(tan2), a = sqrtq(s / tan2), z = s / tan2, root_pi = sqrtq(4 * atanq(1)), term = 1;
    struct jet r = {sqrtq(s) * erfq(a) + tangent * expq(-z) / root_pi, erfq(a) / (2 * sqrtq(s)), 0};
    int n;

    if (z > 0.01) {
        r.d2 = (expq(-z) / (tangent * root_pi) - r.d1) / (2 * s);
        return r;
    }
    for (n = 1; n < 26; term *= -z / n, n++) {
        r.d2 -= term / (2 * n + 1) / (tangent * tan2 * root_pi);
    }
    return r;
}

static inline struct jet oracle_h(enum smith_family family, const struct smith_scale *scale, quad u, quad tan2)
{
    quad level = u + scale->widest, root = sqrtq(level);
    struct jet d, h;

    if (!oracle_exponential(family)) {
        return oracle_root(oracle_moebius(scale, u, tan2));
    }
    if (!(tan2 * 10000 > u)) {
        return oracle_root(oracle_moebius(scale, u, 0));
    }
    d = oracle_r(u, tan2);
    h.f = d.f / root;
    h.d1 = (d.d1 - d.f / (2 * level)) / root;
    h.d2 = (d.d2 - d.d1 / level + 3 * d.f / (4 * level * level)) / root;
    return h;
}

/* ---- phi, -ell, slope -------------------------------------------------------------------------------------- */

static inline struct jet oracle_mean(struct jet a, struct jet b)
{
    struct jet m = {(a.f + b.f) / 2, (a.d1 + b.d1) / 2, (a.d2 + b.d2) / 2};

    return m;
}

/* Times 1 / f: phi, -ell and slope. */
static inline void oracle_divide(struct jet *out, struct jet f)
{
    quad rise = f.d1 / f.f;

    out->f /= f.f;
    out->d1 += rise;
    out->d2 += rise * rise - f.d2 / f.f;
}

/* {phi, -ell, slope} by u; c: less c_min. */
static inline struct jet oracle_local(enum smith_family family, const struct smith_scale *scale, quad u, quad c,
                                      quad light, quad view)
{
    struct jet l = oracle_h(family, scale, u, light), v = oracle_h(family, scale, u, view);
    struct jet n = oracle_root(oracle_moebius(scale, u, 0)), out = {1, 0, 0};
    quad beyond = (quad)scale->c_min - scale->kappa, low = 1 + beyond * u, high = 1 + (beyond + c) * u;

    if (oracle_exponential(family)) {
        out.f = expq(-c * u);
        out.d1 = c;
    } else { /* ln phi = 2 ln low - 2 ln high */
        out.f = low / high * (low / high);
        out.d1 = 2 * c / (low * high);
        out.d2 = out.d1 * (beyond / low + (beyond + c) / high);
    }
    if (oracle_separable(family)) {
        oracle_divide(&out, oracle_mean(n, l));
        oracle_divide(&out, oracle_mean(n, v));
    } else {
        oracle_divide(&out, oracle_mean(l, v));
    }
    return out;
}

#endif
