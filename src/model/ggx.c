/*
 * GGX (Walter et al. 2007) in the geometry of Cook and Torrance: s = 1 / sigma^2, g = b s (1 + c s)^-2.
 * theory 4.4 has its phi and why it may be used: see lobe.h.
 *
 * Condition. That of cook_torrance.h; but an error of c counts 2 s / (1 + c s) times, at most 2 / c: GGX lobes forget what
 * they do not resolve. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"
#include "model/cook_torrance.h"
#include "model/lobe.h"
#include "model/weight.h"

static void variable(const struct lobe_sight *sight, double theta, double u[3])
{
    double s = kernel_exp(theta), product = sight->c_min * s, rest = 1.0 / (1.0 + product);

    u[0] = s * rest;
    u[1] = u[0] * rest;
    u[2] = u[1] * ((1.0 - product) * rest);
}

static void shape(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u, double *phi)
{
    kernels->ggx_shape(sight->c, n, u, phi);
}

static void slopes(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u, double *minus_ell,
                   double *slope)
{
    kernels->ggx_slopes(sight->c, n, u, minus_ell, slope);
}

static void slope(double c, double u, double *ell, double *slope)
{
    *ell = -2.0 * c / (1.0 + c * u);
    *slope = 0.5 * *ell * *ell;
}

static double argument(const struct lobe_sight *sight, double s)
{
    return s / (1.0 + sight->c_min * s);
}

static double lambda(double s)
{
    return s;
}

/* (1 + c s)^-2. */
static struct wide phi(struct twofold s, double c)
{
    struct twofold product = twofold_times(s, c);
    struct wide rest = wide_of((1.0 + product.high) + product.low);

    return wide_over(wide_over(wide_of(1.0), rest), rest);
}

/*
 * Where c_min = 0, phi falls like (c s)^-2 towards 0. Where c_min > 0 it goes to (c_min / c)^2 as u goes to 1 / c_min,
 * like 1 / (c_min s), and only that decides: phi may be far from its limit long after c s is large.
 */
static double tail(const struct lobe_sight *sight, const double *bb, size_t m)
{
    const double *c = sight->c, c_min = sight->c_min;
    double least = weight_least_c(c, bb, m), sharpest = weight_sharpest(c, bb, m, least), tail = 0.0;
    size_t j;

    if (c_min + least > 0.0) {
        return m > 1 ? kernel_exp(TAIL_EXPONENT) / (c_min + least) : 0.0;
    }
    for (j = 0; j < m; j++) {
        if (c[j] > 0.0 && bb[j] > 0.0) {
            double exponent = 0.5 * (TAIL_EXPONENT + weight_exponent(bb[j], sharpest, m));

            tail = fmax(tail, kernel_exp(fmin(exponent, 600.0)) / c[j]);
        }
    }
    return tail;
}

static double exponent(double c_min, double s)
{
    return 2.0 * kernel_log(1.0 + c_min * s);
}

static double sensitivity(double s, double c)
{
    return 2.0 * s / (1.0 + c * s);
}

/* What does not depend on masking. */
#define GGX_MEMBERS                                                                                                    \
    .variable = variable, .shape = shape, .slopes = slopes, .slope = slope, .argument = argument, .lambda = lambda,    \
    .phi = phi, .exponent = exponent, .tail = tail, .sensitivity = sensitivity, .reflectance = 4.0

const struct lobe_kind brdffit_lobe_ggx = {
    .name = "ggx",
    .title = "GGX",
    .row = brdffit_cook_torrance_row,
    .table_kind = TABLE_ROW_SHADOWED,
    .table_factor = brdffit_cook_torrance_table_factor,
    GGX_MEMBERS,
};

const struct lobe_kind brdffit_lobe_ggx_bare = {
    .row = brdffit_cook_torrance_bare_row,
    GGX_MEMBERS,
};
