/*
 * Where memory is full a search goes on depth first: the same proof in memory for one path, ended by the budget alone.
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fit/fit.h"
#include "search_fake.h"
#include "support.h"
#include "verify.h"

/* ---- Lent intervals ------------------------------------------------------------------------------------------- */

static void test_lending(void **state)
{
    uint32_t first, second, node[2];
    struct axis *axis = &fake.axis;

    (void)state;
    fake_new(1, 1);
    axis->node_capacity = 12;
    brdffit_axis_reserve(axis, 2);
    brdffit_axis_start(axis, LOW, HIGH, 8);
    assert_int_not_equal(brdffit_axis_split(axis, 3), 0);
    assert_int_equal(brdffit_axis_split(axis, 4), 0); /* 10 nodes are taken, two are lent */
    first = brdffit_axis_lend(axis, 4, 0, &node[0]);
    second = brdffit_axis_lend(axis, first + 1, 1, &node[1]);
    assert_int_equal(brdffit_axis_lend(axis, second, 2, &node[1]), 0);
    assert_true(node[0] == 10 && node[1] == 11 && second + 1 < AXIS_INTERVALS(12));
    assert_true(brdffit_axis_is_lent(axis, first) && brdffit_axis_is_lent(axis, second + 1));
    assert_false(brdffit_axis_is_lent(axis, axis->intervals - 1));
    assert_int_equal(axis->interval[4].child, 0);
    assert_true(axis->interval[first].high == 10 && axis->interval[first + 1].low == 10);
    assert_true(axis->interval[second].low == 10 && axis->interval[second].high == 11);
    assert_true(axis->interval[second + 1].high == axis->interval[4].high);
    assert_true(axis->coordinate[10] == 0.5 * (axis->coordinate[4] + axis->coordinate[5]));
    assert_true(axis->coordinate[11] == 0.5 * (axis->coordinate[10] + axis->coordinate[5]));
}

/* ---- Functions of known Lipschitz constant ---------------------------------------------------------------------- */

static size_t forgotten;

static void forget(void *self, int axis, uint32_t node, uint32_t interval)
{
    const struct fake *f = self;

    assert_int_equal(axis, 0);
    assert_true(node >= f->axis.node_capacity - f->axis.lent && brdffit_axis_is_lent(&f->axis, interval));
    forgotten++;
}

static void test_small_memory(void **state)
{
    uint64_t seed;
    int lobes, which;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        for (seed = 1; seed <= 6; seed++) {
            struct search_rules rules = rules_new();
            struct search_result tight;

            rules.relative_gap = lobes > 1 ? 0.05 : 1e-4;
            for (which = 0; which < 3; which++) { /* nodes, boxes, both */
                fake_new(lobes, seed);
                fake.engine.forget = forget;
                fake.axis.node_capacity = which == 1 ? NODES : 120;
                fake.heap.capacity = which == 0 ? HEAP : 12;
                brdffit_axis_reserve(&fake.axis, 100);
                forgotten = 0;
                tight = run(4, &rules);
                assert_int_equal(tight.stop, BRDFFIT_STOP_RELATIVE_GAP);
                assert_true(tight.lower_bound <= grid_minimum());
                assert_true(fake.axis.nodes <= fake.axis.node_capacity - fake.axis.lent);
                assert_true(which == 1 || forgotten > 0);
            }
        }
    }
}

/* The budget ends it in the middle of a dive, with a bound of the whole, to the box. */
static void test_budget(void **state)
{
    size_t budget;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        double truth, before = 0.0;

        fake_new(lobes, 3);
        truth = grid_minimum();
        fake.axis.node_capacity = 112;
        fake.heap.capacity = 12;
        brdffit_axis_reserve(&fake.axis, 100);
        for (budget = 10; budget < 400; budget += 1 + budget / 7) {
            struct search_rules rules = rules_new();
            struct search_result result;

            rules.relative_gap = 1e-9;
            rules.box_budget = budget;
            result = run(4, &rules);
            assert_int_equal(result.stop, BRDFFIT_STOP_BUDGET);
            assert_true(result.boxes <= budget && result.boxes + 3 > budget);
            assert_true(result.lower_bound <= truth && result.lower_bound >= before);
            before = result.lower_bound;
        }
    }
}

/* ---- Fits -------------------------------------------------------------------------------------------------------- */

/* A fit whose tables are cut to `nodes` and `boxes`, judged from the samples alone. */
static void fit_in(const brdffit_samples *samples, const brdffit_options *o, uint32_t nodes, size_t boxes)
{
    size_t size = brdffit_workspace_size(samples->count, samples->channels, o);
    void *workspace = malloc(size);
    struct brdffit_test_result flat;
    char why[400];
    struct fit f;
    int kind;

    assert_non_null(workspace);
    assert_int_equal(brdffit_fit_open(&f, samples, o, workspace, size, workspace, NULL), BRDFFIT_OK);
    for (kind = 0; kind < f.model.kinds; kind++) {
        uint32_t lent = f.axis[kind].lent;

        f.axis[kind].node_capacity = nodes + lent;
        brdffit_axis_reserve(&f.axis[kind], lent);
    }
    f.heap.capacity = boxes;
    assert_int_equal(brdffit_fit_finish(&f, o, NULL), BRDFFIT_OK);
    brdffit_test_flatten(&f.handout->result, &flat);
    if (!flat.certified) {
        fail_msg("%u nodes, %zu boxes: %s, e2 %.17g +- %g, bound %.17g of %g", nodes, boxes,
                 brdffit_stop_string(flat.stop), flat.e2, flat.e2_error, flat.lower_bound, flat.sum_of_squares);
    }
    if (brdffit_test_verify(samples, o, &flat, why, sizeof why)) {
        brdffit_test_print(samples, o);
        fail_msg("%u nodes, %zu boxes: %s", nodes, boxes, why);
    }
    free(workspace);
}

static void test_fits(void **state)
{
    static const brdffit_distribution of[] = {BRDFFIT_BECKMANN, BRDFFIT_GGX, BRDFFIT_LAFORTUNE};
    size_t i;
    int lobes;

    (void)state;
    for (i = 0; i < 3; i++) {
        for (lobes = 1; lobes <= 2; lobes++) {
            struct brdffit_test_spec spec = brdffit_test_spec_default();
            struct brdffit_test_data data;
            brdffit_options o;

            spec.noise = 0.05;
            spec.seed = 40 + i;
            brdffit_test_data_new(&spec, &data);
            brdffit_options_init(&o);
            o.lobes = lobes;
            o.distribution = of[i];
            o.relative_gap = lobes > 1 ? 1e-2 : 1e-6;
            fit_in(&data.samples, &o, 12, 8);
            fit_in(&data.samples, &o, 24, 40);
            brdffit_test_data_free(&data);
        }
    }
}

/* A valley that is flat: more boxes than there are nodes, in the default's memory. */
static void test_flat_valley(void **state)
{
    static const double a[] = {0.28360925914770552, 0.22532250058754605},
                        b[] = {0.6588560528208266, 1.1916059705725923},
                        c[] = {0.98110587877619404, 0.37333529724343884};
    static const double values[] = {0.0017209893875593395,  0.13802779614355132,  13.936678844280467,
                                    -0.0032080363402488704, 0.087563838006684117, 12.925025512584785};
    static const double gaps[] = {1e-6, 1e-11, 1e-13};
    static const brdffit_stop ends[] = {BRDFFIT_STOP_RELATIVE_GAP, BRDFFIT_STOP_BUDGET, BRDFFIT_STOP_BUDGET};
    brdffit_samples samples = brdffit_test_coefficients(2, 3, a, b, c, values);
    size_t i;

    (void)state;
    for (i = 0; i < 3; i++) {
        struct brdffit_test_fit fit;
        brdffit_options o;

        brdffit_options_init(&o);
        o.normalise = BRDFFIT_NORMALISE_NONE;
        o.relative_gap = gaps[i];
        o.absolute_gap = 0.0;
        o.box_budget = 150000;
        brdffit_test_fit(&samples, &o, &fit);
        assert_int_equal(fit.result.stop, ends[i]);
        assert_true(fit.result.boxes > 100000);
        assert_true(fit.workspace_size < (size_t)16 << 20);
        brdffit_test_fit_free(&fit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lending), cmocka_unit_test(test_small_memory), cmocka_unit_test(test_budget),
        cmocka_unit_test(test_fits),    cmocka_unit_test(test_flat_valley),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
