/*
 * Ways to the best support, from what is left of the columns after orthogonalisation; only nnls*.c call them.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_NNLS_PARTS_H
#define BRDFFIT_NNLS_PARTS_H

#include "solve/nnls.h"

/* Count 0 when the columns of the support are dependent. */
void brdffit_nnls_support_factor(const struct nnls *nnls, unsigned bits, struct nnls_support *support);

/* One entry a column of the support into z; returns the squared norm of what is left of t. */
double brdffit_nnls_support_solve(const struct nnls_support *support, const double *t, int columns, double *z);

/* One entry a column of the support into z, the best with a.z <= most whatever its signs; returns the squared norm of what is
 * left of t. a: one entry a column of all. */
double brdffit_nnls_limit_step(const struct nnls_support *support, const double *t, int columns, const double *a,
                               double most, double *z, double *multiplier);

/* Unit-column coefficients and their support: by trying all of them, and by an active set. */
unsigned brdffit_nnls_enumerate(const struct nnls *nnls, const double *t, double *unit);
unsigned brdffit_nnls_active(const struct nnls *nnls, const double *t, double *unit);

/* The same with a.unit <= 1, and the multiplier of that, by trying all of them. */
unsigned brdffit_nnls_limited(const struct nnls *nnls, const double *t, const double *a, double *unit,
                              double *multiplier);

#endif
