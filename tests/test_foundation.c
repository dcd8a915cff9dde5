/*
 * The ground floor: exp and log kernels against long double, the arena in both modes, the heap against a sorted
 * reference, the axis of the search. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "arena.h"
#include "axis.h"
#include "heap.h"
#include "kernel_exp.h"
#include "kernel_log.h"
#include "support.h"
#include "tolerance.h"

/* ---- kernels ------------------------------------------------------------------------------------------ */

/* Relative error in units of u (TOL_UNIT), which is what the kernels' comments speak of. */
static double error_in_units(double value, long double truth)
{
    return (double)(fabsl((long double)value - truth) / fabsl(truth)) / TOL_UNIT;
}

static void test_exp_error(void **state)
{
    struct brdffit_test_random random = {1};
    double worst = 0.0;
    long i;

    (void)state;
    for (i = 0; i < 1500000; i++) {
        double scale = i % 3 ? 1.0 : brdffit_test_log_uniform(&random, 1e-18, 1.0);
        double x = brdffit_test_uniform(&random, -708.0, 709.0) * scale;
        double error = error_in_units(kernel_exp(x), expl((long double)x));

        if (!(error < 2.0)) {
            fail_msg("kernel_exp(%a): %g u", x, error);
        }
        worst = fmax(worst, error);
    }
    print_message("exp: %.3f u at worst\n", worst);
}

/* Where k changes, |r| is largest: odd multiples of ln(2) / 2 and their neighbours. */
static void test_exp_between_powers(void **state)
{
    int k, i;

    (void)state;
    for (k = -1021; k <= 1022; k++) {
        double x = (k + 0.5) * 0.69314718055994530942;

        for (i = 0; i < 16; i++, x = nextafter(x, INFINITY)) {
            double y = x - 8.0 * (nextafter(x, INFINITY) - x);

            assert_true(!(y >= -708.0) || error_in_units(kernel_exp(y), expl((long double)y)) < 2.0);
        }
    }
}

static void test_exp_special_values(void **state)
{
    (void)state;
    assert_true(kernel_exp(0.0) == 1.0);
    assert_true(kernel_exp(-0.0) == 1.0);
    assert_true(kernel_exp(-INFINITY) == 0.0);
    assert_true(kernel_exp(-1e308) == 0.0);
    assert_true(kernel_exp(nextafter(-708.0, -INFINITY)) == 0.0);
    assert_true(kernel_exp(-708.0) > 3e-308);
    assert_true(error_in_units(kernel_exp(-708.0), expl(-708.0L)) < 2.0);
    assert_true(error_in_units(kernel_exp(709.0), expl(709.0L)) < 2.0);
    assert_true(kernel_exp(5e-324) == 1.0);
    assert_true(kernel_exp(-TOL_UNIT) <= 1.0);
}

/* phi = exp(-c u) of c, u >= 0 must never exceed 1, and may step up by no more than its error. */
static void test_exp_monotone(void **state)
{
    double before = 0.0, x;
    long i;

    (void)state;
    for (x = -709.0; x <= 709.0; x += 1.0 / 1024.0) {
        double value = kernel_exp(x);

        assert_true(value >= before * (1.0 - 4.0 * TOL_UNIT));
        assert_true(x > 0.0 || value <= 1.0);
        before = value;
    }
    for (i = 0, x = -1.0; i < 100000; i++, x = nextafter(x, 0.0)) {
        assert_true(kernel_exp(nextafter(x, 0.0)) >= kernel_exp(x) * (1.0 - 4.0 * TOL_UNIT));
    }
}

/* Two ulp, or two units of ln 2 times the exponent where that cancels nothing: here always two ulp. */
static void check_log(double x)
{
    long double truth = logl((long double)x);

    if (x == 1.0) {
        assert_true(kernel_log(x) == 0.0);
    } else if (!(fabsl((long double)kernel_log(x) - truth) <= 2.0L * 2.0L * TOL_UNIT * fabsl(truth))) {
        fail_msg("kernel_log(%a) = %a, not %La", x, kernel_log(x), truth);
    }
}

static void test_log_error(void **state)
{
    struct brdffit_test_random random = {2};
    long i;

    (void)state;
    for (i = 0; i < 400000; i++) {
        double decades = i % 2 ? 307.0 : brdffit_test_log_uniform(&random, 1e-17, 1.0);

        check_log(pow(10.0, brdffit_test_uniform(&random, -decades, decades)));
    }
    check_log(1.0);
    check_log(nextafter(1.0, 2.0));
    check_log(nextafter(1.0, 0.0));
    check_log(0x1p-1022);
    check_log(0x1.fffffffffffffp1023);
    check_log(0.70710678118654752);
    check_log(nextafter(0.70710678118654752, 0.0));
    check_log(1.4142135623730951);
    check_log(nextafter(1.4142135623730951, 0.0));
}

/* The axis is ln s: what goes through both must come back. */
static void test_log_undoes_exp(void **state)
{
    double theta;

    (void)state;
    for (theta = -690.0; theta < 690.0; theta += 0.37) {
        assert_true(fabs(kernel_log(kernel_exp(theta)) - theta) <= 4.0 * TOL_UNIT * (1.0 + fabs(theta)));
    }
}

/* ---- arena -------------------------------------------------------------------------------------------- */

/* One layout, as the library does it: returns the bytes used, and marks what it was given. */
static size_t lay_out(struct arena *arena, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    int i;

    for (i = 0; i < 20; i++) {
        size_t count = brdffit_test_below(&random, 300), bytes = 1 + brdffit_test_below(&random, 40), j;
        unsigned char *p = brdffit_arena_take(arena, count, bytes);

        for (j = 0; p && j < count * bytes; j++) {
            p[j] = (unsigned char)i;
        }
        assert_true((uintptr_t)p % ARENA_ALIGNMENT == 0);
        assert_int_equal(p != NULL, arena->base != NULL && !arena->failed);
    }
    return arena->used;
}

/* What counting says suffices at every misalignment, exactly as the sanitizer sees the block. */
static void test_arena_counts_what_it_takes(void **state)
{
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 130; seed++) {
        struct arena arena;
        size_t size, offset = seed % 65;
        unsigned char *block;

        brdffit_arena_init(&arena, NULL, 0);
        size = lay_out(&arena, seed);
        assert_false(arena.failed);
        block = malloc(size + offset);
        assert_non_null(block);
        brdffit_arena_init(&arena, block + offset, size);
        (void)lay_out(&arena, seed);
        assert_false(arena.failed);
        assert_true(arena.used <= size);
        free(block);
    }
}

/* An arena that is too small fails, stays failed, and never hands out memory beyond its end. */
static void test_arena_too_small(void **state)
{
    struct arena arena;
    unsigned char *block;
    size_t size, needed;

    (void)state;
    brdffit_arena_init(&arena, NULL, 0);
    needed = lay_out(&arena, 7);
    for (size = 0; size + 2 * ARENA_ALIGNMENT < needed; size += 97) {
        block = malloc(size + 1);
        assert_non_null(block);
        brdffit_arena_init(&arena, block, size);
        (void)lay_out(&arena, 7);
        assert_true(arena.failed);
        assert_null(brdffit_arena_take(&arena, 1, 1));
        free(block);
    }
}

static void test_arena_overflow(void **state)
{
    static const size_t count[] = {SIZE_MAX, SIZE_MAX / 8, SIZE_MAX / 8 - 7, SIZE_MAX / 2, SIZE_MAX - 64};
    unsigned char block[256];
    size_t i;

    (void)state;
    for (i = 0; i < sizeof count / sizeof count[0]; i++) {
        struct arena arena;

        brdffit_arena_init(&arena, NULL, 0);
        (void)brdffit_arena_take(&arena, count[i], 8);
        (void)brdffit_arena_take(&arena, count[i], 8);
        assert_true(arena.failed);
        brdffit_arena_init(&arena, block, sizeof block);
        assert_null(brdffit_arena_take(&arena, count[i], 1));
        assert_true(arena.failed);
    }
}

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
            struct box box = {(double)brdffit_test_below(&random, 12), sequence++, {(uint32_t)step, 1}, 0};
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
    struct box memory[4], box = {INFINITY, 0, {0, 0}, 0};
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
        cmocka_unit_test(test_exp_error),
        cmocka_unit_test(test_exp_between_powers),
        cmocka_unit_test(test_exp_special_values),
        cmocka_unit_test(test_exp_monotone),
        cmocka_unit_test(test_log_error),
        cmocka_unit_test(test_log_undoes_exp),
        cmocka_unit_test(test_arena_counts_what_it_takes),
        cmocka_unit_test(test_arena_too_small),
        cmocka_unit_test(test_arena_overflow),
        cmocka_unit_test(test_heap_against_sorted),
        cmocka_unit_test(test_heap_orders_infinite_bounds),
        cmocka_unit_test(test_axis_splits),
        cmocka_unit_test(test_axis_ends_at_rounding),
        cmocka_unit_test(test_axis_of_one_point),
    };

    return cmocka_run_group_tests_name("foundation", tests, NULL, NULL);
}
