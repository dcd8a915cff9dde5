/*
 * Checks every claim that a result of brdffit_fit() makes, from the samples alone, in long double, sharing no
 * code with the library. Every test that fits calls it (brdffit_test_fit() of support.h does).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_VERIFY_H
#define BRDFFIT_TESTS_VERIFY_H

#include "brdffit.h"

/* A brdffit_model with roughnesses of its own, and nothing to be initialised. */
struct brdffit_test_model {
    brdffit_distribution distribution;
    int lobes;
    size_t channels;
    double sigma[BRDFFIT_MAX_LOBES];
    const double *x, *y;
    const brdffit_distribution *distributions; /* as brdffit_model's */
};

/* A brdffit_result without pointers to structures: a copy of it is one, but for the arrays of K. */
struct brdffit_test_result {
    struct brdffit_test_model model;
    brdffit_lobe lobe[BRDFFIT_MAX_LOBES];
    const double *channel_scale, *rms;
    double rms_total, e2, e2_error, lower_bound, gap, sum_of_squares, sigma_floor, sigma_tail, kkt_residual;
    brdffit_stop stop;
    int certified;
    size_t boxes, nodes, programs_solved, programs_refused, programs_decided;
    size_t distinct_c, channels_zero, channels_identical, samples_used;
    size_t samples_skipped[BRDFFIT_SKIP_COUNT];
};

/* Padding and absent lobes are zero: copies of equal results have equal bytes, but for the pointers. */
void brdffit_test_flatten(const brdffit_result *result, struct brdffit_test_result *flat);

/* brdffit_eval() of such a model. */
brdffit_status brdffit_test_eval(const struct brdffit_test_model *model, const brdffit_samples *at, double *out,
                                 brdffit_error *error);

/*
 * 0 when everything holds; else 1 and *why (always terminated) names the claim with both numbers.
 * options may be NULL (defaults).
 *
 * Checked: which samples were used and why others were not, channel_scale, E^2 from the residuals at
 * (sigma, x, y), RMS, KKT conditions and optimality of the coefficients, E^2 against the lower bound, the
 * stopping rule, order and range of sigma, weights, effective samples, warnings, flat intervals (sampled), and
 * the lower bound against points all over the domain, near the optimum, and from local descents.
 */
int brdffit_test_verify(const brdffit_samples *samples, const brdffit_options *options,
                        const struct brdffit_test_result *result, char *why, size_t why_size);

/* The same with this many attacks on the lower bound (default: 2000, fewer for large problems) and a seed. */
int brdffit_test_verify_deep(const brdffit_samples *samples, const brdffit_options *options,
                             const struct brdffit_test_result *result, size_t attacks, unsigned long long seed,
                             char *why, size_t why_size);

#endif
