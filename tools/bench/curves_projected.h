/*
 * Variable projection: what a solver needs of the projected functional E^2(u) = min over coefficients >= 0 beside its
 * value, for the peer in curves_varpro.c. With Phi the columns of a channel's support (a, g_1, g_2 where the coefficient
 * is positive), P the projection onto what is orthogonal to them, r = P I the residual and D_p = d Phi / du_p, half of
 * the matrix is
 *
 *   Kaufman         sum_k y_kp y_kq  dg_p . P dg_q                       L. Kaufman, BIT 15, 1975
 *   Golub-Pereyra   that + sum_k (r . dg_p) (r . dg_q) (Phi^T Phi)^-1_pq  G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 1973
 *   Newton          half of the Hessian, while the supports stay
 *
 * all of sums over distinct c, so that a matrix costs little more than a value. SPDX-License-Identifier: MIT
 */
#ifndef CURVES_PROJECTED_H
#define CURVES_PROJECTED_H

#include "curves_reduced.h"

#ifdef __cplusplus
extern "C" {
#endif

enum curves_matrix { CURVES_KAUFMAN, CURVES_GOLUB_PEREYRA, CURVES_NEWTON };

/*
 * Derivatives of E^2 at u (P values), straight after curves_reduced_value() there: P to gradient, P x P to each of the
 * two matrices, of the kind asked for and, unless NULL, Kaufman's, which is never indefinite.
 */
CURVES_API void curves_projected(struct curves_reduced *reduced, int lobes, const double *u, int kind, double *gradient,
                                 double *matrix, double *safe);

#ifdef __cplusplus
}
#endif
#endif
