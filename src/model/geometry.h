/*
 * Samples to the coefficients (a, b, c) of the model, how well they are known, and which samples count.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_GEOMETRY_H
#define BRDFFIT_GEOMETRY_H

#include "brdffit.h"

/* What a distribution's row of geometry is made from, and how far each may be off (rounding.h). */
struct geometry_angles {
    double cos_light;      /* n.l */
    double cos_view;       /* n.v */
    double tan2_half;      /* tan^2 alpha */
    double cos_difference; /* v.h */
    double tan2_light, tan2_view; /* tan^2 of the angles with the normal */
    double versine;        /* 1 - v.h, which would cancel */
    double versine_error;  /* relative */
    double versine_light, versine_view; /* 1 - n.l and 1 - n.v, likewise */
    double versine_light_error, versine_view_error;
    double off_mirror;     /* 1 - r.v, r the mirrored light; not 0 only where `accurate` */
    double mirror;         /* r.v, likewise */
    int accurate;          /* off_mirror and mirror are there */
    double light_error, view_error, difference_error; /* relative, of the cosines */
    double tangent_error, tan2_error; /* absolute, of tan alpha and its square */
    double mirror_error;   /* absolute, of |r - v| */
};

/*
 * The true coefficients a (1 + e), b (1 + e), c + e have errors e within the bounds given here. Where even the sign of r.v
 * is not known, b is 0 and the true lobe is anything from 0 to b_hidden lambda(s) phi(s, c_hidden); else b_hidden is 0.
 */
struct geometry {
    double a, b, c;
    double cos_light;   /* f_r to radiance; 1 for given coefficients */
    double light_error; /* relative, of cos_light and a */
    double b_error;     /* relative */
    double c_error;     /* absolute */
    double b_hidden, c_hidden;
    double tan2_light, tan2_view; /* of the angles with the normal, where masking needs them (masked.c) */
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

/* Unit vector, scaled first so that any finite non-zero length works. 0 on failure. */
int brdffit_geometry_unit(const double *v, double out[3]);

/* Cosine to compare n.l with, from degrees; 0 switches the test off. */
double brdffit_geometry_min_cosine(double max_incidence);

/* The angles of directions that cancel, in double-double arithmetic (accurate.c); those of r.v, if they are `mirrored`.
 * normal: NULL for +z. */
void brdffit_geometry_accurate(const double *light, const double *view, const double *normal, int mirrored,
                               struct geometry_angles *out);

#endif
