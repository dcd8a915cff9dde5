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

static void claim(const brdffit_samples *samples, const brdffit_options *options,
                  const brdffit_interval_options *asked, struct claimed *out)
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

    printf("%s: threshold %.6g of e2 %.6g, %zu boxes; %zu models near enough, %zu outside\n", title, r->threshold, r->e2,
           r->boxes, a->inside, a->outside);
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
            sigma[p] = fmin(fmax(sigma[p], 1e-7), options->sigma_max);
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_lobe)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
