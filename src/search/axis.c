/*
 * The search axis: see axis.h. SPDX-License-Identifier: MIT
 */
#include "search/axis.h"

#include <math.h>

#include "base/tolerance.h"

void brdffit_axis_layout(struct axis *axis, struct arena *arena, uint32_t node_capacity)
{
    axis->node_capacity = node_capacity;
    axis->lent = 0;
    axis->coordinate = ARENA_DOUBLES(arena, node_capacity);
    axis->interval = brdffit_arena_take(arena, AXIS_INTERVALS(node_capacity), sizeof *axis->interval);
}

void brdffit_axis_start(struct axis *axis, double low, double high, uint32_t first)
{
    uint32_t i;

    if (!(low < high)) {
        first = 1;
    }
    axis->first = first;
    axis->intervals = first;
    axis->nodes = first + 1;
    for (i = 0; i <= first; i++) {
        axis->coordinate[i] = i == first ? high : low + (high - low) * ((double)i / first);
    }
    for (i = 0; i < first; i++) {
        axis->interval[i].low = i;
        axis->interval[i].high = i + 1;
        axis->interval[i].child = 0;
    }
}

int brdffit_axis_narrow(const struct axis *axis, uint32_t interval)
{
    double low, high;

    brdffit_axis_ends(axis, interval, &low, &high);
    return !(high - low > LIMIT_SPLIT * (1.0 + fabs(low) + fabs(high)));
}

void brdffit_axis_reserve(struct axis *axis, uint32_t levels)
{
    axis->lent = levels + 2 < axis->node_capacity ? levels : axis->node_capacity > 2 ? axis->node_capacity - 2 : 0;
}

/* Place of the intervals of a level, from the end: they come in pairs, and pairs of nodes are too many by far. */
static uint32_t lent_interval(const struct axis *axis, uint32_t level)
{
    return (uint32_t)AXIS_INTERVALS(axis->node_capacity) - 2 * (axis->lent - level);
}

int brdffit_axis_is_lent(const struct axis *axis, uint32_t interval)
{
    return axis->lent > 0 && interval >= lent_interval(axis, 0);
}

/* Halves of an interval, at `child` and the one after, with a node in between. */
static void halve(struct axis *axis, uint32_t interval, uint32_t child, uint32_t middle)
{
    const struct axis_interval parent = axis->interval[interval];

    axis->coordinate[middle] = 0.5 * (axis->coordinate[parent.low] + axis->coordinate[parent.high]);
    axis->interval[child].low = parent.low;
    axis->interval[child].high = middle;
    axis->interval[child].child = 0;
    axis->interval[child + 1].low = middle;
    axis->interval[child + 1].high = parent.high;
    axis->interval[child + 1].child = 0;
}

uint32_t brdffit_axis_split(struct axis *axis, uint32_t interval)
{
    struct axis_interval *parent = &axis->interval[interval];

    if (parent->child) {
        return parent->child;
    }
    if (axis->nodes >= axis->node_capacity - axis->lent || brdffit_axis_narrow(axis, interval)) {
        return 0;
    }
    halve(axis, interval, axis->intervals, axis->nodes);
    parent->child = axis->intervals;
    axis->intervals += 2;
    axis->nodes++;
    return parent->child;
}

uint32_t brdffit_axis_lend(struct axis *axis, uint32_t interval, uint32_t level, uint32_t *node)
{
    if (level >= axis->lent || brdffit_axis_narrow(axis, interval)) {
        return 0;
    }
    *node = axis->node_capacity - axis->lent + level;
    halve(axis, interval, lent_interval(axis, level), *node);
    return lent_interval(axis, level);
}
