/*
 * Lobes with Smith's masking (Smith 1967; Walter et al. 2007; Heitz 2014): what theory 4.4 asks of a family, for one
 * whose samples have three numbers, c = tan^2 alpha and tau^2 = tan^2 of the angles of light and viewer with the normal.
 * masked.c makes kinds of lobes of it. SPDX-License-Identifier: MIT
 *
 *     g = b s shape(s, c) G2,    shape = (1 + c s)^-2 or exp(-c s),    s = 1 / sigma^2
 *     correlated: G2 = 2 sqrt s / (d_l + d_v)          separable: G2 = 4 s / [(sqrt s + d_l) (sqrt s + d_v)]
 *     GGX: d = sqrt(s + tau^2)     Beckmann: d = r(s) = sqrt s erf(sqrt s / tau) + tau exp(-s / tau^2) / sqrt(pi)
 *
 * What the engines see. With M >= every tau^2 (GGX: the largest; Beckmann: four times that) and u = s / (1 + kappa s),
 * kappa = min(c_min, 1 / (2 M)) for GGX and 0 for Beckmann, c' = c - c_min,
 *
 *     phi(u) = shape(c') / H,   shape = (1 + c' v)^-2, v = s / (1 + c_min s) = u f, f = 1 / (1 + (c_min - kappa) u)
 *                               shape = exp(-c' u)
 *     correlated: H = (h_l + h_v) / 2      separable: H = (h_0 + h_l) (h_0 + h_v) / 4      h = d / sqrt(s + M)
 *     g = b s shape(s, c_min) [s / (s + M)]^(1/2 or 1) phi          h_0 = sqrt(s / (s + M))
 *
 * h in terms of u: GGX: h^2 = (tau^2 + (1 - kappa tau^2) u) / (M + (1 - kappa M) u). The scalars only rescale y. They are
 * chosen so that what all samples share is not in -ell: x -> 0 with all its differences like 1 / s^2, and the far
 * intervals cost nothing, as those of GGX without masking. 0 < h <= 1, so 1 <= 1/H <= (1 + M / s)^(1/2 or 1): phi is at
 * least the unmasked one and at least 1 at c' = 0; nothing overflows. It is not at most 1.
 *
 * Proof that phi, -ell and slope = ell' fall with u and are >= 0 (lobe.h, theory 4.4: 1 and 2). Say that f is *rising* when
 * f > 0, f' >= 0, f'' <= 0, f''' >= 0. (a) Sums of rising functions are rising; with D = f'/f = (ln f)':
 * D >= 0, D' = f''/f - D^2 <= 0, D'' = f'''/f - 3 f''f'/f^2 + 2 D^3 >= 0, and these three add up over products.
 * (b) The root of a rising w is: w'/(2 sqrt w) is a product of two functions with signs (+, -, +), again (+, -, +).
 * (c) Shape: -(ln)' is c', or 2 c' f^2 / (1 + c' v) = 2 c' / ([1 + (c_min - kappa) u] [1 + (c - kappa) u]), a product of such.
 * GGX: h^2 is a Moebius function of u, derivative (M - tau^2) / T^2 >= 0, T = M + (1 - kappa M) u: signs (+, -, +), so h is
 * rising by (b). Beckmann: by z r'' = exp(-z)/(2 sqrt pi) - r'/2 (tau = 1, z = s, k = M / tau^2) h = r (z + k)^-1/2 has
 *     h' = P (z + k)^-3/2,   P = (z + k) r' - r / 2,   P' = [exp(-z)/2 - k int_0^1 v^2 exp(-z v^2) dv] / sqrt(pi),
 *     P'' = [-exp(-z)/2 + k int_0^1 v^4 exp(-z v^2) dv] / sqrt(pi);
 * the integrals are at least exp(-z)/3 and exp(-z)/5, so k >= 5/2 gives P' <= 0 <= P'', and P falls to 0: h' is a
 * product of signs (+, -, +). h_0 is the case tau = 0. Then D of H, with the shape's, is -ell. QED
 * M = 4 tau^2 keeps P and P' well conditioned: what is taken off is at most 1/8 and 3/8 of what is there.
 *
 * Errors, in units of u = 2^-53 of the value (tests/test_smith.c measures them against 113 bits): phi 10 (exponential: 8 and
 * the exponent c' u); -ell 10; slope 20; masking 8. Values below the normal ones have that many of the least double.
 * Computed values of neighbouring u may be out of order by twice as much: nothing may rely on it. Each is >= 0.
 *
 * Condition 3 of theory 4.4 does not hold: tau may make a sample of smaller c fall faster, so mu is not monotone in the
 * distance of two lobes. Light and viewer may be exchanged without changing a bit.
 *
 * Ranges: s in [1e-6, 1e24], c in [0, 1e100], tau^2 in [0, 1e60], M = 0 included: finite. tau = 0 is exact, G1 = 1 there.
 */
#ifndef BRDFFIT_SMITH_H
#define BRDFFIT_SMITH_H

#include <stddef.h>

#include "base/wide.h"
#include "kernels/smith_point.h"

enum smith_family { SMITH_GGX, SMITH_GGX_SEPARABLE, SMITH_BECKMANN, SMITH_BECKMANN_SEPARABLE };

/* What the samples of a problem share. */
struct smith_scale {
    double c_min;
    double kappa;
    double widest; /* M */
};

/* tan2_most: the largest tan^2 of any sample's light or viewer. */
void brdffit_smith_scale(enum smith_family family, double c_min, double tan2_most, struct smith_scale *out);

/* u and its derivatives by theta = ln s; u at s; all that samples share at u. */
void brdffit_smith_variable(const struct smith_scale *scale, double theta, double u[3]);
double brdffit_smith_argument(const struct smith_scale *scale, double s);
void brdffit_smith_point(enum smith_family family, const struct smith_scale *scale, double u, struct smith_point *at);

/* g / (b lambda(s) shape(s, c_min) phi): [s / (s + M)]^(1/2 or 1), in (0, 1]; within 3 u. */
double brdffit_smith_conversion(enum smith_family family, const struct smith_scale *scale, double s);

/*
 * phi, and -ell and slope by u, of n samples (any n): c = tan^2 alpha - c_min >= 0. The bits of kernels/smith_loops.h,
 * whatever they are compiled for.
 */
void brdffit_smith_shape(enum smith_family family, const struct smith_point *at, const double *c, const double *light,
                         const double *view, size_t n, double *phi);
void brdffit_smith_slopes(enum smith_family family, const struct smith_point *at, const double *c, const double *light,
                          const double *view, size_t n, double *minus_ell, double *slope);

/* G2 in (0, 1], and shape(s, c) G2 (c itself, c_min not taken off), however small: within 8 u and a dozen u. */
double brdffit_smith_masking(enum smith_family family, double s, double light, double view);
struct wide brdffit_smith_phi(enum smith_family family, struct twofold s, double c, double light, double view);

/* -d ln g / dc, that of lobe.h: masking does not know c. */
double brdffit_smith_sensitivity(enum smith_family family, double s, double c);

/*
 * out = {-d ln g / d ln tan^2 light, that of view}, each in [0, 1/2], correlated: their sum too; they do not rise with s.
 * GGX: tau^2 / (2 d S) with S = d_l + d_v or sqrt s + d, and tau^2 <= d^2 <= d S. Beckmann: r is homogeneous of degree 1 in
 * (sqrt s, tau), so tau dr/dtau = r - 2 s r' = tau exp(-s / tau^2) / sqrt(pi) <= r, and half of that over S.
 * Near normal incidence, where tau^2 is known absolutely: as d >= sqrt s and y exp(-y^2) < 0.43, each is at most tau^2 / (4 s).
 */
void brdffit_smith_tangents(enum smith_family family, double s, double light, double view, double out[2]);

/*
 * An s beyond which phi_j sqrt(bb_j / bb_0) is, but for a factor that all samples share, within 2 exp(-TAIL_EXPONENT) of its
 * limit. GGX: 1 <= 1/H <= 1 + M / s. Beckmann: 0 <= d / sqrt s - 1 <= exp(-z) / sqrt(pi z), z = s / tau^2.
 */
double brdffit_smith_tail(enum smith_family family, const struct smith_scale *scale, const double *c, const double *bb,
                          size_t m);

#endif
