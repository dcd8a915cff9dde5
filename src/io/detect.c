/*
 * What kind of file is it: see detect.h. SPDX-License-Identifier: MIT
 *
 * A table whose size is exactly what its first twelve bytes say is MERL. Otherwise control bytes near the start
 * make the file binary, that is MERL that something happened to, unless the twelve bytes of its header could be
 * the start of a line of text: then it is text with bad bytes in it, and the line that holds them gets named.
 */
#include "io/detect.h"

#include <string.h>

#include "io/csv/unicode.h"
#include "io/fail.h"
#include "io/bytes/gzip.h"
#include "io/limits.h"
#include "io/merl/merl.h"

static int is_control(unsigned char c)
{
    return (c < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f') || c == 0x7f;
}

static int has_control(const unsigned char *data, size_t size)
{
    size_t i;

    for (i = 0; i < size; i++) {
        if (is_control(data[i])) {
            return 1;
        }
    }
    return 0;
}

static int is_zip(const unsigned char *data, size_t size)
{
    return size >= 4 && memcmp(data, "PK\3\4", 4) == 0;
}

brdffit_status brdffit_io_detect(const unsigned char *data, size_t size, brdffit_io_format *format,
                                 brdffit_error *error)
{
    size_t probe = size < IO_TEXT_PROBE ? size : IO_TEXT_PROBE;
    size_t header = size < MERL_HEADER ? size : MERL_HEADER;
    struct merl merl;

    *format = BRDFFIT_IO_FORMAT_MERL;
    if (brdffit_io_merl_open(data, size, &merl, NULL) == BRDFFIT_OK) {
        return BRDFFIT_OK;
    }
    if (brdffit_io_is_gzip(data, size)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the file was compressed with gzip twice");
    }
    if (is_zip(data, size)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT,
                               "the file is a spreadsheet (xlsx, ods) or another zip archive: save the sheet as CSV");
    }
    if (brdffit_io_utf16(data, size) != IO_UTF16_NOT || !has_control(data, probe) || !has_control(data, header)) {
        *format = BRDFFIT_IO_FORMAT_CSV;
        return BRDFFIT_OK;
    }
    if (size >= MERL_HEADER && !brdffit_io_merl_plausible(data)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT,
                               "the file is neither a text table nor a MERL .binary (its first 12 bytes are not the "
                               "dimensions of a table)");
    }
    return BRDFFIT_OK;
}
