/* A batch of texels for tests: see batch.h. SPDX-License-Identifier: MIT */
#include "batch.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void brdffit_test_batch_plan(struct brdffit_test_batch *b)
{
    size_t size = brdffit_plan_size(&b->data.samples, &b->options);
    brdffit_error error;

    assert_true(size > 0);
    b->memory = malloc(size);
    if (brdffit_plan_init(&b->data.samples, &b->options, b->memory, size, &b->plan, &error) != BRDFFIT_OK) {
        fail_msg("brdffit_plan_init: %s", error.message);
    }
}

void brdffit_test_batch_results(struct brdffit_test_batch *b)
{
    size_t n = b->count, K = b->channels, P = b->lobes;
    double *at;

    at = b->block = calloc(n + 1, (P + 4 * K + 2 * K * P + 3) * sizeof(double));
    b->status = calloc(n + 1, 2);
    b->where = calloc(n + 1, 2 * sizeof(size_t));
    assert_non_null(at);
    brdffit_texel_results_init(&b->results);
    b->results.sigma = at;
    b->results.x = (at += n * P);
    b->results.y = (at += n * K);
    b->results.channel_scale = (at += n * K * P);
    b->results.e2 = (at += n * K);
    b->results.lower_bound = (at += n);
    b->results.sum_of_squares = (at += n);
    b->results.f0 = (at += n);
    b->results.x_more = at + n * K * P;
    b->results.status = b->status;
    b->results.stop = b->stop = b->status + n;
    b->results.where = b->where;
    b->results.boxes = b->boxes = b->where + n;
}

void brdffit_test_batch_new(struct brdffit_test_batch *b, struct brdffit_test_spec spec, size_t count, int lobes,
                            uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    size_t t, length;

    memset(b, 0, sizeof *b);
    b->count = count;
    b->samples = spec.count;
    b->channels = spec.channels;
    b->lobes = (size_t)lobes;
    brdffit_options_init(&b->options);
    b->options.lobes = lobes;
    length = spec.count * spec.channels;
    b->values = malloc((count * length + 1) * sizeof(double));
    for (t = 0; t < count; t++) {
        struct brdffit_test_spec texel = spec;
        struct brdffit_test_data data;

        texel.lobes = 1 + (int)brdffit_test_below(&random, 2);
        texel.sigma[0] = brdffit_test_log_uniform(&random, 0.02, 0.3);
        texel.sigma[1] = texel.sigma[0] * brdffit_test_log_uniform(&random, 1.2, 6.0);
        texel.diffuse = brdffit_test_below(&random, 4) ? brdffit_test_uniform(&random, 0.0, 0.5) : 0.0;
        texel.specular[0] = brdffit_test_log_uniform(&random, 1e-4, 1e-1);
        texel.specular[1] = brdffit_test_log_uniform(&random, 1e-3, 1e-1);
        texel.noise = brdffit_test_below(&random, 8) ? brdffit_test_log_uniform(&random, 1e-4, 0.1) : 0.0;
        brdffit_test_data_new(&texel, &data);
        memcpy(b->values + t * length, data.values, length * sizeof(double));
        brdffit_test_data_free(&data);
    }
    brdffit_test_data_new(&spec, &b->data);
    b->data.samples.values = NULL;
    brdffit_test_batch_results(b);
}

void brdffit_test_batch_free(struct brdffit_test_batch *b)
{
    brdffit_test_data_free(&b->data);
    free(b->values);
    free(b->memory);
    free(b->block);
    free(b->status);
    free(b->where);
}

void brdffit_test_batch_fit_texels(struct brdffit_test_batch *b, const brdffit_texels *texels)
{
    size_t size = brdffit_many_workspace_size(b->plan);
    unsigned char *workspace = malloc(size + 1);
    brdffit_error error;

    assert_non_null(workspace);
    workspace[size] = 0x5a;
    brdffit_many_stats_init(&b->stats);
    if (brdffit_fit_many(b->plan, texels, &b->results, workspace, size, &b->stats, &error) != BRDFFIT_OK) {
        fail_msg("brdffit_fit_many: %s", error.message);
    }
    assert_int_equal(workspace[size], 0x5a);
    free(workspace);
}

void brdffit_test_batch_fit(struct brdffit_test_batch *b)
{
    brdffit_texels texels;

    if (!b->plan) {
        brdffit_test_batch_plan(b);
    }
    brdffit_texels_init(&texels, b->plan);
    texels.count = b->count;
    texels.values = b->values;
    brdffit_test_batch_fit_texels(b, &texels);
}

brdffit_samples brdffit_test_batch_samples(const struct brdffit_test_batch *b, size_t t)
{
    brdffit_samples samples = b->data.samples;

    samples.values = b->values + t * b->samples * b->channels;
    return samples;
}

double brdffit_test_batch_rounding(double e2, double total)
{
    double u = 64.0 * 0x1p-53;

    return 2.0 * u * sqrt(e2 * total) + u * u * total + 1e-13 * e2;
}

/* What the model of texel t leaves, by brdffit_eval(); weights are not known here. */
static double residuals(const struct brdffit_test_batch *b, size_t t, const brdffit_samples *samples)
{
    size_t n = samples->count * b->channels, more = b->options.diffuse == BRDFFIT_DIFFUSE_BURLEY ? 2 : 1, i;
    double *out = malloc(n * sizeof *out), sum = 0.0;
    brdffit_samples at = *samples;
    brdffit_model model;

    brdffit_model_init(&model);
    model.distribution = b->options.distribution;
    model.fresnel = b->options.fresnel;
    model.masking = b->options.masking;
    model.diffuse = b->options.diffuse;
    model.lobes = (int)b->lobes;
    model.channels = b->channels;
    model.sigma = b->results.sigma + t * b->lobes;
    model.x = b->results.x + t * b->channels;
    model.y = b->results.y + t * b->channels * b->lobes;
    model.f0 = b->results.f0 + t * b->channels * b->lobes;
    model.x_more = b->results.x_more + t * b->channels * more;
    at.quantity = BRDFFIT_QUANTITY_RADIANCE;
    assert_int_equal(brdffit_eval(&model, &at, out, NULL), BRDFFIT_OK);
    for (i = 0; i < n; i++) {
        size_t place = i / b->channels;
        double l = samples->light[3 * place + 2], up = samples->view[3 * place + 2];
        double light = samples->quantity == BRDFFIT_QUANTITY_RADIANCE ? 1.0 : l;
        double rest = (samples->values[i] * light - out[i]) /
                      b->results.channel_scale[t * b->channels + i % b->channels];

        sum += l >= cos(b->options.max_incidence * 3.14159265358979323846 / 180.0) - 1e-12 && l > 0.0 && up > 0.0
                   ? rest * rest
                   : 0.0;
    }
    free(out);
    return sum;
}

/* The single fit of a texel; models that verify.c does not know are evaluated instead. */
static void fit_alone(const struct brdffit_test_batch *b, size_t t, const brdffit_samples *samples,
                      struct brdffit_test_fit *fit)
{
    double e2 = b->results.e2[t], rest;

    if (!b->options.fresnel && !b->options.masking && !b->options.diffuse) {
        brdffit_test_fit(samples, &b->options, fit);
        return;
    }
    fit->workspace_size = brdffit_workspace_size(samples->count, samples->channels, &b->options);
    fit->workspace = malloc(fit->workspace_size);
    assert_int_equal(brdffit_test_run(samples, &b->options, fit->workspace, fit->workspace_size, &fit->result, NULL),
                     BRDFFIT_OK);
    rest = residuals(b, t, samples);
    if (!(fabs(rest - e2) <= 16.0 * brdffit_test_batch_rounding(e2, b->results.sum_of_squares[t]))) {
        fail_msg("texel %zu: E^2 %.17g, its model leaves %.17g", t, e2, rest);
    }
}

void brdffit_test_batch_against_fit(const struct brdffit_test_batch *b, size_t t)
{
    brdffit_samples samples = brdffit_test_batch_samples(b, t);
    struct brdffit_test_fit fit;
    const brdffit_texel_results *r = &b->results;
    double slack, absolute, factor = 1.0 + b->options.relative_gap;

    fit_alone(b, t, &samples, &fit);
    slack = brdffit_test_batch_rounding(fit.result.e2, fit.result.sum_of_squares);
    assert_true(fit.result.certified);
    absolute = b->options.absolute_gap * fit.result.sum_of_squares + slack;
    /* The optimum lies between each bound and each E^2. */
    if (!(r->e2[t] >= fit.result.lower_bound - slack && fit.result.e2 >= r->lower_bound[t] - slack &&
          (r->e2[t] <= factor * r->lower_bound[t] || r->e2[t] - r->lower_bound[t] <= absolute) &&
          (r->e2[t] <= factor * fit.result.e2 + slack || r->e2[t] <= fit.result.e2 + absolute) &&
          fabs(r->sum_of_squares[t] - fit.result.sum_of_squares) <= 1e-13 * r->sum_of_squares[t])) {
        brdffit_test_print(&samples, &b->options);
        fail_msg("texel %zu: many E^2 %.17g bound %.17g, fit E^2 %.17g bound %.17g", t, r->e2[t], r->lower_bound[t],
                 fit.result.e2, fit.result.lower_bound);
    }
    brdffit_test_fit_free(&fit);
}
