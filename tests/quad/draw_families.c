/*
 * The families of the campaign, part 1 of 2: problems as data give them, and stretched ones. SPDX-License-Identifier: MIT
 */
#include "draw_families.h"

#include <math.h>

void draw_ordinary(struct draw *d)
{
    draw_shape(d, 2 + draw_below(d, 11), 1 + draw_below(d, 3), 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, draw_one_in(d, 3) ? 85.0 : 60.0);
    if (draw_one_in(d, 3)) {
        draw_random_weights(d, -3.0, 3.0);
    }
    draw_values(d);
}

/* Weights 1/I^2 on data of a narrow lobe: b sqrt(w) spans what exp(c / sigma^2) does. */
void draw_relative(struct draw *d)
{
    double sigma = draw_power(d, -1.7, -0.5), noise = draw_one_in(d, 3) ? 0.0 : draw_power(d, -3.0, -0.5);
    size_t i, k;

    draw_shape(d, 3 + draw_below(d, draw_one_in(d, 4) ? 38 : 10), 1 + draw_below(d, 2), 1,
               (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, 60.0);
    d->no_diffuse = !draw_one_in(d, 3);
    for (i = 0; i < d->samples.count; i++) {
        d->a[i] = draw_one_in(d, 2) ? 0.0 : draw_uniform(d, 0.1, 0.3);
        d->c[i] = draw_power(d, -4.0, 0.0);
        d->tan2_half[i] = draw_power(d, -4.0, 0.0);
    }
    draw_truth(d, sigma, sigma * draw_power(d, 0.0, 0.5), d->no_diffuse ? 0.0 : draw_power(d, -3.0, -1.0));
    d->samples.weights = d->weights;
    for (i = 0; i < d->samples.count; i++) {
        double *values = d->values + i * d->samples.channels, sum = 0.0;

        for (k = 0; k < d->samples.channels; k++) {
            values[k] = fabs(values[k]);
            sum += values[k];
        }
        values[0] *= 1.0 + noise * draw_normal(d); /* relative, as such weights are for */
        d->weights[i] = fmin(1.0 / (sum * sum), 1e300);
    }
}

/* Coefficients whose b sqrt(w) spans up to 1e300 and meets exp(-c / sigma^2) somewhere inside the domain. */
void draw_spans(struct draw *d)
{
    double span = draw_uniform(d, 0.0, draw_one_in(d, 2) ? 140.0 : 300.0), meet = draw_power(d, -2.0, 4.0);
    double apart = draw_power(d, -6.0, -0.5); /* from where they would all meet in one point */
    size_t i, n = 2 + draw_below(d, 11);
    int weights = draw_one_in(d, 2);

    draw_shape(d, n, 1 + draw_below(d, 3), 1, BRDFFIT_FORM_COEFFICIENTS);
    draw_options(d);
    draw_geometry(d, 60.0);
    draw_random_weights(d, -1.0, 1.0);
    d->samples.weights = draw_one_in(d, 2) || weights ? d->weights : NULL;
    for (i = 0; i < n; i++) {
        double power = i ? draw_uniform(d, 0.0, span) : 0.0;

        d->b[i] = pow(10.0, weights ? power / 2 : power);
        d->weights[i] = weights ? pow(10.0, power) : d->weights[i];
        d->c[i] = draw_one_in(d, 6) ? draw_power(d, -4.0, 1.0)
                                    : power * 2.302585 / meet * fabs(1.0 + apart * draw_normal(d));
    }
    draw_truth(d, 1.0 / sqrt(100.0 * meet), 3.0 / sqrt(meet), draw_one_in(d, 4) ? 0.0 : draw_power(d, -6.0, 0.0));
    for (i = 0; i < n && draw_one_in(d, 3); i++) {
        d->values[i * d->samples.channels] = draw_uniform(d, 0.0, 1.0);
    }
}

static void scale(double *array, size_t n, double factor)
{
    size_t i;

    for (i = 0; i < n; i++) {
        array[i] *= factor;
    }
}

void draw_units(struct draw *d)
{
    size_t n, i;

    draw_ordinary(d);
    n = d->samples.count;
    scale(d->values, n * d->samples.channels, draw_power(d, -305.0, 300.0));
    if (d->samples.weights) {
        scale(d->weights, n, draw_power(d, -150.0, 150.0));
    }
    for (i = 0; i < n && d->samples.channels > 1 && draw_one_in(d, 2); i++) { /* channels of different units */
        d->values[i * d->samples.channels] *= 1e-12;
    }
    if (d->samples.form == BRDFFIT_FORM_COEFFICIENTS) {
        scale(d->a, n, draw_power(d, -100.0, 100.0));
        scale(d->b, n, draw_power(d, -100.0, 100.0));
        scale(d->c, n, draw_power(d, -20.0, 20.0));
    }
}

/* No sample near the mirror direction: c_min is large, and the domain ends at sigma_floor. */
void draw_no_mirror(struct draw *d)
{
    double half = draw_uniform(d, 2.0, 45.0), spread = draw_power(d, -4.0, 1.0), sigma = half * 0.0175 / 5.0;
    size_t i;

    draw_shape(d, 2 + draw_below(d, 8), 1 + draw_below(d, 2), 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, 60.0);
    d->question.options.max_incidence = 90.0;
    for (i = 0; i < d->samples.count; i++) {
        double at = half + spread * draw_uniform(d, 0.0, 1.0), off = draw_uniform(d, 0.0, 20.0);

        draw_direction(at + off, 0.0, d->light + 3 * i);
        draw_direction(at - off, 0.0, d->view + 3 * i); /* a negative angle is the other side */
        d->tan2_half[i] = tan(at * 0.0174533) * tan(at * 0.0174533);
        d->c[i] = d->tan2_half[i];
        d->b[i] = draw_power(d, -1.0, 1.0);
    }
    draw_truth(d, sigma * 0.2, sigma * 20.0, draw_one_in(d, 3) ? 0.0 : draw_power(d, -6.0, 0.0));
    for (i = 0; i < d->samples.count && draw_one_in(d, 2); i++) { /* falling by half: wants the narrowest lobe */
        scale(d->values + i * d->samples.channels, d->samples.channels, pow(0.5, (double)i));
    }
    if (draw_one_in(d, 2)) {
        scale(d->values, d->samples.count * d->samples.channels, draw_power(d, -30.0, 10.0));
    }
}

/* Half angles that are the same or nearly: mirror images, and angles that differ by 1e-16 to 1e-9. */
void draw_near_equal(struct draw *d)
{
    double at = draw_one_in(d, 2) ? 0.0 : draw_power(d, -9.0, 1.5), theta = draw_uniform(d, 10.0, 50.0);
    size_t i;

    draw_shape(d, 2 + draw_below(d, 9), 1 + draw_below(d, 3), 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, 60.0);
    for (i = 0; i < d->samples.count; i++) {
        double here = draw_one_in(d, 5) ? draw_power(d, -8.0, 1.0) : at + draw_power(d, -14.5, -7.0), radian;
        double phi = draw_one_in(d, 2) ? 0.0 : draw_uniform(d, 0.0, 360.0);

        radian = here * 0.017453292519943295;
        theta = draw_one_in(d, 2) ? theta : draw_uniform(d, 0.0, 50.0);
        draw_direction(theta + 2.0 * here, phi, d->light + 3 * i);
        draw_direction(theta, phi + 180.0, d->view + 3 * i);
        d->tan2_half[i] = tan(radian) * tan(radian);
        d->c[i] = d->tan2_half[i];
        d->b[i] = draw_one_in(d, 2) ? 1.0 : draw_power(d, -1.0, 1.0);
    }
    draw_truth(d, 1e-12, 1.0, draw_one_in(d, 2) ? 0.0 : draw_power(d, -12.0, 0.0));
    for (i = 0; i < d->samples.count * d->samples.channels && draw_one_in(d, 2); i++) {
        d->values[i] = draw_power(d, -3.0, 0.0);
    }
}

void draw_channels(struct draw *d)
{
    double u = draw_uniform(d, 0.0, 1.0);
    size_t i, k, channels = (size_t)pow(10.0, 4.0 * u * u * u * u * u);

    draw_shape(d, 2 + draw_below(d, 7), channels, 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, 60.0);
    draw_values(d);
    for (k = 1; k < channels; k++) { /* some dark, some repeated, some of other units */
        double factor = draw_one_in(d, 8) ? 0.0 : draw_one_in(d, 8) ? draw_power(d, -20.0, 5.0) : 1.0;
        int repeat = draw_one_in(d, 8);

        for (i = 0; i < d->samples.count; i++) {
            double *value = d->values + i * channels + k;

            *value = factor * (repeat ? value[-1] : *value);
        }
    }
    if (channels > 100) {
        d->question.options.box_budget = 200;
    }
}
