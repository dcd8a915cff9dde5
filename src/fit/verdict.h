/*
 * What may be claimed of a fit, from its final numbers alone. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VERDICT_H
#define BRDFFIT_VERDICT_H

#include "brdffit.h"

/* All in the same units. Any double is allowed anywhere: what makes no sense proves nothing. */
struct evidence {
    double e2;       /* of the model that the caller gets */
    double error;    /* how far e2 may be from it */
    double bound;    /* of every model, as it was proven; nobody has made it fit e2 */
    double total;    /* E^2 of the zero model */
    double relative_gap, absolute_gap; /* the options' */
    brdffit_stop ended; /* why the search did */
};

struct verdict {
    brdffit_stop stop;
    int certified;
    double lower_bound; /* proven, in [0, e2] */
    double gap;         /* e2 - lower_bound; infinite when e2 is no number */
};

struct verdict brdffit_verdict(const struct evidence *evidence);

#endif
