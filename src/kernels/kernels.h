/*
 * Inner loops, one table per instruction set, all with the same bits (lanes.h). n counts doubles and is a multiple of
 * LANES unless a function says otherwise; sums run in lanes. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_H
#define BRDFFIT_KERNELS_H

#include <stddef.h>

#include "base/point.h"
#include "brdffit.h"
#include "kernels/smith_point.h"

/* A functional of the lobe shape: f0 = sum W phi, and its first and second moment of x about a mean. */
struct functional {
    double f0, f1, f2;
};

/* What a lobe that is not exponential does over an interval of u, at each c: x = -ell and slope at both ends (n each;
 * no slopes: 0), and the mean of x at both. */
struct local {
    const double *x_low, *x_high, *slope_low, *slope_high;
    double mean_low, mean_high;
};

/* Most columns of a model: without a shape, of a lobe, of all lobes, and all together. Less in a copy that is made without
 * them (tools/amalgamate), with room for four columns in any: restricted problems count on that. */
#ifdef BRDFFIT_WITHOUT_DIFFUSE
#define FIXED_MOST 1
#else
#define FIXED_MOST 3
#endif
#ifdef BRDFFIT_WITHOUT_FRESNEL
#define EACH_MOST 1
#else
#define EACH_MOST 2
#endif
#define MOVING_MOST (EACH_MOST * SIDES_MOST)
#define COLUMNS_MOST (FIXED_MOST + MOVING_MOST > 7 ? 7 : FIXED_MOST + MOVING_MOST < 4 ? 4 : FIXED_MOST + MOVING_MOST)

/* Off-diagonal cosines of so many columns, and which of them is that of columns i < j. */
#define COSINES(columns) ((columns) * ((columns) - 1) / 2)
#define COSINE(columns, i, j) ((i) * (2 * (columns) - (i) - 1) / 2 + (j) - (i) - 1)

/*
 * One box (theory 4.2, 7.5): its columns at both ends of their sides, and how far they may leave their chords. Columns are
 * the fixed ones, then `each` of every side in turn. Cosines are in the order 01, 02, .., 12, .. of columns. One of two fixed
 * columns has one value; of a fixed column and a side's, or of two columns of one side, values [end]; of two sides, values
 * [end of the first + 2 end of the second].
 */
struct gains {
    size_t channels;
    const double *omega[FIXED_MOST];    /* K: data along the fixed columns */
    const double *tau[MOVING_MOST][2];  /* [column of a side][end]: K */
    const double *shift[MOVING_MOST];   /* K, how far tau may rise above its chord */
    double cosine[COSINES(COLUMNS_MOST)][4];
    double fall[COSINES(COLUMNS_MOST)][2]; /* how far it may fall below its chord along its first and second side */
};

/*
 * Gains at `count` (a multiple of LANES) listed (t, M) of `columns` columns, where a lobe may have more sides than one:
 * cosine[e count + i], and t[(k columns + c) count + i].
 */
struct gains_list {
    size_t channels, count;
    unsigned columns;
    const double *cosine, *t;
};

/* Corners of a box with so many sides times the subsets of sides that are shifted. */
#define GAINS(sides) (1u << (2 * (sides)))

struct kernels {
    /* Whether these were compiled with products that are not rounded (base/ieee.h): then nothing may be made of them. */
    int (*contracts)(void);

    /* phi[j] = exp(-c[j] u); u >= 0. */
    void (*exponential_shape)(const double *c, size_t n, double u, double *phi);

    /* GGX: phi[j] = (1 + c[j] u)^-2; minus_ell = 2 c / (1 + c u) and slope = ell^2 / 2. */
    void (*ggx_shape)(const double *c, size_t n, double u, double *phi);
    void (*ggx_slopes)(const double *c, size_t n, double u, double *minus_ell, double *slope);

    /* The same with masking by Smith (model/smith.h): Beckmann and GGX, correlated and separable. */
    void (*smith_shape[4])(const struct smith_point *at, const double *c, const double *light, const double *view,
                           size_t n, double *phi);
    void (*smith_slopes[4])(const struct smith_point *at, const double *c, const double *light, const double *view,
                            size_t n, double *minus_ell, double *slope);

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

    /* [S - 1]: gain[c + 2^S s] is J at corner c (bit i: the high end of side i) with the sides of subset s shifted.
     * Without `shifted`, only the first 2^S of the GAINS(S) numbers are meant. [fixed - 1][each - 1]; NULL where columns
     * would be more than COLUMNS_MOST. */
    void (*gains[FIXED_MOST][EACH_MOST][SIDES_MOST])(const struct gains *in, int shifted, double *gain);

    /* gain[i], below 0 counting as 0 in cosines. */
    void (*gains_list)(const struct gains_list *in, double *gain);

    /* [S - 1]: an upper bound of J in the box from these, and how far the shift of each side lifts a corner at most. */
    double (*box_maximum[SIDES_MOST])(const double *gain, double *lift);

    /*
     * Curvature of lobes over an interval (bound/moment/interval_family.c), with the ranges [s, S] of (x - mean)^2 and
     * [d, D] of slope: out = {sum bb phi_high^2 (d + 2 s), sum bb phi_low^2 (D + 2 S)}; {sum w phi_high (s + d),
     * sum w phi_low (S + D)}; and sum w phi psi (S + D).
     */
    void (*curvature)(const double *bb, const double *phi_low, const double *phi_high, const struct local *at, size_t n,
                      double out[2]);
    void (*functional_curvature)(const double *w, const double *phi_low, const double *phi_high, const struct local *at,
                                 size_t n, double out[2]);
    double (*pair_curvature)(const double *w, const double *phi, const double *psi, const struct local *at, size_t n);

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
