/*
 * The driver of the search with engines that are known functions: the global minimum, a lower bound that is one,
 * no gap between boxes, ties in order. SPDX-License-Identifier: MIT
 */
#include "search_fake.h"

static void test_finds_the_global_minimum(void **state)
{
    uint64_t seed;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        for (seed = 1; seed <= (lobes > 1 ? 6u : 60u); seed++) {
            struct search_rules rules = rules_new();
            struct search_result result;
            double truth;

            fake_new(lobes, seed);
            rules.relative_gap = lobes > 1 ? 0.05 : 1e-4;
            result = run(16, &rules);
            truth = grid_minimum();
            assert_int_equal(result.stop, BRDFFIT_STOP_RELATIVE_GAP);
            assert_true(result.lower_bound <= truth);
            assert_true(result.objective <= (1.0 + rules.relative_gap) * truth);
            assert_true(result.objective <= (1.0 + rules.relative_gap) * result.lower_bound * (1.0 + 1e-15));
            check_cover(seed, 60);
        }
    }
}

static void test_absolute_gap(void **state)
{
    struct search_rules rules = rules_new();
    struct search_result result;

    (void)state;
    fake_new(1, 3);
    rules.relative_gap = 1e-9;
    rules.absolute_gap = 0.01;
    result = run(16, &rules);
    assert_int_equal(result.stop, BRDFFIT_STOP_ABSOLUTE_GAP);
    assert_true(result.objective - result.lower_bound <= 0.01);
}

/* The diagonal box becomes three: (low, low), (low, high), (high, high). */
static void test_diagonal_splits_in_three(void **state)
{
    struct search_rules rules = rules_new();

    (void)state;
    fake_new(2, 1);
    fake.box_bound = zero_bound;
    rules.box_budget = 4;
    (void)run(1, &rules);
    assert_int_equal(fake.records, 4);
    assert_int_equal(fake.record[0][0], 0);
    assert_int_equal(fake.record[0][1], 0);
    assert_int_equal(fake.record[1][0], 1);
    assert_int_equal(fake.record[1][1], 1);
    assert_int_equal(fake.record[2][0], 1);
    assert_int_equal(fake.record[2][1], 2);
    assert_int_equal(fake.record[3][0], 2);
    assert_int_equal(fake.record[3][1], 2);
}

/* Equal bounds are taken in the order in which they came: breadth first, interval after interval. */
static void test_ties_in_order(void **state)
{
    struct search_rules rules = rules_new();
    size_t i;

    (void)state;
    fake_new(1, 1);
    fake.box_bound = zero_bound;
    rules.box_budget = 2000;
    (void)run(4, &rules);
    assert_int_equal(fake.records, 2000);
    for (i = 0; i < fake.records; i++) {
        assert_int_equal(fake.record[i][0], i);
    }
}

/* Boxes that hold nothing: the incumbent is then the optimum. */
static void test_infinite_bounds(void **state)
{
    struct search_rules rules = rules_new();
    struct search_result result;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        fake_new(lobes, 1);
        fake.box_bound = infinite_bound;
        result = run(8, &rules);
        assert_int_equal(result.stop, BRDFFIT_STOP_RELATIVE_GAP);
        assert_true(result.lower_bound == INFINITY); /* as proven: the verdict on the final numbers sees through it */
        assert_int_equal(result.boxes, lobes > 1 ? 36 : 8);
    }
}

/* An engine that meets no point still gives an incumbent, inside the domain (run() looks). */
static void test_nothing_met(void **state)
{
    struct search_rules rules = rules_new();
    struct search_result result;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        fake_new(lobes, 1);
        fake.met_at = INFINITY;
        rules.box_budget = 500;
        result = run(8, &rules);
        assert_true(isfinite(result.objective));
        assert_true(result.lower_bound <= grid_minimum());
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finds_the_global_minimum), cmocka_unit_test(test_absolute_gap),
        cmocka_unit_test(test_diagonal_splits_in_three), cmocka_unit_test(test_ties_in_order),
        cmocka_unit_test(test_infinite_bounds),          cmocka_unit_test(test_nothing_met),
    };

    return cmocka_run_group_tests_name("search", tests, NULL, NULL);
}
