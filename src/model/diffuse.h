/*
 * Columns without a shape: the diffuse terms (theory 7.2), and Schlick's weight of second columns.
 * SPDX-License-Identifier: MIT
 *
 * Both are made of n.l, n.v and v.h. What cancels is 1 - v.h, 1 - n.l and 1 - n.v, which are kept as such (`versine`), and
 * l.v - (n.l)(n.v) = sin sin cos(azimuths), whose absolute error is charged.
 */
#ifndef BRDFFIT_DIFFUSE_H
#define BRDFFIT_DIFFUSE_H

#include "kernels/kernels.h"
#include "model/geometry.h"

/* Further columns of a diffuse term at a sample with n.l > 0: radiance, and how far each may be off (absolute), but for the
 * relative error of n.l that all share. column[0] and its error are those of geometry.a. */
void brdffit_diffuse_row(brdffit_diffuse diffuse, const struct geometry *geometry, double column[FIXED_MOST],
                         double error[FIXED_MOST]);

/* Below this 1 - v.h, w counts as 0, and (1 - t)^5 of Burley's term below this 1 - t (brdffit.h). */
#define LIMIT_VERSINE 1e-20
/* Below this, cos(azimuths) sin(a) tan(b) counts as 0: rounding of directions makes 1e-15 of 0. */
#define LIMIT_PRODUCT 1e-12

/* (1 - cos)^5. */
static inline double schlick_fifth(double versine)
{
    double square = versine * versine;

    return versine < LIMIT_VERSINE ? 0.0 : square * square * versine;
}

/* w = (1 - v.h)^5. */
static inline double schlick_weight(const struct geometry_angles *angles)
{
    return schlick_fifth(angles->versine);
}

/* b of a lobe's second column, in place of that of its first. */
void brdffit_schlick_column(struct geometry *geometry);

#endif
