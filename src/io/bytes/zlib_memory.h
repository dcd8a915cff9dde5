/*
 * zlib's allocations through memory.h. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_ZLIB_MEMORY_H
#define BRDFFIT_IO_ZLIB_MEMORY_H

#include <string.h>
#include <zlib.h>

#include "io/bytes/memory.h"

static inline void *brdffit_io_zlib_alloc(void *unused, unsigned count, unsigned size)
{
    (void)unused;
    return brdffit_io_alloc(count, size);
}

static inline void brdffit_io_zlib_free(void *unused, void *block)
{
    (void)unused;
    brdffit_io_release(block);
}

/* Zeroed, but for the allocator. */
static inline void brdffit_io_zlib_start(z_stream *stream)
{
    memset(stream, 0, sizeof *stream);
    stream->zalloc = brdffit_io_zlib_alloc;
    stream->zfree = brdffit_io_zlib_free;
}

#endif
