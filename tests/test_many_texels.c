/*
 * brdffit_fit_many(): a texel's answer is its own, whatever is around it; odd texels; calls that fail.
 * SPDX-License-Identifier: MIT
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

#include "batch.h"

/* ---- One texel, one answer ------------------------------------------------------------------------------------ */

/* Texel `t` of b and texel `u` of c have the same bits in every array. */
static void same_texel(const struct brdffit_test_batch *b, size_t t, const struct brdffit_test_batch *c, size_t u)
{
    size_t K = b->channels, P = b->lobes;
    const brdffit_texel_results *x = &b->results, *y = &c->results;

    assert_memory_equal(x->sigma + t * P, y->sigma + u * P, P * sizeof(double));
    assert_memory_equal(x->x + t * K, y->x + u * K, K * sizeof(double));
    assert_memory_equal(x->y + t * K * P, y->y + u * K * P, K * P * sizeof(double));
    assert_memory_equal(x->channel_scale + t * K, y->channel_scale + u * K, K * sizeof(double));
    assert_memory_equal(x->e2 + t, y->e2 + u, sizeof(double));
    assert_memory_equal(x->lower_bound + t, y->lower_bound + u, sizeof(double));
    assert_memory_equal(x->sum_of_squares + t, y->sum_of_squares + u, sizeof(double));
    assert_int_equal(x->status[t], y->status[u]);
    assert_int_equal(x->stop[t], y->stop[u]);
    assert_int_equal(x->where[t], y->where[u]);
    assert_int_equal(x->boxes[t], y->boxes[u]);
}

/* A batch with everything in it: good, noise-free, black, NaN, repeated texels. */
static void mixed_batch(struct brdffit_test_batch *b, int lobes, size_t count)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t t, length = 84 * 3, i;

    brdffit_test_batch_new(b, spec, count, lobes, 5);
    for (t = 0; t < count; t++) {
        double *v = b->values + t * length;

        if (t % 11 == 3) {
            memset(v, 0, length * sizeof *v);
        } else if (t % 13 == 5) {
            v[17] = NAN;
        } else if (t % 7 == 4) {
            memcpy(v, v - length, length * sizeof *v);
        } else if (t % 17 == 8) {
            for (i = 0; i < length; i++) {
                v[i] *= 1e-200; /* beyond what the tiles take */
            }
        }
        for (i = 0; i < length; i++) {
            v[i] = (double)(float)v[i]; /* so that floats hold the same data */
        }
    }
}

static void choose_model(brdffit_options *o, int kind)
{
    o->distribution = kind < 2 ? BRDFFIT_BECKMANN : BRDFFIT_GGX;
    o->masking = kind == 2 ? BRDFFIT_MASKING_SMITH : BRDFFIT_MASKING_V_CAVITY;
    o->fresnel = kind == 2 ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
}

static void test_instruction_sets(void **state)
{
    struct brdffit_test_batch b, c;
    int isa, kind;
    size_t t;

    (void)state;
    for (kind = 0; kind < 4; kind++) { /* one lobe or two, plain or with all that a lobe may have */
        int lobes = 1 + kind % 2;

        mixed_batch(&b, lobes, lobes == 1 ? 61 : 17);
        choose_model(&b.options, kind);
        b.options.isa = BRDFFIT_ISA_BASE;
        brdffit_test_batch_fit(&b);
        for (isa = BRDFFIT_ISA_AUTO; isa < BRDFFIT_ISA_COUNT; isa++) {
            if (!brdffit_isa_supported((brdffit_isa)isa)) {
                continue;
            }
            mixed_batch(&c, lobes, b.count);
            choose_model(&c.options, kind);
            c.options.isa = (brdffit_isa)isa;
            brdffit_test_batch_fit(&c);
            for (t = 0; t < b.count; t++) {
                same_texel(&b, t, &c, t);
            }
            assert_memory_equal(&b.stats, &c.stats, sizeof b.stats);
            brdffit_test_batch_free(&c);
        }
        brdffit_test_batch_free(&b);
    }
}

/* Backwards, one by one, and with others masked: every texel keeps its bits. */
static void test_order_and_size(void **state)
{
    struct brdffit_test_batch b, c;
    brdffit_texels texels;
    unsigned char mask[61];
    size_t t, length = 84 * 3, one;

    (void)state;
    mixed_batch(&b, 1, 61);
    mixed_batch(&c, 1, 61);
    brdffit_test_batch_fit(&b);
    brdffit_test_batch_plan(&c);
    brdffit_texels_init(&texels, c.plan);
    texels.count = c.count;
    texels.values = c.values + (c.count - 1) * length;
    texels.texel_stride = -texels.texel_stride;
    brdffit_test_batch_fit_texels(&c, &texels);
    for (t = 0; t < b.count; t++) {
        same_texel(&b, t, &c, c.count - 1 - t);
    }
    brdffit_texels_init(&texels, c.plan);
    for (one = 0; one < b.count; one += 5) {
        texels.count = 1;
        texels.values = c.values + one * length;
        brdffit_test_batch_fit_texels(&c, &texels);
        same_texel(&b, one, &c, 0);
    }
    texels.count = c.count;
    texels.values = c.values;
    texels.mask = mask;
    for (t = 0; t < c.count; t++) {
        mask[t] = (unsigned char)(t % 3 == 1 ? 7 : 0);
    }
    brdffit_test_batch_fit_texels(&c, &texels);
    for (t = 0; t < c.count; t++) {
        if (mask[t]) {
            same_texel(&b, t, &c, t);
        } else {
            assert_int_equal(c.status[t], BRDFFIT_TEXEL_MASKED);
            assert_true(isnan(c.results.e2[t]) && isnan(c.results.sigma[t]));
        }
    }
    assert_int_equal(c.stats.masked, 41);
    brdffit_test_batch_free(&b);
    brdffit_test_batch_free(&c);
}

/* An image stack of floats, channels last and channels first; 16-bit integers with a scale. */
static void test_layouts(void **state)
{
    struct brdffit_test_batch b, c;
    brdffit_texels texels;
    size_t n = 61, t, i, k;
    float *stack = malloc(n * 84 * 3 * sizeof *stack);
    uint16_t *small = malloc(n * 84 * 3 * sizeof *small);

    (void)state;
    mixed_batch(&b, 1, n);
    mixed_batch(&c, 1, n);
    brdffit_test_batch_fit(&b);
    brdffit_test_batch_plan(&c);
    brdffit_texels_init(&texels, c.plan);
    for (t = 0; t < n; t++) {
        for (i = 0; i < 84; i++) {
            for (k = 0; k < 3; k++) {
                stack[(i * 3 + k) * n + t] = (float)b.values[(t * 84 + i) * 3 + k];
            }
        }
    }
    texels.count = n;
    texels.values = stack;
    texels.type = BRDFFIT_TYPE_FLOAT;
    texels.texel_stride = 1;
    texels.sample_stride = (ptrdiff_t)(3 * n);
    texels.channel_stride = (ptrdiff_t)n;
    brdffit_test_batch_fit_texels(&c, &texels);
    for (t = 0; t < n; t++) {
        same_texel(&b, t, &c, t);
    }
    for (t = 0; t < n * 84 * 3; t++) { /* the same integers as 16 bits, and as doubles already scaled */
        small[t] = (uint16_t)(b.values[t] > 0.0 && b.values[t] < 30.0 ? 2000.0 * b.values[t] : 0.0);
        b.values[t] = (double)small[t] * 0x1p-11;
    }
    brdffit_test_batch_fit(&b);
    brdffit_texels_init(&texels, c.plan);
    texels.count = n;
    texels.values = small;
    texels.type = BRDFFIT_TYPE_UINT16;
    texels.scale = 0x1p-11;
    brdffit_test_batch_fit_texels(&c, &texels);
    for (t = 0; t < n; t++) {
        same_texel(&b, t, &c, t);
    }
    free(stack);
    free(small);
    brdffit_test_batch_free(&b);
    brdffit_test_batch_free(&c);
}

/* ---- Odd texels ------------------------------------------------------------------------------------------------ */

static void test_odd_texels(void **state)
{
    struct brdffit_test_batch b;
    size_t t, k, length = 84 * 3, black = 0, bad = 0;

    (void)state;
    mixed_batch(&b, 1, 61);
    for (k = 0; k < 84; k++) {
        b.values[3 * k + 1] = 0.0;                /* texel 0: a channel without signal */
        b.values[length + 3 * k + 2] = b.values[length + 3 * k]; /* texel 1: two channels alike */
    }
    brdffit_test_batch_fit(&b);
    for (t = 0; t < b.count; t++) {
        if (b.status[t] == BRDFFIT_TEXEL_NO_SIGNAL) {
            black++;
            assert_true(b.results.e2[t] == 0.0 && b.results.lower_bound[t] == 0.0 && b.results.x[3 * t] == 0.0);
            assert_true(b.results.sigma[t] == 6.0);
        } else if (b.status[t] == BRDFFIT_TEXEL_BAD_VALUE) {
            bad++;
            assert_int_equal(b.where[t], 17);
            assert_true(isnan(b.results.sigma[t]) && isnan(b.results.y[3 * t]));
        } else {
            assert_int_equal(b.status[t], BRDFFIT_TEXEL_CERTIFIED);
            assert_int_equal(b.where[t], BRDFFIT_NONE);
        }
    }
    assert_true(black >= 5 && bad >= 4);
    assert_int_equal(b.stats.no_signal, black);
    assert_int_equal(b.stats.bad_value, bad);
    assert_int_equal(b.stats.texels, 61);
    assert_int_equal(b.stats.certified + black + bad, 61);
    assert_true(b.stats.equal >= 6);
    assert_int_equal(b.stats.zero_channels, 1);
    assert_int_equal(b.stats.equal_channels, 1);
    brdffit_test_batch_free(&b);
}

/* Geometry without a fast path: one sample, one c, no diffuse part, a narrow range. */
static void test_degenerate_geometry(void **state)
{
    static const double a[3] = {0.3, 0.2, 0.1}, none[3] = {0.0, 0.0, 0.0}, b3[3] = {1.0, 0.5, 0.25};
    static const double c[3] = {0.0, 0.1, 0.7}, same[3] = {0.2, 0.2, 0.2}, values[6] = {1.0, 0.2, 0.1, 0.3, 0.3, 0.4};
    int kind;

    (void)state;
    for (kind = 0; kind < 5; kind++) {
        brdffit_samples samples = brdffit_test_coefficients(kind == 0 ? 1 : 3, 1, kind == 2 ? none : a,
                                                            kind == 3 ? none : b3, kind == 1 ? same : c, NULL);
        struct brdffit_test_batch b;
        size_t t;

        memset(&b, 0, sizeof b);
        b.count = 2;
        b.samples = samples.count;
        b.channels = b.lobes = 1;
        b.data.samples = samples;
        b.values = malloc(sizeof values);
        memcpy(b.values, values, sizeof values);
        brdffit_options_init(&b.options);
        b.options.sigma_min = kind == 4 ? 6.0 : b.options.sigma_min;
        brdffit_test_batch_results(&b);
        brdffit_test_batch_fit(&b);
        for (t = 0; t < 2; t++) {
            assert_int_equal(b.status[t], BRDFFIT_TEXEL_CERTIFIED);
            brdffit_test_batch_against_fit(&b, t);
        }
        brdffit_test_batch_free(&b);
    }
}

/* ---- Calls that fail ------------------------------------------------------------------------------------------- */

static void test_misuse(void **state)
{
    struct brdffit_test_batch b;
    brdffit_texels texels;
    brdffit_error error;
    const brdffit_plan *plan = NULL;
    size_t size, needed;
    unsigned char *workspace;
    double zero_weights[84] = {0.0};
    brdffit_samples skipped;

    (void)state;
    mixed_batch(&b, 1, 3);
    needed = brdffit_plan_size(&b.data.samples, &b.options);
    b.memory = malloc(needed + 4096);
    assert_int_equal(brdffit_plan_init(&b.data.samples, &b.options, b.memory, needed - 1, &plan, &error),
                     BRDFFIT_ERR_WORKSPACE);
    skipped = b.data.samples;
    skipped.weights = zero_weights;
    assert_int_equal(brdffit_plan_init(&skipped, &b.options, b.memory, needed + 4096, &plan, &error),
                     BRDFFIT_ERR_NO_SAMPLES);
    assert_null(plan);
    b.options.lobes = BRDFFIT_MAX_LOBES + 1;
    assert_int_equal(brdffit_plan_size(&b.data.samples, &b.options), 0);
    assert_int_equal(brdffit_plan_init(&b.data.samples, &b.options, b.memory, needed, &plan, &error),
                     BRDFFIT_ERR_OPTION);
    b.options.lobes = 1;
    assert_int_equal(brdffit_plan_init(&b.data.samples, &b.options, b.memory, needed, &b.plan, &error), BRDFFIT_OK);
    size = brdffit_many_workspace_size(b.plan);
    workspace = malloc(size);
    brdffit_texels_init(&texels, b.plan);
    texels.count = 3;
    texels.values = b.values;
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size - 1, NULL, &error),
                     BRDFFIT_ERR_WORKSPACE);
    texels.scale = 0.0;
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size, NULL, NULL), BRDFFIT_ERR_ARGUMENT);
    texels.scale = 1.0;
    texels.values = NULL;
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size, NULL, &error),
                     BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit_many(NULL, &texels, &b.results, workspace, size, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    texels.count = 0;
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size, NULL, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_many_workspace_size(NULL), 0);
    free(workspace);
    brdffit_test_batch_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_instruction_sets),
        cmocka_unit_test(test_order_and_size),
        cmocka_unit_test(test_layouts),
        cmocka_unit_test(test_odd_texels),
        cmocka_unit_test(test_degenerate_geometry),
        cmocka_unit_test(test_misuse),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
