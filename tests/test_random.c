/*
 * Random problems of every kind, each result judged: layouts, forms, distributions (also other than the truth's),
 * noise, weights, tilted normals, zeros and negatives in the data, ranges of sigma, gaps, budgets.
 * Every third also has the same bits with each instruction set that runs here. To see more of them: test_random FIRST COUNT. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

static unsigned long first = 0, count = 250;

static int one_in(struct brdffit_test_random *random, size_t n)
{
    return brdffit_test_below(random, n) == 0;
}

static struct brdffit_test_spec random_spec(struct brdffit_test_random *random)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    int p;

    spec.seed = brdffit_test_bits(random);
    spec.count = 1 + brdffit_test_below(random, one_in(random, 4) ? 8 : 90);
    spec.channels = 1 + brdffit_test_below(random, 4);
    spec.layout = (enum brdffit_test_layout)brdffit_test_below(random, 3);
    spec.form = (brdffit_form)brdffit_test_below(random, 3);
    if (spec.form != BRDFFIT_FORM_COEFFICIENTS && one_in(random, 2)) {
        spec.quantity = BRDFFIT_QUANTITY_BRDF;
    }
    spec.distribution = (brdffit_distribution)brdffit_test_below(random, 2);
    spec.lobes = 1 + (int)brdffit_test_below(random, 2);
    spec.diffuse = one_in(random, 5) ? 0.0 : brdffit_test_uniform(random, 0.0, 1.0);
    for (p = 0; p < 2; p++) {
        spec.sigma[p] = brdffit_test_log_uniform(random, 1e-3, 3.0);
        spec.specular[p] = spec.sigma[p] * spec.sigma[p] * brdffit_test_log_uniform(random, 1e-3, 10.0);
    }
    spec.noise = one_in(random, 3) ? 0.0 : brdffit_test_log_uniform(random, 1e-4, 0.5);
    spec.weighted = one_in(random, 4);
    spec.normals = one_in(random, 4);
    return spec;
}

static brdffit_options random_options(struct brdffit_test_random *random)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.lobes = 1 + (int)brdffit_test_below(random, 2);
    options.distribution = (brdffit_distribution)brdffit_test_below(random, 2);
    options.normalise = one_in(random, 4) ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
    if (one_in(random, 4)) {
        options.sigma_max = brdffit_test_log_uniform(random, 1e-2, 1e3);
    }
    if (one_in(random, 4)) {
        options.sigma_min = brdffit_test_log_uniform(random, 1e-12, options.sigma_max);
    }
    if (one_in(random, 3)) {
        options.relative_gap = brdffit_test_log_uniform(random, 1e-6, 1.0);
    }
    if (one_in(random, 4)) {
        options.max_incidence = 90.0;
    }
    options.box_budget = one_in(random, 6) ? 1 + brdffit_test_below(random, 2000) : 50000;
    return options;
}

/* Data that a fit refuses for their size: a channel all below 1e-304 (and 1e-300 here), or a sum of squares that is no normal number. */
static int too_small(const struct brdffit_test_data *data, brdffit_normalise normalise)
{
    double all = 0.0;
    size_t i, k, n = data->samples.channels;

    for (k = 0; k < n; k++) {
        double largest = 0.0;

        for (i = 0; i < data->samples.count; i++) {
            largest = fmax(largest, fabs(data->values[i * n + k]));
        }
        if (largest > 0.0 && largest < 1e-300) {
            return 1;
        }
        all = fmax(all, largest);
    }
    return normalise == BRDFFIT_NORMALISE_NONE && all > 0.0 && all < 1e-140;
}

/* Everything of a result but its pointers, and what these point at. */
static void assert_same_bits(const struct brdffit_test_result *p, const struct brdffit_test_result *q, size_t channels,
                             int lobes)
{
    struct brdffit_test_result a = *p, b = *q;

    a.model.x = b.model.x = a.model.y = b.model.y = NULL;
    a.model.distributions = b.model.distributions = NULL;
    a.channel_scale = b.channel_scale = a.rms = b.rms = NULL;
    assert_memory_equal(&a, &b, sizeof a);
    assert_memory_equal(p->model.distributions, q->model.distributions, (size_t)lobes * sizeof(brdffit_distribution));
    assert_memory_equal(p->model.x, q->model.x, channels * sizeof(double));
    assert_memory_equal(p->model.y, q->model.y, channels * (size_t)lobes * sizeof(double));
    assert_memory_equal(p->rms, q->rms, channels * sizeof(double));
    assert_memory_equal(p->channel_scale, q->channel_scale, channels * sizeof(double));
}

/* The result with every instruction set is `expected`, to the bit. */
static int with_every_isa(const brdffit_samples *samples, const brdffit_options *options,
                          const struct brdffit_test_result *expected)
{
    int isa, ran = 0;

    for (isa = BRDFFIT_ISA_BASE; isa < BRDFFIT_ISA_COUNT; isa++) {
        brdffit_options other = *options;
        struct brdffit_test_result flat;
        const brdffit_result *result;

        other.isa = (brdffit_isa)isa;
        if (!brdffit_isa_supported(other.isa)) {
            assert_int_equal(brdffit_fit_new(samples, &other, &result, NULL), BRDFFIT_ERR_UNSUPPORTED);
            continue;
        }
        assert_int_equal(brdffit_fit_new(samples, &other, &result, NULL), BRDFFIT_OK);
        brdffit_test_flatten(result, &flat);
        assert_same_bits(&flat, expected, samples->channels, options->lobes);
        brdffit_result_free(result);
        ran++;
    }
    return ran;
}

static void test_random_problems(void **state)
{
    unsigned long seed, fitted = 0;
    int compared = 0;

    (void)state;
    for (seed = first; seed < first + count; seed++) {
        struct brdffit_test_random random = {0x9e37u * (uint64_t)seed + 1u};
        struct brdffit_test_spec spec = random_spec(&random);
        brdffit_options options = random_options(&random);
        struct brdffit_test_data data;
        struct brdffit_test_fit fit;
        size_t used = 0, i;
        int spoil;

        brdffit_test_data_new(&spec, &data);
        spoil = one_in(&random, 6);
        for (i = 0; spoil && i < spec.count * spec.channels; i++) {
            data.values[i] *= one_in(&random, 3) ? (one_in(&random, 2) ? 0.0 : -1.0) : 1.0;
        }
        if (too_small(&data, options.normalise)) {
            brdffit_test_data_free(&data);
            continue;
        }
        if (brdffit_inspect(&data.samples, &options, &used, NULL, 0, NULL) == BRDFFIT_OK) {
            brdffit_test_fit(&data.samples, &options, &fit);
            assert_int_equal(fit.result.samples_used, used);
            if (seed % 3 == 0) {
                compared += with_every_isa(&data.samples, &options, &fit.result);
            }
            fitted++;
            brdffit_test_fit_free(&fit);
        } else {
            assert_int_equal(used, 0);
        }
        brdffit_test_data_free(&data);
    }
    assert_true(fitted > count / 2);
    print_message("%lu fits judged, %d of them repeated with another instruction set\n", fitted, compared);
    assert_true(compared > 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_problems),
    };

    if (argc == 3) {
        first = strtoul(argv[1], NULL, 10);
        count = strtoul(argv[2], NULL, 10);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
