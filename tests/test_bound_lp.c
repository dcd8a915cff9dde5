/*
 * Bounds of norms l1 and linf attacked: random problems, nasty boxes, and points inside them, none of which may have an
 * objective below its box's bound. The objective is evaluated in long double from the coefficients (a, b, c) at the
 * best z known. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "bound_attack.h"
#include "bound_case.h"
#include "fit/fit.h"

#ifndef BRDFFIT_NO_ECOS

#if defined(__SANITIZE_ADDRESS__)
#define POINTS 2000L
#else
#define POINTS 60000L /* of each norm */
#endif
#define POINTS_PER_BOX 20

/* The objective of the answer in varpro: columns from (a, b, c), z from unit columns of the library. */
static long double objective_of(const struct bound_case *c, struct fit *f, const struct point *at)
{
    const struct reduced *data = &f->data;
    long double total = 0.0L;
    size_t i, k;
    int p;

    for (k = 0; k < c->channels; k++) {
        long double sum = 0.0L;

        for (i = 0; i < c->count; i++) {
            long double r = (long double)c->values[i * c->channels + k] / (data->channel_scale[k] * data->value_scale);

            for (p = 0; p <= c->lobes; p++) {
                long double d = (long double)c->c[i] - data->table[0].c_min, column = c->a[i];

                if (p > 0) {
                    long double s = expl((long double)at->theta[p - 1]), rest = 1.0L + data->table[0].c_min * s;

                    column = c->distribution == BRDFFIT_GGX ? c->b[i] / powl(1.0L + d * s / rest, 2.0L)
                                                            : c->b[i] * expl(-d * s);
                }
                r -= column * f->varpro.answer[k].z[p];
            }
            sum = f->norm == BRDFFIT_NORM_L1 ? sum + fabsl(r) : fmaxl(sum, fabsl(r));
        }
        total = f->norm == BRDFFIT_NORM_L1 ? total + sum : fmaxl(total, sum);
    }
    return total;
}

static long attack(const struct bound_case *c, struct fit *f, double range[2][2], double target, uint64_t *s)
{
    struct box box = {0.0, 0, 0, {0, 1}};
    struct point met;
    struct varpro_value value;
    int same = range[0][0] == range[1][0] && range[0][1] == range[1][1], i, p;

    attack_set_side(f->axis, 0, 0, range[0]);
    attack_set_side(f->axis, 1, 2, range[1]);
    f->axis[0].nodes = 4;
    f->axis[0].intervals = 2;
    if (c->lobes == 1 || same) {
        box.interval[1] = 0;
    }
    box.bound = target;
    (void)brdffit_bound_lp(&f->linear, &box, &met);
    assert_true(box.bound >= 0.0 && box.bound <= f->data.total);
    for (i = 0; i < POINTS_PER_BOX; i++) {
        struct point at = {{0.0, 0.0}};
        long double here;

        for (p = 0; p < 2; p++) {
            double r = i < 9 ? 0.5 * ((p ? i / 3 : i) % 3) : case_uniform(s);

            at.theta[p] = range[p][0] + r * (range[p][1] - range[p][0]);
            at.theta[p] = fmin(fmax(at.theta[p], range[p][0]), range[p][1]);
        }
        brdffit_fit_evaluate(f, &at, 0, &value);
        here = objective_of(c, f, &at);
        /* What the library says of a point is true of it. */
        assert_true(fabsl(here - (long double)value.objective) <= 1e-13L * f->data.total);
        if (!(here >= (long double)box.bound - 1e-14L * f->data.total)) {
            bound_case_print(c, stderr);
            fail_msg("norm %s lobes %d box [%a, %a] x [%a, %a]: bound %.17g above %.17Lg at %a, %a (total %g)",
                     brdffit_norm_string(f->norm), c->lobes, range[0][0], range[0][1], range[1][0], range[1][1],
                     box.bound, here, at.theta[0], at.theta[1], f->data.total);
        }
    }
    return POINTS_PER_BOX;
}

static void attack_problem(uint64_t seed, brdffit_norm norm, long *done, long *proven)
{
    struct bound_case c;
    brdffit_options options;
    brdffit_samples samples;
    struct arena arena;
    struct engine engine;
    struct fit fit;
    struct point optimum;
    void *workspace;
    size_t size;
    uint64_t s = seed;
    int box;

    bound_case_make(&c, seed, &samples, &options);
    options.norm = norm;
    size = brdffit_workspace_size(c.count, c.channels, &options);
    workspace = malloc(size);
    assert_non_null(workspace);
    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(&fit, &arena, c.count, c.channels, &options);
    assert_int_equal(brdffit_reduce(&fit.data, &samples, &fit.model, &options, NULL), BRDFFIT_OK);
    bound_case_rescale(&c, &fit.data);
    brdffit_fit_prepare(&fit, &options);
    brdffit_axis_start(fit.axis, fit.domain[0].low, fit.domain[0].high, 1);
    assert_int_equal(brdffit_fit_engine_start(&fit, &options, &engine), BRDFFIT_OK);
    for (box = 0; box < 2; box++) {
        optimum.theta[box] = fit.domain[0].low + case_uniform(&s) * (fit.domain[0].high - fit.domain[0].low);
    }
    (void)engine.try_point(engine.self, &optimum);
    for (box = 0; box < 10; box++) {
        double range[2][2];

        attack_draw_box(&fit, &optimum, c.lobes, range, &s);
        *done += attack(&c, &fit, range, box % 2 ? INFINITY : fit.data.total * case_uniform(&s), &s);
    }
    *proven += (long)(fit.linear.lp.solved - fit.linear.lp.refused);
    brdffit_fit_engine_finish(&fit, &options);
    free(workspace);
}

static void attack_norm(brdffit_norm norm)
{
    long done = 0, proven = 0;
    uint64_t seed = 1;

    while (done < POINTS) {
        attack_problem(seed++, norm, &done, &proven);
    }
    assert_true(proven > done / POINTS_PER_BOX / 4);
    print_message("%s: %ld points in %ld boxes, %ld programs with certificate\n", brdffit_norm_string(norm), done,
                  done / POINTS_PER_BOX, proven);
}

static void test_l1(void **state)
{
    (void)state;
    attack_norm(BRDFFIT_NORM_L1);
}

static void test_linf(void **state)
{
    (void)state;
    attack_norm(BRDFFIT_NORM_LINF);
}

#else

static void test_l1(void **state)
{
    (void)state; /* no engine to attack: test_norms says what a build without ECOS answers */
}
#define test_linf test_l1

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_l1),
        cmocka_unit_test(test_linf),
    };

    return cmocka_run_group_tests_name("bound_lp", tests, NULL, NULL);
}
