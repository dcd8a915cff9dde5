/*
 * What charge.c and charge_domain.c share: sums in the norm of the fit. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_CHARGE_PARTS_H
#define BRDFFIT_CHARGE_PARTS_H

#include <math.h>

#include "base/vector.h"
#include "brdffit.h"

/* Rounding of all this. */
#define SAFE (1.0 + 1e-6)

/* A sum in the norm, term by term, and its end. */
static inline double join(double sum, double term, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_L2 ? sum + term * term : norm == BRDFFIT_NORM_L1 ? sum + term : larger(sum, term);
}

static inline double root_of(double sum, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_L2 ? sqrt(sum) : sum;
}

#endif
