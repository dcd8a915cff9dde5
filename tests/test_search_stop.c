/*
 * Why the driver of the search stops, and what it says on the way: budget, full tables, rounding, resolution,
 * progress, cancelling. SPDX-License-Identifier: MIT
 */
#include "search_fake.h"

/* Whatever the budget: never exceeded, the bound is one, and every point is in some box. */
static void test_budgets(void **state)
{
    size_t budget;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        double truth;

        fake_new(lobes, 11);
        truth = grid_minimum();
        for (budget = 1; budget <= 50; budget++) {
            struct search_rules rules = rules_new();
            struct search_result result;
            uint32_t first = 16;

            while (first > 1 && (lobes > 1 ? first * (first + 1) / 2 : first) > budget) {
                first /= 2;
            }
            rules.relative_gap = 1e-9;
            rules.box_budget = budget;
            result = run(first, &rules);
            assert_int_equal(result.stop, BRDFFIT_STOP_BUDGET);
            assert_true(result.lower_bound <= truth);
            check_cover(budget, 30);
            if (result.boxes > budget) {
                fail_msg("%d lobes, budget %zu: %zu boxes", lobes, budget, result.boxes);
            }
        }
    }
}

static void test_heap_full(void **state)
{
    size_t capacity;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        double truth;

        fake_new(lobes, 12);
        truth = grid_minimum();
        for (capacity = 1; capacity <= 40; capacity++) {
            struct search_rules rules = rules_new();
            struct search_result result;

            rules.relative_gap = 1e-9;
            fake.heap.capacity = capacity;
            result = run(4, &rules);
            assert_int_equal(result.stop, BRDFFIT_STOP_MEMORY);
            assert_true(result.lower_bound <= truth);
            check_cover(capacity, 30);
        }
    }
}

static void test_node_table_full(void **state)
{
    uint32_t capacity;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        double truth;

        fake_new(lobes, 13);
        truth = grid_minimum();
        for (capacity = 5; capacity <= 40; capacity++) {
            struct search_rules rules = rules_new();
            struct search_result result;

            rules.relative_gap = 1e-9;
            fake.axis.node_capacity = capacity;
            result = run(4, &rules);
            assert_int_equal(result.stop, BRDFFIT_STOP_MEMORY);
            assert_true(result.lower_bound <= truth);
            assert_true(fake.axis.nodes <= capacity);
            check_cover(capacity, 30);
        }
    }
}

static double mixed_bound(const struct fake *f, const struct box *box)
{
    (void)f;
    return box->interval[0] == box->interval[1] ? 0.5 : 0.0;
}

/*
 * A box with one side at rounding level, and another that only lacks a node: memory is what ran out, whichever
 * side was tried last. Made by hand, because a search takes long to get there.
 */
static void test_memory_with_one_narrow_side(void **state)
{
    int advice;

    (void)state;
    for (advice = 0; advice < 2; advice++) {
        struct search_rules rules = rules_new();
        struct search_result result;

        fake_new(2, 1);
        fake.box_bound = mixed_bound;
        fake.advice = advice;
        fake.axis.node_capacity = 3;
        memset(&result, 0, sizeof result);
        brdffit_axis_start(&fake.axis, LOW, HIGH, 2);
        fake.axis.coordinate[1] = nextafter(LOW, HIGH);
        brdffit_search(&fake.axis, &fake.heap, &fake.engine, &rules, &result);
        assert_int_equal(result.boxes, 3);
        if (result.stop != BRDFFIT_STOP_MEMORY) {
            fail_msg("split advice %d: %s", advice, brdffit_stop_string(result.stop));
        }
    }
}

static void test_rounding(void **state)
{
    struct search_rules rules = rules_new();
    struct search_result result;

    (void)state;
    fake_new(1, 1);
    fake.value = distance;
    fake.target = 0.7;
    fake.lipschitz = 1.0 + 1e-3;
    rules.relative_gap = 1e-18;
    result = run(16, &rules);
    assert_string_equal(brdffit_stop_string(result.stop), "rounding");
    assert_true(result.lower_bound <= 1.0 && result.lower_bound > 1.0 - 1e-10);
}

/* Boxes of the resolution are not split; what stops the search is that, even when closed boxes are left over. */
static void test_resolution(void **state)
{
    static const double resolution[] = {1.0, 0.3, 0.05, 0.01};
    size_t i;
    int lobes;

    (void)state;
    for (lobes = 1; lobes <= 2; lobes++) {
        for (i = 0; i < 4; i++) {
            struct search_rules rules = rules_new();
            struct search_result result;
            size_t j;

            fake_new(lobes, 14);
            rules.relative_gap = 1e-9;
            rules.sigma_resolution = lobes > 1 ? 4.0 * resolution[i] : resolution[i];
            result = run(16, &rules);
            for (j = 0; j < fake.records; j++) {
                uint32_t second = lobes > 1 ? fake.record[j][1] : fake.record[j][0];
                double width = fmax(fake_width(&fake, 0, fake.record[j][0]), fake_width(&fake, 0, second));

                assert_true(j < 16 * 17 / 2 || 2.0 * width > rules.sigma_resolution);
            }
            assert_true(result.lower_bound <= grid_minimum());
            check_cover(i, 100);
            assert_string_equal(brdffit_stop_string(result.stop), "resolution");
        }
    }
}

/* ---- progress ----------------------------------------------------------------------------------------- */

struct watch {
    int calls, stop_at;
    size_t boxes;
    double e2, lower_bound;
};

static int watch_progress(void *user, const brdffit_progress *p)
{
    struct watch *w = user;

    w->calls++;
    assert_int_equal(p->phase, BRDFFIT_PHASE_SEARCH);
    assert_true(p->boxes > w->boxes);
    assert_true(p->e2 <= w->e2);
    w->boxes = p->boxes;
    w->e2 = p->e2;
    w->lower_bound = fmax(w->lower_bound, p->lower_bound);
    return w->calls == w->stop_at;
}

static void test_progress_and_cancel(void **state)
{
    struct search_rules rules = rules_new();
    struct search_result result;
    struct watch w = {0, 0, 0, INFINITY, 0.0};

    (void)state;
    fake_new(2, 2);
    rules.relative_gap = 1e-4;
    rules.box_budget = 3000;
    rules.progress = watch_progress;
    rules.progress_user = &w;
    rules.progress_scale = 4.0;
    result = run(16, &rules);
    assert_int_equal(w.calls, result.boxes / 256);
    assert_true(w.e2 >= 4.0 * result.objective);
    assert_true(w.lower_bound <= 4.0 * grid_minimum());
    w = (struct watch){0, 3, 0, INFINITY, 0.0};
    result = run(16, &rules);
    assert_int_equal(result.stop, BRDFFIT_STOP_CANCELLED);
    assert_true(result.boxes >= 3 * 256 && result.boxes < 3 * 256 + 3);
    assert_true(result.lower_bound <= grid_minimum());
    check_cover(1, 100);
    w = (struct watch){0, 0, 0, INFINITY, 0.0};
    rules.cancelled = 1;
    result = run(16, &rules);
    assert_int_equal(result.stop, BRDFFIT_STOP_CANCELLED);
    assert_int_equal(result.boxes, 136);
}

/*
 * What progress calls proven is proven: the box that is being split counts until its children are bounded. Here
 * the 256th box is the upper child of the only box with the minimum inside.
 */
static void test_progress_reports_proven_bounds(void **state)
{
    uint32_t first;

    (void)state;
    for (first = 253; first <= 256; first++) {
        struct search_rules rules = rules_new();
        struct search_result result;
        struct watch w = {0, 0, 0, INFINITY, 0.0};

        fake_new(1, 1);
        fake.value = distance;
        fake.target = HIGH - 0.2 * (HIGH - LOW) / first;
        fake.lipschitz = 1.01;
        rules.relative_gap = 1e-12;
        rules.progress = watch_progress;
        rules.progress_user = &w;
        result = run(first, &rules);
        assert_int_equal(w.calls, 1);
        assert_true(result.lower_bound <= 1.0);
        if (!(w.lower_bound <= 1.0)) {
            fail_msg("first %u: progress says %.17g is proven, the minimum is 1", first, w.lower_bound);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_heap_full),
        cmocka_unit_test(test_node_table_full),
        cmocka_unit_test(test_memory_with_one_narrow_side),
        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_resolution),
        cmocka_unit_test(test_progress_and_cancel),
        cmocka_unit_test(test_progress_reports_proven_bounds),
    };

    return cmocka_run_group_tests_name("search_stop", tests, NULL, NULL);
}
