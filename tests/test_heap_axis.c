/*
 * The heap of boxes against a sorted reference, and the axis of the search. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <math.h>

#include "search/axis.h"
#include "search/heap.h"
#include "support.h"

/* ---- heap --------------------------------------------------------------------------------------------- */

#define HEAP_BOXES 700

static int compare_boxes(const void *p, const void *q)
{
    const struct box *a = p, *b = q;

    if (a->bound != b->bound) {
        return a->bound < b->bound ? -1 : 1;
    }
    return a->sequence < b->sequence ? -1 : a->sequence > b->sequence;
}

/* Push and pop at random beside a sorted array; few distinct bounds, so that ties are common. */
static void heap_against_sorted(struct heap *heap, uint64_t seed)
{
    static struct box sorted[HEAP_BOXES];
    struct brdffit_test_random random = {seed};
    size_t count = 0, step;
    uint64_t sequence = 0;

    heap->count = 0;
    for (step = 0; step < 6000; step++) {
        if (count == 0 || (step % 2000 < 1200 ? brdffit_test_below(&random, 10) < 7 : step % 2 == 0)) {
            struct box box = {.bound = (double)brdffit_test_below(&random, 12),
                              .sequence = sequence++,
                              .interval = {(uint32_t)step, 1}};
            int pushed = brdffit_heap_push(heap, &box);

            assert_int_equal(pushed, count < heap->capacity);
            if (pushed) {
                sorted[count++] = box;
                qsort(sorted, count, sizeof sorted[0], compare_boxes);
            }
        } else {
            struct box box = brdffit_heap_pop(heap);
            size_t i;

            assert_int_equal(box.sequence, sorted[0].sequence);
            assert_true(box.bound == sorted[0].bound);
            assert_int_equal(box.interval[0], sorted[0].interval[0]);
            count--;
            for (i = 0; i < count; i++) {
                sorted[i] = sorted[i + 1];
            }
        }
        assert_int_equal(heap->count, count);
    }
}

static void test_heap_against_sorted(void **state)
{
    static const size_t capacity[] = {1, 2, 3, 60, HEAP_BOXES};
    static struct box memory[HEAP_BOXES];
    struct heap heap;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof capacity / sizeof capacity[0]; i++) {
        heap.box = memory;
        heap.capacity = capacity[i];
        heap_against_sorted(&heap, i + 1);
    }
}

static void test_heap_orders_infinite_bounds(void **state)
{
    struct box memory[4], box = {.bound = INFINITY};
    struct heap heap = {memory, 0, 4};

    (void)state;
    assert_true(brdffit_heap_push(&heap, &box));
    box.sequence = 1;
    box.bound = -INFINITY;
    assert_true(brdffit_heap_push(&heap, &box));
    box.sequence = 2;
    assert_true(brdffit_heap_push(&heap, &box));
    assert_int_equal(brdffit_heap_pop(&heap).sequence, 1);
    assert_int_equal(brdffit_heap_pop(&heap).sequence, 2);
    assert_int_equal(brdffit_heap_pop(&heap).sequence, 0);
    assert_int_equal(heap.count, 0);
}

/* ---- axis --------------------------------------------------------------------------------------------- */

#define AXIS_NODES 500u

struct axis_memory {
    void *block;
    struct axis axis;
};

static struct axis *axis_new(struct axis_memory *memory, uint32_t nodes)
{
    struct arena arena;

    brdffit_arena_init(&arena, NULL, 0);
    brdffit_axis_layout(&memory->axis, &arena, nodes);
    memory->block = malloc(arena.used);
    assert_non_null(memory->block);
    brdffit_arena_init(&arena, memory->block, arena.used);
    brdffit_axis_layout(&memory->axis, &arena, nodes);
    assert_false(arena.failed);
    return &memory->axis;
}

/* Every interval is increasing; children split their parent exactly; leaves cover the whole without gaps. */
static void check_axis(const struct axis *axis, double low, double high)
{
    double leaves = 0.0;
    uint32_t i;

    assert_true(axis->nodes <= axis->node_capacity);
    assert_true(axis->intervals <= AXIS_INTERVALS(axis->node_capacity));
    assert_true(axis->coordinate[axis->interval[0].low] == low);
    assert_true(axis->coordinate[axis->interval[axis->first - 1].high] == high);
    for (i = 0; i < axis->intervals; i++) {
        const struct axis_interval *v = &axis->interval[i];

        assert_true(v->low < axis->nodes && v->high < axis->nodes);
        assert_true(axis->coordinate[v->low] < axis->coordinate[v->high]);
        assert_true(i == 0 || i >= axis->first || v->low == axis->interval[i - 1].high);
        if (v->child) {
            const struct axis_interval *child = &axis->interval[v->child];

            assert_true(child[0].low == v->low && child[1].high == v->high && child[0].high == child[1].low);
        } else {
            leaves += axis->coordinate[v->high] - axis->coordinate[v->low];
        }
    }
    assert_true(fabs(leaves - (high - low)) <= 1e-12 * (fabs(low) + fabs(high)));
}

static void test_axis_splits(void **state)
{
    struct brdffit_test_random random = {5};
    struct axis_memory memory;
    struct axis *axis;
    uint32_t first;

    (void)state;
    for (first = 1; first <= 16; first *= 2) {
        uint32_t before, child;
        int full = 0, i;

        axis = axis_new(&memory, AXIS_NODES);
        brdffit_axis_start(axis, -13.8, 55.3, first);
        check_axis(axis, -13.8, 55.3);
        for (i = 0; i < 4000; i++) {
            uint32_t interval = (uint32_t)brdffit_test_below(&random, axis->intervals);

            before = axis->intervals;
            child = brdffit_axis_split(axis, interval);
            full = full || axis->nodes == AXIS_NODES;
            assert_true(child != 0 || full);
            /* Asking again is free, and gives the same children. */
            assert_int_equal(brdffit_axis_split(axis, interval), child);
            assert_true(axis->intervals <= before + 2);
        }
        assert_true(full);
        check_axis(axis, -13.8, 55.3);
        free(memory.block);
    }
}

/* Splitting towards one point ends, by itself, with an interval whose midpoint is still distinct. */
static void test_axis_ends_at_rounding(void **state)
{
    static const double end[][2] = {{-3.0, 5.0}, {0.0, 1e-9}, {700.0, 700.5}, {-1e300, 1e300}, {55.0, 55.0 + 1e-12}};
    struct axis_memory memory;
    struct axis *axis;
    size_t i;

    (void)state;
    for (i = 0; i < sizeof end / sizeof end[0]; i++) {
        uint32_t interval = 0, child;

        axis = axis_new(&memory, 5000);
        brdffit_axis_start(axis, end[i][0], end[i][1], 1);
        while ((child = brdffit_axis_split(axis, interval)) != 0) {
            interval = child + (child / 2) % 2;
        }
        assert_true(brdffit_axis_narrow(axis, interval));
        assert_true(axis->nodes < 1200);
        check_axis(axis, end[i][0], end[i][1]);
        free(memory.block);
    }
}

static void test_axis_of_one_point(void **state)
{
    struct axis_memory memory;
    struct axis *axis;

    (void)state;
    axis = axis_new(&memory, 20);
    brdffit_axis_start(axis, 2.5, 2.5, 16);
    assert_int_equal(axis->first, 1);
    assert_int_equal(axis->intervals, 1);
    assert_true(axis->coordinate[axis->interval[0].low] == 2.5 && axis->coordinate[axis->interval[0].high] == 2.5);
    assert_true(brdffit_axis_narrow(axis, 0));
    assert_int_equal(brdffit_axis_split(axis, 0), 0);
    free(memory.block);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heap_against_sorted), cmocka_unit_test(test_heap_orders_infinite_bounds),
        cmocka_unit_test(test_axis_splits),         cmocka_unit_test(test_axis_ends_at_rounding),
        cmocka_unit_test(test_axis_of_one_point),
    };

    return cmocka_run_group_tests_name("heap_axis", tests, NULL, NULL);
}
