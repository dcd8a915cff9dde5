/*
 * Binary heap of boxes: see heap.h. SPDX-License-Identifier: MIT
 */
#include "search/heap.h"

static int before(const struct box *p, const struct box *q)
{
    if (p->bound < q->bound) {
        return 1;
    }
    return p->bound == q->bound && p->sequence < q->sequence;
}

void brdffit_heap_layout(struct heap *heap, struct arena *arena, size_t capacity)
{
    heap->box = brdffit_arena_take(arena, capacity, sizeof *heap->box);
    heap->capacity = capacity;
    heap->count = 0;
}

int brdffit_heap_push(struct heap *heap, const struct box *box)
{
    size_t i = heap->count;

    if (heap->count == heap->capacity) {
        return 0;
    }
    heap->count++;
    while (i > 0 && before(box, &heap->box[(i - 1) / 2])) {
        heap->box[i] = heap->box[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    heap->box[i] = *box;
    return 1;
}

struct box brdffit_heap_pop(struct heap *heap)
{
    struct box top = heap->box[0];
    struct box last = heap->box[--heap->count];
    size_t i = 0;

    for (;;) {
        size_t child = 2 * i + 1;

        if (child >= heap->count) {
            break;
        }
        if (child + 1 < heap->count && before(&heap->box[child + 1], &heap->box[child])) {
            child++;
        }
        if (!before(&heap->box[child], &last)) {
            break;
        }
        heap->box[i] = heap->box[child];
        i = child;
    }
    heap->box[i] = last;
    return top;
}
