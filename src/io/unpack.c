/*
 * A gzip stream as far as the options and its own content allow: see unpack.h. SPDX-License-Identifier: MIT
 *
 * A MERL table says in its first bytes how long it is, so that nothing beyond that is unpacked. A text does not, and has
 * the limit of the options alone.
 */
#include "io/unpack.h"

#include "io/bytes/gzip.h"
#include "io/detect.h"
#include "io/fail.h"
#include "io/limits.h"
#include "io/merl/merl.h"
#include "io/options.h"

/* *bytes: of the table that the first bytes are of; 0: of none. Fails when they are of nothing that can be read. */
static brdffit_status promised(const struct io_bytes *start, const brdffit_io_options *options, uint64_t *bytes,
                               brdffit_error *error)
{
    brdffit_io_format format = options->format;
    brdffit_status status = BRDFFIT_OK;

    if (format == BRDFFIT_IO_FORMAT_AUTO) {
        status = brdffit_io_detect(start->data, start->size, &format, error);
    }
    *bytes = format == BRDFFIT_IO_FORMAT_MERL ? brdffit_io_merl_bytes(start->data) : 0;
    return status;
}

brdffit_status brdffit_io_unpack(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                 struct io_bytes *out, brdffit_error *error)
{
    struct io_gzip_limit limit = {brdffit_io_unpacked_limit(options),
                                  "the gzip file unpacks to more than the limit (max_bytes) in bytes"};
    const struct io_gzip_limit probe = {IO_TEXT_PROBE, NULL};
    struct io_bytes start = {NULL, 0, 0};
    brdffit_status status = brdffit_io_gunzip(data, size, &probe, &start, error);
    uint64_t bytes = 0;

    if (status == BRDFFIT_OK && start.size <= probe.bytes) { /* that was all */
        *out = start;
        return BRDFFIT_OK;
    }
    if (status == BRDFFIT_OK) {
        status = promised(&start, options, &bytes, error);
    }
    brdffit_io_bytes_free(&start);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (bytes > 0 && bytes < limit.bytes) {
        limit.bytes = (size_t)bytes;
        limit.message = "the MERL file is longer than its header says (value: bytes expected)";
    }
    return brdffit_io_gunzip(data, size, &limit, out, error);
}
