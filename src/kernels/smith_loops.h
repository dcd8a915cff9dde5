/*
 * Lobes with Smith masking, sample by sample: phi, and -ell and slope (model/smith.h has the formulas, and their errors).
 * c: tan^2 alpha less c_min; light, view: tan^2 of the angles of light and viewer with the normal. n is a multiple of VEC.
 * All terms are positive, so that nothing cancels but what model/smith.h names. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_SMITH_H
#define BRDFFIT_KERNELS_SMITH_H

#include "base/erf.h"
#include "base/lanes.h"
#include "kernels/smith_point.h"

/* H' / H and its negative derivative. */
struct smith_lanes {
    vec x, slope;
};

/* ---- GGX ---- */

/* 1 - kappa tan^2, and the square root of tan^2 + (1 - kappa tan^2) u. */
LANES_INLINE vec smith_ggx_root(const struct smith_point *at, vec tan2, vec *rate)
{
    *rate = 1.0 - at->kappa * tan2;
    return vec_sqrt(tan2 + *rate * at->u);
}

/* One angle: M - tan^2 over the root, and the derivatives of both. */
struct smith_ggx_side {
    vec root, part, root_rise, part_fall;
};

LANES_INLINE struct smith_ggx_side smith_ggx_side(const struct smith_point *at, vec tan2)
{
    struct smith_ggx_side side;
    vec rate, inverse, half;

    side.root = smith_ggx_root(at, tan2, &rate);
    inverse = 1.0 / side.root;
    half = 0.5 * rate * inverse;
    side.part = (at->widest - tan2) * inverse;
    side.root_rise = half;
    side.part_fall = side.part * (half * inverse);
    return side;
}

/* x = E / (2 T S), S the sum of the roots and E that of the parts; slope = x (T'/T + S'/S) - E' / (2 T S). */
LANES_INLINE struct smith_lanes smith_ggx_pair(const struct smith_point *at, struct smith_ggx_side l,
                                               struct smith_ggx_side v)
{
    vec inverse = 1.0 / (l.root + v.root), half = 0.5 / at->level * inverse;
    struct smith_lanes out;

    out.x = (l.part + v.part) * half;
    out.slope = out.x * (at->rate / at->level + (l.root_rise + v.root_rise) * inverse) +
                (l.part_fall + v.part_fall) * half;
    return out;
}

LANES_INLINE struct smith_lanes smith_ggx_masking(const struct smith_point *at, vec light, vec view, int separable)
{
    struct smith_ggx_side l = smith_ggx_side(at, light), v = smith_ggx_side(at, view), normal;
    struct smith_lanes one, two;

    if (!separable) {
        return smith_ggx_pair(at, l, v);
    }
    normal = smith_ggx_side(at, vec_set(0.0));
    one = smith_ggx_pair(at, l, normal);
    two = smith_ggx_pair(at, v, normal);
    one.x += two.x;
    one.slope += two.slope;
    return one;
}

LANES_INLINE void smith_ggx_shape(const struct smith_point *at, const double *c, const double *light,
                                  const double *view, size_t n, int separable, double *phi)
{
    vec normal, l, v, rate;
    size_t j;

    normal = vec_sqrt(vec_set(at->u));
    for (j = 0; j < n; j += VEC) {
        vec shape = 1.0 / (1.0 + vec_load(c + j) * at->v);

        l = smith_ggx_root(at, vec_load(light + j), &rate);
        v = smith_ggx_root(at, vec_load(view + j), &rate);
        vec_store(phi + j, shape * shape * (at->scale / (separable ? (l + normal) * (v + normal) : l + v)));
    }
}

LANES_INLINE void smith_ggx_slopes(const struct smith_point *at, const double *c, const double *light,
                                   const double *view, size_t n, int separable, double *minus_ell, double *slope)
{
    size_t j;

    for (j = 0; j < n; j += VEC) {
        vec k = vec_load(c + j), half = k * at->fall / (1.0 + k * at->v), x = 2.0 * half;
        struct smith_lanes g = smith_ggx_masking(at, vec_load(light + j), vec_load(view + j), separable);

        vec_store(minus_ell + j, x + g.x);
        vec_store(slope + j, x * (at->bend + half) + g.slope);
    }
}

/* ---- Beckmann ---- */

/* One angle: y = sqrt(u) / tan, z = y^2, exp(-z), erf y, and r / sqrt(u) = erf y + exp(-z) / (y sqrt(pi)). */
struct smith_beckmann_side {
    vec y, z, gauss, erf, r;
};

LANES_INLINE struct smith_beckmann_side smith_beckmann_side(const struct smith_point *at, vec tan2)
{
    struct smith_beckmann_side side;
    vec short_y, short_z;

    side.z = at->u / vec_max(tan2, vec_set(at->u * (1.0 / SMITH_EXPONENT_MOST)));
    side.y = vec_sqrt(side.z);
    side.gauss = vec_exp(-side.z);
    short_y = vec_min(side.y, vec_set(ERF_LEVEL));
    short_z = vec_min(side.z, vec_set(ERF_LEVEL * ERF_LEVEL));
    side.erf = vec_erf_with(short_y, short_z, side.gauss);
    side.r = side.erf + 0.5641895835477563 * (side.gauss / side.y);
    return side;
}

/* 2 sqrt(u) P / M, P = T r' - r / 2; at most 1/8 of its first term is taken off. */
LANES_INLINE vec smith_beckmann_first(const struct smith_point *at, struct smith_beckmann_side side)
{
    return side.erf - at->share * (0.5641895835477563 * (side.gauss / side.y));
}

/* -4 u sqrt(u) P' / M; at most 3/8 of its first term is taken off. */
LANES_INLINE vec smith_beckmann_second(const struct smith_point *at, struct smith_beckmann_side side)
{
    vec short_z = vec_min(side.z, vec_set(1.0));
    vec rest = vec_erf_rest(side.y, short_z, side.gauss, side.erf);

    return rest - at->share * (1.1283791670955126 * (side.y * side.gauss));
}

/* x = D = M p / (2 u T r), slope = D^2 + 3 D / (2 T) + M k / (4 u^2 T r): sums over the angles of p, k and r. */
LANES_INLINE struct smith_lanes smith_beckmann_quotient(const struct smith_point *at, vec p, vec k, vec r)
{
    vec inverse = 1.0 / r;
    struct smith_lanes out;

    out.x = at->first * (p * inverse);
    out.slope = out.x * (out.x + 1.5 / at->level) + at->second * (k * inverse);
    return out;
}

LANES_INLINE struct smith_lanes smith_beckmann_masking(const struct smith_point *at, vec light, vec view, int separable)
{
    struct smith_beckmann_side l = smith_beckmann_side(at, light), v = smith_beckmann_side(at, view);
    vec p = smith_beckmann_first(at, l), q = smith_beckmann_first(at, v);
    vec k = smith_beckmann_second(at, l), m = smith_beckmann_second(at, v);
    struct smith_lanes one, two;

    if (!separable) {
        return smith_beckmann_quotient(at, p + q, k + m, l.r + v.r);
    }
    one = smith_beckmann_quotient(at, 1.0 + p, 1.0 + k, 1.0 + l.r);
    two = smith_beckmann_quotient(at, 1.0 + q, 1.0 + m, 1.0 + v.r);
    one.x += two.x;
    one.slope += two.slope;
    return one;
}

LANES_INLINE void smith_beckmann_shape(const struct smith_point *at, const double *c, const double *light,
                                       const double *view, size_t n, int separable, double *phi)
{
    size_t j;

    for (j = 0; j < n; j += VEC) {
        vec l = smith_beckmann_side(at, vec_load(light + j)).r, v = smith_beckmann_side(at, vec_load(view + j)).r;
        vec shape = vec_exp(vec_load(c + j) * -at->u);

        vec_store(phi + j, shape * (at->scale / (separable ? (1.0 + l) * (1.0 + v) : l + v)));
    }
}

LANES_INLINE void smith_beckmann_slopes(const struct smith_point *at, const double *c, const double *light,
                                        const double *view, size_t n, int separable, double *minus_ell, double *slope)
{
    size_t j;

    for (j = 0; j < n; j += VEC) {
        struct smith_lanes g = smith_beckmann_masking(at, vec_load(light + j), vec_load(view + j), separable);

        vec_store(minus_ell + j, vec_load(c + j) + g.x);
        vec_store(slope + j, g.slope);
    }
}

#endif
