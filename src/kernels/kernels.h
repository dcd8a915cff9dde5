/*
 * Inner loops, one table per instruction set, all with the same bits (lanes.h). n counts doubles and is a multiple of
 * LANES unless a function says otherwise; sums run in lanes. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_H
#define BRDFFIT_KERNELS_H

#include <stddef.h>

#include "brdffit.h"

/* A functional of the lobe shape: f0 = sum W phi, and its first and second moment of x about a mean. */
struct functional {
    double f0, f1, f2;
};

/* One box with two lobes: sides 0 and 1, corners c = c0 + 2 c1 with c_i = 1 at the high end of side i (bound_gain.h). */
struct gains_two {
    size_t channels;
    const double *omega;     /* K */
    const double *tau[2][2]; /* [side][end]: K */
    const double *shift[2];  /* [side]: K, how far tau may rise above its chord */
    double cosine[3][4];     /* [kappa of side 0, of side 1, mu][corner] */
    double fall[3][2];       /* [the same][side]: how far it may fall below its chord along that side */
};

struct gains_one {
    size_t channels;
    const double *omega, *tau[2], *shift;
    double cosine[2], fall;
};

struct kernels {
    /* phi[j] = exp(-c[j] u); u >= 0. */
    void (*exponential_shape)(const double *c, size_t n, double u, double *phi);

    /* GGX: phi[j] = (1 + c[j] u)^-2; minus_ell = 2 c / (1 + c u) and slope = ell^2 / 2. */
    void (*ggx_shape)(const double *c, size_t n, double u, double *phi);
    void (*ggx_slopes)(const double *c, size_t n, double u, double *minus_ell, double *slope);

    /* sum bb phi^2, and *first = sum bb phi^2 x. */
    double (*weigh)(const double *bb, const double *phi, const double *x, size_t n, double *first);

    /* sums of bb phi^2 (x - mean)^p, p = 2, 3, 4. */
    void (*central)(const double *bb, const double *phi, const double *x, double mean, size_t n, double m[3]);

    /* `count` functionals with weights `linear + f n`. */
    void (*functionals)(const double *linear, size_t count, const double *phi, const double *x, double mean, size_t n,
                        struct functional *out);

    /* w = bb phi psi, 0 where c >= limit: sum w, and the mean and variance of c under w (0 where the sum is). */
    void (*pair)(const double *bb, const double *phi, const double *psi, const double *c, double limit, size_t n,
                 double out[3]);

    /* gain[c + 4 s]: J at corner c with the sides of subset s shifted (bit i: side i). With only_first, s < 2. */
    void (*gains_two)(const struct gains_two *in, int only_first, double gain[16]);

    /* An upper bound of J in the box from these, and how far the shift of each side lifts a corner at most. */
    double (*climb_two)(const double gain[16], double lift[2]);

    /* gain[c + 2 s] for one lobe: end c, shifted or not. */
    void (*gains_one)(const struct gains_one *in, double gain[4]);
    double (*climb_one)(const double gain[4]);

    /* u.v; largest |v|; v -= factor (inner u); v = factor u. Any n. */
    double (*dot)(const double *u, const double *v, size_t n);
    double (*magnitude)(const double *v, size_t n);
    void (*subtract)(double *v, const double *u, double inner, double factor, size_t n);
    void (*scale)(double *v, const double *u, double factor, size_t n);
};

/* Tables that this build has; the baseline always. */
extern const struct kernels brdffit_kernels_base;
extern const struct kernels brdffit_kernels_avx2;
extern const struct kernels brdffit_kernels_avx512;

/* The table of an instruction set, NULL where the build or the processor lacks it; AUTO: the best there is. */
const struct kernels *brdffit_kernels(brdffit_isa isa);

#endif
