/*
 * Restricted problem, Gram form, for bounds: see nnls.h. Layer 1. SPDX-License-Identifier: MIT
 *
 * R(t, M) = max_{z >= 0} 2 t.z - z'Mz with unit diagonal and off-diagonals in [0, 1]. All entries of M being
 * >= 0, z'Mz >= |z|^2, so R is finite and z_j <= t_j even where M is not positive semidefinite. The maximum
 * lies inside the face of some support S, is stationary there, and M_S is positive semidefinite there (second
 * order condition). So: enumerate supports, take stationary points with z > 0. Any feasible z gives a value
 * <= R; the support of the maximum gives R up to rounding:
 *
 *   - pairs: M_S has 1 - kappa^2 >= 2e-15 (kappa is clipped at LIMIT_COSINE, the safe side), and
 *     p^2 + (q - kappa p)^2 / (1 - kappa^2) is evaluated without cancellation;
 *   - all three: elimination of column 0 is a Cholesky factorisation, backward stable with an error of a few u
 *     in M; z <= |t| turns that into a few u |t|^2. A pivot <= 0 means M_S is singular or indefinite to
 *     rounding, and walking along its null direction to a smaller face loses at most a few u |t|^2.
 *
 * TOL_GAIN u |t|^2 in the caller covers all of it.
 */
#include "nnls.h"

#include "tolerance.h"

static double square_if_positive(double p)
{
    return p > 0.0 ? p * p : 0.0;
}

static double larger(double p, double q)
{
    return p > q ? p : q;
}

/* Interior stationary value of a pair; 0 when it is not feasible. inverse = 1 / (1 - kappa^2). */
static double pair_gain(double p, double q, double kappa, double inverse)
{
    double u = p - kappa * q;
    double v = q - kappa * p;

    return u > 0.0 && v > 0.0 ? p * p + v * v * inverse : 0.0;
}

static double inverse_of(double kappa)
{
    return 1.0 / ((1.0 - kappa) * (1.0 + kappa));
}

double brdffit_nnls_gain2(double p, double q, double kappa)
{
    double clipped = kappa < LIMIT_COSINE ? kappa : LIMIT_COSINE;
    double best = larger(square_if_positive(p), square_if_positive(q));

    return larger(best, pair_gain(p, q, clipped, inverse_of(clipped)));
}

void brdffit_nnls_gram3(struct nnls_gram3 *gram, double c01, double c02, double c12)
{
    int i;

    gram->cosine[0] = c01;
    gram->cosine[1] = c02;
    gram->cosine[2] = c12;
    for (i = 0; i < 3; i++) {
        if (!(gram->cosine[i] < LIMIT_COSINE)) {
            gram->cosine[i] = LIMIT_COSINE;
        }
        gram->pair[i] = inverse_of(gram->cosine[i]);
    }
    gram->p12 = gram->cosine[2] - gram->cosine[0] * gram->cosine[1];
    gram->p22 = (1.0 - gram->cosine[1]) * (1.0 + gram->cosine[1]);
    gram->det = gram->p22 - gram->p12 * gram->p12 * gram->pair[0];
}

/* All three columns: eliminate column 0, then column 1. Returns 0 when z > 0 fails somewhere. */
static double triple_gain(const struct nnls_gram3 *g, double t0, double t1, double t2)
{
    double u1 = t1 - g->cosine[0] * t0;
    double u2 = t2 - g->cosine[1] * t0;
    double step = g->p12 * g->pair[0];
    double z2 = (u2 - step * u1) / g->det;
    double z1 = u1 * g->pair[0] - step * z2;
    double z0 = t0 - g->cosine[0] * z1 - g->cosine[1] * z2;

    if (!(z0 > 0.0 && z1 > 0.0 && z2 > 0.0)) {
        return 0.0;
    }
    /* The quadratic at z, not t.z: an error of z enters only squared. */
    return z0 * (2.0 * t0 - z0 - 2.0 * (g->cosine[0] * z1 + g->cosine[1] * z2)) +
           z1 * (2.0 * t1 - z1 - 2.0 * g->cosine[2] * z2) + z2 * (2.0 * t2 - z2);
}

double brdffit_nnls_gain3(const struct nnls_gram3 *gram, double t0, double t1, double t2)
{
    double best;

    if (gram->det > 0.0) {
        best = triple_gain(gram, t0, t1, t2);
        if (best > 0.0) {
            return best; /* concave, and its unconstrained maximum is feasible */
        }
    }
    best = larger(square_if_positive(t0), larger(square_if_positive(t1), square_if_positive(t2)));
    best = larger(best, pair_gain(t0, t1, gram->cosine[0], gram->pair[0]));
    best = larger(best, pair_gain(t0, t2, gram->cosine[1], gram->pair[1]));
    return larger(best, pair_gain(t1, t2, gram->cosine[2], gram->pair[2]));
}
