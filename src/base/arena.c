/*
 * Bump allocator: see arena.h. SPDX-License-Identifier: MIT
 */
#include "base/arena.h"

#include <stdint.h>

/* Counting starts at ALIGNMENT - 1 so that the size suffices for a base of any alignment. */
void brdffit_arena_init(struct arena *arena, void *base, size_t size)
{
    arena->base = base;
    arena->size = size;
    arena->failed = 0;
    arena->used = ARENA_ALIGNMENT - 1;
    if (base) {
        arena->used = (ARENA_ALIGNMENT - (uintptr_t)base % ARENA_ALIGNMENT) % ARENA_ALIGNMENT;
    }
}

void *brdffit_arena_take(struct arena *arena, size_t count, size_t bytes)
{
    size_t total;
    void *memory;

    if (bytes > 0 && count > (SIZE_MAX - ARENA_ALIGNMENT) / bytes) {
        arena->failed = 1;
        return NULL;
    }
    total = (count * bytes + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
    if (arena->failed || total > SIZE_MAX - arena->used) {
        arena->failed = 1;
        return NULL;
    }
    if (!arena->base) {
        arena->used += total;
        return NULL;
    }
    if (arena->used > arena->size || total > arena->size - arena->used) {
        arena->failed = 1;
        return NULL;
    }
    memory = arena->base + arena->used;
    arena->used += total;
    return memory;
}
