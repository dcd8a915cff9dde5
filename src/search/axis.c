/*
 * The search axis: see axis.h. SPDX-License-Identifier: MIT
 */
#include "search/axis.h"

#include <math.h>

#include "base/tolerance.h"

void brdffit_axis_layout(struct axis *axis, struct arena *arena, uint32_t node_capacity)
{
    axis->node_capacity = node_capacity;
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
    double low = axis->coordinate[axis->interval[interval].low];
    double high = axis->coordinate[axis->interval[interval].high];

    return !(high - low > LIMIT_SPLIT * (1.0 + fabs(low) + fabs(high)));
}

uint32_t brdffit_axis_split(struct axis *axis, uint32_t interval)
{
    struct axis_interval *parent = &axis->interval[interval];
    struct axis_interval *child;
    uint32_t middle = axis->nodes;

    if (parent->child) {
        return parent->child;
    }
    if (axis->nodes >= axis->node_capacity || brdffit_axis_narrow(axis, interval)) {
        return 0;
    }
    axis->coordinate[middle] = 0.5 * (axis->coordinate[parent->low] + axis->coordinate[parent->high]);
    axis->nodes++;
    parent->child = axis->intervals;
    child = &axis->interval[axis->intervals];
    axis->intervals += 2;
    child[0].low = parent->low;
    child[0].high = middle;
    child[0].child = 0;
    child[1].low = middle;
    child[1].high = parent->high;
    child[1].child = 0;
    return parent->child;
}
