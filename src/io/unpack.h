/*
 * A gzip stream as far as the options and its own content allow. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_UNPACK_H
#define BRDFFIT_IO_UNPACK_H

#include "brdffit_io.h"
#include "io/bytes/bytes.h"

/* `out` starts empty; the caller frees it, on failure too. */
brdffit_status brdffit_io_unpack(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                 struct io_bytes *out, brdffit_error *error);

#endif
