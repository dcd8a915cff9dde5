/*
 * Problems of plain models (one Lambert column, one column a lobe, V-cavities) whose results are golden: their data are made by
 * exact or correctly rounded arithmetic alone. The numbers are those of a build from before lobes had several columns.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_COLUMNS_GOLDEN_H
#define BRDFFIT_TESTS_COLUMNS_GOLDEN_H

#include "brdffit.h"

#define GOLDEN_SAMPLES 24

struct golden_data {
    double light[GOLDEN_SAMPLES], view[GOLDEN_SAMPLES], tan2[GOLDEN_SAMPLES], difference[GOLDEN_SAMPLES];
    double weights[GOLDEN_SAMPLES], values[2 * GOLDEN_SAMPLES];
};

/* One fit, and its sigma of the last lobe, e2 and lower bound. */
struct golden_fit {
    brdffit_distribution first, last;
    int lobes;
    brdffit_norm norm;
    brdffit_engine engine;
    double sigma, e2, lower_bound;
    size_t boxes;
};

static inline brdffit_samples golden_samples(struct golden_data *d)
{
    brdffit_samples s;
    int i;

    for (i = 0; i < GOLDEN_SAMPLES; i++) {
        double t = (i / 2) * (i / 2) / 400.0;

        d->light[i] = 0.3 + 0.7 * (i * 7 % 24) / 24.0;
        d->view[i] = 0.35 + 0.6 * (i * 5 % 24) / 24.0;
        d->tan2[i] = t;
        d->difference[i] = 0.5 + 0.5 * (i * 11 % 24) / 24.0;
        d->weights[i] = 1.0 + i % 3;
        d->values[2 * i] = 0.3 * d->light[i] + 0.8 / (1.0 + 40.0 * t) + 0.001 * (i * 13 % 7);
        d->values[2 * i + 1] = 0.1 * d->light[i] + 0.5 / ((1.0 + 9.0 * t) * (1.0 + 9.0 * t)) + 0.002 * (i * 11 % 5);
    }
    brdffit_samples_init(&s);
    s.count = GOLDEN_SAMPLES;
    s.channels = 2;
    s.form = BRDFFIT_FORM_ANGLES;
    s.quantity = BRDFFIT_QUANTITY_RADIANCE;
    s.cos_light = d->light;
    s.cos_view = d->view;
    s.tan2_half = d->tan2;
    s.cos_difference = d->difference;
    s.weights = d->weights;
    s.values = d->values;
    return s;
}

static inline const brdffit_result *golden_result(const struct golden_fit *g, struct golden_data *d)
{
    brdffit_distribution list[3] = {g->first, g->last, g->last};
    const brdffit_result *result = NULL;
    brdffit_samples s = golden_samples(d);
    brdffit_options o;

    brdffit_options_init(&o);
    o.lobes = g->lobes;
    o.distribution = g->first;
    o.distributions = list;
    o.norm = g->norm;
    o.engine = g->engine;
    o.relative_gap = g->lobes > 2 || g->engine == BRDFFIT_ENGINE_SOCP || g->norm != BRDFFIT_NORM_L2 ? 0.05 : 1e-4;
    o.box_budget = 4000;
    o.max_incidence = 90.0;
    (void)brdffit_fit_new(&s, &o, &result, NULL);
    return result;
}

/* clang-format off */
#define B BRDFFIT_BECKMANN
#define G BRDFFIT_GGX
static const struct golden_fit golden_fits[] = {
    {B, B, 1, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.c5a60d8871559p-3, 0x1.32fc6dec2a92cp+0, 0x1.32f9d5ed6a296p+0, 32},
    {B, B, 2, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.e454a33fbb8ebp-3, 0x1.280301415ed36p+0, 0x1.27fba427fb20bp+0, 567},
    {G, G, 1, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.11542216b4be3p-2, 0x1.4db09fd378e39p+0, 0x1.4dab6df821b98p+0, 44},
    {G, G, 2, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.2beb24403a68ep-2, 0x1.449fdf998153p+0, 0x1.4498e866af302p+0, 598},
    {B, G, 2, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.4147cfef7de8dp-3, 0x1.288b49480fd2ap+0, 0x1.2883e70418916p+0, 904},
    {B, G, 3, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.8p+2, 0x1.288b49480fd2ap+0, 0x1.f8bd6c23b20c7p-2, 4000},
    {BRDFFIT_WARD, BRDFFIT_LAFORTUNE, 2, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.49c27ed7ce41p-4, 0x1.65c52e41da96ep-1, 0x1.65bc462f5060ap-1, 810},
    {BRDFFIT_BLINN_PHONG, BRDFFIT_BLINN_PHONG, 1, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.42cfedbbf060fp-3, 0x1.97059a4a27156p+0, 0x1.96fd4b978f419p+0, 36},
    {BRDFFIT_TORRANCE_SPARROW, BRDFFIT_ASHIKHMIN_SHIRLEY, 2, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT, 0x1.26b720828ab7dp-3, 0x1.16e3c0e55c112p+0, 0x1.16dcdf7b5942p+0, 732},
};
#undef B
#undef G
/* clang-format on */

#endif
