/*
 * A small valid problem of each form, in writable arrays, for tests to spoil. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_MISUSE_PROBLEM_H
#define BRDFFIT_TESTS_MISUSE_PROBLEM_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

#define COUNT 12
#define CHANNELS 2

struct problem {
    brdffit_samples samples;
    double light[3 * COUNT], view[3 * COUNT], normal[3 * COUNT];
    double cos_light[COUNT], cos_view[COUNT], tan2_half[COUNT], cos_difference[COUNT];
    double a[COUNT], b[COUNT], c[COUNT], weights[COUNT], values[CHANNELS * COUNT];
};

static inline void problem_init(struct problem *p, brdffit_form form)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    size_t i;

    spec.count = COUNT;
    spec.channels = CHANNELS;
    brdffit_test_data_new(&spec, &data);
    p->samples = data.samples;
    p->samples.form = form;
    memcpy(p->light, data.samples.light, sizeof p->light);
    memcpy(p->view, data.samples.view, sizeof p->view);
    memcpy(p->cos_light, data.samples.cos_light, sizeof p->cos_light);
    memcpy(p->cos_view, data.samples.cos_view, sizeof p->cos_view);
    memcpy(p->tan2_half, data.samples.tan2_half, sizeof p->tan2_half);
    memcpy(p->cos_difference, data.samples.cos_difference, sizeof p->cos_difference);
    memcpy(p->a, data.samples.a, sizeof p->a);
    memcpy(p->b, data.samples.b, sizeof p->b);
    memcpy(p->c, data.samples.c, sizeof p->c);
    memcpy(p->values, data.values, sizeof p->values);
    for (i = 0; i < COUNT; i++) {
        p->normal[3 * i] = p->normal[3 * i + 1] = 0.0;
        p->normal[3 * i + 2] = 2.0;
        p->weights[i] = 1.0;
    }
    p->samples.light = p->light;
    p->samples.view = p->view;
    p->samples.normal = p->normal;
    p->samples.cos_light = p->cos_light;
    p->samples.cos_view = p->cos_view;
    p->samples.tan2_half = p->tan2_half;
    p->samples.cos_difference = p->cos_difference;
    p->samples.a = p->a;
    p->samples.b = p->b;
    p->samples.c = p->c;
    p->samples.weights = p->weights;
    p->samples.values = p->values;
    brdffit_test_data_free(&data);
}

static inline struct brdffit_test_result fit_and_free(const brdffit_samples *samples, const brdffit_options *options)
{
    struct brdffit_test_fit fit;
    struct brdffit_test_result result;

    brdffit_test_fit(samples, options, &fit);
    result = fit.result;
    brdffit_test_fit_free(&fit);
    return result;
}

#endif
