/*
 * A growing buffer of bytes. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_BYTES_H
#define BRDFFIT_IO_BYTES_H

#include <stddef.h>

struct io_bytes {
    unsigned char *data;
    size_t size;
    size_t capacity;
};

/* Make room for at least one more byte, doubling, up to `limit` bytes in all. 0: no memory, or full. */
int brdffit_io_bytes_grow(struct io_bytes *bytes, size_t limit);

/* Room for `capacity` bytes in all. 0: no memory. */
int brdffit_io_bytes_reserve(struct io_bytes *bytes, size_t capacity);

void brdffit_io_bytes_free(struct io_bytes *bytes);

#endif
