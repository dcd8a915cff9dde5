/*
 * Smith's masking: see smith.h. SPDX-License-Identifier: MIT
 */
#include "model/smith.h"

#include <math.h>

#include "base/tolerance.h"
#include "kernels/smith_loops.h"
#include "model/lobe.h"

static int is_separable(enum smith_family family)
{
    return family == SMITH_GGX_SEPARABLE || family == SMITH_BECKMANN_SEPARABLE;
}

static int is_exponential(enum smith_family family)
{
    return family == SMITH_BECKMANN || family == SMITH_BECKMANN_SEPARABLE;
}

static const struct lobe_kind *normals_of(enum smith_family family)
{
    return is_exponential(family) ? &brdffit_lobe_beckmann : &brdffit_lobe_ggx;
}

void brdffit_smith_scale(enum smith_family family, double c_min, double tan2_most, struct smith_scale *out)
{
    out->c_min = c_min;
    out->widest = is_exponential(family) ? 4.0 * tan2_most : tan2_most;
    out->kappa = is_exponential(family) ? 0.0 : fmin(c_min, 0.5 / out->widest);
}

void brdffit_smith_variable(const struct smith_scale *scale, double theta, double u[3])
{
    const struct lobe_sight sight = {.c_min = scale->kappa};

    brdffit_lobe_ggx.variable(&sight, theta, u);
}

double brdffit_smith_argument(const struct smith_scale *scale, double s)
{
    return s / (1.0 + scale->kappa * s);
}

void brdffit_smith_point(enum smith_family family, const struct smith_scale *scale, double u, struct smith_point *at)
{
    double beyond = scale->c_min - scale->kappa, f = 1.0 / (1.0 + beyond * u), root, M = scale->widest;

    at->u = u;
    at->kappa = scale->kappa;
    at->widest = M;
    at->rate = 1.0 - scale->kappa * M;
    at->level = M + at->rate * u;
    root = is_exponential(family) ? at->level / u : at->level;
    at->scale = is_separable(family) ? 4.0 * root : 2.0 * sqrt(root);
    at->v = u * f;
    at->fall = f * f;
    at->bend = 2.0 * beyond * f;
    at->share = u < SMITH_SHARE_MOST * M ? u / M : SMITH_SHARE_MOST;
    at->first = 0.5 * (M / at->level / u);
    at->second = 0.5 * (at->first / u);
}

double brdffit_smith_conversion(enum smith_family family, const struct smith_scale *scale, double s)
{
    double part = s / (s + scale->widest);

    return is_separable(family) ? part : sqrt(part);
}

/* One register of samples, the last of them repeated where there are fewer. */
struct samples {
    double c[VEC], light[VEC], view[VEC];
};

static void gather(struct samples *part, const double *c, const double *light, const double *view, size_t from,
                   size_t n)
{
    size_t i;

    for (i = 0; i < VEC; i++) {
        size_t j = from + i < n ? from + i : n - 1;

        part->c[i] = c[j];
        part->light[i] = light[j];
        part->view[i] = view[j];
    }
}

static void scatter(const double *values, size_t from, size_t n, double *out)
{
    size_t i;

    for (i = 0; i < VEC && from + i < n; i++) {
        out[from + i] = values[i];
    }
}

void brdffit_smith_shape(enum smith_family family, const struct smith_point *at, const double *c, const double *light,
                         const double *view, size_t n, double *phi)
{
    int separable = is_separable(family);
    struct samples part;
    double out[VEC];
    size_t j;

    for (j = 0; j < n; j += VEC) {
        gather(&part, c, light, view, j, n);
        if (is_exponential(family)) {
            smith_beckmann_shape(at, part.c, part.light, part.view, VEC, separable, out);
        } else {
            smith_ggx_shape(at, part.c, part.light, part.view, VEC, separable, out);
        }
        scatter(out, j, n, phi);
    }
}

void brdffit_smith_slopes(enum smith_family family, const struct smith_point *at, const double *c, const double *light,
                          const double *view, size_t n, double *minus_ell, double *slope)
{
    int separable = is_separable(family);
    double x[VEC], bend[VEC];
    struct samples part;
    size_t j;

    for (j = 0; j < n; j += VEC) {
        gather(&part, c, light, view, j, n);
        if (is_exponential(family)) {
            smith_beckmann_slopes(at, part.c, part.light, part.view, VEC, separable, x, bend);
        } else {
            smith_ggx_slopes(at, part.c, part.light, part.view, VEC, separable, x, bend);
        }
        scatter(x, j, n, minus_ell);
        scatter(bend, j, n, slope);
    }
}

/* d / sqrt s of one angle, and tau^2 d(d)/d(tau^2) / sqrt s, half of tau d(d)/d(tau). */
struct side {
    double d, rise;
};

static struct side side_of(enum smith_family family, double s, double tan2)
{
    struct side side;
    double z, y, rest;

    if (!is_exponential(family)) {
        side.d = sqrt(1.0 + tan2 / s);
        side.rise = 0.5 * (tan2 / s / side.d);
        return side;
    }
    z = s / fmax(tan2, s * (1.0 / SMITH_EXPONENT_MOST));
    y = sqrt(z);
    rest = 0.5641895835477563 * (kernel_exp(-z) / y);
    side.d = kernel_erf(y) + rest;
    side.rise = 0.5 * rest;
    return side;
}

double brdffit_smith_masking(enum smith_family family, double s, double light, double view)
{
    double l = side_of(family, s, light).d, v = side_of(family, s, view).d;

    return is_separable(family) ? 2.0 / (1.0 + l) * (2.0 / (1.0 + v)) : 2.0 / (l + v);
}

struct wide brdffit_smith_phi(enum smith_family family, struct twofold s, double c, double light, double view)
{
    struct wide masking = wide_of(brdffit_smith_masking(family, s.high, light, view));

    return wide_times(normals_of(family)->phi(s, c), masking);
}

double brdffit_smith_sensitivity(enum smith_family family, double s, double c)
{
    return normals_of(family)->sensitivity(s, c);
}

void brdffit_smith_tangents(enum smith_family family, double s, double light, double view, double out[2])
{
    struct side l = side_of(family, s, light), v = side_of(family, s, view);
    double both = l.d + v.d;

    out[0] = l.rise / (is_separable(family) ? 1.0 + l.d : both);
    out[1] = v.rise / (is_separable(family) ? 1.0 + v.d : both);
}

double brdffit_smith_tail(enum smith_family family, const struct smith_scale *scale, const double *c, const double *bb,
                          size_t m)
{
    const struct lobe_sight sight = {.c_min = scale->c_min, .c = c};
    double own = is_exponential(family) ? TAIL_EXPONENT * 0.25 : kernel_exp(TAIL_EXPONENT);

    return fmax(normals_of(family)->tail(&sight, bb, m), own * scale->widest);
}
