/*
 * gzip streams in memory. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_GZIP_H
#define BRDFFIT_IO_GZIP_H

#include "brdffit.h"
#include "io/bytes/bytes.h"

/* 1 when the data start with gzip's two magic bytes. */
int brdffit_io_is_gzip(const unsigned char *data, size_t size);

/* How far to unpack. More is BRDFFIT_ERR_FORMAT with `message` and the bytes; NULL: it is left packed. */
struct io_gzip_limit {
    size_t bytes;
    const char *message;
};

/*
 * Unpack every member of a gzip file (concatenated members are legal). `out` starts empty; the caller frees
 * it, on failure too. Where more was left packed, `out` has at least a byte more than the limit.
 */
brdffit_status brdffit_io_gunzip(const unsigned char *data, size_t size, const struct io_gzip_limit *limit,
                                 struct io_bytes *out, brdffit_error *error);

#endif
