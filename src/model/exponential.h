/*
 * What every distribution with phi = exp(-c' u), u = s, shares; they differ in geometry and lambda.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_EXPONENTIAL_H
#define BRDFFIT_EXPONENTIAL_H

#include "model/lobe.h"

void brdffit_exponential_variable(const struct lobe_sight *sight, double theta, double u[3]);
double brdffit_exponential_argument(const struct lobe_sight *sight, double s);
void brdffit_exponential_shape(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u,
                               double *phi);
void brdffit_exponential_slope(double c, double u, double *ell, double *slope);
double brdffit_exponential_tail(const struct lobe_sight *sight, const double *bb, size_t m);
double brdffit_exponential_exponent(double c_min, double s);
struct wide brdffit_exponential_phi(struct twofold s, double c);
double brdffit_exponential_sensitivity(double s, double c);

/* The members of struct lobe_kind that are these. */
#define EXPONENTIAL_MEMBERS                                                                                            \
    .exponential = 1, .steep = 1, .variable = brdffit_exponential_variable, .argument = brdffit_exponential_argument,  \
    .shape = brdffit_exponential_shape, .slope = brdffit_exponential_slope, .phi = brdffit_exponential_phi,            \
    .exponent = brdffit_exponential_exponent, .tail = brdffit_exponential_tail,                                        \
    .sensitivity = brdffit_exponential_sensitivity

#endif
