/*
 * brdffit_io_read_sums() and brdffit_io_samples(). SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "io/bytes/bytes.h"
#include "base/environment.h"
#include "base/intake.h"
#include "io/fail.h"
#include "io/bytes/gzip.h"
#include "io/bytes/map.h"
#include "io/merl/merl.h"
#include "io/options.h"
#include "io/bytes/source.h"
#include "io/table.h"
#include "io/unpack.h"

static int is_merl(const unsigned char *data, size_t size)
{
    struct merl merl;

    return brdffit_io_merl_open(data, size, &merl, NULL) == BRDFFIT_OK;
}

/* The options of the fit, NULL for the defaults; 0 when they cannot be understood. */
static int take_fit(const brdffit_options *fit, brdffit_options *own)
{
    brdffit_options_init(own);
    return !fit || intake(own, sizeof *own, INTAKE_LEAST(brdffit_options, box_user), fit);
}

/* Whether a MERL table would be fitted from sums; of which lobes there are sums the core says (sum_content). */
static int wants_sums(const brdffit_io_options *io, const brdffit_options *fit)
{
    return io->format != BRDFFIT_IO_FORMAT_CSV && !brdffit_io_wants_text(io) &&
           io->merl_sampling == BRDFFIT_IO_MERL_TABLE && fit->norm == BRDFFIT_NORM_L2 &&
           fit->engine == BRDFFIT_ENGINE_MOMENT;
}

ENVIRONMENT_APART static brdffit_status samples_again(brdffit_table *table, brdffit_error *error)
{
    struct io_table *whole = (struct io_table *)(void *)table, *again;
    struct io_table swap;
    brdffit_status status;

    if (!table) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "table is NULL");
    }
    if (!whole->map.data && !whole->bytes.data) {
        return BRDFFIT_OK; /* samples are what it has */
    }
    again = brdffit_io_table_new();
    if (!again) {
        return brdffit_io_no_memory(error);
    }
    status = brdffit_io_merl_read(whole->map.data ? whole->map.data : whole->bytes.data,
                                  whole->map.data ? whole->map.size : whole->bytes.size, &whole->options, again, error);
    if (status == BRDFFIT_OK) {
        again->open.compressed = table->compressed;
        swap = *whole;
        *whole = *again;
        *again = swap;
        brdffit_io_table_connect(whole);
        brdffit_io_table_connect(again);
    }
    brdffit_io_free(&again->open);
    return status;
}

/* Content of `map` or `bytes`, which the table takes over, as sums; or as samples where sums will not do. */
static brdffit_status sum_content(struct io_map *map, struct io_bytes *bytes, const brdffit_io_options *io,
                                  const brdffit_options *fit, brdffit_table **out, brdffit_error *error)
{
    struct io_table *table = brdffit_io_table_new();
    brdffit_status status;

    if (!table) {
        brdffit_io_unmap(map);
        brdffit_io_bytes_free(bytes);
        return brdffit_io_no_memory(error);
    }
    table->map = *map;
    table->bytes = *bytes;
    table->options = *io;
    status = brdffit_io_merl_sum(map->data ? map->data : bytes->data, map->data ? map->size : bytes->size, io, fit,
                                 table, error);
    if (status == BRDFFIT_ERR_UNSUPPORTED) {
        status = samples_again(&table->open, error);
    }
    if (status != BRDFFIT_OK) {
        brdffit_io_free(&table->open);
        return status;
    }
    *out = &table->open;
    return BRDFFIT_OK;
}

/* Content that is not a MERL table as it is: gzip is looked through. Takes over `bytes`; or they are somebody else's. */
static brdffit_status sum_bytes(struct io_bytes *bytes, const unsigned char *data, size_t size,
                                const brdffit_io_options *io, const brdffit_options *fit, brdffit_table **out,
                                brdffit_error *error)
{
    struct io_bytes unpacked = {NULL, 0, 0};
    struct io_map none = {NULL, 0, 0};
    brdffit_status status;

    if (!brdffit_io_is_gzip(data, size)) {
        status = brdffit_io_parse(data, size, io, out, error);
        brdffit_io_bytes_free(bytes);
        return status;
    }
    status = brdffit_io_unpack(data, size, io, &unpacked, error);
    brdffit_io_bytes_free(bytes);
    if (status == BRDFFIT_OK && is_merl(unpacked.data, unpacked.size)) {
        status = sum_content(&none, &unpacked, io, fit, out, error);
    } else {
        if (status == BRDFFIT_OK) {
            status = brdffit_io_parse(unpacked.data, unpacked.size, io, out, error);
        }
        brdffit_io_bytes_free(&unpacked);
    }
    if (status == BRDFFIT_OK) {
        (*out)->compressed = 1;
    }
    return status;
}

/* What cannot be mapped, or is no MERL table as it is. */
static brdffit_status read_content(const char *path, const brdffit_io_options *io, const brdffit_options *fit,
                                   brdffit_table **out, brdffit_error *error)
{
    struct io_bytes bytes = {NULL, 0, 0};
    struct io_map none = {NULL, 0, 0};
    brdffit_status status = brdffit_io_source_read(path, brdffit_io_file_limit(io), &bytes, error);

    if (status != BRDFFIT_OK) {
        brdffit_io_bytes_free(&bytes);
        return status;
    }
    return is_merl(bytes.data, bytes.size) ? sum_content(&none, &bytes, io, fit, out, error)
                                           : sum_bytes(&bytes, bytes.data, bytes.size, io, fit, out, error);
}

ENVIRONMENT_APART static brdffit_status read_sums(const char *path, const brdffit_io_options *options,
                                                  const brdffit_options *fit, brdffit_table **table,
                                                  brdffit_error *error)
{
    struct io_bytes none = {NULL, 0, 0};
    brdffit_io_options checked;
    brdffit_options known;
    struct io_map map;

    if (!table || !path || !take_fit(fit, &known) || brdffit_io_options_check(options, &checked, NULL) != BRDFFIT_OK ||
        !wants_sums(&checked, &known)) {
        return brdffit_io_read(path, options, table, error);
    }
    *table = NULL;
    if (!brdffit_io_map(path, brdffit_io_file_limit(&checked), &map)) {
        return read_content(path, &checked, &known, table, error);
    }
    if (is_merl(map.data, map.size)) {
        return sum_content(&map, &none, &checked, &known, table, error);
    }
    brdffit_io_unmap(&map);
    return read_content(path, &checked, &known, table, error);
}

ENVIRONMENT_APART static brdffit_status read_sums_memory(const void *data, size_t size,
                                                         const brdffit_io_options *options, const brdffit_options *fit,
                                                         brdffit_table **table, brdffit_error *error)
{
    struct io_map map = {data, size, 1};
    struct io_bytes none = {NULL, 0, 0};
    brdffit_io_options checked;
    brdffit_options known;

    if (!table || !data || !take_fit(fit, &known) || brdffit_io_options_check(options, &checked, NULL) != BRDFFIT_OK ||
        size > brdffit_io_file_limit(&checked) || !wants_sums(&checked, &known)) {
        return brdffit_io_read_memory(data, size, options, table, error);
    }
    *table = NULL;
    return is_merl(data, size) ? sum_content(&map, &none, &checked, &known, table, error)
                               : sum_bytes(&none, data, size, &checked, &known, table, error);
}

brdffit_status brdffit_io_read_sums(const char *path, const brdffit_io_options *options, const brdffit_options *fit,
                                    brdffit_table **table, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = read_sums(path, options, fit, table, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_io_read_sums_memory(const void *data, size_t size, const brdffit_io_options *options,
                                           const brdffit_options *fit, brdffit_table **table, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = read_sums_memory(data, size, options, fit, table, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_io_samples(brdffit_table *table, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = samples_again(table, error);
    brdffit_environment_leave(&callers);
    return status;
}
