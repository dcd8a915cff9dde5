/*
 * Families of lobes (theory 4.4). A family is g(s) = b factor(s) phi(u(s), c') with c' = c - c_min >= 0, where
 * phi(0, c') = 1, phi decreases in u and in c', and is log-convex in u, so that every moment of phi is a
 * decreasing function whose range on an interval is its two end values. -ell does not fall with c': so the cosine of two
 * lobes falls with their distance. The slope falls with u. The scalar factor only rescales y.
 *
 *   exponential: phi = exp(-c' u), u = s, factor = lambda(s) exp(-c_min s); the distributions differ in lambda
 *   GGX:         phi = (1 + c' u)^-2, u = s / (1 + c_min s), factor = s (1 + c_min s)^-2
 *                (dividing (1 + c s)^-2 by its value at c_min gives the same function of c' and u)
 *
 * The search runs over theta = ln s; derivatives of phi are with respect to u:
 * ell = d ln phi / du, slope = d ell / du. Layer 2. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FAMILY_H
#define BRDFFIT_FAMILY_H

#include <stddef.h>

#include "brdffit.h"
#include "kernels.h"

struct family {
    int exponential; /* the fast case: ell = -c' whatever u is, and slope = 0 */
    int by_exponent; /* the user's parameter is the exponent n = s, and not sigma = 1 / sqrt(s) */

    /* u and its first and second derivative by theta. */
    void (*variable)(double c_min, double theta, double u[3]);

    /* phi(u, c_j) for n (a multiple of LANES) values; NULL for exponential families: see brdffit_family_shape(). */
    void (*shape)(const double *c, size_t n, double u, double *phi);

    /* ell and slope at one c. */
    void (*slope)(double c, double u, double *ell, double *slope);

    /* lambda(s) phi(s, c_min): what y is divided by. 0 when it underflows. */
    double (*factor)(double c_min, double s);

    /*
     * An s beyond which phi(u(s), c_j) sqrt(bb_j / bb_0) is within exp(-TAIL_EXPONENT) of its limit for
     * every j > 0, so that nothing changes to rounding. 0 when nothing ever changes (m = 1).
     */
    double (*tail)(const double *c, const double *bb, size_t m, double c_min);

    /* ln(1 / phi(s, c_min)): how far the factor falls, but for lambda. */
    double (*exponent)(double c_min, double s);

    /* g / b at one (s, c): lambda(s) phi(s, c), for evaluation. */
    double (*evaluate)(double s, double c);
};

extern const struct family brdffit_family_exponential; /* lambda(s) = s */
extern const struct family brdffit_family_ggx;

/* The distribution must be one of ours. */
const struct family *brdffit_family_of(brdffit_distribution distribution);

/* phi(u, c_j) of any family, by the kernels where they have it. */
static inline void brdffit_family_shape(const struct family *family, const struct kernels *kernels, const double *c,
                                        size_t n, double u, double *phi)
{
    if (family->exponential) {
        kernels->exponential_shape(c, n, u, phi);
    } else {
        family->shape(c, n, u, phi);
    }
}

#endif
