/*
 * Bytes at any place of a file or of memory: see store.h. SPDX-License-Identifier: MIT
 *
 * pread(2) rather than a mapping, which would turn a file that shrinks meanwhile, or a disk that fails, into a
 * signal. It has no position to share, so that threads need no lock.
 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "io/bytes/store.h"

#include <errno.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#include "io/fail.h"
#include "io/bytes/memory.h"
#include "io/bytes/source.h"

/* Largest single request; some systems refuse more than INT_MAX. */
#define CHUNK ((size_t)1 << 30)

brdffit_status brdffit_io_store_open(const char *path, struct io_store *store, brdffit_error *error)
{
    store->memory = NULL;
    store->owned = NULL;
    return brdffit_io_source_open(path, &store->descriptor, &store->size, error);
}

void brdffit_io_store_memory(const void *data, size_t size, struct io_store *store)
{
    store->descriptor = -1;
    store->memory = data;
    store->owned = NULL;
    store->size = size;
}

void brdffit_io_store_close(struct io_store *store)
{
    if (store->descriptor >= 0) {
        (void)close(store->descriptor);
    }
    brdffit_io_release(store->owned);
    store->descriptor = -1;
    store->memory = NULL;
    store->owned = NULL;
}

brdffit_status brdffit_io_store_read(const struct io_store *store, uint64_t offset, void *out, size_t size,
                                     brdffit_error *error)
{
    unsigned char *to = out;

    if (store->descriptor < 0) {
        memcpy(to, store->memory + offset, size);
        return BRDFFIT_OK;
    }
    while (size > 0) {
        ssize_t got = pread(store->descriptor, to, size < CHUNK ? size : CHUNK, (off_t)offset);

        if (got == 0) {
            return brdffit_io_fail_value(error, BRDFFIT_ERR_READ,
                                         "the file became shorter while it was read (value: it ends before byte)",
                                         (double)offset + (double)size);
        }
        if (got > 0) {
            to += got;
            offset += (uint64_t)got;
            size -= (size_t)got;
        } else if (errno != EINTR) {
            return brdffit_io_fail_value(error, BRDFFIT_ERR_READ, "reading the file failed (value: at byte)",
                                         (double)offset);
        }
    }
    return BRDFFIT_OK;
}
