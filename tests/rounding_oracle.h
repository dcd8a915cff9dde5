/*
 * Geometry in 113 bits: a, b, c of every distribution from directions that are doubles, or from others within a known
 * distance. Written from brdffit.h and the angles, shares no code with the library. Include once, in a test that links
 * libquadmath. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ROUNDING_ORACLE_H
#define BRDFFIT_TESTS_ROUNDING_ORACLE_H

#include <quadmath.h>
#include <stddef.h>

#include "brdffit.h"

__extension__ typedef __float128 quad;

struct oracle_angles {
    quad light, view, tan2, difference, off, mirror,
        apart2; /* n.l, n.v, tan^2 alpha, v.h, 1 - r.v, r.v, |l - v|^2 / 4 */
};

struct oracle_row {
    quad a, b, c;
};

static inline quad oracle_pi(void)
{
    return 4 * atanq(1);
}

/* As if in several times 113 bits: error-free transformations move each rounding to the next lower term. */
static inline quad oracle_sum(quad *term, int n)
{
    quad sum = 0;
    int pass, i;

    for (pass = 0; pass < 4; pass++) {
        for (i = 1; i < n; i++) {
            quad x = term[i] + term[i - 1], z = x - term[i];

            term[i - 1] = (term[i] - (x - z)) + (term[i - 1] - z);
            term[i] = x;
        }
    }
    for (i = 0; i < n; i++) {
        sum += term[i];
    }
    return sum;
}

static inline quad oracle_dot(const quad *u, const quad *v)
{
    quad term[3] = {u[0] * v[0], u[1] * v[1], u[2] * v[2]};

    return oracle_sum(term, 3);
}

static inline void oracle_cross(const quad *u, const quad *v, quad *out)
{
    int j;

    for (j = 0; j < 3; j++) {
        quad term[2] = {u[(j + 1) % 3] * v[(j + 2) % 3], -u[(j + 2) % 3] * v[(j + 1) % 3]};

        out[j] = oracle_sum(term, 2);
    }
}

static inline struct oracle_angles oracle_angles(const quad *l, const quad *v, const quad *n)
{
    quad nxl[3], nxv[3], across = 0, half = 0, apart = 0, dot[3], length_l = sqrtq(oracle_dot(l, l)),
                         length_v = sqrtq(oracle_dot(v, v));
    quad length_n = sqrtq(oracle_dot(n, n));
    struct oracle_angles at;
    int j;

    at.light = oracle_dot(n, l) / (length_n * length_l);
    at.view = oracle_dot(n, v) / (length_n * length_v);
    oracle_cross(n, l, nxl);
    oracle_cross(n, v, nxv);
    for (j = 0; j < 3; j++) {
        quad part = (nxl[j] * length_v + nxv[j] * length_l) / (length_n * length_l * length_v);
        quad h = l[j] / length_l + v[j] / length_v, d = l[j] / length_l - v[j] / length_v;

        across += part * part;
        half += h * h;
        apart += d * d;
        dot[j] = l[j] * v[j];
    }
    at.tan2 = across / ((at.light + at.view) * (at.light + at.view));
    at.difference = sqrtq(half) / 2;
    at.apart2 = apart / 4;
    at.off = ((at.light - at.view) * (at.light - at.view) + across) / 2;
    at.mirror = 2 * at.light * at.view - oracle_sum(dot, 3) / (length_l * length_v);
    return at;
}

static inline struct oracle_row oracle_row(brdffit_distribution distribution, const struct oracle_angles *at)
{
    quad pi = oracle_pi(), shared = 2 / (sqrtq(1 + at->tan2) * at->difference), angle = atanq(sqrtq(at->tan2));
    quad g = fminq(1, shared * fminq(at->view, at->light));
    struct oracle_row row = {at->light / pi, at->light, log1pq(at->tan2) / 2};

    switch (distribution) {
    case BRDFFIT_BLINN_PHONG: break;
    case BRDFFIT_TORRANCE_SPARROW:
        row.b = g / (pi * at->view);
        row.c = angle * angle;
        break;
    case BRDFFIT_WARD:
        row.b = sqrtq(at->light / at->view) / (4 * pi);
        row.c = at->tan2;
        break;
    case BRDFFIT_ASHIKHMIN_SHIRLEY: row.b = at->light / (at->difference * fmaxq(at->light, at->view)); break;
    case BRDFFIT_LAFORTUNE:
        row.b = at->mirror > 0 ? at->light : 0;
        row.c = !(at->mirror > 0) ? 0 : at->off < (quad)0.5 ? -log1pq(-at->off) : -logq(at->mirror);
        break;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
        row.b = g / (pi * at->view) * (1 + at->tan2) * (1 + at->tan2);
        row.c = at->tan2;
        break;
    case BRDFFIT_RETRO:
        row.b = at->light;
        row.c = 4 * at->apart2;
        break;
    case BRDFFIT_DISTRIBUTION_COUNT: row.b = row.c = nanq(""); break;
    }
    return row;
}

static inline int oracle_by_exponent(brdffit_distribution distribution)
{
    switch (distribution) { /* no default: the compiler names a distribution that is missing */
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_TORRANCE_SPARROW:
    case BRDFFIT_WARD:
    case BRDFFIT_RETRO:
    case BRDFFIT_DISTRIBUTION_COUNT: return 0;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
    case BRDFFIT_LAFORTUNE: return 1;
    }
    return 0;
}

/* lambda(s) phi(s, c) / phi(s, c_min). */
static inline quad oracle_shape(brdffit_distribution distribution, quad s, quad c, quad c_min)
{
    quad ratio = (1 + c_min * s) / (1 + c * s);

    return distribution == BRDFFIT_GGX ? ratio * ratio : expq(-(c - c_min) * s);
}

static inline quad oracle_lambda(brdffit_distribution distribution, quad s)
{
    switch (distribution) {
    case BRDFFIT_TORRANCE_SPARROW: return 1;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_LAFORTUNE: return (s + 2) / (2 * oracle_pi());
    case BRDFFIT_ASHIKHMIN_SHIRLEY: return (s + 1) / (8 * oracle_pi());
    case BRDFFIT_RETRO: return s / oracle_pi();
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_WARD: return s;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return nanq("");
}

#endif
