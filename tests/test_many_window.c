/*
 * What a plan claims of its windows, attacked at points in long double: polynomials and their errors, and the screening
 * of a window from its ends. SPDX-License-Identifier: MIT
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

#include "batch/batch.h"
#include "support.h"

static long double polynomial(const double *c, size_t terms, long double t)
{
    long double value = 0.0L;

    while (terms-- > 0) {
        value = value * t + c[terms];
    }
    return value;
}

/* D, u and shapes at s, in long double from the plan's own samples. */
struct truth {
    long double d, u, phi[512];
};

static void truth_at(const struct batch_fast *f, long double s, struct truth *at)
{
    size_t m, i;

    at->u = at->d = 0.0L;
    for (m = 0; m < f->distinct; m++) {
        at->phi[m] = expl(-(long double)f->c[m] * s);
        at->u += f->ab[m] * at->phi[m];
    }
    for (m = 0; m <= f->distinct; m++) {
        for (i = f->begin[m]; i < (m < f->distinct ? f->begin[m + 1] : f->used); i++) {
            long double lobe = m < f->distinct ? f->b[i] * at->phi[m] : 0.0L;
            long double rest = lobe - (f->root_a > 0.0 ? at->u * f->a[i] / f->root_a : 0.0L);

            at->d += rest * rest;
        }
    }
}

static void check_polynomials(const struct batch_fast *f, size_t w, long double t, const struct truth *at)
{
    const struct batch_window *window = &f->window[w];
    int more;
    size_t m;

    if (!(fabsl(polynomial(window->d, BATCH_TERMS_D, t) - at->d) <= window->d_error)) {
        fail_msg("window %zu, t %Lg: D is off by %Lg, not %g", w, t, polynomial(window->d, BATCH_TERMS_D, t) - at->d,
                 window->d_error);
    }
    for (more = 0; more < 2; more++) {
        size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS;
        long double square = 0.0L, u = fabsl(polynomial(window->u[more], terms, t) - at->u);

        for (m = 0; m < f->distinct; m++) {
            long double off = polynomial(f->shape[more] + (w * f->distinct + m) * stride, terms, t) - at->phi[m];

            square += f->bb[m] * off * off;
        }
        if (!(sqrtl(square) <= window->n_error[more] && u <= window->u_error[more])) {
            fail_msg("window %zu, t %Lg, more %d: shapes off by %Lg (claimed %g), u by %Lg (%g)", w, t, more,
                     sqrtl(square), window->n_error[more], u, window->u_error[more]);
        }
    }
}

/* Gain of residuals r (one channel, orthogonal to a) at s. */
static long double gain_of(const struct batch_fast *f, const long double *r, const struct truth *at)
{
    long double n = 0.0L;
    size_t m, i;

    for (m = 0; m < f->distinct; m++) {
        for (i = f->begin[m]; i < f->begin[m + 1]; i++) {
            n += r[i] * f->b[i] * at->phi[m];
        }
    }
    return n > 0.0L ? n / sqrtl(at->d) : 0.0L;
}

/* Residuals that make the most of the middle of the window (kind 0), or random ones; 1 their norm. */
static void make_residuals(const struct batch_fast *f, struct brdffit_test_random *random, int kind,
                           const struct truth *low, const struct truth *middle, const struct truth *high,
                           long double *r)
{
    long double along = 0.0L, norm = 0.0L;
    size_t m, i;

    for (m = 0; m <= f->distinct; m++) {
        for (i = f->begin[m]; i < (m < f->distinct ? f->begin[m + 1] : f->used); i++) {
            long double off = m < f->distinct ? middle->phi[m] - 0.5L * (low->phi[m] + high->phi[m]) : 0.0L;

            r[i] = kind == 0 ? f->b[i] * off : brdffit_test_normal(random);
            r[i] += kind == 2 && m < f->distinct ? 9.0L * f->b[i] * middle->phi[m] : 0.0L;
            along += f->root_a > 0.0 ? r[i] * f->a[i] / f->root_a : 0.0L;
        }
    }
    for (i = 0; i < f->used; i++) {
        r[i] -= f->root_a > 0.0 ? along * f->a[i] / f->root_a : 0.0L;
        norm += r[i] * r[i];
    }
    for (i = 0; i < f->used; i++) {
        r[i] /= sqrtl(norm);
    }
}

static void check_screen(const struct batch_fast *f, size_t w, struct brdffit_test_random *random)
{
    const struct batch_window *window = &f->window[w];
    struct truth low, middle, high, at;
    long double r[512], most;
    int kind, j;

    if (!(window->shrink > 0.0)) {
        return;
    }
    truth_at(f, (long double)window->center - window->radius, &low);
    truth_at(f, window->center, &middle);
    truth_at(f, (long double)window->center + window->radius, &high);
    for (kind = 0; kind < 3; kind++) {
        make_residuals(f, random, kind, &low, &middle, &high, r);
        most = (fmaxl(gain_of(f, r, &low), gain_of(f, r, &high)) + window->delta) / window->shrink;
        for (j = 1; j < 12; j++) {
            truth_at(f, window->center + window->radius * (j / 6.0L - 1.0L), &at);
            if (!(gain_of(f, r, &at) <= most)) {
                fail_msg("window %zu, kind %d, place %d: %Lg gained, %Lg claimed", w, kind, j, gain_of(f, r, &at),
                         most);
            }
        }
    }
}

static void check_plan(const struct brdffit_test_spec *spec, double sigma_max)
{
    struct brdffit_test_random random = {spec->seed};
    struct brdffit_test_data data;
    brdffit_options options;
    const brdffit_plan *plan;
    struct truth at;
    size_t size, w;
    void *memory;
    int j;

    brdffit_test_data_new(spec, &data);
    brdffit_options_init(&options);
    options.distribution = spec->distribution;
    options.sigma_max = sigma_max;
    size = brdffit_plan_size(&data.samples, &options);
    memory = malloc(size);
    assert_non_null(memory);
    assert_int_equal(brdffit_plan_init(&data.samples, &options, memory, size, &plan, NULL), BRDFFIT_OK);
    assert_non_null(plan->kernels); /* this geometry has a fast path, or the test tests nothing */
    assert_true(plan->fast.windows >= 1 && plan->fast.used <= 512);
    for (w = 0; w < plan->fast.windows; w++) {
        const struct batch_window *window = &plan->fast.window[w];

        for (j = 0; j < 12; j++) {
            long double t = j < 3 ? (long double)(j - 1) : brdffit_test_uniform(&random, -1.0, 1.0);

            truth_at(&plan->fast, window->center + window->radius * t, &at);
            check_polynomials(&plan->fast, w, t, &at);
        }
        check_screen(&plan->fast, w, &random);
    }
    free(memory);
    brdffit_test_data_free(&data);
}

static void test_windows(void **state)
{
    static const brdffit_distribution distribution[3] = {BRDFFIT_BECKMANN, BRDFFIT_TORRANCE_SPARROW,
                                                         BRDFFIT_BLINN_PHONG};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 9; seed++) {
        spec.seed = seed;
        spec.count = 12 + 24 * (size_t)(seed % 4);
        spec.layout = (enum brdffit_test_layout)(seed % 3);
        spec.weighted = seed % 2 == 0;
        spec.distribution = distribution[seed % 3];
        check_plan(&spec, seed % 4 ? 6.0 : 900.0);
    }
}

/* The windows meet: no s of the range lies between two of them. */
static void test_windows_meet(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_options options;
    const brdffit_plan *plan;
    void *memory;
    size_t size, w;

    (void)state;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&options);
    size = brdffit_plan_size(&data.samples, &options);
    memory = malloc(size);
    assert_int_equal(brdffit_plan_init(&data.samples, &options, memory, size, &plan, NULL), BRDFFIT_OK);
    assert_true(plan->fast.window[0].center - plan->fast.window[0].radius <= 1.0 / 36.0);
    for (w = 1; w < plan->fast.windows; w++) {
        const struct batch_window *left = &plan->fast.window[w - 1], *right = &plan->fast.window[w];

        assert_true((long double)left->center + left->radius >= (long double)right->center - right->radius);
    }
    free(memory);
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_windows),
        cmocka_unit_test(test_windows_meet),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
