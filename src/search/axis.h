/*
 * One axis of the search, shared by every lobe: a binary tree of intervals over a coordinate (ln s), and the
 * nodes where intervals meet. Intervals and nodes are small integers, so that engines keep what they compute
 * about them in plain arrays, once for all boxes. Knows nothing of BRDFs.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_AXIS_H
#define BRDFFIT_AXIS_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/point.h"

struct axis_interval {
    uint32_t low, high; /* nodes */
    uint32_t child;     /* first of two consecutive children; 0: not split yet */
};

struct axis {
    struct axis_interval *interval;
    double *coordinate; /* of each node */
    uint32_t intervals, nodes;
    uint32_t node_capacity;
    uint32_t lent; /* of these, the last so many are lent, level by level, where a search goes depth first */
    uint32_t first; /* intervals 0 .. first - 1 are the first partition, ascending */
};

/* Intervals that can come from `nodes` nodes: one per gap of the first partition, two more per later node. */
#define AXIS_INTERVALS(nodes) (2u * (size_t)(nodes))

void brdffit_axis_layout(struct axis *axis, struct arena *arena, uint32_t node_capacity);

/* The ends of an interval. */
static inline void brdffit_axis_ends(const struct axis *axis, uint32_t interval, double *low, double *high)
{
    *low = axis->coordinate[axis->interval[interval].low];
    *high = axis->coordinate[axis->interval[interval].high];
}

/* Partition [low, high] evenly into `first` intervals (1 when low == high: a single degenerate one). */
void brdffit_axis_start(struct axis *axis, double low, double high, uint32_t first);

/* First child of an interval, splitting it if needed; 0 when the axis is full or the interval too narrow. */
uint32_t brdffit_axis_split(struct axis *axis, uint32_t interval);

/* Keep nodes for `levels` levels of a search that goes depth first; at most the capacity but 2. Before the start. */
void brdffit_axis_reserve(struct axis *axis, uint32_t levels);

/*
 * As brdffit_axis_split(), but into two intervals and a node that belong to `level`: the next call with that level makes
 * others of them, and whoever knows something about them must forget it. 0 when there is no such level, too.
 */
uint32_t brdffit_axis_lend(struct axis *axis, uint32_t interval, uint32_t level, uint32_t *node);

/* Whether an interval is a lent one. */
int brdffit_axis_is_lent(const struct axis *axis, uint32_t interval);

/* Whether an interval is too narrow to be split in floating point. */
int brdffit_axis_narrow(const struct axis *axis, uint32_t interval);

#endif
