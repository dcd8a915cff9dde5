/*
 * The gain R(t, M) = max_{z >= 0} 2 t.z - z'Mz of the restricted problem in lanes, for bounds (nnls.h has the dense
 * form). SPDX-License-Identifier: MIT
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

#include "base/lanes.h"
#include "base/tolerance.h"

/* M of 3 columns (cosines 01, 02, 12), prepared once for many t. */
struct gram3_vec {
    vec cosine[3];
    vec pair[3]; /* 1 / (1 - cosine^2) */
    vec p12;     /* Schur complement after column 0, off-diagonal */
    vec det;     /* determinant of that complement; <= 0: no interior maximum of all three */
    vec inverse; /* 1 / det where det > 0 */
};

LANES_INLINE vec gain_inverse(vec kappa)
{
    return vec_set(1.0) / ((1.0 - kappa) * (1.0 + kappa));
}

/* A NaN becomes the limit too. */
LANES_INLINE vec gain_clip(vec kappa)
{
    return vec_select(kappa < vec_set(LIMIT_COSINE), kappa, vec_set(LIMIT_COSINE));
}

LANES_INLINE vec gain_single(vec p)
{
    vec positive = vec_max(p, vec_set(0.0));

    return positive * positive;
}

/* Interior stationary value of a pair; 0 when it is not feasible. inverse = 1 / (1 - kappa^2). */
LANES_INLINE vec gain_pair(vec p, vec q, vec kappa, vec inverse)
{
    vec u = p - kappa * q, v = q - kappa * p;
    vec_mask feasible = (u > vec_set(0.0)) & (v > vec_set(0.0));

    return (vec)(feasible & (vec_mask)(p * p + v * v * inverse));
}

/* R for 2 columns with t = (p, q); kappa >= 0, clipped, and its inverse. */
LANES_INLINE vec gain2_vec(vec p, vec q, vec kappa, vec inverse)
{
    return vec_max(gain_pair(p, q, kappa, inverse), vec_max(gain_single(p), gain_single(q)));
}

LANES_INLINE struct gram3_vec gram3_vec(vec c01, vec c02, vec c12)
{
    struct gram3_vec g;
    vec p22;
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
    g.inverse = vec_set(1.0) / vec_select(g.det > vec_set(0.0), g.det, vec_set(1.0));
    return g;
}

/* All three columns: eliminate column 0, then column 1. 0 where z > 0 fails somewhere. */
LANES_INLINE vec gain_triple(const struct gram3_vec *g, vec t0, vec t1, vec t2)
{
    const vec zero = vec_set(0.0);
    vec u1 = t1 - g->cosine[0] * t0, u2 = t2 - g->cosine[1] * t0;
    vec step = g->p12 * g->pair[0];
    vec z2 = (u2 - step * u1) * g->inverse;
    vec z1 = u1 * g->pair[0] - step * z2;
    vec z0 = t0 - g->cosine[0] * z1 - g->cosine[1] * z2;
    vec_mask feasible = (g->det > zero) & (z0 > zero) & (z1 > zero) & (z2 > zero);
    /* The quadratic at z, not t.z: an error of z enters only squared. */
    vec value = z0 * (2.0 * t0 - z0 - 2.0 * (g->cosine[0] * z1 + g->cosine[1] * z2)) +
                z1 * (2.0 * t1 - z1 - 2.0 * g->cosine[2] * z2) + z2 * (2.0 * t2 - z2);

    return (vec)(feasible & (vec_mask)value);
}

LANES_INLINE vec gain3_vec(const struct gram3_vec *g, vec t0, vec t1, vec t2)
{
    vec triple = gain_triple(g, t0, t1, t2), best;

    best = vec_max(gain_single(t0), vec_max(gain_single(t1), gain_single(t2)));
    best = vec_max(best, gain_pair(t0, t1, g->cosine[0], g->pair[0]));
    best = vec_max(best, gain_pair(t0, t2, g->cosine[1], g->pair[1]));
    best = vec_max(best, gain_pair(t1, t2, g->cosine[2], g->pair[2]));
    /* Where all three are feasible the problem is concave and its unconstrained maximum the answer. */
    return vec_select(triple > vec_set(0.0), triple, best);
}

#endif
