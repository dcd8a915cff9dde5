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
#include "columns_golden.inc"
};
#undef B
#undef G
/* clang-format on */

#endif
