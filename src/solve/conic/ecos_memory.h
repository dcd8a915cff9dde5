/*
 * ECOS's memory: it does not check its mallocs, so none of them may fail. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_ECOS_MEMORY_H
#define BRDFFIT_ECOS_MEMORY_H

#include <stddef.h>

struct ecos_block;

/* Zero-initialise. What ECOS holds; `scratch`, where given, is the caller's, for what a call takes and releases again. */
struct ecos_memory {
    struct ecos_block *first;
    unsigned char *scratch;
    size_t scratch_size, scratch_used;
    void *way_out; /* of the call that is on */
};

/* call(argument), in which ECOS may run. 0: memory ran out, and the call was left where it was: what it worked on is good
 * for nothing but brdffit_ecos_memory_release(). */
int brdffit_ecos_memory_call(struct ecos_memory *memory, void (*call)(void *argument), void *argument);

/* Everything that ECOS holds, without asking it. */
void brdffit_ecos_memory_release(struct ecos_memory *memory);

/* What malloc, calloc and free are in ECOS's sources (the Makefile's ECOS_FLAGS). */
void *brdffit_ecos_malloc(size_t size);
void *brdffit_ecos_calloc(size_t count, size_t size);
void brdffit_ecos_free(void *block);

#endif
