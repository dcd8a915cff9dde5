/*
 * The gain R(t, M) = max_{z >= 0} 2 t.z - z'Mz of the restricted problem in lanes, for bounds (nnls.h has the dense
 * form). Layer 1. SPDX-License-Identifier: MIT
 *
 * M has a unit diagonal and off-diagonals in [0, 1]. All entries of M being >= 0, z'Mz >= |z|^2, so R is finite and
 * z_j <= t_j even where M is not positive semidefinite. The maximum lies inside the face of some support S, is
 * stationary there, and M_S is positive semidefinite there (second order condition). So: enumerate supports, take
 * stationary points with z > 0. Any feasible z gives a value <= R; the support of the maximum gives R up to rounding:
 *
 *   - pairs: M_S has 1 - kappa^2 >= 2e-15 (kappa is clipped at LIMIT_COSINE, the safe side), and
 *     p^2 + (q - kappa p)^2 / (1 - kappa^2) is evaluated without cancellation;
 *   - all three: elimination of column 0 is a Cholesky factorisation, backward stable with an error of a few u
 *     in M; z <= |t| turns that into a few u |t|^2. A pivot <= 0 means M_S is singular or indefinite to
 *     rounding, and walking along its null direction to a smaller face loses at most a few u |t|^2.
 *
 * TOL_GAIN u |t|^2 in the caller covers all of it.
 */
#ifndef BRDFFIT_GAIN_H
#define BRDFFIT_GAIN_H

#include "lanes.h"
#include "tolerance.h"

/* M of 3 columns (cosines 01, 02, 12), prepared once for many t. */
struct gram3_lanes {
    lanes cosine[3];
    lanes pair[3]; /* 1 / (1 - cosine^2) */
    lanes p12;     /* Schur complement after column 0, off-diagonal */
    lanes det;     /* determinant of that complement; <= 0: no interior maximum of all three */
    lanes inverse; /* 1 / det where det > 0 */
};

LANES_INLINE lanes gain_inverse(lanes kappa)
{
    return lanes_set(1.0) / ((1.0 - kappa) * (1.0 + kappa));
}

/* A NaN becomes the limit too. */
LANES_INLINE lanes gain_clip(lanes kappa)
{
    return lanes_select(kappa < lanes_set(LIMIT_COSINE), kappa, lanes_set(LIMIT_COSINE));
}

LANES_INLINE lanes gain_single(lanes p)
{
    lanes positive = lanes_max(p, lanes_set(0.0));

    return positive * positive;
}

/* Interior stationary value of a pair; 0 when it is not feasible. inverse = 1 / (1 - kappa^2). */
LANES_INLINE lanes gain_pair(lanes p, lanes q, lanes kappa, lanes inverse)
{
    lanes u = p - kappa * q, v = q - kappa * p;
    lanes_mask feasible = (u > lanes_set(0.0)) & (v > lanes_set(0.0));

    return (lanes)(feasible & (lanes_mask)(p * p + v * v * inverse));
}

/* R for 2 columns with t = (p, q); kappa >= 0, clipped, and its inverse. */
LANES_INLINE lanes gain2_lanes(lanes p, lanes q, lanes kappa, lanes inverse)
{
    return lanes_max(gain_pair(p, q, kappa, inverse), lanes_max(gain_single(p), gain_single(q)));
}

LANES_INLINE struct gram3_lanes gram3_lanes(lanes c01, lanes c02, lanes c12)
{
    struct gram3_lanes g;
    lanes p22;
    int i;

    g.cosine[0] = gain_clip(c01);
    g.cosine[1] = gain_clip(c02);
    g.cosine[2] = gain_clip(c12);
    for (i = 0; i < 3; i++) {
        g.pair[i] = gain_inverse(g.cosine[i]);
    }
    g.p12 = g.cosine[2] - g.cosine[0] * g.cosine[1];
    p22 = (1.0 - g.cosine[1]) * (1.0 + g.cosine[1]);
    g.det = p22 - g.p12 * g.p12 * g.pair[0];
    g.inverse = lanes_set(1.0) / lanes_select(g.det > lanes_set(0.0), g.det, lanes_set(1.0));
    return g;
}

/* All three columns: eliminate column 0, then column 1. 0 where z > 0 fails somewhere. */
LANES_INLINE lanes gain_triple(const struct gram3_lanes *g, lanes t0, lanes t1, lanes t2)
{
    const lanes zero = lanes_set(0.0);
    lanes u1 = t1 - g->cosine[0] * t0, u2 = t2 - g->cosine[1] * t0;
    lanes step = g->p12 * g->pair[0];
    lanes z2 = (u2 - step * u1) * g->inverse;
    lanes z1 = u1 * g->pair[0] - step * z2;
    lanes z0 = t0 - g->cosine[0] * z1 - g->cosine[1] * z2;
    lanes_mask feasible = (g->det > zero) & (z0 > zero) & (z1 > zero) & (z2 > zero);
    /* The quadratic at z, not t.z: an error of z enters only squared. */
    lanes value = z0 * (2.0 * t0 - z0 - 2.0 * (g->cosine[0] * z1 + g->cosine[1] * z2)) +
                  z1 * (2.0 * t1 - z1 - 2.0 * g->cosine[2] * z2) + z2 * (2.0 * t2 - z2);

    return (lanes)(feasible & (lanes_mask)value);
}

LANES_INLINE lanes gain3_lanes(const struct gram3_lanes *g, lanes t0, lanes t1, lanes t2)
{
    lanes triple = gain_triple(g, t0, t1, t2), best;

    best = lanes_max(gain_single(t0), lanes_max(gain_single(t1), gain_single(t2)));
    best = lanes_max(best, gain_pair(t0, t1, g->cosine[0], g->pair[0]));
    best = lanes_max(best, gain_pair(t0, t2, g->cosine[1], g->pair[1]));
    best = lanes_max(best, gain_pair(t1, t2, g->cosine[2], g->pair[2]));
    /* Where all three are feasible the problem is concave and its unconstrained maximum the answer. */
    return lanes_select(triple > lanes_set(0.0), triple, best);
}

#endif
