/*
 * Lower bounds attacked: random problems, random boxes, and more than a million points inside them, none of which
 * may have an objective below its box's bound. Problems, boxes and points are chosen to be nasty: negative data,
 * near-collinear lobes, boxes around optima, on the diagonal, in the tail, a few ulp wide. The objective is
 * evaluated in long double from the coefficients (a, b, c) themselves. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bound_attack.h"
#include "bound_case.h"
#include "fit/fit.h"
#include "nnls_case.h"
#include "base/tolerance.h"

#if defined(__SANITIZE_ADDRESS__)
#define POINTS 100000L
#else
#define POINTS 1200000L
#endif
#define POINTS_PER_BOX 96

/* The engine states its rounding a node at a time. */
static double largest_epsilon(const struct fit *f)
{
    double largest = 0.0;
    uint32_t i;

    for (i = 0; i < f->axis[0].nodes; i++) {
        if (i < f->moment.moments.kind[0].ready.known && f->moment.moments.kind[0].ready.on[i]) {
            largest = fmax(largest, f->moment.moments.kind[0].node[i].epsilon);
        }
    }
    return largest;
}

/* Attack one box with points: ends, the diagonal, the middle and random ones. */
static long attack(const struct bound_case *c, struct fit *f, double range[2][2], uint64_t *s)
{
    struct box box = {INFINITY, 0, 0, {0, 1}}; /* unreachable: every bound is tried */
    struct point met;
    int same = range[0][0] == range[1][0] && range[0][1] == range[1][1], i, p;
    double met_objective;

    attack_set_side(f->axis, 0, 0, range[0]);
    attack_set_side(f->axis, 1, 2, range[1]);
    f->axis[0].nodes = 4;
    f->axis[0].intervals = 2;
    if (c->lobes == 1 || same) {
        box.interval[1] = 0;
    }
    brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    met_objective = brdffit_bound_moment(&f->moment, &box, &met);
    assert_true(box.bound >= 0.0 && box.bound <= f->data.total);
    /* What was met is a true objective to within the noise that the engine states. */
    if (met_objective < INFINITY) {
        assert_true(fabsl((long double)met_objective - attack_objective(c, &f->data, met.theta)) <=
                    4.0L * f->moment.moments.slack + 4.0L * largest_epsilon(f) * f->data.total);
    }
    for (i = 0; i < POINTS_PER_BOX; i++) {
        double theta[2];
        long double value;

        for (p = 0; p < 2; p++) {
            double r = i < 9 ? 0.5 * ((p ? i / 3 : i) % 3) : case_uniform(s);

            theta[p] = range[p][0] + r * (range[p][1] - range[p][0]);
            theta[p] = fmin(fmax(theta[p], range[p][0]), range[p][1]);
        }
        if (same && theta[1] < theta[0]) {
            double swap = theta[0];

            theta[0] = theta[1];
            theta[1] = swap;
        }
        value = attack_objective(c, &f->data, theta);
        if (!(value >= (long double)box.bound)) {
            bound_case_print(c, stderr);
            fail_msg("lobes %d box [%a, %a] x [%a, %a]: bound %.17g above objective %.17Lg at %a, %a (total %g)",
                     c->lobes, range[0][0], range[0][1], range[1][0], range[1][1], box.bound, value, theta[0], theta[1],
                     f->data.total);
        }
    }
    return POINTS_PER_BOX;
}

static void attack_problem(uint64_t seed, long *done)
{
    struct bound_case c;
    brdffit_options options;
    brdffit_samples samples;
    const brdffit_result *result;
    struct search_result found;
    struct arena arena;
    struct fit fit;
    void *workspace;
    size_t size;
    uint64_t s = seed;
    int box;

    bound_case_make(&c, seed, &samples, &options);
    size = brdffit_workspace_size(c.count, c.channels, &options);
    workspace = malloc(size);
    assert_non_null(workspace);
    assert_int_equal(brdffit_fit(&samples, &options, workspace, size, &result, NULL), BRDFFIT_OK);
    /* The same reduction again, with its insides in hand. */
    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(&fit, &arena, c.count, c.channels, &options);
    assert_int_equal(brdffit_reduce(&fit.data, &samples, &fit.model, &options, NULL), BRDFFIT_OK);
    bound_case_rescale(&c, &fit.data);
    brdffit_fit_prepare(&fit, &options);
    found.point.theta[0] = -2.0 * log(result->model->sigma[c.lobes - 1]);
    found.point.theta[1] = -2.0 * log(result->model->sigma[0]);
    for (box = 0; box < 40; box++) {
        double range[2][2];

        attack_draw_box(&fit, &found.point, c.lobes, range, &s);
        *done += attack(&c, &fit, range, &s);
    }
    free(workspace);
}

static void test_no_point_below_its_bound(void **state)
{
    uint64_t seed = 1;
    long done = 0;

    (void)state;
    while (done < POINTS) {
        attack_problem(seed++, &done);
    }
    print_message("%ld points in %ld boxes of %ld problems\n", done, done / POINTS_PER_BOX, (long)(seed - 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_point_below_its_bound),
    };

    return cmocka_run_group_tests_name("bound", tests, NULL, NULL);
}
