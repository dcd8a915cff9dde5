/*
 * Lobes with two roughnesses (theory 7.4): s = (s_x, s_y) = (1 / sigma_x^2, 1 / sigma_y^2) along the tangent and across it,
 *
 *     phi(c_x s_x + c_y s_y),   c_x = c cos^2 phi_h,   c_y = c sin^2 phi_h,   phi_h of the half vector from the tangent,
 *
 * of Beckmann's, Ward's, GGX's and Ashikhmin and Shirley's phi(c s). With s = sqrt(s_x s_y) and r = sqrt(s_x / s_y)
 * = sigma_y / sigma_x, c_x s_x + c_y s_y = s [c (r cos^2 phi_h + sin^2 phi_h / r)]: where the ratio is known, the lobe is an
 * isotropic one of a stretched geometry, and so is every model that was found. Its scalar lambda(s) is that of s, but
 * sqrt((n_x + 1) (n_y + 1)) of Ashikhmin and Shirley. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TURN_H
#define BRDFFIT_TURN_H

#include "model/geometry.h"

struct kernels;
struct lobe_kind;
struct lobe_sight;

/* What a lobe's geometry is stretched by. */
struct stretch {
    double ratio;        /* sigma_y / sigma_x; 1: not at all */
    double cosine, sine; /* of the angle that its tangent is turned by */
};

/* From sigma_x / sigma_y and degrees. */
struct stretch brdffit_stretch_of(double anisotropy, double tangent_angle);

/* cos and sin of phi_h of sample i, which has directions. 0 where a tangent is missing or has no direction. */
int brdffit_turn_of(const brdffit_samples *samples, size_t i, double turn[2]);

/* c of a sample becomes that of the stretched geometry, and its error. */
void brdffit_turn_stretch(const struct stretch *stretch, const double turn[2], struct geometry *g);

/* c along the tangent and across it, which add up to c; g->c_error becomes that of both together. */
void brdffit_turn_split(const struct stretch *stretch, const double turn[2], struct geometry *g, double c[2]);

/* E = c_x s_x + c_y s_y of n (a multiple of LANES) groups, and phi of it, which is the kind's phi at c = E, s = 1. */
void brdffit_turned_shape(const struct kernels *kernels, const struct lobe_kind *kind, const struct lobe_sight *sight,
                          size_t n, const double s[2], double *exponent, double *phi);

/* lambda of an anisotropic lobe over lambda(s). */
double brdffit_turn_lambda(const struct lobe_kind *kind, double ratio, double s);

/* Whether a distribution has an anisotropic form here. */
int brdffit_turn_known(brdffit_distribution distribution);

#endif
