/* observations.h: how many observations a fit rests on.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_OBSERVATIONS_H
#define BRDFFIT_CLI_OBSERVATIONS_H

#include "job.h"

/* Samples used times channels that say something of their own: not those without signal, nor those that repeat an earlier
 * one. */
size_t brdffit_cli_observations(const brdffit_result *result);
size_t brdffit_cli_distinct_channels(const brdffit_result *result);

/*
 * How many Gaussian residuals r of one variance would be as uneven as those of the job's fit,
 *
 *     3 (sum w r^2)^2 / sum (w r^2)^2,     at most the observations,
 *
 * as E r^4 = 3 (E r^2)^2 of a Gaussian. Noise in proportion to the signal leaves its mark in few bright samples, which then
 * decide alone. The observations where there is nothing to see: samples that were not kept (sums), fits that are exact to
 * the certificate. Without memory for it the job fails.
 */
double brdffit_cli_effective_observations(struct cli_job *job, const brdffit_options *options);

#endif
