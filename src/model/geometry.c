/*
 * Directions to angles, and which samples count: see geometry.h; each distribution's file makes b and c of them.
 * SPDX-License-Identifier: MIT
 *
 * tan^2 alpha comes from the unnormalised half vector h = l + v as |n x h|^2 / (n.h)^2: near the mirror
 * direction 1 - (n.h)^2 would lose every digit that matters there. Where that cancels itself (alpha below 1e-4, grazing
 * cosines with a given normal, opposite directions; r.v near 1 or 0 for lobes that use it) accurate.c does it again.
 */
#include "model/geometry.h"

#include <math.h>

#include "model/lobe.h"
#include "base/constants.h"
#include "base/degrees.h"
#include "base/error.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "model/rounding.h"

brdffit_status brdffit_geometry_check(const brdffit_samples *s, int need_values, brdffit_error *error)
{
    if (s->quantity != BRDFFIT_QUANTITY_BRDF && s->quantity != BRDFFIT_QUANTITY_RADIANCE) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: unknown quantity");
    }
    if (need_values && s->channels == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: no channels");
    }
    if (s->count == 0) {
        return need_values ? brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "there are no samples") : BRDFFIT_OK;
    }
    if (need_values && !s->values) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: values is NULL");
    }
    switch (s->form) {
    case BRDFFIT_FORM_DIRECTIONS:
        if (!s->light || !s->view) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: light or view is NULL");
        }
        return BRDFFIT_OK;
    case BRDFFIT_FORM_ANGLES:
        if (!s->cos_light || !s->cos_view || !s->tan2_half || !s->cos_difference) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: an array of the angles is NULL");
        }
        return BRDFFIT_OK;
    case BRDFFIT_FORM_COEFFICIENTS:
        if (!s->a || !s->b || !s->c) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: a, b or c is NULL");
        }
        if (s->quantity != BRDFFIT_QUANTITY_RADIANCE) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples given as a, b, c must hold radiance");
        }
        return BRDFFIT_OK;
    }
    return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: unknown form");
}

double brdffit_geometry_min_cosine(double max_incidence)
{
    double sine, cosine;

    if (max_incidence >= 90.0) {
        return 0.0;
    }
    degrees_sincos(max_incidence, &sine, &cosine);
    return cosine - TOL_INCIDENCE;
}

int brdffit_geometry_unit(const double *v, double out[3])
{
    double largest = larger(fabs(v[0]), larger(fabs(v[1]), fabs(v[2])));
    double x, y, z, length;

    if (!(isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && largest > 0.0)) {
        return 0;
    }
    if (largest < 1e-290) { /* so that dividing by it cannot overflow */
        x = v[0] * 1e300;
        y = v[1] * 1e300;
        z = v[2] * 1e300;
        largest *= 1e300;
    } else {
        x = v[0];
        y = v[1];
        z = v[2];
    }
    x /= largest;
    y /= largest;
    z /= largest;
    length = sqrt(x * x + y * y + z * z);
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
    return 1;
}

static brdffit_status vector_error(brdffit_error *error, const double *v, const char *message, size_t i)
{
    int j = 0;

    while (j < 2 && isfinite(v[j])) {
        j++;
    }
    return brdffit_fail_at(error, message, i, BRDFFIT_NONE, v[j]);
}

/* Whether 1 - r.v cancels: near the mirror direction, where it does so in n.l - n.v, and where r.v is about 0. */
static int mirror_cancels(const struct geometry_angles *g)
{
    double difference = g->cos_light - g->cos_view, sum = g->cos_light + g->cos_view;
    double off = 0.5 * (difference * difference + g->tan2_half * (sum * sum));

    return off < ACCURATE_TAN2 || fabs(1.0 - off) < ACCURATE_COSINE;
}

static int cancels(const struct geometry_angles *g, int general, int mirrored)
{
    return g->tan2_half < ACCURATE_TAN2 || g->cos_difference < 1e-3 ||
           (general && (fabs(g->cos_light) < ACCURATE_COSINE || fabs(g->cos_view) < ACCURATE_COSINE)) ||
           (mirrored && mirror_cancels(g));
}

/* 1 - v.h from |l - v|^2 = 4 (1 - (v.h)^2), for unit vectors. */
static double versine_of(const double l[3], const double v[3], double cos_difference)
{
    double apart[3] = {l[0] - v[0], l[1] - v[1], l[2] - v[2]};

    return 0.25 * dot3(apart, apart) / (1.0 + cos_difference);
}

/* sin^2 of the angle of unit vectors, from their cross product. */
static double sine2_of(const double n[3], const double v[3])
{
    double cross[3] = {n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2], n[0] * v[1] - n[1] * v[0]};

    return dot3(cross, cross);
}

/* What sin^2 of the angle with the normal says, once the cosines are there. */
static void tangents(double light, double view, struct geometry_angles *out)
{
    out->tan2_light = light / (out->cos_light * out->cos_light);
    out->tan2_view = view / (out->cos_view * out->cos_view);
    out->versine_light = light / (1.0 + out->cos_light);
    out->versine_view = view / (1.0 + out->cos_view);
}

/* Angles from unit vectors. Products with a normal of +z are exact, so that leaving them out changes no bit. */
static void angles_of_units(const double l[3], const double v[3], const double *n, struct geometry_angles *out)
{
    double h[3] = {l[0] + v[0], l[1] + v[1], l[2] + v[2]}, cross[3], cos_half, sine2;

    if (!n) {
        cos_half = h[2]; /* times |h| */
        sine2 = h[1] * h[1] + h[0] * h[0];
        out->cos_light = l[2];
        out->cos_view = v[2];
        tangents(l[0] * l[0] + l[1] * l[1], v[0] * v[0] + v[1] * v[1], out);
    } else {
        cross[0] = n[1] * h[2] - n[2] * h[1];
        cross[1] = n[2] * h[0] - n[0] * h[2];
        cross[2] = n[0] * h[1] - n[1] * h[0];
        cos_half = dot3(n, h);
        sine2 = dot3(cross, cross);
        out->cos_light = dot3(n, l);
        out->cos_view = dot3(n, v);
        tangents(sine2_of(n, l), sine2_of(n, v), out);
    }
    out->tan2_half = sine2 / (cos_half * cos_half);
    out->cos_difference = 0.5 * sqrt(dot3(h, h)); /* |l + v| = 2 cos(theta_d) for unit vectors */
    out->versine = versine_of(l, v, out->cos_difference);
}

static brdffit_status angles_of_directions(const brdffit_samples *s, size_t i, int mirrored,
                                           struct geometry_angles *out, brdffit_error *error)
{
    double l[3], v[3], n[3];

    if (!brdffit_geometry_unit(s->light + 3 * i, l)) {
        return vector_error(error, s->light + 3 * i, "light direction is not finite or has no length", i);
    }
    if (!brdffit_geometry_unit(s->view + 3 * i, v)) {
        return vector_error(error, s->view + 3 * i, "view direction is not finite or has no length", i);
    }
    if (s->normal && !brdffit_geometry_unit(s->normal + 3 * i, n)) {
        return vector_error(error, s->normal + 3 * i, "normal is not finite or has no length", i);
    }
    angles_of_units(l, v, s->normal ? n : NULL, out);
    out->accurate = 0;
    if (cancels(out, s->normal != NULL, mirrored)) {
        brdffit_geometry_accurate(s->light + 3 * i, s->view + 3 * i, s->normal ? s->normal + 3 * i : NULL, mirrored,
                                  out);
    }
    rounding_of_directions(out, s->normal != NULL);
    return BRDFFIT_OK;
}

static brdffit_status angles_given(const brdffit_samples *s, size_t i, struct geometry_angles *out,
                                   brdffit_error *error)
{
    out->cos_light = s->cos_light[i];
    out->cos_view = s->cos_view[i];
    out->tan2_half = s->tan2_half[i];
    out->cos_difference = s->cos_difference[i];
    out->versine = 1.0 - out->cos_difference;
    out->tan2_light = (1.0 - out->cos_light) * (1.0 + out->cos_light) / (out->cos_light * out->cos_light);
    out->tan2_view = (1.0 - out->cos_view) * (1.0 + out->cos_view) / (out->cos_view * out->cos_view);
    out->versine_light = 1.0 - out->cos_light;
    out->versine_view = 1.0 - out->cos_view;
    rounding_of_angles(out);
    if (!(fabs(out->cos_light) <= 1.0)) {
        return brdffit_fail_at(error, "cos_light is not in [-1, 1]", i, BRDFFIT_NONE, out->cos_light);
    }
    if (!(fabs(out->cos_view) <= 1.0)) {
        return brdffit_fail_at(error, "cos_view is not in [-1, 1]", i, BRDFFIT_NONE, out->cos_view);
    }
    if (!(out->tan2_half >= 0.0 && out->tan2_half <= LIMIT_C)) {
        return brdffit_fail_at(error, "tan2_half is not in [0, 1e100]", i, BRDFFIT_NONE, out->tan2_half);
    }
    if (!(out->cos_difference > 0.0 && out->cos_difference <= 1.0)) {
        return brdffit_fail_at(error, "cos_difference is not in (0, 1]", i, BRDFFIT_NONE, out->cos_difference);
    }
    return BRDFFIT_OK;
}

static brdffit_status coefficients_given(const brdffit_samples *s, size_t i, struct geometry *out, brdffit_error *error)
{
    out->a = s->a[i];
    out->b = s->b[i];
    out->c = s->c[i];
    out->cos_light = 1.0;
    out->light_error = out->b_error = out->c_error = out->b_hidden = out->c_hidden = 0.0;
    if (!(out->a >= 0.0 && isfinite(out->a))) {
        return brdffit_fail_at(error, "a is not finite and >= 0", i, BRDFFIT_NONE, out->a);
    }
    if (!(out->b >= 0.0 && isfinite(out->b))) {
        return brdffit_fail_at(error, "b is not finite and >= 0", i, BRDFFIT_NONE, out->b);
    }
    if (!(out->c >= 0.0 && out->c <= LIMIT_C)) {
        return brdffit_fail_at(error, "c is not in [0, 1e100]", i, BRDFFIT_NONE, out->c);
    }
    return BRDFFIT_OK;
}

brdffit_skip brdffit_geometry_sample(const brdffit_samples *s, brdffit_distribution distribution, double min_cosine,
                                     size_t i, struct geometry *out, brdffit_status *status, brdffit_error *error)
{
    const struct lobe_kind *kind = brdffit_lobe_kind_of(distribution);
    struct geometry_angles *angles = &out->angles;

    *status = BRDFFIT_OK;
    if (s->weights && !(s->weights[i] >= 0.0 && isfinite(s->weights[i]))) {
        *status = brdffit_fail_at(error, "weight is not finite and >= 0", i, BRDFFIT_NONE, s->weights[i]);
        return BRDFFIT_SKIP_COUNT;
    }
    if (s->weights && s->weights[i] == 0.0) {
        return BRDFFIT_SKIP_ZERO_WEIGHT;
    }
    if (s->form == BRDFFIT_FORM_COEFFICIENTS) {
        *status = coefficients_given(s, i, out, error);
        return BRDFFIT_SKIP_COUNT;
    }
    *status = s->form == BRDFFIT_FORM_DIRECTIONS ? angles_of_directions(s, i, kind->mirrored, angles, error)
                                                 : angles_given(s, i, angles, error);
    if (*status != BRDFFIT_OK) {
        return BRDFFIT_SKIP_COUNT;
    }
    if (!(angles->cos_light > LIMIT_GRAZING)) {
        return BRDFFIT_SKIP_LIGHT_BELOW_HORIZON;
    }
    if (!(angles->cos_view > LIMIT_GRAZING)) {
        return BRDFFIT_SKIP_VIEW_BELOW_HORIZON;
    }
    if (angles->cos_light < min_cosine) {
        return BRDFFIT_SKIP_INCIDENCE;
    }
    out->a = angles->cos_light / PI;
    out->cos_light = angles->cos_light;
    out->light_error = angles->light_error + 2.0 * TOL_UNIT;
    out->b_hidden = out->c_hidden = 0.0;
    kind->row(angles, out);
    return BRDFFIT_SKIP_COUNT;
}
