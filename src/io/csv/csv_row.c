/*
 * One data line: see csv_row.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/csv_row.h"

#include <math.h>
#include <string.h>

#include "io/csv/csv_directions.h"
#include "io/csv/csv_weight.h"
#include "io/fail.h"

#define PI 3.14159265358979323846

struct row {
    struct csv_reader *reader;
    size_t sample;
    double value[CSV_ROLE_COUNT];
    size_t channels_missing; /* of this row */
    size_t role_missing;     /* a column with a role that has no value, or BRDFFIT_NONE */
    size_t roles_missing;    /* how many there are */
    int missing, saturated, negative;
};

static brdffit_status fail_field(const struct row *row, size_t column, size_t channel, brdffit_status status,
                                 const char *message, double value)
{
    struct io_place place = IO_NOWHERE;

    place.sample = row->sample;
    place.channel = channel;
    place.line = row->reader->line;
    place.column = column == BRDFFIT_NONE ? column : column + 1;
    if (column < row->reader->layout->columns) {
        brdffit_io_fault(row->reader->layout->options, &row->reader->layout->fields[column]);
    }
    return brdffit_io_fail_at(row->reader->error, status, message, &place, value);
}

static brdffit_status fail_role(const struct row *row, enum csv_role role, const char *message)
{
    return fail_field(row, row->reader->layout->column[role], BRDFFIT_NONE, BRDFFIT_ERR_VALUE, message,
                      row->value[role]);
}

static brdffit_status fail_number(const struct row *row, size_t column, size_t channel, enum io_number fault,
                                  double value)
{
    const char *message = "the field is not a number";

    switch (fault) {
    case IO_NUMBER_INFINITE: message = "the number is infinite"; break;
    case IO_NUMBER_OVERFLOW: message = "the number is too large"; break;
    case IO_NUMBER_HEXADECIMAL: message = "hexadecimal numbers are not read: write it in decimal"; break;
    case IO_NUMBER_NO_MEMORY: return brdffit_io_no_memory(row->reader->error);
    default: break;
    }
    return fail_field(row, column, channel, BRDFFIT_ERR_VALUE, message, value);
}

static brdffit_status fail_cell(const struct row *row, size_t column, size_t channel, enum io_cell cell,
                                enum io_number fault, double value)
{
    if (cell == IO_CELL_THOUSANDS) {
        return fail_field(row, column, channel, BRDFFIT_ERR_VALUE,
                          "thousands separators are not read: write the number without them", 0.0);
    }
    if (cell == IO_CELL_MIXED) {
        return fail_field(row, column, channel, BRDFFIT_ERR_VALUE,
                          "decimal commas and decimal points in one file: write all numbers one way", 0.0);
    }
    return fail_number(row, column, channel, fault, value);
}

static brdffit_status fail_split(const struct row *row, enum io_split split, size_t field)
{
    return fail_field(
        row, field - 1, BRDFFIT_NONE, BRDFFIT_ERR_FORMAT,
        split == IO_SPLIT_UNTERMINATED ? "a quote is not closed on its line" : "text follows a closing quote", 0.0);
}

/* ---- Numbers ------------------------------------------------------------- */

static void remember_unclear(struct row *row, size_t column, size_t before)
{
    struct csv_reader *r = row->reader;

    if (before == 0 && r->writing.unclear > 0) {
        r->unclear.sample = r->unclear.channel = BRDFFIT_NONE;
        r->unclear.line = r->line;
        r->unclear.column = column + 1;
        r->unclear_text = r->layout->fields[column];
    }
}

static int is_missing(const brdffit_io_options *options, double value)
{
    return (options->missing == BRDFFIT_IO_MISSING_VALUE && value == options->missing_value) ||
           (options->missing == BRDFFIT_IO_MISSING_NEGATIVE && value < 0.0);
}

static void take_value(struct row *row, size_t column, size_t k, enum io_cell cell, double value)
{
    const struct csv_layout *layout = row->reader->layout;
    const brdffit_io_options *options = layout->options;
    const double scale = layout->meaning[column].unit == UNIT_PERCENT ? 0.01 : 1.0;

    if (cell != IO_CELL_NUMBER || is_missing(options, value)) {
        row->channels_missing++;
        row->missing |= cell != IO_CELL_EMPTY;
        return;
    }
    row->saturated |= options->saturated > 0.0 && value >= options->saturated;
    row->negative |= value < 0.0;
    row->reader->table->array[IO_VALUES][row->sample * layout->channels + k] = value * scale;
}

/* Numbers of the line: directions and weight into row->value, channels into their place in the table. */
static brdffit_status numbers(struct row *row)
{
    struct csv_reader *r = row->reader;
    size_t j, k = 0;

    row->role_missing = BRDFFIT_NONE;
    for (j = 0; j < r->layout->columns; j++) {
        const enum csv_role role = r->layout->meaning[j].role;
        const int is_channel = role == CSV_CHANNEL;
        const size_t before = r->writing.unclear;
        enum io_number fault;
        enum io_cell cell;
        double value;

        if (role > CSV_CHANNEL) {
            continue;
        }
        cell = brdffit_io_cell(&r->layout->fields[j], r->c_locale, &r->writing, &value, &fault);
        remember_unclear(row, j, before);
        if (cell > IO_CELL_MISSING) {
            return fail_cell(row, j, is_channel ? k : BRDFFIT_NONE, cell, fault, value);
        }
        if (is_channel) {
            take_value(row, j, k++, cell, value);
        } else if (cell != IO_CELL_NUMBER) {
            row->role_missing = row->role_missing == BRDFFIT_NONE ? j : row->role_missing;
            row->roles_missing++;
        } else {
            row->value[role] = value;
        }
    }
    return BRDFFIT_OK;
}

/* At the normal an azimuth means nothing, and instruments leave it out: it is 0 there. Others stay missing. */
static void settle_azimuth(struct row *row)
{
    static const struct {
        enum csv_role azimuth, polar, other;
    } pairs[] = {{CSV_PHI_I, CSV_THETA_I, CSV_THETA_I},
                 {CSV_PHI_O, CSV_THETA_O, CSV_THETA_O},
                 {CSV_PHI, CSV_THETA_I, CSV_THETA_O}};
    const struct csv_layout *layout = row->reader->layout;
    size_t i;

    for (i = 0; i < sizeof pairs / sizeof *pairs && layout->kind == CSV_ANGLES && row->roles_missing == 1; i++) {
        if (layout->column[pairs[i].azimuth] == row->role_missing &&
            (row->value[pairs[i].polar] == 0.0 || row->value[pairs[i].other] == 0.0)) {
            row->role_missing = BRDFFIT_NONE;
            row->reader->azimuths++;
            return;
        }
    }
}

/* ---- What becomes of them ------------------------------------------------ */

/* What turns the values of a sample into f_r: of ccbrdf 1 / n.v, 1 below the horizon, where no fit uses it. */
static double to_brdf(const struct row *row)
{
    const struct io_table *table = row->reader->table;

    switch (row->reader->layout->options->values) {
    case BRDFFIT_IO_VALUES_REFLECTANCE_FACTOR: return 1.0 / PI;
    case BRDFFIT_IO_VALUES_CCBRDF: {
        const double cosine = brdffit_io_csv_cosine(table, IO_VIEW, row->sample);

        return cosine > 0.0 ? 1.0 / cosine : 1.0;
    }
    case BRDFFIT_IO_VALUES_PLAIN: break;
    }
    return 1.0;
}

static void convert_values(struct row *row, double factor)
{
    const size_t channels = row->reader->layout->channels;
    double *values = row->reader->table->array[IO_VALUES] + row->sample * channels;
    size_t k;

    for (k = 0; k < channels && factor != 1.0; k++) {
        values[k] *= factor;
    }
}

/* After the directions: the weight of an uncertainty of f_r depends on them. */
static brdffit_status store_weight(struct row *row, double factor)
{
    const struct csv_reader *r = row->reader;
    double weight = 1.0;

    if (brdffit_io_csv_has(r->layout, CSV_WEIGHT)) {
        weight = row->value[CSV_WEIGHT];
        if (!(weight >= 0.0)) {
            return fail_role(row, CSV_WEIGHT, "the weight is negative");
        }
    }
    if (brdffit_io_csv_has(r->layout, CSV_UNCERTAINTY)) {
        if (!(row->value[CSV_UNCERTAINTY] > 0.0)) {
            return fail_role(row, CSV_UNCERTAINTY, "the uncertainty is not above 0");
        }
        if (!brdffit_io_csv_weight(r->table, row->sample, row->value[CSV_UNCERTAINTY] * factor, &weight)) {
            return fail_role(row, CSV_UNCERTAINTY, "the uncertainty is too small or too large for a weight");
        }
    }
    if (r->table->width[IO_WEIGHTS]) {
        r->table->array[IO_WEIGHTS][row->sample] = weight;
    }
    return BRDFFIT_OK;
}

static brdffit_status store(struct row *row)
{
    enum csv_role role;
    const char *fault = brdffit_io_csv_store(row->reader, row->sample, row->value, &role);
    double factor;
    brdffit_status status;

    if (fault) {
        return fail_role(row, role, fault);
    }
    factor = to_brdf(row);
    status = store_weight(row, factor);
    if (status == BRDFFIT_OK && row->channels_missing == 0) {
        convert_values(row, factor);
    }
    return status;
}

static int is_blank(const struct csv_layout *layout, size_t found)
{
    size_t j;

    for (j = 0; j < found && j < layout->columns; j++) {
        if (layout->fields[j].length > 0) {
            return 0;
        }
    }
    return 1;
}

/* Fields beyond those of the header: harmless when all are empty, as spreadsheets leave them. */
static int only_empty_beyond(const struct io_field *line, const struct csv_layout *layout, size_t found)
{
    const char *end = line->text + line->length,
               *last = layout->fields[layout->columns - 1].text + layout->fields[layout->columns - 1].length;

    (void)found;
    last += layout->fields[layout->columns - 1].quoted;
    for (; last < end; last++) {
        if (*last != layout->separator && *last != ' ' && *last != '\t' && *last != '"') {
            return 0;
        }
    }
    return 1;
}

/* Fields that are not there: fine where nothing is expected. */
static int only_ignored_beyond(const struct csv_layout *layout, size_t found)
{
    for (; found < layout->columns; found++) {
        if (layout->meaning[found].role <= CSV_CHANNEL) {
            return 0;
        }
    }
    return 1;
}

static brdffit_status check_count(struct row *row, const struct io_field *line, size_t found)
{
    struct csv_reader *r = row->reader;

    if (found > r->layout->columns && !only_empty_beyond(line, r->layout, found)) {
        return fail_field(row, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_ERR_FORMAT,
                          "the line has more fields than the header (value: fields found)", (double)found);
    }
    if (found < r->layout->columns && !only_ignored_beyond(r->layout, found)) {
        return fail_field(row, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_ERR_FORMAT,
                          "the line has fewer fields than the header (value: fields found)", (double)found);
    }
    r->longer += found > r->layout->columns;
    return BRDFFIT_OK;
}

static int repeats_header(const struct csv_layout *layout, const struct io_field *line)
{
    return line->length == layout->header.length && memcmp(line->text, layout->header.text, line->length) == 0;
}

/* A row that becomes no sample is a count. */
static void append(struct row *row)
{
    struct csv_reader *r = row->reader;
    struct io_table *table = r->table;

    if (row->channels_missing > 0) {
        table->dropped[BRDFFIT_IO_DROP_ABSENT]++;
        r->missing += (size_t)row->missing;
        return;
    }
    if (row->saturated) {
        table->dropped[BRDFFIT_IO_DROP_SATURATED]++;
        return;
    }
    if (r->wavelength) {
        r->wavelength[row->sample] = row->value[CSV_WAVELENGTH];
    }
    table->open.negative += (size_t)row->negative;
    table->open.lines[row->sample] = r->line;
    table->samples.count++;
}

brdffit_status brdffit_io_csv_row(struct csv_reader *reader, const struct io_field *line)
{
    const struct csv_layout *layout = reader->layout;
    struct row row;
    size_t found;
    enum io_split split = brdffit_io_split(line, layout->separator, layout->fields, layout->columns, &found);
    brdffit_status status;

    memset(&row, 0, sizeof row);
    row.reader = reader;
    row.sample = reader->table->samples.count;
    if (split != IO_SPLIT_OK) {
        return fail_split(&row, split, found);
    }
    if (is_blank(layout, found)) {
        return BRDFFIT_OK;
    }
    if (repeats_header(layout, line)) {
        reader->headers++;
        return BRDFFIT_OK;
    }
    reader->table->open.rows++;
    status = check_count(&row, line, found);
    if (status == BRDFFIT_OK) {
        status = numbers(&row);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    settle_azimuth(&row);
    if (row.role_missing != BRDFFIT_NONE && (row.channels_missing == 0 || row.channels_missing < layout->channels)) {
        return fail_field(&row, row.role_missing, BRDFFIT_NONE, BRDFFIT_ERR_VALUE,
                          "the field is empty, or says that there is no value", 0.0);
    }
    if (row.role_missing == BRDFFIT_NONE) {
        status = store(&row);
    }
    if (status == BRDFFIT_OK) {
        append(&row);
    }
    return status;
}
