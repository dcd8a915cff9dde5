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
    uint32_t first; /* intervals 0 .. first - 1 are the first partition, ascending */
};

/* Intervals that can come from `nodes` nodes: one per gap of the first partition, two more per later node. */
#define AXIS_INTERVALS(nodes) (2u * (size_t)(nodes))

void brdffit_axis_layout(struct axis *axis, struct arena *arena, uint32_t node_capacity);

/* Partition [low, high] evenly into `first` intervals (1 when low == high: a single degenerate one). */
void brdffit_axis_start(struct axis *axis, double low, double high, uint32_t first);

/* First child of an interval, splitting it if needed; 0 when the axis is full or the interval too narrow. */
uint32_t brdffit_axis_split(struct axis *axis, uint32_t interval);

/* Whether an interval is too narrow to be split in floating point. */
int brdffit_axis_narrow(const struct axis *axis, uint32_t interval);

#endif
