/*
 * gzip streams in memory. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_GZIP_H
#define BRDFFIT_IO_GZIP_H

#include "brdffit.h"
#include "io/bytes/bytes.h"

/* 1 when the data start with gzip's two magic bytes. */
int brdffit_io_is_gzip(const unsigned char *data, size_t size);

/*
 * Unpack every member of a gzip file (concatenated members are legal). `out` starts empty; the caller frees
 * it, on failure too. More than `limit` bytes is a failure.
 */
brdffit_status brdffit_io_gunzip(const unsigned char *data, size_t size, size_t limit, struct io_bytes *out,
                                 brdffit_error *error);

#endif
