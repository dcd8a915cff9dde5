/*
 * What a plan claims of its windows, attacked at points in long double: polynomials and their errors, how D changes, and the
 * screening of a window from its ends. SPDX-License-Identifier: MIT
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
    long double d[BATCH_PAIRS], u[EACH_MOST], phi[EACH_MOST][512];
};

/* sqrt(s + tau^2), or Beckmann's r: smith.h. */
static long double masking(const struct batch_fast *f, long double s, long double tan2)
{
    long double tau = sqrtl(tan2);

    if (!f->steep || tan2 == 0.0L) {
        return sqrtl(s + tan2);
    }
    return sqrtl(s) * erfl(sqrtl(s) / tau) + tau * expl(-s / tan2) * 0.56418958354775628694807945156077L;
}

/* phi at s of one group: lobe.h, smith.h. */
static long double shape(const struct batch_fast *f, const struct lobe_sight *sight, size_t m, long double s,
                         brdffit_masking kind)
{
    long double c = sight->c[m], v = s / (1.0L + sight->c_min * s);
    long double own = f->steep ? expl(-c * s) : 1.0L / ((1.0L + c * v) * (1.0L + c * v));
    long double all, light, view, level;

    if (kind != BRDFFIT_MASKING_SMITH && kind != BRDFFIT_MASKING_SMITH_SEPARABLE) {
        return own;
    }
    level = sqrtl(s + (f->steep ? 4.0L : 1.0L) * sight->tan2_most);
    light = masking(f, s, sight->light[m]) / level;
    view = masking(f, s, sight->view[m]) / level;
    all = sqrtl(s) / level;
    return own / (kind == BRDFFIT_MASKING_SMITH ? (light + view) / 2.0L : (all + light) * (all + view) / 4.0L);
}

/* At t of window w, in its factors. */
static void truth_at(const struct batch_fast *f, size_t w, long double t, brdffit_masking kind, struct truth *at)
{
    const struct batch_window *window = &f->window[w];
    long double s = expl(window->center + window->radius * t), rest[EACH_MOST];
    size_t m, i;
    int j, l;

    for (j = 0; j < f->each; j++) {
        long double lift = window->scale[j] * expl(window->tilt[j] * t);

        for (at->u[j] = 0.0L, m = 0; m < f->distinct; m++) {
            at->phi[j][m] = lift * shape(f, &f->column[j].sight, m, s, kind);
            at->u[j] += f->column[j].ab[m] * at->phi[j][m];
        }
        for (l = 0; l <= j; l++) {
            at->d[BATCH_PAIR(l, j)] = 0.0L;
        }
    }
    for (m = 0; m <= f->distinct; m++) {
        for (i = f->begin[m]; i < (m < f->distinct ? f->begin[m + 1] : f->used); i++) {
            for (j = 0; j < f->each; j++) {
                rest[j] = (m < f->distinct ? f->column[j].b[i] * at->phi[j][m] : 0.0L) -
                          (f->root_a > 0.0 ? at->u[j] * f->a[i] / f->root_a : 0.0L);
                for (l = 0; l <= j; l++) {
                    at->d[BATCH_PAIR(l, j)] += rest[l] * rest[j];
                }
            }
        }
    }
}

/* Polynomials of D, u and the shapes of each column against the truth. */
static void check_polynomials(const struct batch_fast *f, size_t w, long double t, const struct truth *at)
{
    const struct batch_window *window = &f->window[w];
    int more, j, l;
    size_t m;

    for (j = 0; j < f->each; j++) {
        for (l = 0; l <= j; l++) {
            int pair = BATCH_PAIR(l, j);
            long double off = polynomial(window->d[pair], BATCH_TERMS_D, t) + (l < j ? window->apart : 0.0) -
                              at->d[pair];

            if (!(fabsl(off) <= window->d_error[pair])) {
                fail_msg("window %zu, t %Lg: D is off by %Lg, not %g", w, t, off, window->d_error[pair]);
            }
        }
        for (more = 0; more < 2; more++) {
            size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS;
            long double square = 0.0L, u = fabsl(polynomial(window->u[j][more], terms, t) - at->u[j]);

            for (m = 0; m < f->distinct; m++) {
                long double off = polynomial(f->column[j].shape[more] + (w * f->distinct + m) * stride, terms, t) -
                                  at->phi[j][m];

                square += f->column[j].bb[m] * off * off;
            }
            if (!(sqrtl(square) <= window->n_error[j][more] && u <= window->u_error[j][more])) {
                fail_msg("window %zu, t %Lg, more %d: shapes off by %Lg (claimed %g), u by %Lg (%g)", w, t, more,
                         sqrtl(square), window->n_error[j][more], u, window->u_error[j][more]);
            }
        }
    }
}

/* y D y, with the product of two columns as much lower as the plan has it. */
static long double square_of(const struct batch_fast *f, size_t w, const struct truth *at, const long double *y)
{
    long double sum = at->d[0] * y[0] * y[0];

    return f->each == 1 ? sum : sum + 2.0L * (at->d[1] - f->window[w].apart) * y[0] * y[1] + at->d[2] * y[1] * y[1];
}

/* D from one place to another in the window, for coefficients of any sign. */
static void check_rate(const struct batch_fast *f, size_t w, brdffit_masking kind, struct brdffit_test_random *random)
{
    const struct batch_window *window = &f->window[w];
    struct truth here, there;
    int i;

    for (i = 0; i < 6; i++) {
        double t = brdffit_test_uniform(random, -1.0, 1.0), other = brdffit_test_uniform(random, -1.0, 1.0);
        long double y[EACH_MOST] = {brdffit_test_normal(random), brdffit_test_normal(random)}, least;

        if (i % 2) {
            y[1] = -y[0]; /* the worst where columns are nearly parallel */
        }
        truth_at(f, w, t, kind, &here);
        truth_at(f, w, other, kind, &there);
        least = (1.0L - window->rate * fabs(other - t)) / (1.0L + 2.0L * window->excess) * square_of(f, w, &here, y);
        if (window->excess < INFINITY && !(square_of(f, w, &there, y) >= least)) {
            fail_msg("window %zu: D at %g is %Lg of that at %g, %Lg claimed", w, other, square_of(f, w, &there, y), t,
                     least);
        }
    }
}

/* Gain of residuals r (one channel, orthogonal to a), its root: over y >= 0. */
static long double gain_of(const struct batch_fast *f, const long double *r, const struct truth *at)
{
    long double n[EACH_MOST] = {0.0L, 0.0L}, most = 0.0L, det;
    size_t m, i;
    int j;

    for (j = 0; j < f->each; j++) {
        for (m = 0; m < f->distinct; m++) {
            for (i = f->begin[m]; i < f->begin[m + 1]; i++) {
                n[j] += r[i] * f->column[j].b[i] * at->phi[j][m];
            }
        }
        most = n[j] > 0.0L ? fmaxl(most, n[j] / sqrtl(at->d[BATCH_PAIR(j, j)])) : most;
    }
    det = f->each > 1 ? at->d[0] * at->d[2] - at->d[1] * at->d[1] : 0.0L;
    if (det > 1e-12L * at->d[0] * at->d[2]) {
        long double one = n[0] * at->d[2] - n[1] * at->d[1], two = n[1] * at->d[0] - n[0] * at->d[1];

        most = one > 0.0L && two > 0.0L ? fmaxl(most, sqrtl((n[0] * one + n[1] * two) / det)) : most;
    }
    return most;
}

/* Residuals that make the most of the middle of the window (kind 0), or random ones; 1 their norm. */
static void make_residuals(const struct batch_fast *f, struct brdffit_test_random *random, int kind,
                           const struct truth *low, const struct truth *middle, const struct truth *high,
                           long double *r)
{
    int j = f->each > 1 && brdffit_test_below(random, 2);
    long double along = 0.0L, norm = 0.0L;
    size_t m, i;

    for (m = 0; m <= f->distinct; m++) {
        for (i = f->begin[m]; i < (m < f->distinct ? f->begin[m + 1] : f->used); i++) {
            int lobe = m < f->distinct;
            long double off = lobe ? middle->phi[j][m] - 0.5L * (low->phi[j][m] + high->phi[j][m]) : 0.0L;

            r[i] = kind == 0 ? f->column[j].b[i] * off : brdffit_test_normal(random);
            r[i] += kind == 2 && lobe ? 9.0L * f->column[j].b[i] * middle->phi[j][m] : 0.0L;
            along += f->root_a > 0.0 ? r[i] * f->a[i] / f->root_a : 0.0L;
        }
    }
    for (i = 0; i < f->used; i++) {
        r[i] -= f->root_a > 0.0 ? along * f->a[i] / f->root_a : 0.0L;
        norm += r[i] * r[i];
    }
    for (i = 0; i < f->used && norm > 0.0L; i++) {
        r[i] /= sqrtl(norm);
    }
}

static void check_screen(const struct batch_fast *f, size_t w, brdffit_masking masked,
                         struct brdffit_test_random *random)
{
    const struct batch_window *window = &f->window[w];
    struct truth low, middle, high, at;
    long double r[512], most;
    int kind, j;

    if (!(window->shrink > 0.0)) {
        return;
    }
    truth_at(f, w, -1.0L, masked, &low);
    truth_at(f, w, 0.0L, masked, &middle);
    truth_at(f, w, 1.0L, masked, &high);
    for (kind = 0; kind < 3; kind++) {
        make_residuals(f, random, kind, &low, &middle, &high, r);
        most = (fmaxl(gain_of(f, r, &low), gain_of(f, r, &high)) + window->delta) / window->shrink;
        for (j = 1; j < 12; j++) {
            truth_at(f, w, j / 6.0L - 1.0L, masked, &at);
            if (!(gain_of(f, r, &at) <= most)) {
                fail_msg("window %zu, kind %d, place %d: %Lg gained, %Lg claimed", w, kind, j, gain_of(f, r, &at),
                         most);
            }
        }
    }
}

static void check_plan(const struct brdffit_test_spec *spec, const brdffit_options *options)
{
    struct brdffit_test_random random = {spec->seed};
    struct brdffit_test_data data;
    const brdffit_plan *plan;
    struct truth at;
    size_t size, w;
    void *memory;
    int j;

    brdffit_test_data_new(spec, &data);
    size = brdffit_plan_size(&data.samples, options);
    memory = malloc(size);
    assert_non_null(memory);
    assert_int_equal(brdffit_plan_init(&data.samples, options, memory, size, &plan, NULL), BRDFFIT_OK);
    assert_non_null(plan->kernels); /* this geometry has a fast path, or the test tests nothing */
    assert_true(plan->fast.windows >= 1 && plan->fast.used <= 512);
    for (w = 0; w < plan->fast.windows; w++) {
        for (j = 0; j < 12; j++) {
            long double t = j < 3 ? (long double)(j - 1) : brdffit_test_uniform(&random, -1.0, 1.0);

            truth_at(&plan->fast, w, t, options->masking, &at);
            check_polynomials(&plan->fast, w, t, &at);
        }
        check_rate(&plan->fast, w, options->masking, &random);
        check_screen(&plan->fast, w, options->masking, &random);
    }
    free(memory);
    brdffit_test_data_free(&data);
}

static void test_windows(void **state)
{
    static const brdffit_distribution distribution[4] = {BRDFFIT_BECKMANN, BRDFFIT_TORRANCE_SPARROW,
                                                         BRDFFIT_BLINN_PHONG, BRDFFIT_GGX};
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options;
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 12; seed++) {
        brdffit_options_init(&options);
        spec.seed = seed;
        spec.count = 12 + 24 * (size_t)(seed % 4);
        spec.layout = (enum brdffit_test_layout)(seed % 3);
        spec.weighted = seed % 2 == 0;
        spec.distribution = options.distribution = distribution[seed % 4];
        options.sigma_max = seed % 5 ? 6.0 : 900.0;
        check_plan(&spec, &options);
    }
}

/* Two columns a lobe, and shapes with masking. */
static void test_windows_of_columns(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options options;
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 12; seed++) {
        brdffit_options_init(&options);
        spec.seed = seed;
        spec.count = 20 + 20 * (size_t)(seed % 3);
        spec.layout = (enum brdffit_test_layout)(seed % 3);
        options.distribution = seed % 2 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        options.fresnel = seed % 4 < 2 ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
        options.masking = seed % 3 == 0   ? BRDFFIT_MASKING_SMITH
                          : seed % 3 == 1 ? BRDFFIT_MASKING_SMITH_SEPARABLE
                                          : BRDFFIT_MASKING_V_CAVITY;
        check_plan(&spec, &options);
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
    assert_true(plan->fast.window[0].center - plan->fast.window[0].radius <= -log(36.0));
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
        cmocka_unit_test(test_windows_of_columns),
        cmocka_unit_test(test_windows_meet),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
