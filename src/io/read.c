/*
 * brdffit_io_read() and brdffit_io_read_memory(). SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "io/bytes/bytes.h"
#include "io/csv/csv.h"
#include "io/detect.h"
#include "base/environment.h"
#include "io/fail.h"
#include "io/bytes/gzip.h"
#include "io/merl/merl.h"
#include "io/options.h"
#include "io/bytes/source.h"
#include "io/table.h"
#include "io/unpack.h"

/* Unpacked content into a new table, in the default floating-point environment. */
ENVIRONMENT_APART static brdffit_status parse_there(const unsigned char *data, size_t size,
                                                    const brdffit_io_options *options, brdffit_table **out,
                                                    brdffit_error *error)
{
    brdffit_io_format format = options->format;
    brdffit_status status = BRDFFIT_OK;
    struct io_table *table;

    if (size == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the file is empty");
    }
    if (format == BRDFFIT_IO_FORMAT_AUTO) {
        status = brdffit_io_detect(data, size, &format, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (format == BRDFFIT_IO_FORMAT_MERL && brdffit_io_wants_text(options)) {
        return brdffit_io_fail(
            error, BRDFFIT_ERR_OPTION,
            "a MERL table holds f_r of known directions: channels, columns, missing and saturated values, "
            "directions and ccbrdf or reflectance-factor are for text");
    }
    table = brdffit_io_table_new();
    if (!table) {
        return brdffit_io_no_memory(error);
    }
    switch (format) { /* no default: the compiler names a format that nobody reads */
    case BRDFFIT_IO_FORMAT_CSV: status = brdffit_io_csv_read(data, size, options, table, error); break;
    case BRDFFIT_IO_FORMAT_MERL: status = brdffit_io_merl_read(data, size, options, table, error); break;
    case BRDFFIT_IO_FORMAT_AUTO: break; /* brdffit_io_detect() has found one */
    }
    if (status != BRDFFIT_OK) {
        brdffit_io_free(&table->open);
        return status;
    }
    *out = &table->open;
    return BRDFFIT_OK;
}

/* Decimal numbers and angles round to nearest whatever the caller's rounding mode is. */
brdffit_status brdffit_io_parse(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                brdffit_table **out, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = parse_there(data, size, options, out, error);
    brdffit_environment_leave(&callers);
    return status;
}

/* Content as it came: gzip is looked through. `owner`, when given, holds the data and is freed early. */
static brdffit_status unpack_and_parse(const unsigned char *data, size_t size, struct io_bytes *owner,
                                       const brdffit_io_options *options, brdffit_table **out, brdffit_error *error)
{
    struct io_bytes unpacked = {NULL, 0, 0};
    brdffit_status status;

    if (!brdffit_io_is_gzip(data, size)) {
        return brdffit_io_parse(data, size, options, out, error);
    }
    status = brdffit_io_unpack(data, size, options, &unpacked, error);
    if (owner) {
        brdffit_io_bytes_free(owner);
    }
    if (status == BRDFFIT_OK) {
        status = brdffit_io_parse(unpacked.data, unpacked.size, options, out, error);
    }
    if (status == BRDFFIT_OK) {
        (*out)->compressed = 1;
    }
    brdffit_io_bytes_free(&unpacked);
    return status;
}

brdffit_status brdffit_io_read(const char *path, const brdffit_io_options *options, brdffit_table **table,
                               brdffit_error *error)
{
    struct io_bytes bytes = {NULL, 0, 0};
    brdffit_io_options checked;
    brdffit_status status;

    if (!table || !path) {
        if (table) {
            *table = NULL;
        }
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "reading a file: path or table is NULL");
    }
    *table = NULL;
    status = brdffit_io_options_check(options, &checked, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_io_source_read(path, brdffit_io_file_limit(&checked), &bytes, error);
    }
    if (status == BRDFFIT_OK) {
        status = unpack_and_parse(bytes.data, bytes.size, &bytes, &checked, table, error);
    }
    brdffit_io_bytes_free(&bytes);
    return status;
}

brdffit_status brdffit_io_read_memory(const void *data, size_t size, const brdffit_io_options *options,
                                      brdffit_table **table, brdffit_error *error)
{
    brdffit_io_options checked;
    brdffit_status status;

    if (!table || (!data && size > 0)) {
        if (table) {
            *table = NULL;
        }
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "reading from memory: data or table is NULL");
    }
    *table = NULL;
    status = brdffit_io_options_check(options, &checked, error);
    if (status == BRDFFIT_OK && size > brdffit_io_file_limit(&checked)) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT,
                                     "the data are larger than the limit (max_bytes) in bytes",
                                     (double)brdffit_io_file_limit(&checked));
    }
    return status == BRDFFIT_OK ? unpack_and_parse(data, size, NULL, &checked, table, error) : status;
}
