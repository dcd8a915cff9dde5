/*
 * Bounds of engine socp attacked as test_bound.c attacks those of engine moment: random problems (near-collinear
 * lobes, exact data, negative values, the tail), random boxes (wide, a hair wide, around the optimum, on the
 * diagonal), and random points inside them, none of which may have an objective below its box's bound. Every box is
 * bounded three times: sent to ECOS, with a target that closes it or just does not, and with the target 0.
 * SPDX-License-Identifier: MIT
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

#if defined(__SANITIZE_ADDRESS__)
#define POINTS 20000L
#else
#define POINTS 400000L
#endif
#define POINTS_PER_BOX 24
#define BOXES_PER_PROBLEM 40

#ifndef BRDFFIT_NO_ECOS

/* What was seen, so that the test can say that it saw enough. */
struct tally {
    long points, boxes, solved, decided, refused, positive, close;
};

/* A problem with the insides of its fit in hand. */
struct attacked {
    struct bound_case c;
    double told[CASE_SAMPLES]; /* c as the library is told, within SNAP of the true one */
    struct fit fit;
    struct point optimum;
    double objective; /* at the optimum, internal units */
    void *workspace;
};

/*
 * Every fourth problem is one where the lobe in the data rests on samples far down its flank, whose b makes up for
 * exp(-c s): exponents of dozens, exact data. And the library is told c that differ by SNAP from those of the
 * objective, as after merging directions.
 */
#define SNAP 1e-13

static void steepen(struct attacked *a, uint64_t *s)
{
    struct bound_case *c = &a->c;
    double most = 0.0, sharp;
    size_t i, k;

    c->c[0] = 0.0; /* so that changes are relative to c - c_min */
    for (i = 0; i < c->count; i++) {
        most = fmax(most, c->c[i]);
    }
    sharp = most > 0.0 ? 300.0 * case_uniform(s) / most : 1.0;
    for (i = 0; i < c->count; i++) {
        c->b[i] *= exp(sharp * c->c[i]);
        a->told[i] = c->c[i] * (1.0 + 0.9 * SNAP * case_signed(s));
        for (k = 0; k < c->channels; k++) {
            c->values[i * c->channels + k] = (double)(c->a[i] * 0.3L + c->b[i] * (1.0L + (long double)k) *
                                                                           expl(-(long double)c->c[i] * sharp));
        }
    }
}

static void open_problem(struct attacked *a, uint64_t seed)
{
    brdffit_options options;
    brdffit_samples samples;
    const brdffit_result *result;
    struct arena arena;
    int steep;
    size_t size;

    bound_case_make(&a->c, seed, &samples, &options);
    steep = seed % 4 == 0 && a->c.distribution == BRDFFIT_BECKMANN;
    if (steep) {
        options.sigma_min = 1e-12;
        options.sigma_max = 1e3;
        steepen(a, &seed);
        samples.c = a->told;
    }
    assert_int_equal(brdffit_fit_new(&samples, &options, &result, NULL), BRDFFIT_OK);
    a->optimum.theta[0] = -2.0 * log(result->model->sigma[a->c.lobes - 1]);
    a->optimum.theta[1] = -2.0 * log(result->model->sigma[0]);
    brdffit_result_free(result);
    options.engine = BRDFFIT_ENGINE_SOCP;
    size = brdffit_workspace_size(a->c.count, a->c.channels, &options);
    a->workspace = malloc(size);
    assert_non_null(a->workspace);
    brdffit_arena_init(&arena, a->workspace, size);
    brdffit_fit_layout(&a->fit, &arena, a->c.count, a->c.channels, &options);
    assert_int_equal(brdffit_reduce(&a->fit.data, &samples, &a->fit.model, &options, NULL), BRDFFIT_OK);
    a->fit.data.table[0].snapped = steep ? SNAP : 0.0;
    bound_case_rescale(&a->c, &a->fit.data);
    brdffit_fit_prepare(&a->fit, &options);
    a->objective = (double)attack_objective(&a->c, &a->fit.data, a->optimum.theta);
    a->fit.axis[0].nodes = 4;
    a->fit.axis[0].intervals = 2;
}

/* What closes a box is asked for in several ways; the answer must hold in all of them. */
static double target_of(const struct attacked *a, int way, uint64_t *s)
{
    return way == 0 ? INFINITY : way == 1 ? a->objective * (1.0 + pow(10.0, -9.0 * case_uniform(s))) : 0.0;
}

static double bound_of(struct attacked *a, const struct box *sides, int way, uint64_t *s, struct tally *tally)
{
    struct bound_socp *engine = &a->fit.socp;
    struct box box = *sides;
    double target = target_of(a, way, s), met_objective;
    struct point met;
    long double exact;

    box.bound = target;
    assert_int_equal(brdffit_bound_socp_start(engine, &a->fit.varpro, a->fit.axis, way > 0), BRDFFIT_OK);
    met_objective = brdffit_bound_socp(engine, &box, &met);
    brdffit_bound_socp_finish(engine);
    assert_true(box.bound >= 0.0 && box.bound <= a->fit.data.total);
    assert_int_equal(engine->evaluated, 1);
    assert_int_equal(engine->solved + engine->decided, 1);
    assert_true(engine->refused <= engine->solved);
    assert_true(way > 0 || engine->solved == 1);
    exact = attack_objective(&a->c, &a->fit.data, met.theta);
    assert_true(fabsl((long double)met_objective - exact) <= 1e-10L * a->fit.data.total);
    tally->solved += (long)engine->solved;
    tally->decided += (long)engine->decided;
    tally->refused += (long)engine->refused;
    tally->positive += box.bound > 0.0;
    tally->close += box.bound > 0.0 && box.bound >= (1.0 - 1e-8) * (double)exact;
    return box.bound;
}

/* Coefficients (less those at the centre) of an optimum anywhere in the box are within the certificate's limits. */
static void check_limits(struct attacked *a, double range[2][2], uint64_t *s)
{
    const struct bound_socp *engine = &a->fit.socp;
    struct varpro *v = &a->fit.varpro;
    double centre[CASE_CHANNELS][NNLS_COLUMNS], norm[NNLS_COLUMNS];
    struct varpro_value value;
    struct point at;
    size_t k;
    int i, j, p, group = 1 + a->c.lobes;

    for (i = 0; i < 4; i++) {
        for (p = 0; p < a->c.lobes; p++) {
            double r = i == 0 ? 0.5 : case_uniform(s);

            at.theta[p] = i == 1 ? range[p][1] : (1.0 - r) * range[p][0] + r * range[p][1];
        }
        brdffit_varpro_evaluate(v, &at, 0, &value);
        for (k = 0; k < a->c.channels; k++) {
            for (j = 0; j < group; j++) {
                size_t column = 1 + k * (size_t)group + (size_t)j;
                double here = v->nnls.norm[j] * v->nnls.scale[j], z = v->answer[k].unit[j] * v->answer[k].data_scale;
                double tolerance = 1e-9 * sqrt(a->fit.data.total), most;

                if (i == 0) {
                    norm[j] = here;
                    centre[k][j] = z;
                    continue;
                }
                z = here > 0.0 ? z * (norm[j] / here) : 0.0;
                most = engine->upper[column];
                assert_true(z - centre[k][j] <= most * (1.0 + 1e-12) + tolerance);
                assert_true(z - centre[k][j] >= engine->lower[column] - tolerance);
                assert_true(fabs(centre[k][j] + engine->lower[column]) <= tolerance);
            }
        }
    }
}

static void attack(struct attacked *a, double range[2][2], uint64_t *s, struct tally *tally)
{
    int same = range[0][0] == range[1][0] && range[0][1] == range[1][1], i, p, way;
    struct box box = {0.0, 0, 0, {0, 1}};
    double bound = 0.0;

    attack_set_side(a->fit.axis, 0, 0, range[0]);
    attack_set_side(a->fit.axis, 1, 2, range[1]);
    if (a->c.lobes == 1 || same) {
        box.interval[1] = 0;
    }
    for (way = 0; way < 3; way++) {
        bound = fmax(bound, bound_of(a, &box, way, s, tally));
        if (way == 0) {
            check_limits(a, range, s);
        }
    }
    for (i = 0; i < POINTS_PER_BOX; i++) {
        double theta[2];
        long double value;

        for (p = 0; p < 2; p++) {
            double r = i < 9 ? 0.5 * ((p ? i / 3 : i) % 3) : case_uniform(s);

            theta[p] = range[p][0] + r * (range[p][1] - range[p][0]);
            theta[p] = fmin(fmax(theta[p], range[p][0]), range[p][1]);
        }
        value = attack_objective(&a->c, &a->fit.data, theta);
        if (!(value >= (long double)bound)) {
            bound_case_print(&a->c, stderr);
            fail_msg("lobes %d box [%a, %a] x [%a, %a]: bound %.17g above objective %.17Lg at %a, %a (total %g)",
                     a->c.lobes, range[0][0], range[0][1], range[1][0], range[1][1], bound, value, theta[0], theta[1],
                     a->fit.data.total);
        }
    }
    tally->boxes++;
    tally->points += POINTS_PER_BOX;
}

/* To a few units in the last place, or to a point, about the optimum: the allowance for rounding is all there is. */
static void squeeze(const struct attacked *a, double range[2][2], uint64_t *s)
{
    int p;

    for (p = 0; p < 2; p++) {
        double at = a->optimum.theta[a->c.lobes > 1 ? p : 0] * (1.0 + 1e-15 * case_signed(s));

        range[p][0] = fmin(fmax(at, a->fit.domain[0].low), a->fit.domain[0].high);
        range[p][1] = fmin(range[p][0] + fabs(at) * 4e-16 * (double)(case_next(s) % 4), a->fit.domain[0].high);
    }
    if (range[0][1] > range[1][0]) {
        memcpy(range[1], range[0], sizeof range[0]);
    }
}

static void test_no_point_below_its_bound(void **state)
{
    struct tally tally = {0};
    uint64_t seed;

    (void)state;
    for (seed = 1; tally.points < POINTS; seed++) {
        struct attacked a;
        uint64_t s = seed;
        int i;

        open_problem(&a, seed);
        for (i = 0; i < BOXES_PER_PROBLEM; i++) {
            double range[2][2];

            attack_draw_box(&a.fit, &a.optimum, a.c.lobes, range, &s);
            if (i % 4 == 0) {
                squeeze(&a, range, &s);
            }
            attack(&a, range, &s, &tally);
        }
        free(a.workspace);
    }
    print_message("%ld points in %ld boxes of %ld problems; %ld programs (%ld refused), %ld decided without; "
                  "%ld bounds positive, %ld within 1e-8 of the objective\n",
                  tally.points, tally.boxes, (long)(seed - 1), tally.solved, tally.refused, tally.decided,
                  tally.positive, tally.close);
    /* An engine that never says anything would pass. */
    assert_true(tally.positive > tally.boxes / 2);
    assert_true(tally.close > tally.boxes / 20);
    assert_true(tally.solved > tally.boxes && tally.decided > tally.boxes / 4);
}

#else

static void test_no_point_below_its_bound(void **state)
{
    (void)state;
    skip();
}

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_point_below_its_bound),
    };

    return cmocka_run_group_tests_name("bound_socp", tests, NULL, NULL);
}
