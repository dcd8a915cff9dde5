/*
 * Checks every claim that a result of brdffit_fit() makes, from the samples alone, in long double, sharing no
 * code with the library. Every test that fits calls it (brdffit_test_fit() of support.h does).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_VERIFY_H
#define BRDFFIT_TESTS_VERIFY_H

#include "brdffit.h"

/*
 * 0 when everything holds; else 1 and *why (always terminated) names the claim with both numbers.
 * options may be NULL (defaults).
 *
 * Checked: which samples were used and why others were not, channel_scale, E^2 from the residuals at
 * (sigma, x, y), RMS, KKT conditions and optimality of the coefficients, E^2 against the lower bound, the
 * stopping rule, order and range of sigma, weights, effective samples, warnings, flat intervals (sampled), and
 * the lower bound against points all over the domain, near the optimum, and from local descents.
 */
int brdffit_verify(const brdffit_samples *samples, const brdffit_options *options, const brdffit_result *result,
                   char *why, size_t why_size);

/* The same with this many attacks on the lower bound (default: 2000, fewer for large problems) and a seed. */
int brdffit_verify_deep(const brdffit_samples *samples, const brdffit_options *options, const brdffit_result *result,
                        size_t attacks, unsigned long long seed, char *why, size_t why_size);

#endif
