/*
 * Intervals of parameters: attacked by models near the optimum, compared with what these reach, and counted against
 * a known truth. SPDX-License-Identifier: MIT
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>

#include "fewer.h"
#include "intervals_attack.h"

struct claimed {
    const brdffit_result *fit;
    const brdffit_interval_result *claim;
    void *workspace;
};

static void claim(const brdffit_samples *samples, const brdffit_options *options, const brdffit_interval_options *asked,
                  struct claimed *out)
{
    size_t size = brdffit_intervals_workspace_size(samples->count, samples->channels, options);
    brdffit_error error = {0};

    assert_true(size > 0);
    assert_int_equal(brdffit_fit_new(samples, options, &out->fit, &error), BRDFFIT_OK);
    out->workspace = malloc(size);
    if (brdffit_intervals(samples, options, out->fit->model, out->fit->e2, asked, out->workspace, size, &out->claim,
                          &error) != BRDFFIT_OK) {
        fail_msg("%s", error.message);
    }
}

static void claim_free(struct claimed *c)
{
    brdffit_result_free(c->fit);
    free(c->workspace);
}

static void check_range(const brdffit_range *r, double fitted)
{
    assert_true(r->low <= r->inner_low && r->inner_low <= r->inner_high && r->inner_high <= r->high);
    assert_true(r->inner_low <= fitted * (1 + 1e-12) && r->inner_high >= fitted * (1 - 1e-12));
}

/* Inner within outer, the fitted model within inner. */
static void check_ranges(const struct claimed *c)
{
    const brdffit_model *m = c->fit->model;
    const brdffit_interval_result *r = c->claim;
    size_t k, P = (size_t)m->lobes, F = (size_t)r->diffuse_columns;
    size_t p;

    for (p = 0; p < P; p++) {
        check_range(&r->sigma[p], m->sigma[p]);
    }
    for (k = 0; k < r->channels; k++) {
        check_range(&r->x[k * F], m->x[k]);
        for (p = 0; p < P; p++) {
            check_range(&r->y[k * P + p], m->y[k * P + p]);
            if (r->f0) {
                check_range(&r->f0[k * P + p], m->f0[k * P + p]);
            }
        }
    }
}

static void print_range(const char *name, const brdffit_range *r, const long double reached[2])
{
    printf("  %-8s [%.7g, %.7g]  inner [%.7g, %.7g]  sampled [%.7g, %.7g]%s%s%s\n", name, r->low, r->high, r->inner_low,
           r->inner_high, (double)reached[0], (double)reached[1], r->flags & BRDFFIT_INTERVAL_LOW_END ? " low end" : "",
           r->flags & BRDFFIT_INTERVAL_HIGH_END ? " high end" : "", r->flags & BRDFFIT_INTERVAL_OPEN ? " open" : "");
}

static void print_claim(const char *title, const struct claimed *c, const struct attack *a)
{
    const brdffit_interval_result *r = c->claim;
    size_t at = 0, k;
    int p, f;

    printf("%s: threshold %.6g of e2 %.6g, %zu boxes; %zu models near enough, %zu outside\n", title, r->threshold,
           r->e2, r->boxes, a->inside, a->outside);
    for (p = 0; p < r->lobes; p++, at++) {
        print_range("sigma", &r->sigma[p], (long double[2]){a->reached[0][at], a->reached[1][at]});
    }
    for (k = 0; k < r->channels; k++) {
        for (f = 0; f < r->diffuse_columns; f++, at++) {
            print_range("x", &r->x[k * (size_t)r->diffuse_columns + (size_t)f],
                        (long double[2]){a->reached[0][at], a->reached[1][at]});
        }
        for (p = 0; p < r->lobes; p++, at++) {
            print_range("y", &r->y[k * (size_t)r->lobes + (size_t)p],
                        (long double[2]){a->reached[0][at], a->reached[1][at]});
            if (r->f0) {
                at++;
                print_range("f0", &r->f0[k * (size_t)r->lobes + (size_t)p],
                            (long double[2]){a->reached[0][at], a->reached[1][at]});
            }
        }
    }
}

/* Roughness over what is claimed and a tenth more on each side. */
static void draw_sigma(const struct claimed *c, struct brdffit_test_random *random, double *sigma)
{
    int p, q;

    for (p = 0; p < c->claim->lobes; p++) {
        const brdffit_range *r = &c->claim->sigma[p];
        double low = log(fmax(r->low, 1e-6)), high = log(r->high), more = 0.1 * (high - low) + 1e-9;

        sigma[p] = exp(brdffit_test_uniform(random, low - more, high + more));
    }
    for (p = 1; p < c->claim->lobes; p++) {
        for (q = p; q > 0 && sigma[q - 1] > sigma[q]; q--) {
            double s = sigma[q];

            sigma[q] = sigma[q - 1];
            sigma[q - 1] = s;
        }
    }
}

/* Within what was searched; below 1e-7 the oracle would need more digits. */
static double in_range(const brdffit_options *o, double floor, double sigma)
{
    int by_exponent = strcmp(brdffit_parameter_string(o->distribution), "exponent") == 0;
    double low = by_exponent ? 1.0 / sqrt(o->exponent_max) * (1 + 1e-15) : o->sigma_min;
    double high = by_exponent ? 1.0 / sqrt(o->exponent_min) * (1 - 1e-15) : o->sigma_max;

    return fmin(fmax(sigma, fmax(fmax(1e-7, floor), low)), high);
}

static void attack(const char *title, const brdffit_samples *samples, const brdffit_options *options,
                   const brdffit_interval_options *asked, int points)
{
    struct brdffit_test_random random = {20260729};
    struct claimed c;
    struct attack a;
    double sigma[BRDFFIT_MAX_LOBES], scale = 1.0, centre[BRDFFIT_MAX_LOBES];
    int i, p, q;

    claim(samples, options, asked, &c);
    attack_new(&a, samples, options, c.fit->channel_scale, c.claim);
    for (p = 0; p < options->lobes; p++) {
        centre[p] = c.fit->model->sigma[p];
    }
    (void)attack_sigma(&a, c.fit->model->sigma, 200, &random);
    for (i = 0; i < points; i++) {
        if (i % 2) { /* a walk inside of the set, out to where it ends */
            for (p = 0; p < options->lobes; p++) {
                sigma[p] = centre[p] * exp(scale * brdffit_test_normal(&random));
            }
            for (p = 1; p < options->lobes; p++) {
                for (q = p; q > 0 && sigma[q - 1] > sigma[q]; q--) {
                    double s = sigma[q];

                    sigma[q] = sigma[q - 1];
                    sigma[q - 1] = s;
                }
            }
        } else {
            draw_sigma(&c, &random, sigma);
        }
        for (p = 0; p < options->lobes; p++) {
            sigma[p] = in_range(options, c.fit->sigma_floor, sigma[p]);
        }
        if (attack_sigma(&a, sigma, 100, &random)) {
            memcpy(centre, sigma, sizeof centre);
            scale *= 1.3;
        } else {
            scale *= 0.9;
        }
    }
    print_claim(title, &c, &a);
    check_ranges(&c);
    assert_int_equal(a.outside, 0);
    assert_true(a.inside > 0);
    attack_free(&a);
    claim_free(&c);
}

static void one_lobe(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_options o;
    brdffit_interval_options asked;

    (void)state;
    spec.noise = 0.02;
    spec.lobes = 1;
    spec.sigma[0] = 0.2;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&o);
    brdffit_interval_options_init(&asked);
    attack("one lobe", &data.samples, &o, NULL, FEWER(200, 20));
    asked.eta = 0.01;
    attack("one lobe, eta 0.01", &data.samples, &o, &asked, FEWER(200, 20));
    asked.eta = 1.0;
    attack("one lobe, eta 1", &data.samples, &o, &asked, FEWER(200, 20));
    brdffit_test_data_free(&data);
}

/* Other models of data that have two lobes and noise. */
static void other_models(void **state)
{
    static const struct {
        const char *title;
        int lobes, points;
        brdffit_distribution distribution;
        brdffit_fresnel fresnel;
        brdffit_diffuse diffuse;
        brdffit_masking masking;
    } cases[] = {
        {"two Beckmann lobes", 2, 150, BRDFFIT_BECKMANN, 0, 0, 0},
        {"two GGX lobes", 2, 60, BRDFFIT_GGX, 0, 0, 0},
        {"GGX, Smith", 1, 200, BRDFFIT_GGX, 0, 0, BRDFFIT_MASKING_SMITH},
        {"GGX, Smith, Schlick", 1, 100, BRDFFIT_GGX, BRDFFIT_FRESNEL_SCHLICK, 0, BRDFFIT_MASKING_SMITH},
        {"Beckmann, Schlick", 1, 100, BRDFFIT_BECKMANN, BRDFFIT_FRESNEL_SCHLICK, 0, 0},
        {"Ward, Oren-Nayar", 1, 100, BRDFFIT_WARD, 0, BRDFFIT_DIFFUSE_OREN_NAYAR, 0},
        {"Blinn-Phong, no diffuse term", 1, 100, BRDFFIT_BLINN_PHONG, 0, BRDFFIT_DIFFUSE_NONE, 0},
        {"Beckmann, Burley", 1, 60, BRDFFIT_BECKMANN, 0, BRDFFIT_DIFFUSE_BURLEY, 0},
    };
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    size_t i;

    (void)state;
    spec.noise = 0.01;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < sizeof cases / sizeof *cases; i++) {
        brdffit_options o;

        brdffit_options_init(&o);
        o.lobes = cases[i].lobes;
        o.distribution = cases[i].distribution;
        o.fresnel = cases[i].fresnel;
        o.diffuse = cases[i].diffuse;
        o.masking = cases[i].masking;
        attack(cases[i].title, &data.samples, &o, NULL, FEWER(cases[i].points, 10));
    }
    brdffit_test_data_free(&data);
}

/* Channels that bounds do without, weights, noise given, and units at the ends of the number range. */
static void channels_and_units(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_interval_options asked;
    brdffit_options o;
    size_t i;

    (void)state;
    spec.noise = 0.02;
    spec.lobes = 1;
    spec.weighted = 1;
    spec.channels = 5;
    brdffit_test_data_new(&spec, &data);
    for (i = 0; i < spec.count; i++) {
        data.values[5 * i + 2] = data.values[5 * i];
        data.values[5 * i + 3] = 0.0;
        data.values[5 * i + 4] = 2.0 * data.values[5 * i];
    }
    brdffit_options_init(&o);
    brdffit_interval_options_init(&asked);
    attack("equal and zero channels, weights", &data.samples, &o, NULL, FEWER(60, 10));
    asked.noise = 0.1;
    asked.level = 0.5;
    attack("noise 0.1", &data.samples, &o, &asked, FEWER(60, 10));
    o.normalise = BRDFFIT_NORMALISE_NONE;
    attack("own units", &data.samples, &o, NULL, FEWER(60, 10));
    asked.noise = 0.0;
    asked.eta = 1e6;
    attack("eta 1e6", &data.samples, &o, &asked, FEWER(60, 10));
    brdffit_test_data_free(&data);
}

/* A lobe that is narrower than what the directions resolve, one that is not there, and one roughness only. */
static void flat(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct claimed c;
    brdffit_interval_options asked;
    brdffit_options o;

    (void)state;
    brdffit_options_init(&o);
    brdffit_interval_options_init(&asked);
    spec.noise = 0.01;
    spec.lobes = 1;
    spec.sigma[0] = 0.001;
    spec.layout = BRDFFIT_TEST_GRID;
    brdffit_test_data_new(&spec, &data);
    attack("unresolved", &data.samples, &o, NULL, FEWER(100, 10));
    claim(&data.samples, &o, NULL, &c);
    assert_true(c.claim->sigma[0].flags & BRDFFIT_INTERVAL_LOW_END);
    assert_true(c.claim->sigma[0].low == c.fit->sigma_floor);
    claim_free(&c);
    o.fresnel = BRDFFIT_FRESNEL_SCHLICK;
    attack("unresolved, Schlick", &data.samples, &o, NULL, FEWER(100, 10));
    brdffit_test_data_free(&data);

    brdffit_options_init(&o);
    spec = brdffit_test_spec_default();
    spec.noise = 0.01;
    spec.lobes = 1;
    spec.specular[0] = 0.0;
    spec.channels = 1;
    brdffit_test_data_new(&spec, &data);
    attack("no lobe", &data.samples, &o, NULL, FEWER(100, 10));
    o.fresnel = BRDFFIT_FRESNEL_SCHLICK;
    attack("no lobe, Schlick", &data.samples, &o, NULL, FEWER(100, 10));
    claim(&data.samples, &o, NULL, &c);
    assert_true(c.claim->f0[0].low == 0.0 && c.claim->f0[0].high == 1.0);
    assert_int_equal(c.claim->f0[0].flags & 3u, BRDFFIT_INTERVAL_LOW_END | BRDFFIT_INTERVAL_HIGH_END);
    claim_free(&c);
    brdffit_options_init(&o);
    o.sigma_min = o.sigma_max = 0.3;
    attack("one roughness", &data.samples, &o, NULL, FEWER(20, 5));
    o.sigma_min = 0.05;
    o.sigma_max = 0.3;
    o.lobes = 2;
    attack("two lobes of none", &data.samples, &o, NULL, FEWER(60, 5));
    brdffit_test_data_free(&data);
}

/* Zero data, one sample, data that fit exactly. */
static void degenerate(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct claimed c;
    brdffit_interval_options asked;
    brdffit_options o;
    brdffit_error error;
    const brdffit_interval_result *none = NULL;
    size_t i;

    (void)state;
    brdffit_options_init(&o);
    brdffit_interval_options_init(&asked);
    spec.lobes = 1;
    brdffit_test_data_new(&spec, &data);
    attack("exact, 95 %", &data.samples, &o, NULL, 5);
    asked.noise = 1e-3;
    attack("exact, noise given", &data.samples, &o, &asked, FEWER(60, 5));
    for (i = 0; i < spec.count * spec.channels; i++) {
        data.values[i] = 0.0;
    }
    claim(&data.samples, &o, NULL, &c);
    assert_true(c.claim->threshold == 0.0);
    assert_true(c.claim->x[0].high < 1e-100 && c.claim->sigma[0].flags == 3u);
    claim_free(&c);
    attack("zero, noise given", &data.samples, &o, &asked, FEWER(30, 5));
    data.samples.count = 1;
    data.values[0] = 1.0;
    claim(&data.samples, &o, &asked, &c);
    check_ranges(&c);
    assert_true(c.claim->x[0].low == 0.0 && c.claim->y[0].low == 0.0);
    assert_int_equal(brdffit_intervals(&data.samples, &o, c.fit->model, c.fit->e2, NULL, c.workspace,
                                       brdffit_intervals_workspace_size(1, spec.channels, &o), &none, &error),
                     BRDFFIT_ERR_VALUE);
    claim_free(&c);
    attack("one sample", &data.samples, &o, &asked, FEWER(30, 5));
    brdffit_test_data_free(&data);
}

static void refuse(const brdffit_samples *samples, const brdffit_options *o, const brdffit_model *model,
                   const brdffit_interval_options *asked, size_t size, brdffit_status status)
{
    const brdffit_interval_result *none = NULL;
    void *workspace = malloc(size);
    brdffit_error error = {0};

    assert_int_equal(brdffit_intervals(samples, o, model, 1.0, asked, workspace, size, &none, &error), status);
    assert_int_equal(error.status, status);
    assert_non_null(error.message);
    assert_null(none);
    free(workspace);
}

/* What is refused, and what an early end leaves: wider intervals, the same at every instruction set. */
static void refusals_and_budgets(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_interval_options asked;
    struct claimed c, few, base;
    brdffit_options o, other;
    brdffit_model model;
    size_t size;

    (void)state;
    spec.noise = 0.02;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&o);
    brdffit_interval_options_init(&asked);
    o.lobes = 2;
    size = brdffit_intervals_workspace_size(data.samples.count, data.samples.channels, &o);
    claim(&data.samples, &o, NULL, &c);
    model = *c.fit->model;
    asked.level = 1.0;
    refuse(&data.samples, &o, &model, &asked, size, BRDFFIT_ERR_OPTION);
    asked.level = 0.0;
    asked.eta = -1.0;
    refuse(&data.samples, &o, &model, &asked, size, BRDFFIT_ERR_OPTION);
    refuse(&data.samples, &o, &model, NULL, size - 64, BRDFFIT_ERR_WORKSPACE);
    refuse(&data.samples, &o, NULL, NULL, size, BRDFFIT_ERR_ARGUMENT);
    model.lobes = 1;
    refuse(&data.samples, &o, &model, NULL, size, BRDFFIT_ERR_ARGUMENT);
    other = o;
    other.norm = BRDFFIT_NORM_L1;
    refuse(&data.samples, &other, c.fit->model, NULL, size, BRDFFIT_ERR_UNSUPPORTED);
    other = o;
    other.engine = BRDFFIT_ENGINE_SOCP;
    refuse(&data.samples, &other, c.fit->model, NULL, size, BRDFFIT_ERR_UNSUPPORTED);
    asked.eta = 0.0;
    asked.box_budget = 50;
    attack("50 boxes an end", &data.samples, &o, &asked, FEWER(30, 5));
    claim(&data.samples, &o, &asked, &few);
    assert_false(few.claim->complete);
    assert_true(few.claim->sigma[0].low <= c.claim->sigma[0].low && c.claim->sigma[0].high <= few.claim->sigma[0].high);
    other = o;
    other.isa = BRDFFIT_ISA_BASE;
    claim(&data.samples, &other, NULL, &base);
    assert_memory_equal(base.claim->sigma, c.claim->sigma, 2 * sizeof *c.claim->sigma);
    assert_memory_equal(base.claim->y, c.claim->y, 6 * sizeof *c.claim->y);
    claim_free(&c);
    claim_free(&few);
    claim_free(&base);
    brdffit_test_data_free(&data);
}

/* Random problems, with ends proven to 0.1 %, so that a bound that is a little wrong has nowhere to hide. */
static void campaign(void **state)
{
    struct brdffit_test_random random = {77};
    size_t problems = FEWER(16, 6), i;

    (void)state;
    for (i = 0; i < problems; i++) {
        struct brdffit_test_spec spec = brdffit_test_spec_default();
        struct brdffit_test_data data;
        brdffit_interval_options asked;
        brdffit_options o;
        size_t j;
        double unit = i % 5 == 4 ? brdffit_test_log_uniform(&random, 1e-140, 1e140) : 1.0;

        spec.seed = brdffit_test_bits(&random);
        spec.layout = (enum brdffit_test_layout)(i % 3);
        spec.count = 6 + brdffit_test_below(&random, 60);
        spec.channels = 1 + brdffit_test_below(&random, 2);
        spec.lobes = 1 + (int)brdffit_test_below(&random, 2);
        spec.sigma[0] = brdffit_test_log_uniform(&random, 0.01, 1.0);
        spec.sigma[1] = brdffit_test_log_uniform(&random, 0.01, 1.0);
        spec.noise = brdffit_test_log_uniform(&random, 1e-4, 0.3);
        spec.weighted = i % 4 == 1;
        spec.normals = i % 4 == 2;
        brdffit_test_data_new(&spec, &data);
        for (j = 0; j < data.samples.count * spec.channels; j++) {
            data.values[j] *= unit;
        }
        brdffit_options_init(&o);
        brdffit_interval_options_init(&asked);
        o.lobes = 1 + (i % 8 == 7);
        o.distribution = (brdffit_distribution)brdffit_test_below(&random, BRDFFIT_DISTRIBUTION_COUNT - 1);
        if (o.distribution < BRDFFIT_TORRANCE_SPARROW && i % 3 == 0) {
            o.masking = BRDFFIT_MASKING_SMITH;
        }
        o.fresnel = i % 4 == 3 ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
        o.diffuse = spec.layout == BRDFFIT_TEST_GRID && i % 2 ? BRDFFIT_DIFFUSE_OREN_NAYAR : BRDFFIT_DIFFUSE_LAMBERT;
        o.normalise = i % 2 ? BRDFFIT_NORMALISE_MAX : BRDFFIT_NORMALISE_NONE;
        asked.eta = brdffit_test_log_uniform(&random, 1e-3, 10.0);
        asked.tolerance = o.lobes > 1 ? 0.02 : 1e-3;
        asked.box_budget = o.lobes > 1 ? 300 : 20000;
        attack("random", &data.samples, &o, &asked, FEWER(o.lobes > 1 ? 30 : 80, 5));
        brdffit_test_data_free(&data);
    }
}

/* Truths inside of their 95 % intervals, over many draws of noise. */
static void coverage(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t seeds = FEWER(200, 20), inside[7] = {0}, all = 0, i, j, k;
    brdffit_options o;

    (void)state;
    spec.lobes = 1;
    spec.noise = 0.02;
    brdffit_options_init(&o);
    o.normalise = BRDFFIT_NORMALISE_NONE;
    spec.channels = 1;
    for (i = 0; i < seeds; i++) {
        struct brdffit_test_data data;
        struct claimed c;

        spec.seed = 1000 + i;
        brdffit_test_data_new(&spec, &data);
        claim(&data.samples, &o, NULL, &c);
        inside[0] += c.claim->sigma[0].low <= spec.sigma[0] && spec.sigma[0] <= c.claim->sigma[0].high;
        for (k = 0; k < spec.channels; k++) {
            double x = spec.diffuse * (1.0 + (double)k / 4.0), y = spec.specular[0] * (1.0 + (double)k / 8.0);

            inside[1 + 2 * k] += c.claim->x[k].low <= x && x <= c.claim->x[k].high;
            inside[2 + 2 * k] += c.claim->y[k].low <= y && y <= c.claim->y[k].high;
        }
        claim_free(&c);
        brdffit_test_data_free(&data);
    }
    for (j = 0; j < 1 + 2 * spec.channels; j++) {
        printf("coverage of %s: %.1f %% of %zu\n",
               j == 0  ? "sigma"
               : j % 2 ? "x"
                       : "y",
               100.0 * (double)inside[j] / (double)seeds, seeds);
        all += inside[j];
        assert_true(inside[j] > FEWER(88 * seeds / 100, 0));
    }
    assert_true(all <= 7 * seeds);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_lobe),           cmocka_unit_test(other_models),
                                       cmocka_unit_test(channels_and_units), cmocka_unit_test(flat),
                                       cmocka_unit_test(degenerate),         cmocka_unit_test(refusals_and_budgets),
                                       cmocka_unit_test(campaign),           cmocka_unit_test(coverage)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
