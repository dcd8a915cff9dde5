/*
 * Text tables: see csv.h and, for the format, brdffit_io.h. SPDX-License-Identifier: MIT
 *
 *     bytes -> unicode -> header (fields, words, roles, layout) -> survey -> rows (cell) -> pivot -> suspicions
 *
 * Each step understands what it can and notes it in the table, or refuses; none guesses in silence.
 */
#define _POSIX_C_SOURCE 200809L
#include "io/csv/csv.h"

#include <locale.h>
#include <string.h>

#include "io/bytes/memory.h"
#include "io/csv/csv_row.h"
#include "io/csv/header.h"
#include "io/csv/pivot.h"
#include "io/csv/survey.h"
#include "io/csv/suspect.h"
#include "io/csv/unicode.h"
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
        table->width[IO_TANGENT] = brdffit_io_csv_has(layout, CSV_TX) ? 3 : 0;
    }
    table->width[IO_WEIGHTS] = brdffit_io_csv_has(layout, CSV_WEIGHT) || brdffit_io_csv_has(layout, CSV_UNCERTAINTY);
    table->with_lines = 1;
}

static brdffit_status choose_quantity(const struct csv_layout *layout, const brdffit_io_options *options,
                                      struct io_table *table, brdffit_error *error)
{
    int coefficients = layout->kind == CSV_COEFFICIENTS;

    table->samples.quantity = coefficients ? BRDFFIT_QUANTITY_RADIANCE : BRDFFIT_QUANTITY_BRDF;
    if (coefficients && (options->values != BRDFFIT_IO_VALUES_PLAIN ||
                         (options->quantity_set && options->quantity != BRDFFIT_QUANTITY_RADIANCE))) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION,
                               "a table of a, b, c holds radiance: there is no n.l to turn f_r into it");
    }
    if (options->quantity_set) {
        table->samples.quantity = options->quantity;
    }
    return BRDFFIT_OK;
}

/* ---- Rows ---------------------------------------------------------------- */

static int reserve(struct csv_reader *r)
{
    struct io_table *table = r->table;
    const size_t count = table->samples.count, rows = count < IO_FIRST_ROWS ? IO_FIRST_ROWS : 2 * count;

    if (count < table->capacity) {
        return 1;
    }
    if (brdffit_io_csv_has(r->layout, CSV_WAVELENGTH)) {
        double *moved = brdffit_io_resize(r->wavelength, rows, sizeof *moved);

        if (!moved) {
            return 0;
        }
        r->wavelength = moved;
    }
    return brdffit_io_table_reserve(table, rows);
}

static brdffit_status read_rows(struct csv_reader *r, struct io_lines *lines)
{
    struct io_field line;

    while (brdffit_io_next_line(lines, &line)) {
        brdffit_status status;

        if (!reserve(r)) {
            return brdffit_io_no_memory(r->error);
        }
        r->line = lines->line;
        status = brdffit_io_csv_row(r, &line);
        if (status != BRDFFIT_OK) {
            return status;
        }
    }
    if (r->table->open.rows == 0) {
        return brdffit_io_fail(r->error, BRDFFIT_ERR_NO_SAMPLES, "there are no data lines below the header");
    }
    if (r->table->samples.count == 0) {
        return brdffit_io_fail(
            r->error, BRDFFIT_ERR_NO_SAMPLES,
            r->table->dropped[BRDFFIT_IO_DROP_SATURATED] > 0
                ? "every data line is without a value or saturated"
                : "every data line has an empty channel field, or one that says that there is no value");
    }
    return BRDFFIT_OK;
}

/* 1,234 can be a decimal comma only where another number shows that commas are. */
static brdffit_status settle_commas(const struct csv_reader *r)
{
    if (r->writing.commas == 0 && r->writing.unclear > 0) {
        brdffit_io_fault(r->layout->options, &r->unclear_text);
        return brdffit_io_fail_at(r->error, BRDFFIT_ERR_VALUE,
                                  "a decimal comma, or one that parts thousands? write numbers with a decimal point",
                                  &r->unclear, 0.0);
    }
    return BRDFFIT_OK;
}

/* ---- What is said -------------------------------------------------------- */

static void note_count(struct io_table *table, size_t count, const char *what)
{
    if (count > 0) {
        brdffit_io_table_note(table, 0, what, count, count == 1 ? "" : "s");
    }
}

static void note_writing(const struct csv_reader *r)
{
    if (r->writing.commas > 0) {
        brdffit_io_table_note(r->table, 0, "numbers are written with a decimal comma");
    }
    note_count(r->table, r->missing, "%zu row%s without a value (NA, NaN or the like) left out");
    note_count(r->table, r->azimuths, "%zu azimuth%s without a value at a polar angle of 0, where it means nothing");
    note_count(r->table, r->writing.degrees, "%zu number%s with a degree sign");
    note_count(r->table, r->writing.percents, "%zu number%s with a percent sign taken as hundredths");
    note_count(r->table, r->longer, "%zu line%s with empty fields beyond the header's");
    note_count(r->table, r->headers, "%zu line%s that repeat the header skipped");
    note_count(r->table, r->polar_signed, "%zu negative polar angle%s taken as on the other side of the normal");
}

/* "theta_i = Incident angle", for names that are not the role's own. */
static void note_roles(const struct csv_layout *layout, struct io_table *table)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        const enum csv_role role = layout->meaning[j].role;
        const char *own = role < CSV_ROLE_COUNT ? brdffit_io_role_name(role) : "";
        const struct io_field name = layout->names[j];
        char quoted[IO_QUOTED];
        size_t length = 0;

        while (length < name.length && !strchr("([{", name.text[length])) {
            length++;
        }
        if (*own && role != CSV_WEIGHT && role != CSV_UNCERTAINTY && !brdffit_io_same_name(&name, own, strlen(own)) &&
            !(length > 0 && brdffit_io_same_name(&(struct io_field){name.text, length, 0}, own, strlen(own)))) {
            brdffit_io_table_note(table, 0, "column %s is taken as %s", brdffit_io_column_name(layout, j, quoted), own);
        }
        if (role == CSV_CHANNEL && layout->meaning[j].unit == UNIT_PERCENT) {
            brdffit_io_table_note(table, 0, "column %s is in percent, and divided by 100",
                                  brdffit_io_column_name(layout, j, quoted));
        }
    }
}

/* Channels whose names say that they are no f_r, which they are taken for. */
static void note_values(const struct csv_layout *layout, struct io_table *table)
{
    const brdffit_io_options *o = layout->options;
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        const char *values = layout->meaning[j].role == CSV_CHANNEL ? brdffit_io_names_values(&layout->names[j]) : NULL;
        char quoted[IO_QUOTED];

        if (values && !o->quantity_set && o->values == BRDFFIT_IO_VALUES_PLAIN && layout->kind != CSV_COEFFICIENTS) {
            brdffit_io_table_note(table, 1,
                                  "column %s is taken as f_r, though its name says something else (--values %s)",
                                  brdffit_io_column_name(layout, j, quoted), values);
        }
    }
}

static void note_frame(const struct csv_layout *layout, struct io_table *table)
{
    const enum csv_role first = layout->kind == CSV_HALF_ANGLES ? CSV_THETA_H : CSV_THETA_I;

    if (layout->kind == CSV_ANGLES && brdffit_io_csv_has(layout, CSV_PHI)) {
        brdffit_io_table_note(table, 0, "one azimuth: that between light and viewer, with the mirror direction at %d",
                              layout->options->directions_as & BRDFFIT_IO_MIRROR_AT_ZERO ? 0 : 180);
    } else if (layout->kind == CSV_ANGLES && brdffit_io_csv_has(layout, CSV_PHI_O) &&
               !brdffit_io_csv_has(layout, CSV_PHI_I)) {
        brdffit_io_table_note(table, 0, "no azimuth of the light: it is taken as 0");
    }
    if (brdffit_io_csv_has(layout, first) && layout->meaning[layout->column[first]].unit == UNIT_RADIANS) {
        brdffit_io_table_note(table, 0, "angles are in radians, as their names or units say");
    }
    if (brdffit_io_csv_has(layout, first) && layout->meaning[layout->column[first]].elevation) {
        brdffit_io_table_note(table, 0, "polar angles count from the surface, as their names say");
    }
}

/* ---- The whole ----------------------------------------------------------- */

static brdffit_status finish(struct csv_reader *r)
{
    brdffit_status status = settle_commas(r);

    if (status == BRDFFIT_OK && r->wavelength) {
        status = brdffit_io_csv_pivot(r);
    }
    if (status == BRDFFIT_OK && r->table->samples.count == 0) {
        return brdffit_io_fail(r->error, BRDFFIT_ERR_NO_SAMPLES, "no directions have a value of every wavelength");
    }
    if (status == BRDFFIT_OK) {
        note_writing(r);
        status = brdffit_io_suspect_values(r);
    }
    return status == BRDFFIT_OK ? brdffit_io_suspect_directions(r) : status;
}

static brdffit_status body(struct io_lines *lines, struct csv_layout *layout, const void *c_locale,
                           struct io_table *table, brdffit_error *error)
{
    struct csv_reader reader;
    brdffit_status status = brdffit_io_csv_survey(*lines, layout, c_locale, table, error);

    memset(&reader, 0, sizeof reader);
    reader.layout = layout;
    reader.table = table;
    reader.c_locale = c_locale;
    reader.error = error;
    if (status == BRDFFIT_OK) {
        status = choose_quantity(layout, layout->options, table, error);
    }
    if (status == BRDFFIT_OK) {
        note_roles(layout, table);
        note_frame(layout, table);
        note_values(layout, table);
        open_arrays(layout, table);
        status = read_rows(&reader, lines);
    }
    if (status == BRDFFIT_OK) {
        status = finish(&reader);
    }
    brdffit_io_release(reader.wavelength);
    return status;
}

static brdffit_status read_lines(struct io_lines *lines, struct csv_layout *layout, struct io_table *table,
                                 brdffit_error *error)
{
    brdffit_status status = brdffit_io_csv_header(lines, layout, table, error);
    locale_t c_locale;

    if (status != BRDFFIT_OK) {
        return status;
    }
    c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!c_locale) {
        return brdffit_io_no_memory(error);
    }
    status = body(lines, layout, &c_locale, table, error);
    freelocale(c_locale);
    return status;
}

static void note_plain(const struct io_plain *done, struct io_table *table)
{
    if (done->utf16 != IO_UTF16_NOT) {
        brdffit_io_table_note(table, 0, "the text is UTF-16");
    }
    note_count(table, done->minus, "%zu dash or minus sign%s of Unicode taken as -");
    note_count(table, done->blanks, "%zu no-break or other blank%s of Unicode taken as plain");
}

/* Text without a mark, as UTF-8. */
static brdffit_status read_text(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                struct io_table *table, brdffit_error *error)
{
    const size_t mark = size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    struct io_lines lines = {(const char *)data + mark, (const char *)data + size, 0};
    struct csv_layout layout;
    brdffit_status status;

    memset(&layout, 0, sizeof layout);
    layout.options = options;
    status = read_lines(&lines, &layout, table, error);
    brdffit_io_layout_free(&layout);
    if (status == BRDFFIT_OK && table->notes_failed) {
        status = brdffit_io_no_memory(error);
    }
    if (status == BRDFFIT_OK) {
        brdffit_io_table_publish(table);
    }
    if (status == BRDFFIT_OK && options->fault && options->fault_size > 0) {
        options->fault[0] = '\0';
    }
    return status;
}

brdffit_status brdffit_io_csv_read(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                   struct io_table *table, brdffit_error *error)
{
    struct io_bytes plain = {NULL, 0, 0};
    struct io_plain done;
    brdffit_status status = BRDFFIT_OK;

    table->open.format = BRDFFIT_IO_FORMAT_CSV;
    if (!brdffit_io_plain(data, size, &plain, &done)) {
        brdffit_io_bytes_free(&plain);
        return brdffit_io_no_memory(error);
    }
    note_plain(&done, table);
    status = read_text(plain.data ? plain.data : data, plain.data ? plain.size : size, options, table, error);
    brdffit_io_bytes_free(&plain);
    return status;
}
