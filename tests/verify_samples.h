/*
 * verify.c, part 1 of 4: samples to (a, b, c) in long double, written from theory section 1 and the comments of
 * brdffit.h (its table of distributions), not from the library. Support.c makes synthetic data with it.
 * SPDX-License-Identifier: MIT
 *
 * The library works in double, so the same sample has slightly different coefficients there. Each sample
 * carries how much: relative errors of a, b and the radiance, and the absolute error of c, from the roundings
 * that any reasonable double implementation makes (unit vectors, dot and cross products: a few units each).
 */
#ifndef BRDFFIT_TESTS_VERIFY_SAMPLES_H
#define BRDFFIT_TESTS_VERIFY_SAMPLES_H

#include "verify_distributions.h"

/* A light exactly at the limit counts, whatever its cosine rounded to. */
#define VERIFY_INCIDENCE 1e-12L

static inline void verify_unit_vector(const double *from, long double to[3])
{
    long double x = from[0], y = from[1], z = from[2], length = sqrtl(x * x + y * y + z * z);

    to[0] = x / length;
    to[1] = y / length;
    to[2] = z / length;
}

static inline long double verify_dot(const long double u[3], const long double v[3])
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static inline void verify_directions(const brdffit_samples *s, size_t i, struct verify_angles *angles)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    long double l[3], v[3], n[3], h[3], cross[3], nh;

    verify_unit_vector(s->light + 3 * i, l);
    verify_unit_vector(s->view + 3 * i, v);
    verify_unit_vector(s->normal ? s->normal + 3 * i : up, n);
    h[0] = l[0] + v[0];
    h[1] = l[1] + v[1];
    h[2] = l[2] + v[2];
    cross[0] = n[1] * h[2] - n[2] * h[1];
    cross[1] = n[2] * h[0] - n[0] * h[2];
    cross[2] = n[0] * h[1] - n[1] * h[0];
    nh = verify_dot(n, h);
    angles->nl = verify_dot(n, l);
    angles->nv = verify_dot(n, v);
    angles->tan2 = verify_dot(cross, cross) / (nh * nh);
    angles->vh = verify_dot(v, h) / sqrtl(verify_dot(h, h));
    h[0] = l[0] - v[0];
    h[1] = l[1] - v[1];
    h[2] = l[2] - v[2];
    angles->apart2 = verify_dot(h, h);
}

/* Everything that angles decide, and its errors. */
static inline void verify_coefficients_of(brdffit_distribution distribution, const struct verify_angles *angles,
                                          int directions, struct verify_sample *out)
{
    long double tangent = sqrtl(angles->tan2), u = VERIFY_UNIT;

    out->a = angles->nl / VERIFY_PI;
    verify_row(distribution, angles, out);
    out->error_a = out->error_radiance = 8.0L * u;
    out->error_b = 32.0L * u;
    out->error_c = verify_error_c(distribution, angles, directions, out->c);
    if (directions) {
        out->error_a += 8.0L * u / angles->nl;
        out->error_radiance += 8.0L * u / angles->nl;
        out->error_b += 16.0L * u * (1.0L / angles->nl + 1.0L / angles->nv + 1.0L / angles->vh + 4.0L * tangent);
    }
}

/* Why sample i does not count; BRDFFIT_SKIP_COUNT when it does, and then *out is filled. */
static inline brdffit_skip verify_sample_of(brdffit_distribution distribution, const brdffit_samples *s,
                                            double max_incidence, size_t i, struct verify_sample *out)
{
    struct verify_angles angles;

    if (s->weights && s->weights[i] == 0.0) {
        return BRDFFIT_SKIP_ZERO_WEIGHT;
    }
    out->to_radiance = 1.0L;
    if (s->form == BRDFFIT_FORM_COEFFICIENTS) {
        out->a = s->a[i];
        out->b = s->b[i];
        out->c = s->c[i];
        out->error_a = out->error_b = out->error_radiance = 8.0L * VERIFY_UNIT;
        out->error_c = 0.0L;
        return BRDFFIT_SKIP_COUNT;
    }
    if (s->form == BRDFFIT_FORM_DIRECTIONS) {
        verify_directions(s, i, &angles);
    } else {
        angles.nl = s->cos_light[i];
        angles.nv = s->cos_view[i];
        angles.tan2 = s->tan2_half[i];
        angles.vh = s->cos_difference[i];
        angles.apart2 = 4.0L * (1.0L - angles.vh) * (1.0L + angles.vh);
    }
    if (!(angles.nl > 0.0L)) {
        return BRDFFIT_SKIP_LIGHT_BELOW_HORIZON;
    }
    if (!(angles.nv > 0.0L)) {
        return BRDFFIT_SKIP_VIEW_BELOW_HORIZON;
    }
    if (max_incidence < 90.0 && angles.nl < cosl(max_incidence * (VERIFY_PI / 180.0L)) - VERIFY_INCIDENCE) {
        return BRDFFIT_SKIP_INCIDENCE;
    }
    verify_coefficients_of(distribution, &angles, s->form == BRDFFIT_FORM_DIRECTIONS, out);
    out->to_radiance = s->quantity == BRDFFIT_QUANTITY_BRDF ? angles.nl : 1.0L;
    return BRDFFIT_SKIP_COUNT;
}

/* The same for Cook-Torrance: Beckmann and GGX. */
static inline brdffit_skip verify_sample(const brdffit_samples *s, double max_incidence, size_t i,
                                         struct verify_sample *out)
{
    return verify_sample_of(BRDFFIT_BECKMANN, s, max_incidence, i, out);
}

/* Relative error of verify_lobe() in double, c being off by error_c. */
static inline long double verify_lobe_error(int ggx, long double c, long double error_c, long double sigma)
{
    long double s = 1.0L / (sigma * sigma), exponent = 4.0L * VERIFY_UNIT * c * s + error_c * s;

    return 16.0L * VERIFY_UNIT + (ggx ? 2.0L * exponent / (1.0L + c * s) : exponent);
}

#endif
