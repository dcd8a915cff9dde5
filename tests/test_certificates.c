/*
 * Inputs whose certificates were false (tests/data/certificates/README.md), and the ends of the domain: no lower bound
 * is above the E^2 of a point that quad precision finds, and e2 is what the reported parameters have.
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "brdffit_io.h"
#include "fewer.h"
#include "quad/campaign_run.h"
#include "support.h"

/* Evaluations of E^2 a fit: enough for a grid of the domain and a descent to 1e-20 of the optimum. */
#define EFFORT FEWER(300, 60)
#define LINES 6

struct tally {
    int fits, refused, faults;
};

static void report(struct tally *tally, const struct fit_question *q, const struct fit_view *v,
                   const struct judgement *j)
{
    char text[1024];

    if (tally->faults++ < LINES) {
        judge_describe(j, v, text, sizeof text);
        print_error("%s, %d lobes, norm %s, engine %s, normalise %d, gap %g, sigma [%g, %g], exponent_min %g: %s\n",
                    brdffit_distribution_string(q->distribution[0]), q->lobes, brdffit_norm_string(q->options.norm),
                    brdffit_engine_string(q->options.engine), (int)q->options.normalise, q->options.relative_gap,
                    q->options.sigma_min, q->options.sigma_max, q->options.exponent_min, text);
    }
}

static void fit_and_judge(struct tally *tally, const struct fit_question *q)
{
    struct judgement verdict;
    struct fit_view view;

    fit_view_new(&view, q);
    tally->fits++;
    tally->refused += view.status != BRDFFIT_OK;
    if (judge(&view, q, EFFORT, &verdict)) {
        report(tally, q, &view, &verdict);
    }
    fit_view_free(&view);
}

static void finish(const struct tally *tally)
{
    print_message("%d fits, %d of them refused, %d at fault\n", tally->fits, tally->refused, tally->faults);
    assert_true(tally->refused < tally->fits);
    assert_int_equal(tally->faults, 0);
}

/* Both engines, both normalisations, one and two lobes, three gaps. */
static void every_way(struct tally *tally, struct fit_question *q)
{
    static const double gaps[3] = {1e-3, 1e-6, 1e-10};
    int engine, normalise, gap;

    q->options.box_budget = FEWER(20000, 1000);
    for (q->lobes = 1; q->lobes <= 2; q->lobes++) {
        for (engine = 0; engine < BRDFFIT_ENGINE_COUNT; engine++) {
            for (normalise = 0; normalise < 2; normalise++) {
                for (gap = 0; gap < (engine == BRDFFIT_ENGINE_SOCP ? 1 : 3); gap++) {
                    q->options.engine = (brdffit_engine)engine;
                    q->options.normalise = (brdffit_normalise)normalise;
                    q->options.relative_gap = gaps[gap];
                    fit_and_judge(tally, q);
                }
            }
        }
    }
}

static brdffit_table *read_case(const char *name)
{
    char path[256];
    brdffit_table *table;
    brdffit_error error;

    snprintf(path, sizeof path, "tests/data/certificates/%s.csv", name);
    if (brdffit_io_read(path, NULL, &table, &error) != BRDFFIT_OK) {
        fail_msg("%s: %s (tests run from the project's folder)", path, error.message);
    }
    return table;
}

static void try_file(const char *name, const brdffit_distribution *distributions, int count)
{
    brdffit_table *table = read_case(name);
    struct tally tally = {0, 0, 0};
    int j;

    for (j = 0; j < count; j++) {
        struct fit_question q;

        fit_question_init(&q, table->samples, 1, distributions[j]);
        every_way(&tally, &q);
    }
    brdffit_io_free(table);
    finish(&tally);
}

static const brdffit_distribution all_shapes[] = {BRDFFIT_BECKMANN, BRDFFIT_GGX, BRDFFIT_BLINN_PHONG, BRDFFIT_LAFORTUNE,
                                                  BRDFFIT_TORRANCE_SPARROW};

#define CASE(name, shapes)                                                                                             \
    static void test_##name(void **state)                                                                              \
    {                                                                                                                  \
        (void)state;                                                                                                   \
        try_file(#name, all_shapes, shapes);                                                                           \
    }

CASE(a_subnormal_min, 2)
CASE(floor_small_units, 5)
CASE(floor_unit, 5)
CASE(mem_stop, 2)
CASE(overflow_min, 2)
CASE(relative_weights, 2)
CASE(snap_eval, 5)
CASE(underflow_min, 2)

/* Two samples in their own units are no reason to give up (gaps of 1e-5 and less run out of nodes). */
static void test_mem_stop_is_certified(void **state)
{
    brdffit_table *table = read_case("mem_stop");
    struct fit_question q;
    struct fit_view view;

    (void)state;
    fit_question_init(&q, table->samples, 1, BRDFFIT_BECKMANN);
    q.options.normalise = BRDFFIT_NORMALISE_NONE;
    fit_view_new(&view, &q);
    assert_int_equal(view.status, BRDFFIT_OK);
    if (!view.certified) {
        fail_msg("stop %s after %zu boxes: e2 %.17g, lower bound %.17g", brdffit_stop_string(view.stop), view.boxes,
                 view.e2, view.lower_bound);
    }
    fit_view_free(&view);
    brdffit_io_free(table);
}

static void test_snap_eval_narrowest(void **state)
{
    static const double high[3] = {1e-12, 3e-12, 1e-11};
    brdffit_table *table = read_case("snap_eval");
    struct tally tally = {0, 0, 0};
    int i;

    (void)state;
    for (i = 0; i < 3; i++) {
        struct fit_question q;

        fit_question_init(&q, table->samples, 1, BRDFFIT_BECKMANN);
        q.options.sigma_max = high[i];
        every_way(&tally, &q);
    }
    brdffit_io_free(table);
    finish(&tally);
}

static void test_lafortune(void **state)
{
    static const double least[3] = {0.1, 0.01, 0.001};
    brdffit_table *table = read_case("lafortune");
    struct tally tally = {0, 0, 0};
    int i;

    (void)state;
    for (i = 0; i < 3; i++) {
        struct fit_question q;

        fit_question_init(&q, table->samples, 1, BRDFFIT_LAFORTUNE);
        q.options.exponent_min = least[i];
        every_way(&tally, &q);
    }
    brdffit_io_free(table);
    finish(&tally);
}

/*
 * Two samples whose best roughness is an end of its range, with c s = x there: what the library's own s is off by,
 * relative to 1 / sigma_max^2, changes the lobe by x times that.
 */
static void domain_end(struct tally *tally, double x, int narrow, struct brdffit_test_random *random)
{
    double end = pow(10.0, brdffit_test_uniform(random, -11.9, narrow ? -8.9 : -0.9));
    double a[2] = {0.0, 0.0}, b[2], c[2], values[2] = {0.001, 1.0};
    quad s = quad_s(end);
    brdffit_samples samples = brdffit_test_coefficients(2, 1, a, b, c, values);
    struct fit_question q;

    c[0] = 0.0;
    c[1] = (double)(x / s);
    b[0] = 1.0;
    b[1] = (double)expq(c[1] * s);
    fit_question_init(&q, &samples, 1, BRDFFIT_BECKMANN);
    q.options.sigma_max = end;
    q.options.sigma_min = narrow ? end : 1e-12;
    q.options.relative_gap = 1e-14;
    q.options.absolute_gap = 0.0;
    q.options.box_budget = 20000;
    fit_and_judge(tally, &q);
}

static void test_domain_end(void **state)
{
    static const double x[] = {0.5, 3.0, 10.0, 30.0, 100.0, 300.0};
    struct brdffit_test_random random = {88172645463325252ull};
    struct tally tally = {0, 0, 0};
    int i, narrow, n;

    (void)state;
    for (i = 0; i < 6; i++) {
        for (narrow = 0; narrow < 2; narrow++) {
            for (n = 0; n < FEWER(20, 5); n++) {
                domain_end(&tally, x[i], narrow, &random);
            }
        }
    }
    finish(&tally);
}

/* Problems that campaigns found, one of each kind of fault and family: they say their own options. */
static void test_campaign_finds(void **state)
{
    glob_t found;
    size_t i;
    int faulty = 0;

    (void)state;
    assert_int_equal(glob("tests/data/certificates/campaign/*.csv", 0, NULL, &found), 0);
    for (i = 0; i < found.gl_pathc; i++) {
        char text[2048];

        if (campaign_replay(found.gl_pathv[i], text, sizeof text) > 0) { /* to refuse is a way out */
            print_error("%s: %s\n", found.gl_pathv[i], text);
            faulty++;
        }
    }
    globfree(&found);
    print_message("%zu problems, %d at fault\n", i, faulty);
    assert_int_equal(faulty, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_subnormal_min),
        cmocka_unit_test(test_floor_small_units),
        cmocka_unit_test(test_floor_unit),
        cmocka_unit_test(test_mem_stop),
        cmocka_unit_test(test_mem_stop_is_certified),
        cmocka_unit_test(test_overflow_min),
        cmocka_unit_test(test_relative_weights),
        cmocka_unit_test(test_snap_eval),
        cmocka_unit_test(test_snap_eval_narrowest),
        cmocka_unit_test(test_underflow_min),
        cmocka_unit_test(test_lafortune),
        cmocka_unit_test(test_domain_end),
        cmocka_unit_test(test_campaign_finds),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
