/*
 * Filling in brdffit_error for the file readers. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_FAIL_H
#define BRDFFIT_IO_FAIL_H

#include "base/ieee.h"
#include "brdffit.h"

/* Where; members that do not apply hold BRDFFIT_NONE. */
struct io_place {
    size_t sample, channel, line, column;
};

#define IO_NOWHERE {BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_NONE}

/* All return `status`; `error` may be NULL. */
brdffit_status brdffit_io_fail(brdffit_error *error, brdffit_status status, const char *message);
brdffit_status brdffit_io_fail_value(brdffit_error *error, brdffit_status status, const char *message, double value);
brdffit_status brdffit_io_fail_at(brdffit_error *error, brdffit_status status, const char *message,
                                  const struct io_place *place, double value);

/* Text from a file, printable, at most `size` - 1 bytes, cut with "..." where it is longer. Bytes that are not UTF-8 become
 * '?', as control characters do. Returns `out`. */
const char *brdffit_io_quote(const char *text, size_t length, char *out, size_t size);

/* Shorthand for the commonest of all. */
brdffit_status brdffit_io_no_memory(brdffit_error *error);

#endif
