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
#include "verify_lobes.h"
#include "verify_samples.h"

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

/*
 * How far two evaluations of one sum of squares may be apart: residuals carry a few u of the data each, and the (a, b,
 * c) here differ from the library's by a few u too (verify_samples.h); 64 u stands for all of that.
 */
static double rounding(double e2, double total)
{
    double u = 64.0 * 0x1p-53;

    return 2.0 * u * sqrt(e2 * total) + u * u * total + 1e-13 * e2;
}

/* Both certified: neither E^2 may lie below the other's bound, and each is within the gap of the other's bound. */
static void against_fit(const struct batch *b, size_t t)
{
    brdffit_samples samples = texel_samples(b, t);
    struct brdffit_test_fit fit;
    const brdffit_texel_results *r = &b->results;
    double slack, absolute, factor = 1.0 + b->options.relative_gap;

    brdffit_test_fit(&samples, &b->options, &fit);
    slack = rounding(fit.result.e2, fit.result.sum_of_squares);
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

/* ---- Attacks ---------------------------------------------------------------------------------------------------- */

/* Smallest sum of squares of v - x a - y g over x, y >= 0, in long double. */
static long double smallest(const struct verify_sample *at, const long double *v, const long double *g, size_t n)
{
    long double aa = 0.0L, gg = 0.0L, ag = 0.0L, av = 0.0L, gv = 0.0L, x, y, sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        aa += at[i].a * at[i].a;
        gg += g[i] * g[i];
        ag += at[i].a * g[i];
        av += at[i].a * v[i];
        gv += g[i] * v[i];
    }
    y = aa * gg - ag * ag > 0.0L ? (gv * aa - av * ag) / (aa * gg - ag * ag) : 0.0L;
    x = aa > 0.0L ? (av - y * ag) / aa : 0.0L;
    if (!(y > 0.0L)) {
        y = 0.0L;
        x = aa > 0.0L ? fmaxl(av / aa, 0.0L) : 0.0L;
    } else if (!(x > 0.0L)) {
        x = 0.0L;
        y = gg > 0.0L ? fmaxl(gv / gg, 0.0L) : 0.0L;
    }
    for (i = 0; i < n; i++) {
        long double rest = v[i] - x * at[i].a - y * g[i];

        sum += rest * rest;
    }
    return sum;
}

/* The objective of one lobe of roughness sigma, its coefficients chosen best. Samples are weighted in place. */
struct attack {
    struct verify_sample at[256];
    long double v[8][256], g[256], scale[8];
    size_t used, channels;
    brdffit_distribution distribution;
};

static long double objective(struct attack *k, long double sigma)
{
    long double sum = 0.0L;
    size_t i, c;

    for (i = 0; i < k->used; i++) {
        k->g[i] = k->at[i].b * verify_lobe(k->distribution, k->at[i].c, sigma);
    }
    for (c = 0; c < k->channels; c++) {
        sum += smallest(k->at, k->v[c], k->g, k->used);
    }
    return sum;
}

static void open_attack(struct attack *k, const struct batch *b, size_t t)
{
    brdffit_samples samples = texel_samples(b, t);
    size_t i, c;

    assert_true(samples.count <= 256 && samples.channels <= 8);
    k->used = 0;
    k->channels = samples.channels;
    k->distribution = b->options.distribution;
    for (i = 0; i < samples.count; i++) {
        struct verify_sample *at = &k->at[k->used];
        long double root;

        if (verify_sample_of(k->distribution, &samples, b->options.max_incidence, i, at) != BRDFFIT_SKIP_COUNT) {
            continue;
        }
        root = samples.weights ? sqrtl((long double)samples.weights[i]) : 1.0L;
        for (c = 0; c < k->channels; c++) {
            k->v[c][k->used] = root * at->to_radiance * samples.values[i * k->channels + c] /
                               b->results.channel_scale[t * k->channels + c];
        }
        at->a *= root;
        at->b *= root;
        k->used++;
    }
}

/* No roughness of a dense grid, nor near the optimum, beats the bound; E^2 is what sigma, x and y give. */
static void attack_texel(const struct batch *b, size_t t)
{
    static struct attack k;
    double bound = b->results.lower_bound[t], sigma = b->results.sigma[t], slack = rounding(bound, b->results.sum_of_squares[t]);
    long double e2 = 0.0L;
    size_t i, c;
    int j;

    if (b->lobes != 1) {
        return;
    }
    open_attack(&k, b, t);
    for (j = 0; j < 300; j++) {
        long double at = j < 200 ? 6.0L * powl(1e-3L, (long double)j / 200.0L)
                                 : sigma * (1.0L + 0.2L * (long double)(j - 250) / 50.0L);
        long double value = at <= 6.0L ? objective(&k, at) : INFINITY;

        if (value < bound - slack) {
            fail_msg("texel %zu: sigma %.17Lg has E^2 %.17Lg below the bound %.17g", t, at, value, bound);
        }
    }
    for (c = 0; c < k.channels; c++) {
        double scale = b->results.channel_scale[t * k.channels + c];

        for (i = 0; i < k.used; i++) {
            long double model = k.at[i].a * b->results.x[t * k.channels + c] +
                                k.at[i].b * b->results.y[t * k.channels + c] *
                                    verify_lobe(k.distribution, k.at[i].c, sigma);

            e2 += (k.v[c][i] - model / scale) * (k.v[c][i] - model / scale);
        }
    }
    if (!(fabsl(e2 - b->results.e2[t]) <= rounding(b->results.e2[t], b->results.sum_of_squares[t]))) {
        fail_msg("texel %zu: E^2 %.17g, from its model %.17Lg", t, b->results.e2[t], e2);
    }
}

static void test_against_fit_of(struct batch *b, double general_share)
{
    size_t t;

    fit_all(b);
    for (t = 0; t < b->count; t++) {
        assert_int_equal(b->status[t], BRDFFIT_TEXEL_CERTIFIED);
        assert_true(b->stop[t] == BRDFFIT_STOP_RELATIVE_GAP || b->stop[t] == BRDFFIT_STOP_ABSOLUTE_GAP);
        against_fit(b, t);
        attack_texel(b, t);
    }
    if (!((double)b->stats.general <= general_share * (double)b->count)) {
        fail_msg("%zu of %zu texels took the general path", b->stats.general, b->count);
    }
}

static void check_against_fit(struct brdffit_test_spec spec, size_t count, int lobes, uint64_t seed)
{
    struct batch b;

    batch_new(&b, spec, count, lobes, seed);
    test_against_fit_of(&b, lobes > 1 ? 1.0 : 0.1);
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
    check_against_fit(spec, 40, 1, 8);
    spec.form = BRDFFIT_FORM_ANGLES;
    spec.channels = 1;
    spec.count = 29;
    check_against_fit(spec, 40, 1, 9);
    spec.form = BRDFFIT_FORM_COEFFICIENTS;
    spec.quantity = BRDFFIT_QUANTITY_RADIANCE;
    spec.channels = 5;
    spec.count = 200;
    check_against_fit(spec, 20, 1, 10);
}

/* Other distributions, units and gaps; GGX has the general path only. */
static void test_options(void **state)
{
    static const double gap[3] = {1e-1, 1e-5, 1e-3};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct batch b;
    int d;

    (void)state;
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        spec.distribution = (brdffit_distribution)d;
        spec.layout = d % 2 ? BRDFFIT_TEST_GRID : BRDFFIT_TEST_RANDOM;
        batch_new(&b, spec, 12, 1, 20 + (uint64_t)d);
        b.options.distribution = (brdffit_distribution)d;
        b.options.normalise = d % 2 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        b.options.relative_gap = gap[d % 3];
        test_against_fit_of(&b, d == BRDFFIT_GGX ? 1.0 : 0.5);
        batch_free(&b);
    }
}

/* Metals: x is zero in truth, so that noise decides channel by channel whether it is zero in the fit. */
static void test_metals(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct batch b;
    size_t t, i, zero = 0;

    (void)state;
    batch_new(&b, spec, 40, 1, 31);
    for (t = 0; t < b.count; t++) {
        struct brdffit_test_spec metal = spec;
        struct brdffit_test_data data;

        metal.seed = 100 + t;
        metal.lobes = 1;
        metal.diffuse = 0.0;
        metal.sigma[0] = 0.05 + 0.01 * (double)t;
        metal.noise = 0.02;
        brdffit_test_data_new(&metal, &data);
        memcpy(b.values + t * 84 * 3, data.values, 84 * 3 * sizeof(double));
        brdffit_test_data_free(&data);
    }
    test_against_fit_of(&b, 0.2);
    for (i = 0; i < b.count * 3; i++) {
        zero += b.results.x[i] == 0.0;
    }
    assert_in_range(zero, 20, 100); /* about half of 120: the test tests what it means to */
    batch_free(&b);
}

static void test_two_lobes(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    check_against_fit(spec, 8, 2, 17);
}

/* One-lobe truth, with noise or without, and two-lobe truth, fitted with two lobes: the count of texels that one lobe suffices for, against two fits. */
static void test_one_lobe_enough(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct batch b;
    size_t t, enough = 0;

    (void)state;
    batch_new(&b, spec, 8, 2, 41);
    for (t = 0; t < b.count; t++) {
        struct brdffit_test_spec texel = spec;
        struct brdffit_test_data data;

        texel.seed = 300 + t;
        texel.lobes = t < 6 ? 1 : 2;
        texel.sigma[0] = 0.15;
        texel.noise = t < 3 ? 0.0 : 0.01;
        brdffit_test_data_new(&texel, &data);
        memcpy(b.values + t * 84 * 3, data.values, 84 * 3 * sizeof(double));
        brdffit_test_data_free(&data);
    }
    b.options.relative_gap = 0.02; /* what noise alone lets a second lobe gain is about 1 % */
    fit_all(&b);
    for (t = 0; t < b.count; t++) {
        brdffit_samples samples = texel_samples(&b, t);
        brdffit_options options = b.options;
        struct brdffit_test_fit fit;

        options.lobes = 1;
        options.relative_gap = 1e-6;
        brdffit_test_fit(&samples, &options, &fit);
        enough += fit.result.e2 <= 1.02 * b.results.lower_bound[t] ||
                  fit.result.e2 <= b.results.lower_bound[t] + 1e-12 * b.results.sum_of_squares[t];
        brdffit_test_fit_free(&fit);
    }
    assert_true(enough >= 3 && enough <= 6);
    assert_int_equal(b.stats.one_lobe_enough, enough);
    batch_free(&b);
}

/* ---- One texel, one answer ------------------------------------------------------------------------------------ */

/* Texel `t` of b and texel `u` of c have the same bits in every array. */
static void same_texel(const struct batch *b, size_t t, const struct batch *c, size_t u)
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
static void mixed_batch(struct batch *b, int lobes, size_t count)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t t, length = 84 * 3, i;

    batch_new(b, spec, count, lobes, 5);
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

static void test_instruction_sets(void **state)
{
    struct batch b, c;
    int isa, lobes;
    size_t t;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        mixed_batch(&b, lobes, lobes == 1 ? 61 : 9);
        b.options.isa = BRDFFIT_ISA_BASE;
        fit_all(&b);
        for (isa = BRDFFIT_ISA_AUTO; isa < BRDFFIT_ISA_COUNT; isa++) {
            if (!brdffit_isa_supported((brdffit_isa)isa)) {
                continue;
            }
            mixed_batch(&c, lobes, b.count);
            c.options.isa = (brdffit_isa)isa;
            fit_all(&c);
            for (t = 0; t < b.count; t++) {
                same_texel(&b, t, &c, t);
            }
            assert_memory_equal(&b.stats, &c.stats, sizeof b.stats);
            batch_free(&c);
        }
        batch_free(&b);
    }
}

/* Backwards, one by one, and with others masked: every texel keeps its bits. */
static void test_order_and_size(void **state)
{
    struct batch b, c;
    brdffit_texels texels;
    unsigned char mask[61];
    size_t t, length = 84 * 3, one;

    (void)state;
    mixed_batch(&b, 1, 61);
    mixed_batch(&c, 1, 61);
    fit_all(&b);
    plan_of(&c);
    brdffit_texels_init(&texels, c.plan);
    texels.count = c.count;
    texels.values = c.values + (c.count - 1) * length;
    texels.texel_stride = -texels.texel_stride;
    fit_texels(&c, &texels);
    for (t = 0; t < b.count; t++) {
        same_texel(&b, t, &c, c.count - 1 - t);
    }
    brdffit_texels_init(&texels, c.plan);
    for (one = 0; one < b.count; one += 5) {
        texels.count = 1;
        texels.values = c.values + one * length;
        fit_texels(&c, &texels);
        same_texel(&b, one, &c, 0);
    }
    texels.count = c.count;
    texels.values = c.values;
    texels.mask = mask;
    for (t = 0; t < c.count; t++) {
        mask[t] = (unsigned char)(t % 3 == 1 ? 7 : 0);
    }
    fit_texels(&c, &texels);
    for (t = 0; t < c.count; t++) {
        if (mask[t]) {
            same_texel(&b, t, &c, t);
        } else {
            assert_int_equal(c.status[t], BRDFFIT_TEXEL_MASKED);
            assert_true(isnan(c.results.e2[t]) && isnan(c.results.sigma[t]));
        }
    }
    assert_int_equal(c.stats.masked, 41);
    batch_free(&b);
    batch_free(&c);
}

/* An image stack of floats, channels last and channels first; 16-bit integers with a scale. */
static void test_layouts(void **state)
{
    struct batch b, c;
    brdffit_texels texels;
    size_t n = 61, t, i, k;
    float *stack = malloc(n * 84 * 3 * sizeof *stack);
    uint16_t *small = malloc(n * 84 * 3 * sizeof *small);

    (void)state;
    mixed_batch(&b, 1, n);
    mixed_batch(&c, 1, n);
    fit_all(&b);
    plan_of(&c);
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
    fit_texels(&c, &texels);
    for (t = 0; t < n; t++) {
        same_texel(&b, t, &c, t);
    }
    for (t = 0; t < n * 84 * 3; t++) { /* the same integers as 16 bits, and as doubles already scaled */
        small[t] = (uint16_t)(b.values[t] > 0.0 && b.values[t] < 30.0 ? 2000.0 * b.values[t] : 0.0);
        b.values[t] = (double)small[t] * 0x1p-11;
    }
    fit_all(&b);
    brdffit_texels_init(&texels, c.plan);
    texels.count = n;
    texels.values = small;
    texels.type = BRDFFIT_TYPE_UINT16;
    texels.scale = 0x1p-11;
    fit_texels(&c, &texels);
    for (t = 0; t < n; t++) {
        same_texel(&b, t, &c, t);
    }
    free(stack);
    free(small);
    batch_free(&b);
    batch_free(&c);
}

/* ---- Odd texels ------------------------------------------------------------------------------------------------ */

static void test_odd_texels(void **state)
{
    struct batch b;
    size_t t, k, length = 84 * 3, black = 0, bad = 0;

    (void)state;
    mixed_batch(&b, 1, 61);
    for (k = 0; k < 84; k++) {
        b.values[3 * k + 1] = 0.0;                /* texel 0: a channel without signal */
        b.values[length + 3 * k + 2] = b.values[length + 3 * k]; /* texel 1: two channels alike */
    }
    fit_all(&b);
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
    batch_free(&b);
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
        struct batch b;
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
        results_of(&b);
        fit_all(&b);
        for (t = 0; t < 2; t++) {
            assert_int_equal(b.status[t], BRDFFIT_TEXEL_CERTIFIED);
            against_fit(&b, t);
        }
        batch_free(&b);
    }
}

/* ---- Calls that fail ------------------------------------------------------------------------------------------- */

static void test_misuse(void **state)
{
    struct batch b;
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
    b.options.lobes = 3;
    assert_int_equal(brdffit_plan_size(&b.data.samples, &b.options), 0);
    assert_int_equal(brdffit_plan_init(&b.data.samples, &b.options, b.memory, needed, &plan, &error), BRDFFIT_ERR_OPTION);
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
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_fit_many(NULL, &texels, &b.results, workspace, size, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    texels.count = 0;
    assert_int_equal(brdffit_fit_many(b.plan, &texels, &b.results, workspace, size, NULL, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_many_workspace_size(NULL), 0);
    free(workspace);
    batch_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_lobe),         cmocka_unit_test(test_options),
        cmocka_unit_test(test_metals),           cmocka_unit_test(test_two_lobes),
        cmocka_unit_test(test_one_lobe_enough),
        cmocka_unit_test(test_instruction_sets), cmocka_unit_test(test_order_and_size),
        cmocka_unit_test(test_layouts),          cmocka_unit_test(test_odd_texels),
        cmocka_unit_test(test_degenerate_geometry), cmocka_unit_test(test_misuse),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
