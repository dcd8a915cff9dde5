/*
 * Fits of random lists of two and three lobes, each judged by verify.c from the samples alone; the order of the list does
 * not matter; and the optimum against a coarse grid over all roughnesses. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "lobes_case.h"
#include "verify.h"
#include "verify_problem.h"

/* A list, and samples of a goniometer whose values are those of its lobes with noise. */
struct list_case {
    struct brdffit_test_data data;
    brdffit_distribution list[LC_LOBES];
    brdffit_options options;
};

static const brdffit_distribution lists[][LC_LOBES + 1] = {
    {2, BRDFFIT_BECKMANN, BRDFFIT_GGX, 0},
    {2, BRDFFIT_GGX, BRDFFIT_TORRANCE_SPARROW, 0},
    {2, BRDFFIT_WARD, BRDFFIT_LAFORTUNE, 0},
    {2, BRDFFIT_BLINN_PHONG, BRDFFIT_ASHIKHMIN_SHIRLEY, 0},
    {3, BRDFFIT_BECKMANN, BRDFFIT_BECKMANN, BRDFFIT_BECKMANN},
    {3, BRDFFIT_GGX, BRDFFIT_GGX, BRDFFIT_GGX},
    {3, BRDFFIT_GGX, BRDFFIT_BECKMANN, BRDFFIT_GGX},
    {3, BRDFFIT_BLINN_PHONG, BRDFFIT_BECKMANN, BRDFFIT_GGX},
    {3, BRDFFIT_LAFORTUNE, BRDFFIT_LAFORTUNE, BRDFFIT_WARD},
    {3, BRDFFIT_TORRANCE_SPARROW, BRDFFIT_WARD, BRDFFIT_ASHIKHMIN_SHIRLEY},
    {3, BRDFFIT_BLINN_PHONG, BRDFFIT_BLINN_PHONG, BRDFFIT_BLINN_PHONG},
};
#define LISTS (sizeof lists / sizeof *lists)

static void case_new(struct list_case *c, size_t which, uint64_t seed, double noise)
{
    struct brdffit_test_random random = {seed};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t i, k;
    int p, lobes = (int)lists[which][0];

    spec.seed = seed;
    spec.channels = 1 + seed % 2;
    spec.count = seed % 3 ? 60 : 84;
    spec.layout = seed % 4 == 3 ? BRDFFIT_TEST_RANDOM : BRDFFIT_TEST_GRID;
    spec.weighted = seed % 5 == 2;
    brdffit_test_data_new(&spec, &c->data);
    memcpy(c->list, lists[which] + 1, sizeof c->list);
    for (i = 0; i < spec.count * spec.channels; i++) {
        c->data.values[i] = 0.0;
    }
    for (p = 0; p < lobes; p++) {
        double sigma = brdffit_test_log_uniform(&random, p ? 0.15 : 0.05, p ? 0.6 : 0.2);

        for (i = 0; i < spec.count; i++) {
            struct verify_sample at;

            if (verify_sample_of(c->list[p], &c->data.samples, 90.0, i, &at) != BRDFFIT_SKIP_COUNT) {
                continue;
            }
            for (k = 0; k < spec.channels; k++) {
                long double y = 0.05L + 0.1L * (long double)((k + (size_t)p) % 3);
                long double v = (p ? 0.0L : 0.3L * at.a) + y * at.b * verify_lobe(c->list[p], at.c, sigma);

                c->data.values[i * spec.channels + k] += (double)(v / at.to_radiance);
            }
        }
    }
    for (i = 0; i < spec.count * spec.channels; i++) {
        c->data.values[i] *= 1.0 + noise * brdffit_test_normal(&random);
    }
    brdffit_options_init(&c->options);
    c->options.lobes = lobes;
    c->options.distributions = c->list;
    c->options.relative_gap = 0.05;
    c->options.box_budget = 40000;
    c->options.sigma_min = 1e-3;
    c->options.sigma_max = 2.0;
    c->options.exponent_min = 0.25;
    c->options.exponent_max = 1e6;
}

/* The judge's own attacks, and the gap closed. */
static void test_lists_are_judged(void **state)
{
    size_t i, certified = 0, fits = 0;
    uint64_t seed;

    (void)state;
    for (i = 0; i < LISTS; i++) {
        for (seed = 1; seed <= FEWER(3, 1); seed++) {
            struct list_case c;
            struct brdffit_test_fit fit;

            case_new(&c, i, 10 * i + seed, 0.05);
            brdffit_test_fit(&c.data.samples, &c.options, &fit);
            certified += (size_t)fit.result.certified;
            fits++;
            brdffit_test_fit_free(&fit);
            brdffit_test_data_free(&c.data);
        }
    }
    print_message("%zu of %zu fits certified to 5 %%\n", certified, fits);
    assert_true(certified * 10 >= fits * 8);
}

/* The nasty problems of the attacks, fitted: what they claim is true, whatever stopped them. */
static void test_nasty_problems(void **state)
{
    static struct lobes_case m;
    size_t fits = 0, certified = 0;
    uint64_t seed;

    (void)state;
    for (seed = 1; fits < FEWER(120, 30); seed++) {
        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT) && !m.samples.weights) {
            struct brdffit_test_fit fit;

            m.options.relative_gap = 0.02;
            m.options.box_budget = m.lobes > 2 ? 700 : 2000;
            brdffit_test_fit(&m.samples, &m.options, &fit);
            certified += (size_t)fit.result.certified;
            fits++;
            brdffit_test_fit_free(&fit);
        }
        lc_close(&m);
    }
    print_message("%zu of %zu certified\n", certified, fits);
}

/* Whatever the order, the same problem: both proofs hold for both optima. */
static void test_order_of_the_list(void **state)
{
    size_t i;

    (void)state;
    for (i = 0; i < LISTS; i++) {
        struct list_case c;
        struct brdffit_test_fit one, two;
        brdffit_distribution first;

        case_new(&c, i, 100 + i, 0.05);
        brdffit_test_fit(&c.data.samples, &c.options, &one);
        first = c.list[0];
        memmove(c.list, c.list + 1, ((size_t)c.options.lobes - 1) * sizeof *c.list);
        c.list[c.options.lobes - 1] = first;
        brdffit_test_fit(&c.data.samples, &c.options, &two);
        assert_true(one.result.lower_bound <= two.result.e2 * (1.0 + 1e-12));
        assert_true(two.result.lower_bound <= one.result.e2 * (1.0 + 1e-12));
        brdffit_test_fit_free(&one);
        brdffit_test_fit_free(&two);
        brdffit_test_data_free(&c.data);
    }
}

/* Brute force: every point of a grid in ln sigma, with the judge's long double columns. */
#define GRID FEWER(18, 8)

static void test_against_a_grid(void **state)
{
    size_t i;

    (void)state;
    for (i = 0; i < LISTS; i++) {
        struct brdffit_test_fit fit;
        struct verify_problem p;
        struct list_case c;
        long double least = INFINITY, at[LC_LOBES];
        int index, points, j;

        case_new(&c, i, 200 + i, 0.1);
        brdffit_test_fit(&c.data.samples, &c.options, &fit);
        memset(&p, 0, sizeof p);
        p.samples = &c.data.samples;
        p.options = &c.options;
        p.floor = fit.result.sigma_floor;
        verify_classify(&p);
        verify_rows(&p, fit.result.channel_scale);
        verify_floors(&p);
        points = c.options.lobes == 2 ? GRID * GRID : GRID * GRID * GRID;
        for (index = 0; index < points; index++) {
            int place = index;
            long double e2;

            for (j = 0; j < c.options.lobes; j++) {
                at[j] = fmaxl(p.lobe[j].low, p.floor);
                at[j] *= powl(p.lobe[j].high / at[j], (place % GRID) / (GRID - 1.0L));
                at[j] = fminl(at[j], p.lobe[j].high);
                place /= GRID;
            }
            e2 = verify_optimum(&p, at);
            if (!(e2 + verify_allowance(&p, at) >= fit.result.lower_bound)) {
                fail_msg("list %zu: lower bound %.17g above %.17Lg", i, fit.result.lower_bound, e2);
            }
            least = fminl(least, e2);
        }
        /* The fit is no worse than the best of the grid by more than it admits. */
        assert_true(fit.result.e2 - fit.result.gap <= least * (1.0L + 1e-12L));
        assert_true(!fit.result.certified ||
                    fit.result.e2 <= (1.0L + c.options.relative_gap) * least * (1.0L + 1e-12L));
        verify_problem_free(&p);
        brdffit_test_fit_free(&fit);
        brdffit_test_data_free(&c.data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_are_judged),
        cmocka_unit_test(test_nasty_problems),
        cmocka_unit_test(test_order_of_the_list),
        cmocka_unit_test(test_against_a_grid),
    };

    return cmocka_run_group_tests_name("fit_lobes", tests, NULL, NULL);
}
