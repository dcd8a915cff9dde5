/*
 * Samples to the coefficients (a, b, c) of the model, and which samples count.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_GEOMETRY_H
#define BRDFFIT_GEOMETRY_H

#include "brdffit.h"

/* What a distribution's row of geometry is made from. */
struct geometry_angles {
    double cos_light;      /* n.l */
    double cos_view;       /* n.v */
    double tan2_half;      /* tan^2 alpha */
    double cos_difference; /* v.h */
};

struct geometry {
    double a, b, c;
    double cos_light; /* f_r to radiance; 1 for given coefficients */
    struct geometry_angles angles; /* what they come from; not set for given coefficients */
};

/* Everything that can be wrong with pointers, counts and enumerations of `samples`. need_values: 0 for eval. */
brdffit_status brdffit_geometry_check(const brdffit_samples *samples, int need_values, brdffit_error *error);

/*
 * Classify sample i: BRDFFIT_SKIP_COUNT when it counts, and then *out is filled. A sample that is not finite,
 * or out of range, sets *status and *error. min_cosine: cosine of the largest incidence, 0 for none.
 */
brdffit_skip brdffit_geometry_sample(const brdffit_samples *samples, brdffit_distribution distribution,
                                     double min_cosine, size_t i, struct geometry *out, brdffit_status *status,
                                     brdffit_error *error);

/* Cosine to compare n.l with, from degrees; 0 switches the test off. */
double brdffit_geometry_min_cosine(double max_incidence);

#endif
