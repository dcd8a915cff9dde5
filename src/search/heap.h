/*
 * Boxes that are still open, ordered by (bound, sequence number): a binary heap in the caller's memory.
 * A box is one interval of the axis per lobe. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_HEAP_H
#define BRDFFIT_HEAP_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

struct box {
    double bound;         /* lower bound of the objective inside */
    uint64_t sequence;    /* breaks ties, so that runs are reproducible */
    uint32_t interval[2]; /* of the axis; the second is 0 for one lobe */
    int split;            /* dimension that the engine advises to split */
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
