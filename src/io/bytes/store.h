/*
 * Bytes at any place of a file or of memory. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_STORE_H
#define BRDFFIT_IO_STORE_H

#include <stddef.h>
#include <stdint.h>

#include "brdffit.h"

/* Zero-initialise with descriptor -1. Reading changes nothing: threads may share it. */
struct io_store {
    int descriptor;              /* -1: memory */
    const unsigned char *memory;
    void *owned;                 /* released with the store; NULL: the caller's memory */
    uint64_t size;
};

/* A regular file. */
brdffit_status brdffit_io_store_open(const char *path, struct io_store *store, brdffit_error *error);

void brdffit_io_store_memory(const void *data, size_t size, struct io_store *store);
void brdffit_io_store_close(struct io_store *store);

/* Exactly `size` bytes from `offset`; the caller knows that they are inside. */
brdffit_status brdffit_io_store_read(const struct io_store *store, uint64_t offset, void *out, size_t size,
                                     brdffit_error *error);

#endif
