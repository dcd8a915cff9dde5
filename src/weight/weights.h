/*
 * Weights of samples: the work of the public functions. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_WEIGHTS_H
#define BRDFFIT_WEIGHTS_H

#include "brdffit.h"

size_t brdffit_weights_bytes(size_t count, size_t channels, brdffit_weighting weighting);

brdffit_status brdffit_weights_run(const brdffit_samples *samples, brdffit_weighting weighting, double floor,
                                   void *workspace, size_t size, double *out, brdffit_error *error);

/* brdffit_weights_crowded(). */
int brdffit_weights_crowd(const brdffit_samples *samples, const double *solid_angles, void *workspace, size_t size);

/* Kish's effective sample size by the count: brdffit_weights_effective(). */
double brdffit_weights_share(const double *weights, size_t count);

#endif
