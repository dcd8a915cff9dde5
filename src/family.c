/*
 * Lobe families: see family.h. Layer 2. SPDX-License-Identifier: MIT
 */
#include "family.h"

#include <math.h>

#include "kernel_exp.h"
#include "kernel_log.h"
#include "tolerance.h"

/* ---- exponential: Beckmann has lambda(s) = s ---- */

static void exponential_variable(double c_min, double theta, double u[3])
{
    (void)c_min;
    u[0] = kernel_exp(theta);
    u[1] = u[0];
    u[2] = u[0];
}

static void exponential_shape(const double *c, size_t n, double u, double *phi)
{
    size_t j;

    for (j = 0; j < n; j++) {
        phi[j] = kernel_exp(-c[j] * u);
    }
}

static void exponential_slope(double c, double u, double *ell, double *slope)
{
    (void)u;
    *ell = -c;
    *slope = 0.0;
}

static double exponential_factor(double c_min, double s)
{
    return s * kernel_exp(-c_min * s);
}

/* ln of sqrt(m bb_j / bb_0): what a sample weighs against the sharpest one. */
static double weight_exponent(const double *bb, size_t j, size_t m)
{
    return 0.5 * (kernel_log((double)m) + kernel_log(bb[j]) - kernel_log(bb[0]));
}

static double exponential_tail(const double *c, const double *bb, size_t m, double c_min)
{
    double tail = 0.0;
    size_t j;

    (void)c_min;
    for (j = 1; j < m; j++) {
        tail = fmax(tail, (TAIL_EXPONENT + weight_exponent(bb, j, m)) / c[j]);
    }
    return tail;
}

static double exponential_largest_s(double c_min)
{
    return c_min > 0.0 ? LIMIT_EXPONENT / c_min : INFINITY;
}

static double exponential_evaluate(double s, double c)
{
    return s * kernel_exp(-c * s);
}

const struct family brdffit_family_exponential = {
    1,
    exponential_variable,
    exponential_shape,
    exponential_slope,
    exponential_factor,
    exponential_tail,
    exponential_largest_s,
    exponential_evaluate,
};

/* ---- GGX ---- */

static void ggx_variable(double c_min, double theta, double u[3])
{
    double s = kernel_exp(theta), product = c_min * s, rest = 1.0 / (1.0 + product);

    u[0] = s * rest;
    u[1] = u[0] * rest;
    u[2] = u[1] * ((1.0 - product) * rest);
}

static void ggx_shape(const double *c, size_t n, double u, double *phi)
{
    size_t j;

    for (j = 0; j < n; j++) {
        double root = 1.0 / (1.0 + c[j] * u);

        phi[j] = root * root;
    }
}

static void ggx_slope(double c, double u, double *ell, double *slope)
{
    *ell = -2.0 * c / (1.0 + c * u);
    *slope = 0.5 * *ell * *ell;
}

static double ggx_factor(double c_min, double s)
{
    double rest = 1.0 + c_min * s;

    return s / (rest * rest);
}

/* phi falls like (c s)^-2 where c_min = 0; where c_min > 0, u stops growing at 1 / c_min. */
static double ggx_tail(const double *c, const double *bb, size_t m, double c_min)
{
    double tail = 0.0;
    size_t j;

    for (j = 1; j < m; j++) {
        double exponent = 0.5 * (TAIL_EXPONENT + weight_exponent(bb, j, m));

        tail = fmax(tail, kernel_exp(fmin(exponent, 600.0)) / c[j]);
    }
    return c_min > 0.0 ? fmin(tail, kernel_exp(TAIL_EXPONENT) / c_min) : tail;
}

static double ggx_largest_s(double c_min)
{
    (void)c_min;
    return INFINITY;
}

static double ggx_evaluate(double s, double c)
{
    double rest = 1.0 + c * s;

    return s / (rest * rest);
}

const struct family brdffit_family_ggx = {
    0, ggx_variable, ggx_shape, ggx_slope, ggx_factor, ggx_tail, ggx_largest_s, ggx_evaluate,
};

const struct family *brdffit_family_of(brdffit_distribution distribution)
{
    return distribution == BRDFFIT_GGX ? &brdffit_family_ggx : &brdffit_family_exponential;
}
