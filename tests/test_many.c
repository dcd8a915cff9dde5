/*
 * brdffit_fit_many(): what the interface promises, and each texel against brdffit_fit() on the same data.
 * SPDX-License-Identifier: MIT
 *
 * Calls to the allocator are seen by the linker's --wrap, as in test_promises.c.
 * LDFLAGS: -Wl,--wrap=malloc
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"
#include "verify.h"

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

static size_t allocations;

void *__wrap_malloc(size_t size)
{
    allocations++;
    return __real_malloc(size);
}

/* ---- A batch and its results -------------------------------------------------------------------------------- */

struct batch {
    size_t count, samples, channels, lobes;
    brdffit_options options;
    struct brdffit_test_data data; /* geometry */
    double *values;                /* texel, sample, channel */
    void *memory;
    const brdffit_plan *plan;
    brdffit_texel_results results;
    double *block;
    unsigned char *status, *stop;
    size_t *where, *boxes;
    brdffit_many_stats stats;
};

static void plan_of(struct batch *b)
{
    size_t size = brdffit_plan_size(&b->data.samples, &b->options);
    brdffit_error error;

    assert_true(size > 0);
    b->memory = malloc(size);
    if (brdffit_plan_init(&b->data.samples, &b->options, b->memory, size, &b->plan, &error) != BRDFFIT_OK) {
        fail_msg("brdffit_plan_init: %s", error.message);
    }
}

static void results_of(struct batch *b)
{
    size_t n = b->count, K = b->channels, P = b->lobes;
    double *at;

    at = b->block = calloc(n + 1, (P + 2 * K + K * P + 3) * sizeof(double));
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
    b->results.sum_of_squares = at + n;
    b->results.status = b->status;
    b->results.stop = b->stop = b->status + n;
    b->results.where = b->where;
    b->results.boxes = b->boxes = b->where + n;
}

/* `count` texels over the geometry of spec, each with its own truth and noise. */
static void batch_new(struct batch *b, struct brdffit_test_spec spec, size_t count, int lobes, uint64_t seed)
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
    results_of(b);
}

static void batch_free(struct batch *b)
{
    brdffit_test_data_free(&b->data);
    free(b->values);
    free(b->memory);
    free(b->block);
    free(b->status);
    free(b->where);
}

static void fit_texels(struct batch *b, const brdffit_texels *texels)
{
    size_t size = brdffit_many_workspace_size(b->plan), before;
    unsigned char *workspace = malloc(size + 1);
    brdffit_error error;

    assert_non_null(workspace);
    workspace[size] = 0x5a;
    brdffit_many_stats_init(&b->stats);
    before = allocations;
    if (brdffit_fit_many(b->plan, texels, &b->results, workspace, size, &b->stats, &error) != BRDFFIT_OK) {
        fail_msg("brdffit_fit_many: %s", error.message);
    }
    assert_int_equal(allocations, before);
    assert_int_equal(workspace[size], 0x5a);
    free(workspace);
}

static void fit_all(struct batch *b)
{
    brdffit_texels texels;

    if (!b->plan) {
        plan_of(b);
    }
    brdffit_texels_init(&texels, b->plan);
    texels.count = b->count;
    texels.values = b->values;
    fit_texels(b, &texels);
}

/* The samples of one texel, for everybody else. */
static brdffit_samples texel_samples(const struct batch *b, size_t t)
{
    brdffit_samples samples = b->data.samples;

    samples.values = b->values + t * b->samples * b->channels;
    return samples;
}

/* Both certified: neither E^2 may lie below the other's bound, and each is within the gap of the other's bound. */
static void against_fit(const struct batch *b, size_t t)
{
    brdffit_samples samples = texel_samples(b, t);
    struct brdffit_test_fit fit;
    const brdffit_texel_results *r = &b->results;
    double slack, factor = 1.0 + b->options.relative_gap;

    brdffit_test_fit(&samples, &b->options, &fit);
    slack = 1e-13 * fit.result.sum_of_squares; /* two evaluations of one residual */
    if (fit.result.certified && b->status[t] == BRDFFIT_TEXEL_CERTIFIED) {
        double absolute = slack + b->options.absolute_gap * fit.result.sum_of_squares;

        if (!(r->e2[t] >= fit.result.lower_bound - slack && fit.result.e2 >= r->lower_bound[t] - slack &&
              (r->e2[t] <= factor * fit.result.lower_bound + slack || r->e2[t] <= fit.result.e2 + absolute ||
               r->e2[t] <= fit.result.lower_bound * factor * factor) &&
              (r->e2[t] <= factor * r->lower_bound[t] || r->e2[t] - r->lower_bound[t] <= absolute))) {
            brdffit_test_print(&samples, &b->options);
            fail_msg("texel %zu: many E^2 %.17g bound %.17g, fit E^2 %.17g bound %.17g", t, r->e2[t],
                     r->lower_bound[t], fit.result.e2, fit.result.lower_bound);
        }
    }
    brdffit_test_fit_free(&fit);
}

static void check_against_fit(struct brdffit_test_spec spec, size_t count, int lobes, uint64_t seed)
{
    struct batch b;
    size_t t;

    batch_new(&b, spec, count, lobes, seed);
    fit_all(&b);
    for (t = 0; t < count; t++) {
        assert_int_equal(b.status[t], BRDFFIT_TEXEL_CERTIFIED);
        against_fit(&b, t);
    }
    batch_free(&b);
}

static void test_one_lobe(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    check_against_fit(spec, 60, 1, 7);
    spec.layout = BRDFFIT_TEST_RANDOM;
    spec.weighted = 1;
    spec.quantity = BRDFFIT_QUANTITY_BRDF;
    check_against_fit(spec, 30, 1, 8);
    spec.form = BRDFFIT_FORM_ANGLES;
    spec.channels = 1;
    spec.count = 29;
    check_against_fit(spec, 30, 1, 9);
}

static void test_two_lobes(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    check_against_fit(spec, 8, 2, 17);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_lobe),
        cmocka_unit_test(test_two_lobes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
