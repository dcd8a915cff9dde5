/*
 * Lobe families: see family.h. Layer 2. SPDX-License-Identifier: MIT
 */
#include "family.h"

#include <math.h>

#include "kernel_exp.h"
#include "kernel_log.h"
#include "tolerance.h"

#define PI 3.14159265358979323846

/* ---- exponential: all but the last two functions of each, which hold lambda, are the same ---- */

static void exponential_variable(double c_min, double theta, double u[3])
{
    (void)c_min;
    u[0] = kernel_exp(theta);
    u[1] = u[0];
    u[2] = u[0];
}

static void exponential_slope(double c, double u, double *ell, double *slope)
{
    (void)u;
    *ell = -c;
    *slope = 0.0;
}

/* ln of sqrt(m bb_j / bb_0): what a sample weighs against the sharpest one. */
static double weight_exponent(double bb_j, double bb_0, size_t m)
{
    return 0.5 * (kernel_log((double)m) + kernel_log(bb_j) - kernel_log(bb_0));
}

static double exponential_tail(const double *c, const double *bb, size_t m, double c_min)
{
    double tail = 0.0, most = 0.0, cap;
    size_t j;

    (void)c_min;
    for (j = 1; j < m; j++) {
        most = bb[j] > most ? bb[j] : most;
    }
    cap = most > 0.0 ? TAIL_EXPONENT + weight_exponent(most, bb[0], m) : 0.0;
    for (j = 1; j < m && cap > tail * c[j]; j++) { /* c ascends: from there on no sample can matter */
        tail = fmax(tail, (TAIL_EXPONENT + weight_exponent(bb[j], bb[0], m)) / c[j]);
    }
    return tail;
}

static double exponential_exponent(double c_min, double s)
{
    return c_min * s;
}

/* lambda(s) = s: Beckmann, Ward */
static double exponential_evaluate(double s, double c)
{
    return s * kernel_exp(-c * s);
}

static double exponential_factor(double c_min, double s)
{
    return exponential_evaluate(s, c_min);
}

/* lambda(s) = 1: Torrance-Sparrow */
static double sparrow_evaluate(double s, double c)
{
    return kernel_exp(-c * s);
}

static double sparrow_factor(double c_min, double s)
{
    return sparrow_evaluate(s, c_min);
}

/* lambda(s) = (s + 2) / (2 pi): Blinn-Phong, Lafortune */
static double phong_evaluate(double s, double c)
{
    return (s + 2.0) / (2.0 * PI) * kernel_exp(-c * s);
}

static double phong_factor(double c_min, double s)
{
    return phong_evaluate(s, c_min);
}

/* lambda(s) = (s + 1) / (8 pi): Ashikhmin-Shirley */
static double ashikhmin_evaluate(double s, double c)
{
    return (s + 1.0) / (8.0 * PI) * kernel_exp(-c * s);
}

static double ashikhmin_factor(double c_min, double s)
{
    return ashikhmin_evaluate(s, c_min);
}

/* clang-format off */
#define EXPONENTIAL(by_exponent, name)                                                                         \
    {                                                                                                          \
        1, by_exponent, exponential_variable, NULL, exponential_slope, name##_factor,             \
            exponential_tail, exponential_exponent, name##_evaluate                                           \
    }
/* clang-format on */

const struct family brdffit_family_exponential = EXPONENTIAL(0, exponential);
static const struct family family_sparrow = EXPONENTIAL(0, sparrow);
static const struct family family_phong = EXPONENTIAL(1, phong);
static const struct family family_ashikhmin = EXPONENTIAL(1, ashikhmin);

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

/*
 * Where c_min = 0, phi falls like (c s)^-2 towards 0. Where c_min > 0 it goes to (c_min / c)^2 as u goes to 1 / c_min,
 * like 1 / (c_min s), and only that decides: phi may be far from its limit long after c s is large.
 */
static double ggx_tail(const double *c, const double *bb, size_t m, double c_min)
{
    double tail = 0.0;
    size_t j;

    if (c_min > 0.0) {
        return m > 1 ? kernel_exp(TAIL_EXPONENT) / c_min : 0.0;
    }
    for (j = 1; j < m; j++) {
        double exponent = 0.5 * (TAIL_EXPONENT + weight_exponent(bb[j], bb[0], m));

        tail = fmax(tail, kernel_exp(fmin(exponent, 600.0)) / c[j]);
    }
    return tail;
}

static double ggx_exponent(double c_min, double s)
{
    return 2.0 * kernel_log(1.0 + c_min * s);
}

static double ggx_evaluate(double s, double c)
{
    double rest = 1.0 + c * s;

    return s / (rest * rest);
}

const struct family brdffit_family_ggx = {
    0, 0, ggx_variable, ggx_shape, ggx_slope, ggx_factor, ggx_tail, ggx_exponent, ggx_evaluate,
};

const struct family *brdffit_family_of(brdffit_distribution distribution)
{
    static const struct family *const family[BRDFFIT_DISTRIBUTION_COUNT] = {
        [BRDFFIT_BECKMANN] = &brdffit_family_exponential,
        [BRDFFIT_GGX] = &brdffit_family_ggx,
        [BRDFFIT_TORRANCE_SPARROW] = &family_sparrow,
        [BRDFFIT_WARD] = &brdffit_family_exponential,
        [BRDFFIT_BLINN_PHONG] = &family_phong,
        [BRDFFIT_ASHIKHMIN_SHIRLEY] = &family_ashikhmin,
        [BRDFFIT_LAFORTUNE] = &family_phong,
    };

    return family[distribution];
}

const char *brdffit_parameter_string(brdffit_distribution distribution)
{
    if (!((unsigned)distribution < BRDFFIT_DISTRIBUTION_COUNT)) {
        return "unknown";
    }
    return brdffit_family_of(distribution)->by_exponent ? "exponent" : "sigma";
}
