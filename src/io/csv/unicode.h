/*
 * Text as bytes of UTF-8 with plain signs and blanks. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_UNICODE_H
#define BRDFFIT_IO_UNICODE_H

#include "io/bytes/bytes.h"

enum io_utf16 { IO_UTF16_NOT = 0, IO_UTF16_LITTLE, IO_UTF16_BIG };

/* By its mark, or without one by the zeros of every other byte. */
enum io_utf16 brdffit_io_utf16(const unsigned char *data, size_t size);

/* What was done to a text. */
struct io_plain {
    enum io_utf16 utf16;
    size_t minus;  /* minus signs and dashes of Unicode that became '-' */
    size_t blanks; /* no-break and other blanks that became ' ', marks without width that went */
};

/*
 * The text as UTF-8 without a byte-order mark, such signs replaced, into `out`; left empty where the data are that already
 * but for a mark, which the caller skips. Lines stay lines. 0: no memory.
 */
int brdffit_io_plain(const unsigned char *data, size_t size, struct io_bytes *out, struct io_plain *done);

#endif
