/*
 * Marks on the entries of a table: which have been computed. All are off at first, at no cost: only those up to the largest
 * index that was ever asked for are looked at, and cleared then. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MARKS_H
#define BRDFFIT_MARKS_H

#include <string.h>

#include "base/arena.h"

struct marks {
    unsigned char *on;
    size_t known, capacity;
};

static inline void marks_layout(struct marks *m, struct arena *arena, size_t capacity)
{
    m->on = brdffit_arena_take(arena, capacity, 1);
    m->capacity = capacity;
    m->known = 0;
}

static inline void marks_start(struct marks *m)
{
    m->known = 0;
}

/* Whether `index` was marked before; it is afterwards. */
static inline int marks_set(struct marks *m, size_t index)
{
    int before;

    if (index >= m->known) {
        size_t to = index + 64 < m->capacity ? index + 64 : m->capacity;

        memset(m->on + m->known, 0, to - m->known);
        m->known = to;
    }
    before = m->on[index];
    m->on[index] = 1;
    return before;
}

static inline void marks_clear(struct marks *m, size_t index)
{
    if (index < m->known) {
        m->on[index] = 0;
    }
}

#endif
