/*
 * Newton descent of functions known in closed form, one to three sides: never above its start, always inside the box, at
 * the minimum where there is one, stationary where it ends. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "solve/newton.h"
#include "support.h"

/* f = offset + sum_i log(cosh(d_i)) weight_i + 1/2 d' H d, d = theta - centre; convex when H is semidefinite. */
struct bowl {
    int sides, evaluations;
    double centre[SIDES_MOST], weight[SIDES_MOST], h[SIDES_MOST][SIDES_MOST], offset;
    double low[SIDES_MOST], high[SIDES_MOST];
};

static void evaluate(void *self, const struct point *at, int derivatives, struct varpro_value *value)
{
    struct bowl *b = self;
    int p, q;

    memset(value, 0, sizeof *value);
    b->evaluations++;
    value->objective = b->offset;
    for (p = 0; p < b->sides; p++) {
        double d = at->theta[p] - b->centre[p];

        assert_true(at->theta[p] >= b->low[p] && at->theta[p] <= b->high[p]);
        value->objective += b->weight[p] * log(cosh(d));
        value->gradient[p] += b->weight[p] * tanh(d);
        value->hessian[p][p] += b->weight[p] / (cosh(d) * cosh(d));
        for (q = 0; q < b->sides; q++) {
            double e = at->theta[q] - b->centre[q];

            value->objective += 0.5 * d * b->h[p][q] * e;
            value->gradient[p] += b->h[p][q] * e;
            value->hessian[p][q] += b->h[p][q];
        }
    }
    if (!derivatives) {
        memset(value->gradient, 0xff, sizeof value->gradient); /* NaN: nobody may look */
        memset(value->hessian, 0xff, sizeof value->hessian);
    }
}

/* curved: +1 semidefinite, with a side or two that nothing depends on when `level`; -1 indefinite. */
static void bowl_new(struct bowl *b, int sides, int curved, int level, struct brdffit_test_random *random)
{
    double root[SIDES_MOST][SIDES_MOST];
    int p, q, k;

    memset(b, 0, sizeof *b);
    b->sides = sides;
    b->offset = 1.0;
    for (p = 0; p < sides; p++) {
        b->centre[p] = brdffit_test_uniform(random, -1.0, 1.0);
        b->weight[p] = brdffit_test_log_uniform(random, 1e-2, 10.0);
        b->low[p] = -3.0;
        b->high[p] = 3.0;
        for (q = 0; q < sides; q++) {
            root[p][q] = brdffit_test_uniform(random, -1.0, 1.0);
        }
    }
    for (p = 0; p < sides; p++) {
        for (q = 0; q < sides; q++) {
            for (k = 0; k < sides; k++) {
                b->h[p][q] += root[p][k] * root[q][k] * (curved < 0 && k == 0 ? -1.0 : 1.0);
            }
        }
    }
    for (p = 0; p < sides && level; p++) {
        if (p == level % sides) {
            b->weight[p] = 0.0;
            for (q = 0; q < sides; q++) {
                b->h[p][q] = b->h[q][p] = 0.0;
            }
        }
    }
}

static double descend(struct bowl *b, struct point *at)
{
    const struct newton descent = {b, evaluate, b->sides, b->low, b->high, 0.0};

    b->evaluations = 0;
    return brdffit_newton(&descent, at);
}

static void random_start(const struct bowl *b, struct point *at, struct brdffit_test_random *random)
{
    int p;

    memset(at, 0, sizeof *at);
    for (p = 0; p < b->sides; p++) {
        at->theta[p] = brdffit_test_uniform(random, b->low[p], b->high[p]);
    }
}

static void test_finds_the_minimum(void **state)
{
    struct brdffit_test_random random = {1};
    int sides, trial, p, level;

    (void)state;
    for (sides = 1; sides <= SIDES_MOST; sides++) {
        for (trial = 0; trial < 2000; trial++) {
            struct bowl b;
            struct point at;

            level = trial % 5 == 4 ? 1 + trial : 0;
            bowl_new(&b, sides, 1, level, &random);
            random_start(&b, &at, &random);
            assert_true(descend(&b, &at) <= 1.0 + 1e-14);
            for (p = 0; p < sides; p++) {
                assert_true((level && p == level % sides) || fabs(at.theta[p] - b.centre[p]) <= 1e-6);
            }
            assert_true(b.evaluations <= 30);
        }
    }
}

/* The minimum outside of the box, or none: the end is stationary but for sides that the box holds. */
static void test_ends_stationary(void **state)
{
    struct brdffit_test_random random = {2};
    int sides, trial, p, held = 0;

    (void)state;
    for (sides = 1; sides <= SIDES_MOST; sides++) {
        for (trial = 0; trial < 2000; trial++) {
            struct varpro_value before, after;
            struct bowl b;
            struct point at;

            bowl_new(&b, sides, trial % 2 ? -1 : 1, 0, &random);
            for (p = 0; p < sides; p++) {
                b.low[p] = brdffit_test_uniform(&random, -2.0, 0.5);
                b.high[p] = b.low[p] + brdffit_test_uniform(&random, 0.0, 1.5);
                b.offset = 20.0;
            }
            random_start(&b, &at, &random);
            evaluate(&b, &at, 1, &before);
            assert_true(descend(&b, &at) <= before.objective);
            evaluate(&b, &at, 1, &after);
            assert_true(after.objective <= before.objective);
            for (p = 0; p < sides; p++) {
                int low = at.theta[p] <= b.low[p], high = at.theta[p] >= b.high[p];

                held += low || high;
                assert_true((low && after.gradient[p] >= 0.0) || (high && after.gradient[p] <= 0.0) ||
                            fabs(after.gradient[p]) <= 1e-4);
            }
        }
    }
    assert_true(held > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finds_the_minimum),
        cmocka_unit_test(test_ends_stationary),
    };

    return cmocka_run_group_tests_name("newton", tests, NULL, NULL);
}
