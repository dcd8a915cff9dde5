/*
 * Beckmann and GGX lobes with another masking than V-cavities: Smith's, height-correlated and separable (smith.h has the
 * mathematics), and none. SPDX-License-Identifier: MIT
 *
 * b = 1 / (pi (n.v) cos^4 alpha): cook_torrance.h's without G. Smith's G2 is in phi, for it depends on s.
 *
 * Condition. That of cook_torrance.h, and with Smith that of tangents: an error dt of tau = tan of an angle with the normal
 * is 2 dt / tau of ln tau^2, which counts min(1/2, tau^2 / (4 s)) of that in ln g (smith.h): at most dt / tau, and at most
 * dt tau / (2 s), so that neither normal incidence nor grazing is without a bound: dt / sqrt(2 s) at worst.
 */
#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "model/cook_torrance.h"
#include "model/exponential.h"
#include "model/lobe.h"
#include "model/rounding.h"
#include "model/smith.h"

/* The least s that options allow, 1 / LIMIT_SIGMA_MAX^2. */
#define LEAST_S 1e-6

/* What an error of a tangent makes of ln g, whatever s is. */
static double tangent_charge(double tan2, double error)
{
    double tangent = sqrt(tan2), off = (1.0 + tan2) * (2.0 * TOL_ANGLE + 8.0 * TOL_UNIT) + error;

    return off * smaller(tangent > 0.0 ? 1.0 / tangent : INFINITY, tangent / (2.0 * LEAST_S) + off / (2.0 * LEAST_S));
}

static void row_smith(const struct geometry_angles *g, struct geometry *out)
{
    brdffit_cook_torrance_bare_row(g, out);
    out->b_error += ENOUGH *
                    (tangent_charge(g->tan2_light, g->light_error) + tangent_charge(g->tan2_view, g->view_error));
}

/* ---- what lobe.h asks, from smith.h ---- */

static struct smith_scale scale_of(enum smith_family family, const struct lobe_sight *sight)
{
    struct smith_scale scale;

    brdffit_smith_scale(family, sight->c_min, sight->tan2_most, &scale);
    return scale;
}

static struct smith_point point_of(enum smith_family family, const struct lobe_sight *sight, double u)
{
    const struct smith_scale scale = scale_of(family, sight);
    struct smith_point at;

    brdffit_smith_point(family, &scale, u, &at);
    return at;
}

static double lambda(double s)
{
    return s;
}

/* The functions of one family, and its kind. */
#define SMITH_KIND(id, family, lobe, is_steep)                                                                         \
    static void id##_variable(const struct lobe_sight *sight, double theta, double u[3])                               \
    {                                                                                                                  \
        const struct smith_scale scale = scale_of(family, sight);                                                      \
                                                                                                                       \
        brdffit_smith_variable(&scale, theta, u);                                                                      \
    }                                                                                                                  \
    static double id##_argument(const struct lobe_sight *sight, double s)                                              \
    {                                                                                                                  \
        const struct smith_scale scale = scale_of(family, sight);                                                      \
                                                                                                                       \
        return brdffit_smith_argument(&scale, s);                                                                      \
    }                                                                                                                  \
    static void id##_shape(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u,          \
                           double *phi)                                                                                \
    {                                                                                                                  \
        const struct smith_point at = point_of(family, sight, u);                                                      \
                                                                                                                       \
        kernels->smith_shape[family](&at, sight->c, sight->light, sight->view, n, phi);                                \
    }                                                                                                                  \
    static void id##_slopes(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u,         \
                            double *minus_ell, double *slope)                                                          \
    {                                                                                                                  \
        const struct smith_point at = point_of(family, sight, u);                                                      \
                                                                                                                       \
        kernels->smith_slopes[family](&at, sight->c, sight->light, sight->view, n, minus_ell, slope);                  \
    }                                                                                                                  \
    static double id##_masking(double s, double light, double view)                                                    \
    {                                                                                                                  \
        return brdffit_smith_masking(family, s, light, view);                                                          \
    }                                                                                                                  \
    static double id##_conversion(const struct lobe_sight *sight, double s)                                            \
    {                                                                                                                  \
        const struct smith_scale scale = scale_of(family, sight);                                                      \
                                                                                                                       \
        return brdffit_smith_conversion(family, &scale, s);                                                            \
    }                                                                                                                  \
    static double id##_tail(const struct lobe_sight *sight, const double *bb, size_t m)                                \
    {                                                                                                                  \
        const struct smith_scale scale = scale_of(family, sight);                                                      \
                                                                                                                       \
        return brdffit_smith_tail(family, &scale, sight->c, bb, m);                                                    \
    }                                                                                                                  \
    static struct wide id##_phi(struct twofold s, double c)                                                            \
    {                                                                                                                  \
        return lobe.phi(s, c);                                                                                         \
    }                                                                                                                  \
    static double id##_exponent(double c_min, double s)                                                                \
    {                                                                                                                  \
        return lobe.exponent(c_min, s);                                                                                \
    }                                                                                                                  \
    static double id##_sensitivity(double s, double c)                                                                 \
    {                                                                                                                  \
        return brdffit_smith_sensitivity(family, s, c);                                                                \
    }                                                                                                                  \
    static const struct lobe_kind id = {                                                                               \
        .steep = is_steep,                                                                                             \
        .smith = 1,                                                                                                    \
        .reflectance = 4.0,                                                                                            \
        .row = row_smith,                                                                                              \
        .variable = id##_variable,                                                                                     \
        .argument = id##_argument,                                                                                     \
        .shape = id##_shape,                                                                                           \
        .slopes = id##_slopes,                                                                                         \
        .lambda = lambda,                                                                                              \
        .phi = id##_phi,                                                                                               \
        .masking = id##_masking,                                                                                       \
        .conversion = id##_conversion,                                                                                 \
        .exponent = id##_exponent,                                                                                     \
        .tail = id##_tail,                                                                                             \
        .sensitivity = id##_sensitivity,                                                                               \
    };

SMITH_KIND(ggx_smith, SMITH_GGX, brdffit_lobe_ggx, 0)
SMITH_KIND(ggx_separable, SMITH_GGX_SEPARABLE, brdffit_lobe_ggx, 0)
SMITH_KIND(beckmann_smith, SMITH_BECKMANN, brdffit_lobe_beckmann, 1)
SMITH_KIND(beckmann_separable, SMITH_BECKMANN_SEPARABLE, brdffit_lobe_beckmann, 1)

static const struct lobe_kind beckmann_bare = {
    .row = brdffit_cook_torrance_bare_row,
    .reflectance = 4.0,
    EXPONENTIAL_MEMBERS,
    .lambda = lambda,
};

const struct lobe_kind *brdffit_lobe_kind_other_masking(brdffit_distribution distribution, brdffit_masking masking)
{
    int beckmann = distribution == BRDFFIT_BECKMANN;

    if (!beckmann && distribution != BRDFFIT_GGX) {
        return NULL;
    }
    switch (masking) {
    case BRDFFIT_MASKING_SMITH: return beckmann ? &beckmann_smith : &ggx_smith;
    case BRDFFIT_MASKING_SMITH_SEPARABLE: return beckmann ? &beckmann_separable : &ggx_separable;
    case BRDFFIT_MASKING_NONE: return beckmann ? &beckmann_bare : &brdffit_lobe_ggx_bare;
    default: return NULL;
    }
}
