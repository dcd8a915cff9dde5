/*
 * The driver of the search with three sides, of like lobes or not: every point of the domain in exactly one box that is
 * not split, up to the order of like lobes; a lower bound that is one; runs of equal intervals split by how many of them
 * take the upper half. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "search/search.h"
#include "support.h"

#define SIDES 3
#define NODES 4000u
#define HEAP 60000u
#define RECORDS 60000u

/* A function with a known Lipschitz constant, symmetric in like sides, and every box that was bounded. */
struct fake {
    struct axis axis[SIDES];
    struct heap heap;
    struct engine engine;
    double low[SIDES], high[SIDES]; /* of each axis */
    double amplitude[SIDES][3], frequency[SIDES][3], phase[SIDES][3], lipschitz[SIDES];
    int flat; /* bound 0 everywhere: breadth first, as far as the budget goes */
    size_t records;
    uint32_t record[RECORDS][SIDES];
};

static double node_memory[SIDES][NODES];
static struct axis_interval interval_memory[SIDES][2 * NODES];
static struct box heap_memory[HEAP];
static struct fake fake;

static double end_of(int side, uint32_t interval, int high)
{
    const struct axis *axis = &fake.axis[fake.engine.sides.axis[side]];
    const struct axis_interval *v = &axis->interval[interval];

    return axis->coordinate[high ? v->high : v->low];
}

static double value_at(const double *theta)
{
    double sum = 1.0, pull = 1.0;
    int p, i;

    for (p = 0; p < fake.engine.sides.count; p++) {
        int a = fake.engine.sides.axis[p];

        for (i = 0; i < 3; i++) {
            sum += fake.amplitude[a][i] * (1.0 + sin(fake.frequency[a][i] * theta[p] + fake.phase[a][i]));
        }
        pull *= sin(theta[p]);
    }
    return sum + 0.2 * (1.0 + pull);
}

static double bound(void *self, struct box *box, struct point *met)
{
    double reach = 0.0, widest = -1.0;
    int p;

    (void)self;
    assert_true(fake.records < RECORDS);
    memset(met, 0, sizeof *met);
    for (p = 0; p < fake.engine.sides.count; p++) {
        double low = end_of(p, box->interval[p], 0), high = end_of(p, box->interval[p], 1);
        double change = 0.5 * (high - low) * fake.lipschitz[fake.engine.sides.axis[p]];

        met->theta[p] = 0.5 * (low + high);
        reach += change;
        fake.record[fake.records][p] = box->interval[p];
        if (change > widest * (1.0 + 1e-9)) {
            widest = change;
            box->split = (uint32_t)p;
        }
    }
    fake.records++;
    box->bound = fake.flat ? 0.0 : fmax(0.0, value_at(met->theta) - reach);
    return value_at(met->theta);
}

static double try_point(void *self, struct point *point)
{
    int p;

    (void)self;
    for (p = 0; p < fake.engine.sides.count; p++) {
        int a = fake.engine.sides.axis[p];

        assert_true(point->theta[p] >= fake.low[a] && point->theta[p] <= fake.high[a]);
    }
    return value_at(point->theta);
}

static double width(void *self, int axis, uint32_t interval)
{
    const struct axis_interval *v = &fake.axis[axis].interval[interval];

    (void)self;
    return fake.axis[axis].coordinate[v->high] - fake.axis[axis].coordinate[v->low];
}

/* Sides of one axis are like ones. */
static void fake_new(const int *axis, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    int p, i;

    memset(&fake, 0, sizeof fake);
    fake.heap.box = heap_memory;
    fake.heap.capacity = HEAP;
    fake.engine.bound = bound;
    fake.engine.try_point = try_point;
    fake.engine.width = width;
    fake.engine.sides.count = SIDES;
    for (p = 0; p < SIDES; p++) {
        fake.engine.sides.axis[p] = axis[p];
        fake.engine.sides.first[p] = p > 0 && axis[p] == axis[p - 1] ? fake.engine.sides.first[p - 1] : p;
        fake.axis[p].coordinate = node_memory[p];
        fake.axis[p].interval = interval_memory[p];
        fake.axis[p].node_capacity = NODES;
        fake.low[p] = -1.0 - p;
        fake.high[p] = 2.0 + 0.5 * p;
        fake.lipschitz[p] = 0.2;
        for (i = 0; i < 3; i++) {
            fake.amplitude[p][i] = brdffit_test_uniform(&random, 0.0, 1.0);
            fake.frequency[p][i] = brdffit_test_uniform(&random, 0.3, 3.0);
            fake.phase[p][i] = brdffit_test_uniform(&random, 0.0, 6.3);
            fake.lipschitz[p] += fake.amplitude[p][i] * fake.frequency[p][i];
        }
    }
}

static struct search_result run(uint32_t first, double gap, size_t budget)
{
    struct search_rules rules = {.relative_gap = gap, .box_budget = budget, .progress_scale = 1.0};
    struct search_result result;
    int p;

    memset(&result, 0xff, sizeof result);
    fake.records = 0;
    for (p = 0; p < SIDES; p++) {
        brdffit_axis_start(&fake.axis[p], fake.low[p], fake.high[p], first);
    }
    brdffit_search(fake.axis, &fake.heap, &fake.engine, &rules, &result);
    assert_int_equal(result.boxes, fake.records);
    assert_true(result.boxes <= budget);
    assert_true(result.lower_bound <= result.objective);
    return result;
}

static void ascend(double *theta)
{
    int p, q;

    for (p = 0; p < SIDES; p++) {
        for (q = p; q > fake.engine.sides.first[p] && theta[q - 1] > theta[q]; q--) {
            double keep = theta[q];

            theta[q] = theta[q - 1];
            theta[q - 1] = keep;
        }
    }
}

static int holds(const uint32_t *record, const double *theta)
{
    int p, in = 1;

    for (p = 0; p < SIDES; p++) {
        in = in && end_of(p, record[p], 0) <= theta[p] && theta[p] <= end_of(p, record[p], 1);
    }
    return in;
}

static int contains(const uint32_t *outer, const uint32_t *inner)
{
    int p, in = 1;

    for (p = 0; p < SIDES; p++) {
        in = in && end_of(p, outer[p], 0) <= end_of(p, inner[p], 0) && end_of(p, inner[p], 1) <= end_of(p, outer[p], 1);
    }
    return in;
}

/*
 * The boxes that hold a point (like lobes ascending) are each inside of the one before: no point is in two boxes of the
 * first partition, or in two children. And the last of them was not split: no box at all is inside of it.
 */
static void check_point(double *theta)
{
    const uint32_t *last = NULL;
    size_t j;

    ascend(theta);
    for (j = 0; j < fake.records; j++) {
        if (holds(fake.record[j], theta)) {
            assert_true(!last || (contains(last, fake.record[j]) && !contains(fake.record[j], last)));
            last = fake.record[j];
        }
    }
    assert_non_null(last);
    for (j = 0; j < fake.records; j++) {
        assert_true(fake.record[j] == last || !contains(last, fake.record[j]));
    }
}

static const int pattern[][SIDES] = {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 2}};
#define PATTERNS (sizeof pattern / sizeof *pattern)

static void random_point(struct brdffit_test_random *random, double *theta)
{
    int p;

    for (p = 0; p < SIDES; p++) {
        int a = fake.engine.sides.axis[p];

        theta[p] = brdffit_test_uniform(random, fake.low[a], fake.high[a]);
        if (p > 0 && a == fake.engine.sides.axis[p - 1] && brdffit_test_below(random, 3) == 0) {
            theta[p] = theta[p - 1] + 1e-3 * brdffit_test_uniform(random, 0.0, 1.0); /* near the diagonal */
            theta[p] = fmin(theta[p], fake.high[a]);
        }
    }
}

static void test_every_point_once(void **state)
{
    size_t i;
    uint64_t seed;
    int flat, j;

    (void)state;
    for (i = 0; i < PATTERNS; i++) {
        for (flat = 0; flat < 2; flat++) {
            for (seed = 1; seed <= 6; seed++) {
                struct brdffit_test_random random = {seed};
                double theta[SIDES];

                fake_new(pattern[i], seed);
                fake.flat = flat;
                (void)run(seed % 2 ? 4 : 1, 0.02, 3000 + 7 * seed);
                for (j = 0; j < 300; j++) {
                    random_point(&random, theta);
                    check_point(theta);
                }
            }
        }
    }
}

/* Multisets of intervals for like sides, all combinations for others. */
static void test_first_partition(void **state)
{
    static const size_t boxes[PATTERNS] = {120, 36 * 8, 8 * 36, 512};
    size_t i, j;
    int p;

    (void)state;
    for (i = 0; i < PATTERNS; i++) {
        fake_new(pattern[i], 1);
        fake.flat = 1;
        (void)run(8, 0.02, boxes[i] + 1); /* no split fits any more */
        assert_int_equal(fake.records, boxes[i]);
        for (j = 0; j < fake.records; j++) {
            for (p = 0; p < SIDES; p++) {
                assert_true(fake.record[j][p] < 8);
                assert_true(p == fake.engine.sides.first[p] || fake.record[j][p - 1] <= fake.record[j][p]);
            }
            for (p = 0; j > 0 && p < SIDES && fake.record[j][p] == fake.record[j - 1][p]; p++) {
            }
            assert_true(j == 0 || (p < SIDES && fake.record[j][p] > fake.record[j - 1][p])); /* in order, none twice */
        }
    }
}

/* A run of r equal intervals becomes r + 1 boxes. */
static void test_runs(void **state)
{
    static const uint32_t three[5][SIDES] = {{0, 0, 0}, {1, 1, 1}, {1, 1, 2}, {1, 2, 2}, {2, 2, 2}};
    static const uint32_t two[4][SIDES] = {{0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}};
    size_t j;

    (void)state;
    fake_new(pattern[0], 1);
    fake.flat = 1;
    (void)run(1, 0.02, 5);
    assert_int_equal(fake.records, 5);
    for (j = 0; j < 5; j++) {
        assert_memory_equal(fake.record[j], three[j], sizeof three[j]);
    }
    (void)run(1, 0.02, 4); /* four children do not fit */
    assert_int_equal(fake.records, 1);
    fake_new(pattern[1], 1);
    fake.flat = 1;
    fake.lipschitz[0] = 10.0; /* the like pair is to be split */
    fake.lipschitz[1] = 0.1;
    (void)run(1, 0.02, 4);
    assert_int_equal(fake.records, 4);
    for (j = 0; j < 4; j++) {
        assert_memory_equal(fake.record[j], two[j], sizeof two[j]);
    }
    fake.lipschitz[0] = 0.1; /* the other one */
    fake.lipschitz[1] = 10.0;
    (void)run(1, 0.02, 4);
    assert_int_equal(fake.records, 3);
    assert_true(fake.record[1][2] == 1 && fake.record[2][2] == 2 && fake.record[2][0] == 0 && fake.record[2][1] == 0);
}

static double grid_minimum(void)
{
    int steps = 50, i;
    double best = INFINITY;

    for (i = 0; i < (steps + 1) * (steps + 1) * (steps + 1); i++) {
        int place = i, p;
        double theta[SIDES];

        for (p = 0; p < SIDES; p++) {
            int a = fake.engine.sides.axis[p];

            theta[p] = fake.low[a] + (fake.high[a] - fake.low[a]) * (place % (steps + 1)) / steps;
            place /= steps + 1;
        }
        best = fmin(best, value_at(theta));
    }
    return best;
}

static void test_finds_the_global_minimum(void **state)
{
    size_t i;
    uint64_t seed;

    (void)state;
    for (i = 0; i < PATTERNS; i++) {
        for (seed = 1; seed <= 4; seed++) {
            struct search_result result;
            double truth;

            fake_new(pattern[i], 10 * seed);
            result = run(8, 0.25, 50000);
            truth = grid_minimum();
            assert_int_equal(result.stop, BRDFFIT_STOP_RELATIVE_GAP);
            assert_true(result.lower_bound <= truth && result.objective <= 1.25 * truth);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_point_once),
        cmocka_unit_test(test_first_partition),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_finds_the_global_minimum),
    };

    return cmocka_run_group_tests_name("search_lobes", tests, NULL, NULL);
}
