/*
 * An engine for the driver of the search that is a known function with a Lipschitz bound, and that remembers every
 * box. Shared by test_search.c and test_search_stop.c. SPDX-License-Identifier: MIT
 */
#ifndef SEARCH_FAKE_H
#define SEARCH_FAKE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "search/search.h"
#include "support.h"

#define LOW (-3.0)
#define HIGH 3.0
#define NODES 20000u
#define HEAP 60000u
#define RECORDS 60000u

/* A function of known Lipschitz constant, symmetric in its arguments, and every box that was bounded. */
struct fake {
    struct axis axis;
    struct heap heap;
    struct engine engine;
    double (*value)(const struct fake *fake, const double *theta);
    double (*box_bound)(const struct fake *fake, const struct box *box);
    double amplitude[4], frequency[4], phase[4], lipschitz, target;
    int advice;    /* split to advise; 2: the wider side */
    double met_at; /* objective of `met`: 0 is f(middle), else this */
    size_t records;
    uint32_t record[RECORDS][2];
    double bound[RECORDS];
};

static double node_memory[NODES];
static struct axis_interval interval_memory[2 * NODES];
static struct box heap_memory[HEAP];
static struct fake fake;

static inline double side(const struct fake *f, uint32_t interval, int high)
{
    const struct axis_interval *v = &f->axis.interval[interval];

    return f->axis.coordinate[high ? v->high : v->low];
}

static inline double wave(const struct fake *f, double t)
{
    double sum = 0.0;
    int i;

    for (i = 0; i < 4; i++) {
        sum += f->amplitude[i] * (1.0 + sin(f->frequency[i] * t + f->phase[i]));
    }
    return sum;
}

static inline double waves(const struct fake *f, const double *theta)
{
    double sum = 0.5 + wave(f, theta[0]);

    if (f->engine.sides.count > 1) {
        sum += wave(f, theta[1]) + 0.3 * sin(theta[0] + theta[1]) + 0.3;
    }
    return sum;
}

static inline double distance(const struct fake *f, const double *theta)
{
    return 1.0 + fabs(theta[0] - f->target) + (f->engine.sides.count > 1 ? fabs(theta[1] - f->target) : 0.0);
}

static inline struct point middle(const struct fake *f, const struct box *box)
{
    struct point at;
    int p;

    for (p = 0; p < 2; p++) {
        uint32_t interval = f->engine.sides.count > 1 ? box->interval[p] : box->interval[0];

        at.theta[p] = 0.5 * (side(f, interval, 0) + side(f, interval, 1));
    }
    return at;
}

static inline double half_width(const struct fake *f, const struct box *box, int p)
{
    return 0.5 * (side(f, box->interval[p], 1) - side(f, box->interval[p], 0));
}

/* f(middle) - L (half widths), clipped at 0 as an engine's is. */
static inline double lipschitz_bound(const struct fake *f, const struct box *box)
{
    struct point at = middle(f, box);
    double reach = half_width(f, box, 0) + (f->engine.sides.count > 1 ? half_width(f, box, 1) : 0.0);

    return fmax(0.0, f->value(f, at.theta) - f->lipschitz * reach);
}

static inline double zero_bound(const struct fake *f, const struct box *box)
{
    (void)f;
    (void)box;
    return 0.0;
}

static inline double infinite_bound(const struct fake *f, const struct box *box)
{
    (void)f;
    (void)box;
    return INFINITY;
}

static inline double fake_bound(void *self, struct box *box, struct point *met)
{
    struct fake *f = self;

    assert_true(f->records < RECORDS);
    f->record[f->records][0] = box->interval[0];
    f->record[f->records][1] = box->interval[1];
    box->bound = f->box_bound(f, box);
    f->bound[f->records++] = box->bound;
    box->split = (uint32_t)f->advice;
    if (f->advice > 1) {
        box->split = f->engine.sides.count > 1 && half_width(f, box, 1) > half_width(f, box, 0);
    }
    *met = middle(f, box);
    return f->met_at > 0.0 ? f->met_at : f->value(f, met->theta);
}

static inline double fake_try(void *self, struct point *point)
{
    const struct fake *f = self;
    int p;

    for (p = 0; p < f->engine.sides.count; p++) {
        assert_true(point->theta[p] >= LOW && point->theta[p] <= HIGH);
    }
    return f->value(f, point->theta);
}

static inline double fake_width(void *self, int axis, uint32_t interval)
{
    (void)axis;
    return side(self, interval, 1) - side(self, interval, 0);
}

static inline void fake_new(int lobes, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    int i;

    memset(&fake, 0, sizeof fake);
    fake.axis.coordinate = node_memory;
    fake.axis.interval = interval_memory;
    fake.axis.node_capacity = NODES;
    fake.heap.box = heap_memory;
    fake.heap.capacity = HEAP;
    fake.engine.self = &fake;
    fake.engine.sides.count = lobes;
    fake.engine.bound = fake_bound;
    fake.engine.try_point = fake_try;
    fake.engine.width = fake_width;
    fake.value = waves;
    fake.box_bound = lipschitz_bound;
    fake.advice = 2;
    fake.lipschitz = lobes > 1 ? 0.3 : 0.0;
    for (i = 0; i < 4; i++) {
        fake.amplitude[i] = brdffit_test_uniform(&random, 0.0, 1.0);
        fake.frequency[i] = brdffit_test_uniform(&random, 0.3, 6.0);
        fake.phase[i] = brdffit_test_uniform(&random, 0.0, 6.3);
        fake.lipschitz += fake.amplitude[i] * fake.frequency[i];
    }
}

static inline struct search_rules rules_new(void)
{
    struct search_rules rules;

    memset(&rules, 0, sizeof rules);
    rules.relative_gap = 1e-2;
    rules.box_budget = 40000;
    rules.progress_scale = 1.0;
    return rules;
}

static inline struct search_result run(uint32_t first, const struct search_rules *rules)
{
    struct search_result result;

    memset(&result, 0xff, sizeof result); /* NaN: what is not set shows */
    fake.records = 0;
    brdffit_axis_start(&fake.axis, LOW, HIGH, first);
    brdffit_search(&fake.axis, &fake.heap, &fake.engine, rules, &result);
    assert_int_equal(result.boxes, fake.records);
    assert_true(result.lower_bound <= result.objective || result.lower_bound == INFINITY);
    assert_true(result.objective == fake.value(&fake, result.point.theta));
    return result;
}

/* The smallest value on a fine grid: no lower bound may exceed it. */
static inline double grid_minimum(void)
{
    int steps = fake.engine.sides.count > 1 ? 300 : 20000, i, j;
    double best = INFINITY;

    for (i = 0; i <= steps; i++) {
        for (j = fake.engine.sides.count > 1 ? i : steps; j <= steps; j++) {
            double theta[2] = {LOW + (HIGH - LOW) * i / steps, LOW + (HIGH - LOW) * j / steps};

            best = fmin(best, fake.value(&fake, theta));
        }
    }
    return best;
}

static inline int contains(uint32_t outer, uint32_t inner)
{
    return side(&fake, outer, 0) <= side(&fake, inner, 0) && side(&fake, outer, 1) >= side(&fake, inner, 1);
}

/* The smallest box around a point must be a leaf: a split that lost a child leaves its parent the smallest. */
static inline void check_cover(uint64_t seed, int points)
{
    struct brdffit_test_random random = {seed};
    int lobes = fake.engine.sides.count, i;
    size_t j;

    for (i = 0; i < points; i++) {
        double x = brdffit_test_uniform(&random, LOW, HIGH), y = brdffit_test_uniform(&random, LOW, HIGH), area;
        double t[2] = {lobes > 1 ? fmin(x, y) : x, lobes > 1 ? fmax(x, y) : x}, smallest = INFINITY;
        uint32_t leaf[2] = {0, 0};

        for (j = 0; j < fake.records; j++) {
            const uint32_t *r = fake.record[j];
            uint32_t second = lobes > 1 ? r[1] : r[0];

            area = fake_width(&fake, 0, r[0]) * fake_width(&fake, 0, second);
            if (area < smallest && side(&fake, r[0], 0) <= t[0] && t[0] <= side(&fake, r[0], 1) &&
                side(&fake, second, 0) <= t[1] && t[1] <= side(&fake, second, 1)) {
                smallest = area;
                leaf[0] = r[0];
                leaf[1] = second;
            }
        }
        assert_true(smallest < INFINITY);
        for (j = 0; j < fake.records; j++) {
            const uint32_t *r = fake.record[j];
            uint32_t second = lobes > 1 ? r[1] : r[0];

            assert_false(contains(leaf[0], r[0]) && contains(leaf[1], second) &&
                         (r[0] != leaf[0] || second != leaf[1]));
        }
    }
}

#endif
