/* sample.c: single samples of a table. SPDX-License-Identifier: MIT */
#include "sample.h"

#include <math.h>

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length(const double *a)
{
    return sqrt(dot(a, a));
}

static double tangent_squared(const double *normal, const double *half)
{
    /* |n x h|^2 / (n.h)^2: exact near the normal, where 1/cos^2 - 1 is not. */
    const double cross[3] = {normal[1] * half[2] - normal[2] * half[1], normal[2] * half[0] - normal[0] * half[2],
                             normal[0] * half[1] - normal[1] * half[0]};
    const double cosine = dot(normal, half);
    return cosine > 0 ? dot(cross, cross) / (cosine * cosine) : INFINITY;
}

void brdffit_cli_angles(const brdffit_samples *samples, size_t i, struct cli_angles *angles)
{
    static const double up[3] = {0, 0, 1};
    if (samples->form == BRDFFIT_FORM_COEFFICIENTS) {
        angles->cos_light = angles->cos_view = NAN;
        angles->tan2_half = samples->c[i];
        return;
    }
    if (samples->form == BRDFFIT_FORM_ANGLES) {
        angles->cos_light = samples->cos_light[i];
        angles->cos_view = samples->cos_view[i];
        angles->tan2_half = samples->tan2_half[i];
        return;
    }
    const double *const light = samples->light + 3 * i;
    const double *const view = samples->view + 3 * i;
    const double *const normal = samples->normal == NULL ? up : samples->normal + 3 * i;
    const double l = length(light), v = length(view), n = length(normal);
    const double half[3] = {light[0] / l + view[0] / v, light[1] / l + view[1] / v, light[2] / l + view[2] / v};
    angles->cos_light = dot(normal, light) / (n * l);
    angles->cos_view = dot(normal, view) / (n * v);
    angles->tan2_half = tangent_squared(normal, half);
}

static const double *at(const double *array, size_t index)
{
    return array == NULL ? NULL : array + index;
}

void brdffit_cli_slice(const brdffit_samples *samples, size_t i, brdffit_samples *one)
{
    *one = *samples;
    one->count = 1;
    one->light = at(samples->light, 3 * i);
    one->view = at(samples->view, 3 * i);
    one->normal = at(samples->normal, 3 * i);
    one->cos_light = at(samples->cos_light, i);
    one->cos_view = at(samples->cos_view, i);
    one->tan2_half = at(samples->tan2_half, i);
    one->cos_difference = at(samples->cos_difference, i);
    one->a = at(samples->a, i);
    one->b = at(samples->b, i);
    one->c = at(samples->c, i);
    one->values = at(samples->values, samples->channels * i);
    one->weights = at(samples->weights, i);
}

int brdffit_cli_is_used(const brdffit_samples *samples, const brdffit_options *options, size_t i)
{
    brdffit_samples one;
    size_t used = 0;
    brdffit_cli_slice(samples, i, &one);
    return brdffit_inspect(&one, options, &used, NULL, 0, NULL) == BRDFFIT_OK && used == 1;
}

double brdffit_cli_to_radiance(const brdffit_samples *samples, size_t i)
{
    if (samples->quantity == BRDFFIT_QUANTITY_RADIANCE) {
        return 1;
    }
    struct cli_angles angles;
    brdffit_cli_angles(samples, i, &angles);
    return angles.cos_light;
}

double brdffit_cli_weight(const brdffit_samples *samples, size_t i)
{
    return samples->weights == NULL ? 1 : samples->weights[i];
}
