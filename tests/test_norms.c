/*
 * Norms l1 and linf, whole fits: every result is judged against its samples in long double, against a dense grid of
 * roughness, and against what must come out of exact, spoilt and degenerate data. SPDX-License-Identifier: MIT
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
#include "fit/fit.h"
#include "support.h"

static brdffit_options options_of(brdffit_norm norm, int lobes)
{
    brdffit_options options;

    brdffit_options_init(&options);
    options.norm = norm;
    options.lobes = lobes;
    options.relative_gap = lobes > 1 ? 1e-2 : 1e-3;
    options.box_budget = 20000;
    return options;
}

/* Beckmann samples as coefficients, so that the judge needs no geometry of the library. */
#define MOST 48
struct data {
    brdffit_samples samples;
    double a[MOST], b[MOST], c[MOST], values[MOST * 31], weights[MOST];
};

static void make(struct data *d, uint64_t seed, size_t count, size_t channels, int lobes, double noise, int weighted)
{
    static const double sigma[2] = {0.15, 0.5};
    struct brdffit_test_random random = {seed};
    size_t i, k;
    int p;

    for (i = 0; i < count; i++) {
        double t = tan(brdffit_test_uniform(&random, 0.0, 1.2));

        d->a[i] = brdffit_test_uniform(&random, 0.1, 0.32);
        d->b[i] = brdffit_test_uniform(&random, 0.3, 1.5);
        d->c[i] = i ? t * t : 0.001;
        d->weights[i] = weighted && i % 5 == 3 ? 0.0 : brdffit_test_log_uniform(&random, 0.1, 10.0);
    }
    for (i = 0; i < count; i++) {
        for (k = 0; k < channels; k++) {
            double value = d->a[i] * (0.5 + 0.3 * (double)(k % 3));

            for (p = 0; p < lobes; p++) {
                value += d->b[i] * 0.1 * (p + 1) * exp(-d->c[i] / (sigma[p] * sigma[p])) / (sigma[p] * sigma[p]);
            }
            d->values[i * channels + k] = value * (1.0 + noise * brdffit_test_normal(&random));
        }
    }
    d->samples = brdffit_test_coefficients(count, channels, d->a, d->b, d->c, d->values);
    d->samples.weights = weighted ? d->weights : NULL;
}

#ifndef BRDFFIT_NO_ECOS

struct figures {
    long double objective, zero, squares, weights;
};

/* What the norm makes of the residuals of the result's own coefficients, and of the data. */
static struct figures figures_of(const brdffit_samples *s, brdffit_norm norm, const struct brdffit_test_result *r)
{
    struct figures f = {0.0L, 0.0L, 0.0L, 0.0L};
    size_t i, k;
    int p;

    for (i = 0; i < s->count; i++) {
        long double w = s->weights ? s->weights[i] : 1.0;

        f.weights += w;
        for (k = 0; k < s->channels && w > 0.0L; k++) {
            long double value = s->values[i * s->channels + k], rest = value - s->a[i] * (long double)r->model.x[k];

            for (p = 0; p < r->model.lobes; p++) {
                long double inverse = 1.0L / ((long double)r->model.sigma[p] * r->model.sigma[p]);

                rest -= r->model.y[k * (size_t)r->model.lobes + (size_t)p] *
                        (s->b[i] * inverse * expl(-s->c[i] * inverse));
            }
            value = fabsl(value / r->channel_scale[k]);
            rest = fabsl(rest / r->channel_scale[k]);
            f.squares += w * rest * rest;
            f.objective = norm == BRDFFIT_NORM_L1 ? f.objective + w * rest : fmaxl(f.objective, rest);
            f.zero = norm == BRDFFIT_NORM_L1 ? f.zero + w * value : fmaxl(f.zero, value);
        }
    }
    return f;
}

/* Every claim that does not need another fit. */
static void judge(const brdffit_samples *s, const brdffit_options *o, const struct brdffit_test_result *r)
{
    struct figures f = figures_of(s, o->norm, r);
    long double rms = sqrtl(f.squares / ((long double)s->channels * f.weights));
    size_t k;

    assert_true(fabsl(f.objective - (long double)r->e2) <= 1e-12L * f.zero);
    assert_true(fabsl(f.zero - (long double)r->sum_of_squares) <= 1e-13L * f.zero);
    assert_true(fabsl(rms - (long double)r->rms_total) <= 1e-11L * f.zero);
    assert_true(r->lower_bound >= 0.0 && r->lower_bound <= r->e2 && r->gap == r->e2 - r->lower_bound);
    assert_true(r->kkt_residual <= 1e-7);
    for (k = 0; k < s->channels * (size_t)r->model.lobes; k++) {
        assert_true(r->model.y[k] >= 0.0 && r->model.x[k / (size_t)r->model.lobes] >= 0.0);
    }
    if (r->stop == BRDFFIT_STOP_RELATIVE_GAP) {
        /* Along a flat interval the reported objective may be the optimum's plus rounding. */
        assert_true(r->e2 <= (1.0 + o->relative_gap) * r->lower_bound * (1.0 + 1e-12) + 1e-13 * r->sum_of_squares);
    } else if (r->stop == BRDFFIT_STOP_ABSOLUTE_GAP) {
        assert_true(r->gap <= (1.0 + 1e-9) * o->absolute_gap * r->sum_of_squares);
    }
    assert_true(r->certified == (r->stop == BRDFFIT_STOP_RELATIVE_GAP || r->stop == BRDFFIT_STOP_ABSOLUTE_GAP));
    assert_true(r->programs_refused <= r->programs_solved && r->programs_decided <= r->boxes);
}

static void fit_and_judge(const brdffit_samples *samples, const brdffit_options *options, struct brdffit_test_fit *fit)
{
    brdffit_error error;

    fit->workspace_size = brdffit_workspace_size(samples->count, samples->channels, options);
    fit->workspace = malloc(fit->workspace_size);
    assert_non_null(fit->workspace);
    if (brdffit_test_run(samples, options, fit->workspace, fit->workspace_size, &fit->result, &error) != BRDFFIT_OK) {
        fail_msg("%s", error.message);
    }
    judge(samples, options, &fit->result);
}

/* Smallest objective on a grid of theta, by the restricted problem with ECOS beside it. */
static double grid_minimum(const brdffit_samples *samples, const brdffit_options *options, int steps)
{
    struct arena arena;
    struct engine engine;
    struct fit fit;
    size_t size = brdffit_workspace_size(samples->count, samples->channels, options);
    void *workspace = malloc(size);
    double best = INFINITY;
    int i, j;

    assert_non_null(workspace);
    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(&fit, &arena, samples->count, samples->channels, options);
    assert_int_equal(brdffit_reduce(&fit.data, samples, &fit.model, options, NULL), BRDFFIT_OK);
    brdffit_fit_prepare(&fit, options);
    brdffit_axis_start(fit.axis, fit.domain[0].low, fit.domain[0].high, 1);
    assert_int_equal(brdffit_fit_engine_start(&fit, options, &engine), BRDFFIT_OK);
    for (i = 0; i <= steps; i++) {
        for (j = options->lobes > 1 ? i : steps; j <= steps; j++) {
            struct point at;
            struct varpro_value value;

            at.theta[0] = fit.domain[0].low + (fit.domain[0].high - fit.domain[0].low) * i / steps;
            at.theta[1] = fit.domain[0].low + (fit.domain[0].high - fit.domain[0].low) * j / steps;
            brdffit_fit_evaluate(&fit, &at, options->lobes == 1, &value);
            assert_true(value.kkt <= 1e-7);
            best = fmin(best, value.objective);
        }
    }
    brdffit_fit_engine_finish(&fit, options);
    best *= options->norm == BRDFFIT_NORM_L1 ? fit.data.scale_w : 1.0;
    free(workspace);
    return best;
}

static void test_against_a_grid(void **state)
{
    int i, lobes;

    (void)state;
    for (i = 0; i < FEWER(12, 4); i++) {
        for (lobes = 1; lobes <= 2; lobes++) {
            brdffit_options options = options_of(i % 2 ? BRDFFIT_NORM_L1 : BRDFFIT_NORM_LINF, lobes);
            struct brdffit_test_fit fit;
            struct data d;
            double grid;

            make(&d, 10 + (uint64_t)i, 24 + (size_t)i, 1 + (size_t)i % 3, 2, 0.1, i % 4 == 2 || i % 4 == 3);
            fit_and_judge(&d.samples, &options, &fit);
            assert_int_equal(fit.result.certified, 1);
            grid = grid_minimum(&d.samples, &options, lobes > 1 ? FEWER(60, 20) : FEWER(800, 200));
            /* No point of the grid is below the bound, and the fit is no worse than the gap beyond the best. */
            assert_true(grid >= fit.result.lower_bound);
            assert_true(fit.result.e2 <= (1.0 + options.relative_gap) * grid);
            free(fit.workspace);
        }
    }
}

static void test_exact_data_are_recovered(void **state)
{
    int i, lobes;

    (void)state;
    for (i = 0; i < 8; i++) {
        for (lobes = 1; lobes <= 2; lobes++) {
            brdffit_options options = options_of(i % 2 ? BRDFFIT_NORM_L1 : BRDFFIT_NORM_LINF, lobes);
            struct brdffit_test_fit fit;
            struct data d;

            make(&d, 50 + (uint64_t)i, 40, 1 + (size_t)i % 3, lobes, 0.0, i & 2);
            fit_and_judge(&d.samples, &options, &fit);
            assert_int_equal(fit.result.certified, 1);
            assert_true(fit.result.e2 <= 1e-11 * fit.result.sum_of_squares);
            assert_true(fabs(fit.result.model.sigma[0] - 0.15) <= 1e-9);
            assert_true(lobes < 2 || fabs(fit.result.model.sigma[1] - 0.5) <= 1e-8);
            free(fit.workspace);
        }
    }
}

/* A tenth of the samples far out: l1 gives the truth to the bit of the rest, l2 does not. */
static void test_l1_ignores_gross_outliers(void **state)
{
    brdffit_options options = options_of(BRDFFIT_NORM_L1, 1);
    struct brdffit_test_fit fit;
    struct data d;
    size_t i;

    (void)state;
    make(&d, 7, 40, 2, 1, 0.0, 0);
    for (i = 0; i < 8; i++) {
        d.values[(i / 2) * 20 + 10 + i % 2] += 30.0;
    }
    fit_and_judge(&d.samples, &options, &fit);
    assert_true(fit.result.certified && fabs(fit.result.model.sigma[0] - 0.15) <= 1e-9);
    free(fit.workspace);
    options.norm = BRDFFIT_NORM_L2;
    brdffit_test_fit(&d.samples, &options, &fit);
    assert_true(fabs(fit.result.model.sigma[0] - 0.15) > 0.015);
    brdffit_test_fit_free(&fit);
}

/* ---- The edges ---------------------------------------------------------------------------------------------- */

static void test_degenerate_input(void **state)
{
    static const double weights[4] = {1.0, 0.0, 1e-3, 1e3};
    int norm, lobes, kind;

    (void)state;
    for (norm = BRDFFIT_NORM_L1; norm <= BRDFFIT_NORM_LINF; norm++) {
        for (lobes = 1; lobes <= 2; lobes++) {
            for (kind = 0; kind < 7; kind++) {
                brdffit_options options = options_of((brdffit_norm)norm, lobes);
                struct brdffit_test_fit fit;
                struct data d;
                size_t i, count = kind == 0 ? 1 : kind == 1 ? 2 : 20;

                make(&d, 3, count, kind == 6 ? 31 : 2, 2, 0.05, 0);
                for (i = 0; i < 2 * count; i++) {
                    d.values[i] *= kind == 2 ? 0.0 : kind == 3 ? -1.0 : 1.0; /* nothing, or nothing but negative */
                }
                for (i = 0; i < count; i++) {
                    d.c[i] = kind == 4 ? 0.5 : d.c[i];
                    d.b[i] = kind == 5 ? 0.0 : d.b[i]; /* no lobe anywhere */
                }
                options.sigma_min = 0.05;
                d.samples.weights = count == 2 ? weights + 2 : NULL;
                fit_and_judge(&d.samples, &options, &fit);
                assert_int_equal(fit.result.certified, 1);
                assert_true(kind > 1 || fit.result.e2 <= 1e-13 * fit.result.sum_of_squares);
                assert_true(kind != 3 || fit.result.e2 >= (1.0 - 1e-14) * fit.result.sum_of_squares);
                /* No roughness can be told from another: the largest, and said so. */
                assert_true(kind != 4 || (fit.result.lobe[0].warnings & BRDFFIT_WARN_FLAT &&
                                          fit.result.model.sigma[0] == options.sigma_max));
                free(fit.workspace);
            }
        }
    }
}

/* Any budget leaves a valid bound and incumbent; sending every box to ECOS changes neither optimum nor proof. */
static void test_budgets_and_shortcuts(void **state)
{
    static const size_t budget[] = {1, 2, 3, 16, 17, 40, 20000};
    int norm;
    size_t i;

    (void)state;
    for (norm = BRDFFIT_NORM_L1; norm <= BRDFFIT_NORM_LINF; norm++) {
        brdffit_options options = options_of((brdffit_norm)norm, 1);
        double last = 0.0, best = 0.0;

        for (i = 0; i < 2 * sizeof budget / sizeof *budget; i++) {
            struct brdffit_test_fit fit;
            struct data d;

            make(&d, 91, 30, 3, 2, 0.1, 1);
            options.socp_every_box = i % 2 != 0;
            options.box_budget = budget[i / 2];
            fit_and_judge(&d.samples, &options, &fit);
            assert_true(fit.result.boxes <= options.box_budget);
            assert_true(fit.result.certified || fit.result.stop == BRDFFIT_STOP_BUDGET);
            assert_true(!options.socp_every_box || fit.result.programs_decided == 0);
            if (fit.result.certified) {
                best = fit.result.e2;
            }
            last = fmax(last, fit.result.lower_bound);
            free(fit.workspace);
        }
        assert_true(best > 0.0 && last <= best);
    }
}

/* The data's own units, and any scale of data and weights: the same roughness. */
static void test_units(void **state)
{
    int i, norm;

    (void)state;
    for (norm = BRDFFIT_NORM_L1; norm <= BRDFFIT_NORM_LINF; norm++) {
        double sigma = 0.0;

        for (i = 0; i < 3; i++) {
            brdffit_options options = options_of((brdffit_norm)norm, 1);
            struct brdffit_test_fit fit;
            struct data d;
            size_t j;

            make(&d, 17, 30, 2, 1, 0.05, 1);
            for (j = 0; j < 60; j++) {
                d.values[j] *= i ? pow(2.0, i == 1 ? 300.0 : -300.0) : 1.0;
            }
            for (j = 0; j < 30; j++) {
                d.weights[j] *= i ? 0x1p40 : 1.0;
            }
            options.normalise = BRDFFIT_NORMALISE_NONE;
            fit_and_judge(&d.samples, &options, &fit);
            assert_int_equal(fit.result.certified, 1);
            assert_true(i == 0 || fit.result.model.sigma[0] == sigma);
            sigma = fit.result.model.sigma[0];
            free(fit.workspace);
        }
    }
}

/* All distributions go through the same engine. */
static void test_distributions(void **state)
{
    int distribution;

    (void)state;
    for (distribution = 0; distribution < BRDFFIT_DISTRIBUTION_COUNT; distribution++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        brdffit_options options = options_of(distribution % 2 ? BRDFFIT_NORM_L1 : BRDFFIT_NORM_LINF, 1);
        struct brdffit_test_data data;
        const brdffit_result *result;

        spec.distribution = options.distribution = (brdffit_distribution)distribution;
        spec.lobes = 1;
        spec.sigma[0] = 0.2;
        brdffit_test_data_new(&spec, &data);
        assert_int_equal(brdffit_fit_new(&data.samples, &options, &result, NULL), BRDFFIT_OK);
        assert_int_equal(result->certified, 1);
        assert_true(fabs(result->model->sigma[0] - 0.2) <= 1e-9);
        brdffit_result_free(result);
        brdffit_test_data_free(&data);
    }
}

#else

static void test_unsupported(void **state)
{
    int norm;

    (void)state;
    for (norm = BRDFFIT_NORM_L1; norm <= BRDFFIT_NORM_LINF; norm++) {
        brdffit_options options = options_of((brdffit_norm)norm, 1);
        struct data d;

        make(&d, 1, 10, 1, 1, 0.0, 0);
        (void)brdffit_test_fit_fails(&d.samples, &options, BRDFFIT_ERR_UNSUPPORTED);
    }
}

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
#ifndef BRDFFIT_NO_ECOS
        cmocka_unit_test(test_against_a_grid),
        cmocka_unit_test(test_exact_data_are_recovered),
        cmocka_unit_test(test_l1_ignores_gross_outliers),
        cmocka_unit_test(test_degenerate_input),
        cmocka_unit_test(test_budgets_and_shortcuts),
        cmocka_unit_test(test_units),
        cmocka_unit_test(test_distributions),
#else
        cmocka_unit_test(test_unsupported),
#endif
    };

    return cmocka_run_group_tests_name("norms", tests, NULL, NULL);
}
