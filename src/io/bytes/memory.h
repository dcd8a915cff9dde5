/*
 * The only allocations of libbrdffit_io, zlib's included. SPDX-License-Identifier: MIT
 *
 * A test that compiles memory.c itself with BRDFFIT_TEST_ALLOC defined gets a variant that counts live blocks
 * and fails the allocation of its choice; the rest of the library links against it unchanged.
 */
#ifndef BRDFFIT_IO_MEMORY_H
#define BRDFFIT_IO_MEMORY_H

#include <stddef.h>

/* NULL on failure and when count * size overflows; at least one byte, so NULL always means failure. */
void *brdffit_io_alloc(size_t count, size_t size);

/* The same, all bytes zero. */
void *brdffit_io_alloc_zero(size_t count, size_t size);

/* Change the size of a block (NULL: a new one). On failure the old block stays as it was. */
void *brdffit_io_resize(void *block, size_t count, size_t size);

void brdffit_io_release(void *block);

#ifdef BRDFFIT_TEST_ALLOC
/* Fail the allocation after `successes` more (negative: never), and count what is live. */
void brdffit_io_test_fail_after(long successes);
size_t brdffit_io_test_live(void);
#endif

#endif
