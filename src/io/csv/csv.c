/*
 * Text tables: see csv.h and, for the format, brdffit_io.h. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include "io/csv/csv.h"

#include <locale.h>
#include <string.h>

#include "io/csv/csv_header.h"
#include "io/csv/csv_row.h"
#include "io/fail.h"
#include "io/limits.h"

static void open_arrays(const struct csv_layout *layout, struct io_table *table)
{
    if (layout->kind == CSV_COEFFICIENTS) {
        table->samples.form = BRDFFIT_FORM_COEFFICIENTS;
        table->width[IO_A] = 1;
        table->width[IO_B] = 1;
        table->width[IO_C] = 1;
    } else {
        table->samples.form = BRDFFIT_FORM_DIRECTIONS;
        table->width[IO_LIGHT] = 3;
        table->width[IO_VIEW] = 3;
        table->width[IO_NORMAL] = brdffit_io_csv_has(layout, CSV_NX) ? 3 : 0;
    }
    table->width[IO_WEIGHTS] = brdffit_io_csv_has(layout, CSV_WEIGHT) || brdffit_io_csv_has(layout, CSV_UNCERTAINTY);
    table->with_lines = 1;
}

static brdffit_status choose_quantity(const struct csv_layout *layout, const brdffit_io_options *options,
                                      struct io_table *table, brdffit_error *error)
{
    int coefficients = layout->kind == CSV_COEFFICIENTS;

    table->samples.quantity = coefficients ? BRDFFIT_QUANTITY_RADIANCE : BRDFFIT_QUANTITY_BRDF;
    if (!options->quantity_set) {
        return BRDFFIT_OK;
    }
    if (coefficients && options->quantity != BRDFFIT_QUANTITY_RADIANCE) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION,
                               "a table of a, b, c holds radiance: there is no n.l to turn f_r into it");
    }
    table->samples.quantity = options->quantity;
    return BRDFFIT_OK;
}

static brdffit_status rows(struct io_lines *lines, const struct csv_layout *layout, const void *c_locale,
                           struct io_table *table, brdffit_error *error)
{
    struct io_field line;

    while (brdffit_io_next_line(lines, &line)) {
        size_t count = table->samples.count;
        brdffit_status status;

        if (count == table->capacity &&
            !brdffit_io_table_reserve(table, count < IO_FIRST_ROWS ? IO_FIRST_ROWS : 2 * count)) {
            return brdffit_io_no_memory(error);
        }
        table->open.rows++;
        status = brdffit_io_csv_row(&line, lines->line, layout, c_locale, table, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
    }
    if (table->open.rows == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_NO_SAMPLES, "there are no data lines below the header");
    }
    if (table->samples.count == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every data line has an empty channel field");
    }
    return BRDFFIT_OK;
}

static brdffit_status body(struct io_lines *lines, const struct csv_layout *layout, struct io_table *table,
                           brdffit_error *error)
{
    locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    brdffit_status status;

    if (!c_locale) {
        return brdffit_io_no_memory(error);
    }
    status = rows(lines, layout, &c_locale, table, error);
    freelocale(c_locale);
    return status;
}

static void skip_mark(struct io_lines *lines)
{
    if (lines->end - lines->at >= 3 && memcmp(lines->at, "\xef\xbb\xbf", 3) == 0) {
        lines->at += 3;
    }
}

brdffit_status brdffit_io_csv_read(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                   struct io_table *table, brdffit_error *error)
{
    struct io_lines lines = {(const char *)data, (const char *)data + size, 0};
    struct csv_layout layout;
    struct io_field header;
    brdffit_status status;

    memset(&layout, 0, sizeof layout);
    layout.directions_only = options->directions_only;
    table->open.format = BRDFFIT_IO_FORMAT_CSV;
    skip_mark(&lines);
    if (!brdffit_io_next_line(&lines, &header)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "there is no header line");
    }
    status = brdffit_io_csv_header(&header, lines.line, &layout, table, error);
    if (status == BRDFFIT_OK) {
        status = choose_quantity(&layout, options, table, error);
    }
    if (status == BRDFFIT_OK) {
        open_arrays(&layout, table);
        status = body(&lines, &layout, table, error);
    }
    brdffit_io_csv_layout_free(&layout);
    if (status == BRDFFIT_OK) {
        brdffit_io_table_publish(table);
    }
    return status;
}
