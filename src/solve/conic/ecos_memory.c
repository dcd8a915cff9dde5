/*
 * ECOS's memory: see ecos_memory.h. SPDX-License-Identifier: MIT
 *
 * ECOS, AMD and LDL call malloc where no argument can say for whom, and go on with what it returns. So a call of theirs
 * belongs to its thread; each block hangs in a list; and where there is no memory, the call is left by longjmp. Nothing
 * of ours stands between (ECOS calls nobody back), and all that it held is in the list.
 */
#include "solve/conic/ecos_memory.h"

#ifndef BRDFFIT_NO_ECOS /* the Makefile leaves this file out then; who compiles all of src may not */

#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Before each block; as long as the strictest alignment asks for. */
struct ecos_block {
    struct ecos_block *next, **link;
    max_align_t data[];
};

#define ALIGNMENT (sizeof(max_align_t))

static _Thread_local struct ecos_memory *current;

int brdffit_ecos_memory_call(struct ecos_memory *memory, void (*call)(void *argument), void *argument)
{
    jmp_buf way_out;

    memory->way_out = &way_out;
    memory->scratch_used = 0;
    current = memory; /* calls do not nest */
    if (setjmp(way_out) != 0) {
        current = NULL;
        return 0;
    }
    call(argument);
    current = NULL;
    return 1;
}

void brdffit_ecos_memory_release(struct ecos_memory *memory)
{
    while (memory->first) {
        struct ecos_block *next = memory->first->next;

        free(memory->first);
        memory->first = next;
    }
}

static void *from_scratch(struct ecos_memory *memory, size_t size)
{
    const size_t rounded = size <= memory->scratch_size ? (size / ALIGNMENT + 1) * ALIGNMENT : SIZE_MAX;
    void *block;

    if (rounded > memory->scratch_size - memory->scratch_used) {
        return NULL;
    }
    block = memory->scratch + memory->scratch_used;
    memory->scratch_used += rounded;
    return block;
}

static int in_scratch(const struct ecos_memory *memory, const void *block)
{
    const uintptr_t at = (uintptr_t)block, start = (uintptr_t)memory->scratch;

    return at >= start && at - start < memory->scratch_size;
}

void *brdffit_ecos_malloc(size_t size)
{
    struct ecos_memory *const memory = current;
    void *taken = from_scratch(memory, size);
    struct ecos_block *block;

    if (taken) {
        return taken;
    }
    block = size < SIZE_MAX - sizeof *block ? malloc(sizeof *block + size) : NULL;
    if (!block) {
        longjmp(*(jmp_buf *)memory->way_out, 1);
    }
    block->next = memory->first;
    block->link = &memory->first;
    if (block->next) {
        block->next->link = &block->next;
    }
    memory->first = block;
    return block->data;
}

void *brdffit_ecos_calloc(size_t count, size_t size)
{
    const size_t bytes = size == 0 || count <= SIZE_MAX / size ? count * size : SIZE_MAX;
    void *block = brdffit_ecos_malloc(bytes);

    memset(block, 0, bytes);
    return block;
}

void brdffit_ecos_free(void *data)
{
    struct ecos_block *block;

    if (!data || in_scratch(current, data)) {
        return;
    }
    block = (struct ecos_block *)(void *)((unsigned char *)data - offsetof(struct ecos_block, data));
    *block->link = block->next;
    if (block->next) {
        block->next->link = block->link;
    }
    free(block);
}

#endif
