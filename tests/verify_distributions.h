/*
 * verify.c: the table of distributions of brdffit.h in long double, row by row, with what the roundings of a
 * reasonable double implementation do to each number. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_VERIFY_DISTRIBUTIONS_H
#define BRDFFIT_TESTS_VERIFY_DISTRIBUTIONS_H

#include <math.h>

#include "brdffit.h"

#define VERIFY_PI 3.14159265358979323846264338327950288L
#define VERIFY_UNIT 1.1102230246251565e-16L

struct verify_sample {
    long double a, b, c, to_radiance;
    long double error_a, error_b, error_radiance; /* relative */
    long double error_c;                          /* absolute */
};

struct verify_angles {
    long double nl, nv, tan2, vh;
};

static inline int verify_by_exponent(brdffit_distribution distribution)
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

/* Range of sigma = 1/sqrt(s) that the options ask for. */
static inline double verify_lowest(const brdffit_options *o, brdffit_distribution distribution)
{
    return verify_by_exponent(distribution) ? 1.0 / sqrt(o->exponent_max) : o->sigma_min;
}

static inline double verify_highest(const brdffit_options *o, brdffit_distribution distribution)
{
    return verify_by_exponent(distribution) ? 1.0 / sqrt(o->exponent_min) : o->sigma_max;
}

static inline long double verify_shadowing(const struct verify_angles *angles)
{
    long double nh = 1.0L / sqrtl(1.0L + angles->tan2), shared = 2.0L * nh / angles->vh;

    return fminl(1.0L, fminl(shared * angles->nv, shared * angles->nl));
}

/* 1 - r.v, from the angles that samples are given in. */
static inline long double verify_off_mirror(const struct verify_angles *angles)
{
    long double sum = angles->nl + angles->nv, difference = angles->nl - angles->nv;

    return 0.5L * (difference * difference + angles->tan2 * sum * sum);
}

/* b and c. */
static inline void verify_row(brdffit_distribution distribution, const struct verify_angles *at,
                              struct verify_sample *out)
{
    long double cos2 = 1.0L / (1.0L + at->tan2), angle = atanl(sqrtl(at->tan2)), off;

    switch (distribution) {
    case BRDFFIT_TORRANCE_SPARROW:
        out->b = verify_shadowing(at) / (VERIFY_PI * at->nv);
        out->c = angle * angle;
        return;
    case BRDFFIT_WARD:
        out->b = at->nl / sqrtl(at->nl * at->nv) / (4.0L * VERIFY_PI);
        out->c = at->tan2;
        return;
    case BRDFFIT_BLINN_PHONG:
        out->b = at->nl;
        out->c = 0.5L * log1pl(at->tan2);
        return;
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
        out->b = at->nl / (at->vh * fmaxl(at->nl, at->nv));
        out->c = 0.5L * log1pl(at->tan2);
        return;
    case BRDFFIT_LAFORTUNE:
        off = verify_off_mirror(at);
        out->b = off < 1.0L ? at->nl : 0.0L;
        out->c = off < 1.0L ? -log1pl(-off) : 0.0L;
        return;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
        out->b = verify_shadowing(at) / (VERIFY_PI * at->nv * cos2 * cos2);
        out->c = at->tan2;
        return;
    case BRDFFIT_RETRO:
        out->b = at->nl;
        out->c = 4.0L * (1.0L - at->vh) * (1.0L + at->vh);
        return;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    out->b = out->c = NAN;
}

/*
 * Error of c: of its formula (none where c is tan^2 alpha itself), and for directions of the angle, 8 units, and of
 * merging (reduce.h); d(alpha^2) = 2 alpha, d(-ln cos) = tan alpha, d(-ln(1 - q)) = sqrt(2 q - q^2) / (1 - q).
 */
static inline long double verify_error_c(brdffit_distribution distribution, const struct verify_angles *at,
                                         int directions, long double c)
{
    long double tangent = sqrtl(at->tan2), root = sqrtl(c), u = VERIFY_UNIT, off, slope = NAN, merged;

    switch (distribution) {
    case BRDFFIT_TORRANCE_SPARROW: slope = 2.0L * root; break;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_ASHIKHMIN_SHIRLEY: slope = tangent; break;
    case BRDFFIT_RETRO: slope = 4.0L * root; break;
    case BRDFFIT_LAFORTUNE:
        off = verify_off_mirror(at);
        slope = off < 1.0L ? sqrtl(off * (2.0L - off)) / (1.0L - off) : 0.0L;
        break;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_WARD: return directions ? 16.0L * u * tangent * (1.0L + at->tan2) + 64.0L * u * u : 0.0L;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    merged = directions ? 16.0L * u * root * (1.0L + c) : 0.0L;
    return 8.0L * u * c + (directions || distribution == BRDFFIT_LAFORTUNE ? 8.0L * u * slope + 64.0L * u * u : 0.0L) +
           merged;
}

/* g / b: lambda(s) phi(c, s), s = 1 / sigma^2. */
static inline long double verify_lobe(brdffit_distribution distribution, long double c, long double sigma)
{
    long double s = 1.0L / (sigma * sigma), t = 1.0L + c * s;

    switch (distribution) {
    case BRDFFIT_GGX: return s / (t * t);
    case BRDFFIT_TORRANCE_SPARROW: return expl(-c * s);
    case BRDFFIT_ASHIKHMIN_SHIRLEY: return (s + 1.0L) / (8.0L * VERIFY_PI) * expl(-c * s);
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_LAFORTUNE: return (s + 2.0L) / (2.0L * VERIFY_PI) * expl(-c * s);
    case BRDFFIT_RETRO: return s / VERIFY_PI * expl(-c * s);
    case BRDFFIT_BECKMANN:
    case BRDFFIT_WARD: return s * expl(-c * s);
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return NAN;
}

#endif
