/*
 * Bump allocator over the caller's workspace. The same layout code runs twice: with base NULL it only
 * counts (brdffit_workspace_size), with a base it hands out 64-byte aligned memory.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_ARENA_H
#define BRDFFIT_ARENA_H

#include <stddef.h>

#include "base/ieee.h"

#define ARENA_ALIGNMENT 64u

struct arena {
    unsigned char *base; /* NULL: count only */
    size_t size;
    size_t used;
    int failed; /* overflowed size_t, or the workspace */
};

void brdffit_arena_init(struct arena *arena, void *base, size_t size);

/* count * bytes, aligned; NULL when counting or failed. Contents are undefined. */
void *brdffit_arena_take(struct arena *arena, size_t count, size_t bytes);

#define ARENA_DOUBLES(arena, count) ((double *)brdffit_arena_take((arena), (count), sizeof(double)))

#endif
