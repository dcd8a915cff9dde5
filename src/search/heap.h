/*
 * Boxes that are still open, ordered by (bound, sequence number): a binary heap in the caller's memory.
 * A box is one interval per side. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_HEAP_H
#define BRDFFIT_HEAP_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/point.h"

struct box {
    double bound;         /* lower bound of the objective inside */
    uint64_t sequence;    /* breaks ties, so that runs are reproducible */
    uint32_t split;       /* side that the engine advises to split */
    uint32_t interval[SIDES_MOST]; /* of each side's axis; 0 beyond the sides of the model */
};

struct heap {
    struct box *box;
    size_t count, capacity;
};

void brdffit_heap_layout(struct heap *heap, struct arena *arena, size_t capacity);

/* 0 when the heap is full. */
int brdffit_heap_push(struct heap *heap, const struct box *box);

/* Remove and return the lowest; the heap must not be empty. */
struct box brdffit_heap_pop(struct heap *heap);

#endif
