/*
 * The model that the caller gets, as doubles in the data's units, and what it leaves of the data.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_PUBLISHED_H
#define BRDFFIT_PUBLISHED_H

#include "fit/fit.h"

/* Internal units. */
struct published {
    double objective; /* in the fit's norm */
    double error;     /* how far that is from the samples' own, at these very coefficients and roughnesses */
    double squares;   /* weighted sum of squared residuals, whatever the norm */
    double effective[BRDFFIT_MAX_LOBES]; /* samples that each lobe rests on: (sum g^2)^2 / sum g^4 */
};

/* After an evaluation at the optimum: fit->x, y and rms, given each lobe's sigma as published. */
struct published brdffit_fit_publish(struct fit *fit, const double *sigma);

/* What triangles (reduce_rows.c) may have done to a channel's residual, relative to |I|; 0 without any. */
double brdffit_fit_triangle_error(const struct reduced *reduced);

/*
 * What brdffit_fit_publish() may add to an objective met on the way: the search proves that much more, so that what it
 * closes is closed when the final numbers are in.
 */
double brdffit_fit_allowance(const struct fit *fit, double objective);

#endif
