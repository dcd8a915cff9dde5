/*
 * The reduced problem: E^2 as a function of one or two roughnesses, the coefficients eliminated by non-negative least
 * squares. What NLopt, SciPy and the grid of the benchmark minimise; written to be fast, because a slow objective would
 * make any peer look bad. Shares nothing with the library but the reader of files.
 *
 * The variable is u = ln sigma, s = exp(-2 u). Samples of equal c count once (there are 28 in the paper's 84):
 *
 *     U(s) = sum a b e^-cs    V_k(s) = sum I_k b e^-cs    H(s1, s2) = sum b^2 e^-cs1 e^-cs2
 *
 * with the smallest c taken off every c, which only rescales a lobe. Two lobes are orthogonalised on the sums, so that
 * close ones lose no digits, and the up to seven supports of three columns are compared in closed form.
 *
 * Also built into build/libcurves_reduced.so, for SciPy by way of ctypes. SPDX-License-Identifier: MIT
 */
#ifndef CURVES_REDUCED_H
#define CURVES_REDUCED_H

#include "peers_problem.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CURVES_API __attribute__((visibility("default")))

/* What the peers search: narrower lobes than 1e-3 are single samples in all data here. */
#define CURVES_SIGMA_MIN 1e-3
#define CURVES_SIGMA_MAX 6.0

struct curves_reduced {
    size_t count, channels; /* distinct c, padded with weights 0 to a multiple of 8; K */
    double *c;              /* count; owns the memory of all arrays here */
    double *b2, *ab;        /* count each: sums of b^2 and of a b */
    double *ib;             /* channels x count: sums of I_k b */
    double *omega;          /* channels: I_k.a / |a| */
    double *shape, *rest;   /* scratch: 2 x count, count */
    double *moved;          /* scratch: 2 x count */
    double *tau, *rho;      /* scratch: channels each */
    double *coefficient;    /* scratch: channels x 3: of a, g1, g2 as they stand (not of unit length) */
    double norm_a, total;   /* |a|, sum of I^2 */
};

/* 0 when memory runs out. The problem is not needed afterwards. */
int curves_reduced_new(struct curves_reduced *reduced, const struct peers_problem *problem);
void curves_reduced_free(struct curves_reduced *reduced);

/* E^2 at `lobes` values of u; dE^2/du to gradient unless that is NULL. */
CURVES_API double curves_reduced_value(struct curves_reduced *reduced, int lobes, const double *u, double *gradient);

/* For other languages: opaque, NULL when the file cannot be used. `batch` fills e2[i] for points x lobes values of u. */
CURVES_API struct curves_reduced *curves_reduced_open(const char *path);
CURVES_API void curves_reduced_close(struct curves_reduced *reduced);
CURVES_API double curves_reduced_one(struct curves_reduced *reduced, double u);
CURVES_API double curves_reduced_two(struct curves_reduced *reduced, double u1, double u2);
CURVES_API void curves_reduced_batch(struct curves_reduced *reduced, int lobes, size_t points, const double *u,
                                     double *e2);

/* E^2 at u from the samples' residuals, in long double: what every curve's error is measured with. */
CURVES_API double curves_reduced_judge(const char *path, int lobes, const double *u);
double curves_judge(const struct peers_problem *problem, int lobes, const double *u);

#ifdef __cplusplus
}
#endif
#endif
