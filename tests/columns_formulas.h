/*
 * Lobes with Fresnel and masking and the diffuse terms of brdffit.h in long double, written from the literature and not from
 * the library: Schlick 1994, Walter et al. 2007 and Heitz 2014 (Smith), Oren and Nayar 1994, Burley 2012.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_COLUMNS_FORMULAS_H
#define BRDFFIT_TESTS_COLUMNS_FORMULAS_H

#include <math.h>

#include "verify_distributions.h"

#define COLUMNS_FIXED 3

/* What a sample is, whatever form it came in. */
struct columns_angles {
    struct verify_angles angles;
    long double tan2_light, tan2_view, lv;             /* tan^2 of the angles with the normal, l.v */
    long double versine, versine_light, versine_view; /* 1 - v.h, 1 - n.l, 1 - n.v */
};

/* (1 - t)^5; below 1e-100 it counts as 0. */
static inline long double columns_fifth(long double versine)
{
    return versine < 1e-20L ? 0.0L : powl(versine, 5.0L);
}

static inline void columns_diffuse(brdffit_diffuse diffuse, const struct columns_angles *at, long double *column)
{
    long double a = at->angles.nl / VERIFY_PI, d = at->angles.vh, light = columns_fifth(at->versine_light);
    long double view = columns_fifth(at->versine_view), larger = fmaxl(at->angles.nl, at->angles.nv), product;

    column[0] = diffuse == BRDFFIT_DIFFUSE_NONE ? 0.0L : a;
    if (diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR) {
        product = (at->lv - at->angles.nl * at->angles.nv) / larger;
        column[1] = product < 1e-12L ? 0.0L : a * product;
    } else if (diffuse == BRDFFIT_DIFFUSE_BURLEY) { /* (1 + (F90 - 1) Fl) (1 + (F90 - 1) Fv), F90 - 1 = 2 r d^2 - 1/2 */
        column[0] = a * (1.0L - light / 2.0L) * (1.0L - view / 2.0L);
        column[1] = a * 2.0L * d * d * ((1.0L - view / 2.0L) * light + (1.0L - light / 2.0L) * view);
        column[2] = a * 4.0L * powl(d, 4.0L) * light * view;
    }
}

/* Lambda of Smith's masking. */
static inline long double columns_lambda(brdffit_distribution distribution, long double s, long double tan2)
{
    long double a;

    if (!(tan2 > 0.0L)) {
        return 0.0L;
    }
    if (distribution == BRDFFIT_GGX) {
        return 0.5L * tan2 / s / (1.0L + sqrtl(1.0L + tan2 / s));
    }
    a = sqrtl(s / tan2);
    return 0.5L * (expl(-a * a) / (a * sqrtl(VERIFY_PI)) - erfcl(a));
}

static inline long double columns_masking(brdffit_masking masking, brdffit_distribution distribution, long double s,
                                          const struct columns_angles *at)
{
    long double light, view;

    if (masking == BRDFFIT_MASKING_V_CAVITY) {
        return verify_shadowing(&at->angles);
    }
    if (masking == BRDFFIT_MASKING_NONE) {
        return 1.0L;
    }
    light = columns_lambda(distribution, s, at->tan2_light);
    view = columns_lambda(distribution, s, at->tan2_view);
    return masking == BRDFFIT_MASKING_SMITH ? 1.0L / (1.0L + light + view) : 1.0L / ((1.0L + light) * (1.0L + view));
}

/* ln of g = b lambda(s) phi(s, c); -INFINITY where there is no lobe. */
static inline long double columns_log_lobe(brdffit_distribution distribution, brdffit_masking masking, long double s,
                                           const struct columns_angles *at)
{
    struct verify_sample row;

    verify_row(distribution, &at->angles, &row);
    if (distribution <= BRDFFIT_GGX) { /* the table's G with another */
        row.b *= columns_masking(masking, distribution, s, at) / verify_shadowing(&at->angles);
    }
    if (!(row.b > 0.0L)) {
        return -INFINITY;
    }
    if (distribution == BRDFFIT_GGX) {
        return logl(row.b) + logl(s) - 2.0L * log1pl(row.c * s);
    }
    return logl(row.b) - row.c * s + logl(verify_lobe(distribution, 0.0L, 1.0L / sqrtl(s)));
}

#endif
