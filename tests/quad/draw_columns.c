/*
 * The families of the campaign with several columns a lobe and of the diffuse term, and with masking that depends on
 * roughness: other families with such models, and the edges that only these have. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "draw_families.h"

void draw_columns(struct draw *d)
{
    static void (*const family[])(struct draw *) = {draw_ordinary, draw_ordinary,   draw_ordinary, draw_gaps,
                                                    draw_relative, draw_no_mirror,  draw_units,    draw_near_equal,
                                                    draw_channels, draw_degenerate, draw_grazing};

    d->wide = 1;
    family[draw_below(d, sizeof family / sizeof family[0])](d);
}

void draw_columns_batch(struct draw *d)
{
    d->wide = 2;
    draw_batch(d);
}

/* The viewer as far from the light as `apart` degrees, on the other side of the normal or around the light. */
static void place(struct draw *d, size_t i, double theta, double apart)
{
    double phi = draw_uniform(d, 0.0, 360.0), other = theta - apart;

    draw_direction(theta, phi, d->light + 3 * i);
    draw_direction(fabs(other), other < 0.0 ? phi + 180.0 : phi, d->view + 3 * i);
}

/* Mostly v.h = 1 to the bit, or as near to it as directions get. */
static void retro(struct draw *d)
{
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double theta = draw_uniform(d, 0.0, 80.0);

        place(d, i, theta, draw_one_in(d, 3) ? draw_power(d, -16.0, 1.0) : 0.0);
        if (draw_one_in(d, 2)) {
            memcpy(d->view + 3 * i, d->light + 3 * i, 3 * sizeof *d->view);
        }
        d->cos_difference[i] = draw_one_in(d, 3) ? 1.0 - draw_power(d, -16.0, -1.0) : 1.0;
    }
}

/* One v.h for all, but for what rounding and a millionth part make of it: columns of a lobe are parallel. */
static void parallel(struct draw *d)
{
    double apart = draw_uniform(d, 5.0, 120.0), off = draw_one_in(d, 2) ? 0.0 : draw_power(d, -15.0, -2.0);
    double cosine = draw_uniform(d, 0.1, 0.9999);
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double theta = draw_uniform(d, fmax(0.0, apart - 85.0), 85.0);

        place(d, i, theta, apart * (1.0 + off * draw_normal(d)));
        d->cos_difference[i] = fmin(1.0, cosine * (1.0 + off * draw_normal(d)));
    }
}

/* Angles with the normal that vanish, or are tiny: tangents 0, and diffuse columns that vanish. */
static void upright(struct draw *d)
{
    double most = draw_power(d, -16.0, 1.5);
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double *at[2] = {d->light + 3 * i, d->view + 3 * i}, *cosine[2] = {d->cos_light + i, d->cos_view + i};
        int k;

        for (k = 0; k < 2; k++) {
            double theta = draw_one_in(d, 3) ? 0.0 : most * draw_uniform(d, 0.0, 1.0);

            draw_direction(theta, draw_uniform(d, 0.0, 360.0), at[k]);
            *cosine[k] = cos(theta * 0.0174533);
        }
    }
}

/* Single samples at the horizon: tangents up to 1e12 beside ordinary ones. */
static void horizon(struct draw *d)
{
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double *at[2] = {d->light + 3 * i, d->view + 3 * i}, *cosine[2] = {d->cos_light + i, d->cos_view + i};
        int k;

        for (k = 0; k < 2; k++) {
            if (draw_one_in(d, 2)) {
                double above = draw_power(d, -12.0, 1.0);

                draw_direction(90.0 - above, draw_uniform(d, 0.0, 360.0), at[k]);
                *cosine[k] = sin(above * 0.0174533);
            }
        }
    }
}

/* c rises where tangents fall: with Smith's masking the sample of the smaller c may fall faster. */
static void crossing(struct draw *d)
{
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double share = draw_uniform(d, 0.0, 1.0);

        d->tan2_half[i] = pow(10.0, -6.0 + 6.0 * share);
        d->cos_light[i] = pow(10.0, -4.0 + 4.0 * share);
        d->cos_view[i] = draw_one_in(d, 2) ? d->cos_light[i] : draw_uniform(d, 0.1, 1.0);
        place(d, i, 89.0 - 60.0 * share, 2.0 * (89.0 - 60.0 * share) + 20.0 * share * draw_uniform(d, -1.0, 1.0));
    }
}

static void nothing(struct draw *d)
{
    (void)d;
}

void draw_columns_edges(struct draw *d)
{
    static void (*const edge[])(struct draw *) = {retro, parallel, upright, horizon, crossing, nothing};
    brdffit_options *o = &d->question.options;

    d->wide = 1;
    draw_shape(d, 1 + draw_below(d, 10), 1 + draw_below(d, 3), 1, (brdffit_form)draw_below(d, 2));
    draw_options(d);
    o->max_incidence = 90.0;
    draw_geometry(d, 75.0);
    edge[draw_below(d, sizeof edge / sizeof edge[0])](d);
    if (draw_one_in(d, 3)) {
        draw_random_weights(d, draw_one_in(d, 4) ? -300.0 : -6.0, draw_one_in(d, 4) ? 140.0 : 6.0);
    }
    if (draw_one_in(d, 4)) {
        o->sigma_max = draw_power(d, -12.0, 3.0);
        o->sigma_min = draw_one_in(d, 2) ? o->sigma_max : fmax(1e-12, o->sigma_max * draw_power(d, -6.0, 0.0));
    }
    draw_truth(d, draw_power(d, -4.0, -1.0), 2.0, draw_one_in(d, 3) ? 0.0 : draw_power(d, -12.0, 0.0));
}
