/*
 * The families of the campaign, part 2 of 2: edges of what the library takes, other routes through it, and the list of
 * all. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "draw_families.h"

/* Gaps down to 1e-13 of problems that fit well, badly and exactly, without an absolute gap. */
void draw_gaps(struct draw *d)
{
    draw_ordinary(d);
    d->question.options.relative_gap = draw_power(d, -13.0, -5.0);
    d->question.options.absolute_gap = draw_one_in(d, 4) ? draw_power(d, -18.0, -10.0) : 0.0;
    d->question.options.box_budget = 8000;
    draw_truth(d, 0.02, 2.0, draw_one_in(d, 3) ? 0.0 : draw_power(d, -14.0, 0.5));
}

/* A range that begins or ends at s, or is only that; 1 where s is its largest. */
static int range_from(struct draw *d)
{
    brdffit_options *o = &d->question.options;

    o->sigma_max = o->sigma_min = draw_power(d, -11.9, 2.0);
    o->exponent_min = o->exponent_max = draw_power(d, -5.0, 23.0);
    if (draw_one_in(d, 3)) {
        return 0;
    }
    if (draw_one_in(d, 2)) {
        o->sigma_min = fmax(1e-12, o->sigma_max * draw_power(d, -6.0, 0.0));
        o->exponent_max = fmin(1e24, o->exponent_min * draw_power(d, 0.0, 6.0));
        return 0;
    }
    o->sigma_max = fmin(1e3, o->sigma_min * draw_power(d, 0.0, 6.0));
    o->exponent_min = fmax(1e-6, o->exponent_max * draw_power(d, -6.0, 0.0));
    return 1;
}

/*
 * The optimum is an end of the range, with c s = x there: b exp(-c s) of the second sample is 1 there, and what s is off
 * by relative to the end changes it by x times that. Data above the lobe where it grows beyond the end.
 */
static void draw_ends(struct draw *d)
{
    brdffit_options *o = &d->question.options;
    double x = draw_power(d, -1.0, 2.7);
    int largest, a;
    size_t i;
    quad s;

    draw_shape(d, 2 + (draw_one_in(d, 2) ? draw_below(d, 4) : 0), 1, 1, BRDFFIT_FORM_COEFFICIENTS);
    draw_options(d);
    o->relative_gap = draw_power(d, -14.0, draw_one_in(d, 4) ? -3.0 : -12.0);
    o->absolute_gap = draw_one_in(d, 4) ? o->absolute_gap : 0.0;
    largest = range_from(d);
    s = largest ? quad_s(o->sigma_min) : quad_s(o->sigma_max);
    if (quad_by_exponent(d->question.distribution[0])) {
        s = largest ? o->exponent_max : o->exponent_min;
    }
    a = draw_one_in(d, 4);
    for (i = 0; i < d->samples.count; i++) {
        double low = draw_power(d, -4.0, -1.0), high = draw_uniform(d, 0.5, 1.0);

        d->a[i] = a ? draw_uniform(d, 0.0, 0.1) : 0.0;
        d->c[i] = i ? (double)(x * (i == 1 ? 1.0 : draw_uniform(d, 0.0, 1.0)) / s) : 0.0;
        d->b[i] = d->question.distribution[0] == BRDFFIT_GGX ? 1.0 : (double)expq(d->c[i] * s);
        d->values[i] = (i == 0) == largest ? high : low;
    }
}

/* Products that are subnormal or vanish: single weights, values and coefficients far below the others. */
static void draw_subnormal(struct draw *d)
{
    size_t i;

    draw_shape(d, 2 + draw_below(d, 10), 1 + draw_below(d, 2), 1, BRDFFIT_FORM_COEFFICIENTS);
    draw_options(d);
    draw_geometry(d, 60.0);
    draw_values(d);
    draw_random_weights(d, -1.0, 1.0);
    for (i = 0; i < d->samples.count; i++) {
        int single = draw_one_in(d, 4);

        d->a[i] = fmax(d->a[i], 0.1) * (single && draw_one_in(d, 2) ? 1.0 : draw_power(d, -165.0, -140.0));
        d->b[i] *= draw_one_in(d, 4) ? draw_power(d, -140.0, 0.0) : 1.0;
        d->weights[i] = single ? draw_power(d, -323.0, -100.0) : d->weights[i];
        d->values[i * d->samples.channels] *= single && draw_one_in(d, 2) ? draw_power(d, 0.0, 100.0) : 1.0;
    }
    if (draw_one_in(d, 2)) {
        for (i = 0; i < d->samples.count; i++) {
            d->a[i] = draw_uniform(d, 0.1, 0.3);
        }
    }
}

/* Turn both directions of sample i into the frame of a random normal; lengths are any. */
static void tilt(struct draw *d, size_t i)
{
    double frame[3][3], theta = draw_uniform(d, 0.0, 180.0), phi = draw_uniform(d, 0.0, 360.0);
    double *vector[2] = {d->light + 3 * i, d->view + 3 * i};
    int j, k;

    draw_direction(theta + 90.0, phi, frame[0]);
    draw_direction(90.0, phi + 90.0, frame[1]);
    draw_direction(theta, phi, frame[2]);
    for (k = 0; k < 2; k++) {
        double turned[3], length = draw_power(d, -5.0, 5.0);

        for (j = 0; j < 3; j++) {
            turned[j] = vector[k][0] * frame[0][j] + vector[k][1] * frame[1][j] + vector[k][2] * frame[2][j];
            turned[j] *= length;
        }
        memcpy(vector[k], turned, sizeof turned);
    }
    memcpy(d->normal + 3 * i, frame[2], sizeof frame[2]);
}

void draw_grazing(struct draw *d)
{
    size_t i;
    int normals;

    draw_shape(d, 2 + draw_below(d, 9), 1 + draw_below(d, 3), 1, BRDFFIT_FORM_DIRECTIONS);
    draw_options(d);
    draw_geometry(d, 85.0);
    d->question.options.max_incidence = 90.0;
    normals = draw_one_in(d, 2);
    d->samples.normal = normals ? d->normal : NULL;
    for (i = 0; i < d->samples.count; i++) {
        double *at[2] = {d->light + 3 * i, d->view + 3 * i};
        int k;

        for (k = 0; k < 2; k++) {
            if (draw_one_in(d, 2)) {
                draw_direction(90.0 - draw_power(d, normals ? -10.0 : -13.0, 1.0), draw_uniform(d, 0.0, 360.0), at[k]);
            }
        }
        if (normals) {
            tilt(d, i);
        }
    }
    draw_values(d);
}

/* Directions exactly (by whole numbers) and nearly 90 degrees from the mirror direction. */
static void draw_lafortune(struct draw *d)
{
    size_t i;
    int j;

    draw_shape(d, 2 + draw_below(d, 10), 1 + draw_below(d, 2), 1, BRDFFIT_FORM_DIRECTIONS);
    for (j = 0; j < QUAD_LOBES; j++) {
        d->question.distribution[j] = BRDFFIT_LAFORTUNE;
    }
    draw_options(d);
    d->question.options.exponent_min = draw_power(d, -3.0, -1.0);
    d->question.options.exponent_max = 1e7;
    draw_geometry(d, 80.0);
    d->question.options.max_incidence = 90.0;
    for (i = 0; i < d->samples.count; i++) {
        double p = 1.0 + (double)draw_below(d, 9), q = 1.0 + (double)draw_below(d, 9);
        double theta = 10.0 + 10.0 * (double)draw_below(d, 7);
        double *l = d->light + 3 * i, *v = d->view + 3 * i;

        if (draw_one_in(d, 3)) { /* v.(-p, 0, q) = 0 exactly */
            l[0] = p, l[1] = 0.0, l[2] = q;
            v[0] = q, v[1] = draw_uniform(d, -1.0, 1.0), v[2] = p;
        } else if (draw_one_in(d, 2)) {
            draw_direction(theta, 0.0, l);
            draw_direction(90.0 - theta, 0.0, v);
        }
        if (draw_one_in(d, 4)) {
            v[0] += draw_power(d, -17.0, -3.0) * (draw_one_in(d, 2) ? 1.0 : -1.0);
        }
    }
    draw_values(d);
    for (i = 0; i < d->samples.count * d->samples.channels && draw_one_in(d, 2); i++) {
        d->values[i] = draw_one_in(d, 4) ? 0.0 : 1.0;
    }
}

/* Data that fit exactly, vanish, repeat, are negative; one sample. */
void draw_degenerate(struct draw *d)
{
    size_t i, kind = draw_below(d, 5);

    draw_shape(d, 1 + draw_below(d, 5), 1 + draw_below(d, 3), 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    draw_geometry(d, 60.0);
    draw_truth(d, 0.02, 2.0, kind == 0 ? 0.0 : 0.1);
    for (i = 0; i < d->samples.count * d->samples.channels; i++) {
        double *value = d->values + i;

        *value = kind == 1 ? -*value : kind == 2 && draw_one_in(d, 2) ? 0.0 : kind == 3 ? 1.0 : *value;
        *value *= kind == 4 && draw_one_in(d, 2) ? -1.0 : 1.0;
    }
}

/* Any sample of the families above, with more rows of it for bins. */
static void draw_sums(struct draw *d)
{
    int bins = draw_one_in(d, 2);
    size_t n = bins ? 8 + draw_below(d, 30) : 2 + draw_below(d, 11);

    draw_shape(d, n, 1 + draw_below(d, 3), 1, (brdffit_form)draw_below(d, 3));
    draw_options(d);
    d->question.options.norm = BRDFFIT_NORM_L2;
    d->question.options.engine = BRDFFIT_ENGINE_MOMENT;
    draw_geometry(d, draw_one_in(d, 3) ? 85.0 : 60.0);
    if (draw_one_in(d, 2)) {
        draw_random_weights(d, draw_one_in(d, 2) ? -3.0 : -40.0, 3.0);
    }
    draw_values(d);
    d->route = bins ? DRAW_BINS : DRAW_SUMS;
    d->bits = bins ? 1 + (int)draw_below(d, 6) : 0;
    d->groups = bins ? 16 + 8 * draw_below(d, 12) + ((size_t)16 << d->bits) : n;
}

void draw_batch(struct draw *d)
{
    static void (*const geometry[])(struct draw *) = {draw_ordinary, draw_no_mirror, draw_near_equal, draw_relative};
    size_t t, i, length, texels = 1 + draw_below(d, 6);
    struct draw one = *d;

    geometry[draw_below(d, 4)](&one);
    d->wide = 0; /* the question is that of `one` */
    draw_shape(d, one.samples.count, one.samples.channels, texels, one.samples.form);
    length = one.samples.count * one.samples.channels;
    memcpy(d->block, one.block, (size_t)(one.values - one.block) * sizeof *d->block);
    d->samples.weights = one.samples.weights ? d->weights : NULL;
    d->samples.quantity = one.samples.quantity;
    d->question.options = one.question.options;
    d->question.options.norm = BRDFFIT_NORM_L2;
    for (t = 0; t < texels; t++) {
        double *values = d->values + t * length;

        for (i = 0; i < length; i++) {
            values[i] = one.values[i] * (t ? 1.0 + draw_uniform(d, -0.5, 0.5) : 1.0);
            values[i] *= t % 4 == 3 ? 1e-9 : 1.0;
        }
        if (t && draw_one_in(d, 6)) {
            memcpy(values, values - length, length * sizeof *values);
        }
    }
    d->route = DRAW_MANY;
    draw_free(&one);
}

const struct draw_family draw_families[] = {
    {"ordinary", draw_ordinary},
    {"relative", draw_relative},
    {"spans", draw_spans},
    {"units", draw_units},
    {"no_mirror", draw_no_mirror},
    {"near_equal", draw_near_equal},
    {"channels", draw_channels},
    {"gaps", draw_gaps},
    {"ends", draw_ends},
    {"subnormal", draw_subnormal},
    {"grazing", draw_grazing},
    {"lafortune", draw_lafortune},
    {"degenerate", draw_degenerate},
    {"sums", draw_sums},
    {"batch", draw_batch},
    {"columns", draw_columns},
    {"col_edges", draw_columns_edges},
    {"col_batch", draw_columns_batch},
};

const int draw_family_count = (int)(sizeof draw_families / sizeof draw_families[0]);
