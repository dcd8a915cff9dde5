/*
 * A whole file, pipe or standard input into memory. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_SOURCE_H
#define BRDFFIT_IO_SOURCE_H

#include <stdint.h>

#include "brdffit.h"
#include "io/bytes/bytes.h"

/*
 * Read `path` ("-": standard input) to its end. `out` starts empty; the caller frees it, on failure too.
 * errno is left as the caller had it, unless the system refused for a reason that no message here names.
 */
brdffit_status brdffit_io_source_read(const char *path, size_t limit, struct io_bytes *out, brdffit_error *error);

/* Open a regular file for reading at any place, and tell its size. errno as above. */
brdffit_status brdffit_io_source_open(const char *path, int *descriptor, uint64_t *size, brdffit_error *error);

#endif
