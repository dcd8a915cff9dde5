/*
 * A growing buffer of bytes: see bytes.h. SPDX-License-Identifier: MIT
 */
#include "io/bytes/bytes.h"

#include "io/limits.h"
#include "io/bytes/memory.h"

int brdffit_io_bytes_reserve(struct io_bytes *bytes, size_t capacity)
{
    unsigned char *data;

    if (capacity <= bytes->capacity) {
        return 1;
    }
    data = brdffit_io_resize(bytes->data, capacity, 1);
    if (!data) {
        return 0;
    }
    bytes->data = data;
    bytes->capacity = capacity;
    return 1;
}

int brdffit_io_bytes_grow(struct io_bytes *bytes, size_t limit)
{
    size_t capacity = bytes->capacity;

    if (bytes->size < capacity) {
        return 1;
    }
    if (capacity >= limit) {
        return 0;
    }
    if (capacity > limit / 2) {
        capacity = limit;
    } else {
        capacity = capacity < IO_FIRST_BUFFER / 2 ? IO_FIRST_BUFFER : 2 * capacity;
    }
    return brdffit_io_bytes_reserve(bytes, capacity < limit ? capacity : limit);
}

void brdffit_io_bytes_free(struct io_bytes *bytes)
{
    brdffit_io_release(bytes->data);
    bytes->data = NULL;
    bytes->size = 0;
    bytes->capacity = 0;
}
