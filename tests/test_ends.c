/*
 * The ends of what can be said in doubles: coefficients near the largest double, roughness at the ends of its range,
 * and a result's e2 against its own model there. SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

#define MOST 8

/* ---- What a model leaves of its data, by brdffit_eval() ------------------------------------------------------ */

static double objective_of(const brdffit_samples *s, const brdffit_options *o, const struct brdffit_test_model *model,
                           const double *scale)
{
    double out[MOST * 2], sum = 0.0;
    size_t i, k;

    assert_true(s->count * s->channels <= MOST * 2);
    assert_int_equal(brdffit_test_eval(model, s, out, NULL), BRDFFIT_OK);
    for (i = 0; i < s->count; i++) {
        for (k = 0; k < s->channels; k++) {
            double r = fabs(s->values[i * s->channels + k] - out[i * s->channels + k]) / scale[k];
            double w = s->weights ? s->weights[i] : 1.0;

            sum = o->norm == BRDFFIT_NORM_LINF ? fmax(sum, r) : sum + (o->norm == BRDFFIT_NORM_L1 ? w * r : w * r * r);
        }
    }
    return sum;
}

/* e2 is that of the published model, to its own error and eval's. */
static void check_model(const brdffit_samples *s, const brdffit_options *o, const struct brdffit_test_result *r)
{
    double found = objective_of(s, o, &r->model, r->channel_scale), own;

    own = o->norm == BRDFFIT_NORM_L2 ? 64.0 * DBL_EPSILON * sqrt(r->e2 * r->sum_of_squares) : 0.0;
    own += 64.0 * DBL_EPSILON * (o->norm == BRDFFIT_NORM_L2 ? r->e2 : r->sum_of_squares);
    own += o->norm == BRDFFIT_NORM_L2 ? pow(64.0 * DBL_EPSILON, 2.0) * r->sum_of_squares : 0.0;
    if (!(fabs(found - r->e2) <= r->e2_error + own)) {
        brdffit_test_print(s, o);
        fail_msg("e2 %.17g, but the model has %.17g (errors %g, %g)", r->e2, found, r->e2_error, own);
    }
    assert_true(r->lower_bound <= r->e2);
    assert_true(r->e2_error >= 0.0 && r->e2_error <= 1e-11 * r->sum_of_squares);
}

/* A fit that is not judged by brdffit_verify(), which knows norm l2 and gaps of more than rounding only. */
static void fit_plainly(const brdffit_samples *samples, const brdffit_options *o, struct brdffit_test_fit *fit)
{
    const brdffit_result *result;

    fit->workspace_size = brdffit_workspace_size(samples->count, samples->channels, o);
    fit->workspace = malloc(fit->workspace_size);
    assert_non_null(fit->workspace);
    assert_int_equal(brdffit_fit(samples, o, fit->workspace, fit->workspace_size, &result, NULL), BRDFFIT_OK);
    brdffit_test_flatten(result, &fit->result);
}

/* ---- No sample near the mirror ------------------------------------------------------------------------------- */

struct narrow {
    double a[5], b[5], c[5], values[5];
    brdffit_samples samples;
};

/* Data that fall with c > 0: the narrower the lobe the better, to where y leaves the doubles. */
static void narrow_new(struct narrow *p, double unit)
{
    size_t i;

    for (i = 0; i < 5; i++) {
        p->a[i] = 0.3;
        p->b[i] = 0.3;
        p->c[i] = 0.031 * (1.0 + 5e-4 * (double)i);
        p->values[i] = unit * pow(0.5, (double)i);
    }
    p->samples = brdffit_test_coefficients(5, 1, p->a, p->b, p->c, p->values);
}

static void check_floor(const struct narrow *p, const brdffit_options *o)
{
    struct brdffit_test_fit fit;
    const struct brdffit_test_result *r = &fit.result;
    int by_exponent = strcmp(brdffit_parameter_string(o->distribution), "exponent") == 0;

    if (o->norm == BRDFFIT_NORM_L2) {
        brdffit_test_fit(&p->samples, o, &fit);
    } else {
        fit_plainly(&p->samples, o, &fit);
    }
    check_model(&p->samples, o, r);
    assert_int_equal(r->certified, 1);
    assert_true(r->model.y[0] > 1e250 && isfinite(r->model.y[0]));
    assert_true(r->sigma_floor > (by_exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min));
    assert_true(r->model.sigma[0] >= r->sigma_floor);
    brdffit_test_fit_free(&fit);
}

static void test_floor(void **state)
{
    static const double units[] = {1.0, 1e-9, 1e9, 1e-30, 1e30, 1e-200, 1e200};
    brdffit_options o;
    struct narrow p;
    size_t u;
    int d, norm;

    (void)state;
    brdffit_options_init(&o);
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        for (norm = 0; norm < BRDFFIT_NORM_COUNT; norm++) {
            for (u = 0; u < sizeof units / sizeof *units && d != BRDFFIT_GGX; u++) {
                o.distribution = (brdffit_distribution)d;
                o.norm = (brdffit_norm)norm;
                narrow_new(&p, units[u]);
#ifndef BRDFFIT_NO_ECOS
                check_floor(&p, &o);
#else
                if (norm == BRDFFIT_NORM_L2) {
                    check_floor(&p, &o);
                }
#endif
            }
        }
    }
}

/* A map has the models of its fits. */
static void test_floor_of_maps(void **state)
{
    static const double units[] = {1.0, 1e-9, 1e9, 1e-30};
    brdffit_options o;
    size_t u;

    (void)state;
    brdffit_options_init(&o);
    for (u = 0; u < sizeof units / sizeof *units; u++) {
        struct narrow p;
        struct brdffit_test_fit fit;
        const brdffit_plan *plan;
        brdffit_texels texels;
        brdffit_texel_results to;
        double sigma, y, x, e2, bound;
        unsigned char status;
        void *memory, *work;
        size_t size;

        narrow_new(&p, units[u]);
        brdffit_test_fit(&p.samples, &o, &fit);
        size = brdffit_plan_size(&p.samples, &o);
        memory = malloc(size);
        assert_int_equal(brdffit_plan_init(&p.samples, &o, memory, size, &plan, NULL), BRDFFIT_OK);
        size = brdffit_many_workspace_size(plan);
        work = malloc(size);
        brdffit_texels_init(&texels, plan);
        texels.count = 1;
        texels.values = p.values;
        brdffit_texel_results_init(&to);
        to.sigma = &sigma;
        to.x = &x;
        to.y = &y;
        to.e2 = &e2;
        to.lower_bound = &bound;
        to.status = &status;
        assert_int_equal(brdffit_fit_many(plan, &texels, &to, work, size, NULL, NULL), BRDFFIT_OK);
        assert_int_equal(status, BRDFFIT_TEXEL_CERTIFIED);
        assert_true(y > 1e250 && isfinite(y));
        assert_true(fabs(e2 - fit.result.e2) <= 1e-12 * e2 && fabs(sigma / fit.result.model.sigma[0] - 1.0) <= 1e-12);
        free(work);
        free(memory);
        brdffit_test_fit_free(&fit);
    }
}

/* ---- Roughness near 1e-12 and at the ends of its range --------------------------------------------------------- */

/* The least E^2 over y >= 0 of two samples without a diffuse part, at 1/sigma^2. */
static long double least(const double *b, const double *c, const double *values, double sigma)
{
    long double s = 1.0L / ((long double)sigma * sigma), g[2], gg = 0.0L, gi = 0.0L, y, sum = 0.0L;
    int i;

    for (i = 0; i < 2; i++) {
        g[i] = b[i] * expl(-(long double)c[i] * s);
        gg += g[i] * g[i];
        gi += g[i] * values[i];
    }
    y = gi > 0.0L ? gi / gg : 0.0L;
    for (i = 0; i < 2; i++) {
        sum += (values[i] - y * g[i]) * (values[i] - y * g[i]);
    }
    return sum;
}

/* The optimum on an end of the range, and steep there: rounding of that end must not lift the bound above it. */
static void attack_end(struct brdffit_test_random *random, double steep, int high)
{
    double end = brdffit_test_log_uniform(random, 1e-11, 1e-8), s = 1.0 / (end * end);
    double a[2] = {0.0, 0.0}, b[2], c[2], values[2] = {high ? 1.0 : 0.001, high ? 0.001 : 1.0};
    brdffit_samples samples = brdffit_test_coefficients(2, 1, a, b, c, values);
    struct brdffit_test_fit fit;
    brdffit_options o;

    b[0] = 1.0;
    c[0] = 0.0;
    c[1] = steep / s;
    b[1] = exp(c[1] * s);
    brdffit_options_init(&o);
    o.sigma_max = high ? 1.0 : end;
    o.sigma_min = high ? end : 1e-12;
    o.relative_gap = 1e-14;
    o.absolute_gap = 0.0;
    o.box_budget = 300;
    fit_plainly(&samples, &o, &fit);
    check_model(&samples, &o, &fit.result);
    assert_true(fit.result.model.sigma[0] >= o.sigma_min && fit.result.model.sigma[0] <= o.sigma_max);
    if (!(fit.result.lower_bound <= least(b, c, values, end))) {
        brdffit_test_print(&samples, &o);
        fail_msg("bound %.17g above the end's %.17Lg", fit.result.lower_bound, least(b, c, values, end));
    }
    brdffit_test_fit_free(&fit);
}

static void test_domain_ends(void **state)
{
    static const double steep[] = {1.0, 5.0, 20.0, 50.0, 150.0, 300.0};
    struct brdffit_test_random random = {5};
    size_t i, j;

    (void)state;
    for (i = 0; i < sizeof steep / sizeof *steep; i++) {
        for (j = 0; j < 200; j++) {
            attack_end(&random, steep[i], j % 2);
        }
    }
}

/* Near the smallest roughness, where a unit of ln s is a part of 1e-14: what the model says is what e2 says. */
static void test_tiny_roughness(void **state)
{
    struct brdffit_test_random random = {6};
    size_t t, i;

    (void)state;
    for (t = 0; t < 300; t++) {
        double a[MOST], b[MOST], c[MOST], values[2 * MOST];
        brdffit_samples samples = brdffit_test_coefficients(MOST, 2, a, b, c, values);
        struct brdffit_test_fit fit;
        brdffit_options o;

        for (i = 0; i < MOST; i++) {
            a[i] = brdffit_test_uniform(&random, 0.1, 0.3);
            b[i] = brdffit_test_uniform(&random, 0.1, 2.0);
            c[i] = i ? brdffit_test_log_uniform(&random, 1e-26, 3e-23) : t % 2 ? 1e-23 : 0.0;
            values[2 * i] = brdffit_test_uniform(&random, 0.0, 1.0);
            values[2 * i + 1] = brdffit_test_uniform(&random, 0.0, 1.0);
        }
        brdffit_options_init(&o);
        o.lobes = 1 + (int)(t % 3 == 0);
        o.box_budget = 3000;
        brdffit_test_fit(&samples, &o, &fit);
        check_model(&samples, &o, &fit.result);
        brdffit_test_fit_free(&fit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floor),
        cmocka_unit_test(test_floor_of_maps),
        cmocka_unit_test(test_domain_ends),
        cmocka_unit_test(test_tiny_roughness),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
