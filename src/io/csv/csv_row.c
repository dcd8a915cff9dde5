/*
 * One data line, one sample: see csv_row.h. SPDX-License-Identifier: MIT
 *
 * Every field is checked, also those of a line that an empty channel will drop: a table is sound or it is not.
 */
#include "io/csv/csv_row.h"

#include "io/csv/angle.h"
#include "io/csv/csv_weight.h"
#include "io/fail.h"
#include "io/csv/number.h"

/* What stays the same while one line is read. */
struct row {
    const struct csv_layout *layout;
    struct io_table *table;
    brdffit_error *error;
    const void *c_locale;
    size_t line;
    size_t sample;
    double value[CSV_ROLE_COUNT];
};

static brdffit_status fail_field(const struct row *row, size_t column, size_t channel, brdffit_status status,
                                 const char *message, double value)
{
    struct io_place place = IO_NOWHERE;

    place.sample = row->sample;
    place.channel = channel;
    place.line = row->line;
    place.column = column == BRDFFIT_NONE ? column : column + 1;
    return brdffit_io_fail_at(row->error, status, message, &place, value);
}

static brdffit_status fail_role(const struct row *row, enum csv_role role, const char *message)
{
    return fail_field(row, row->layout->column[role], BRDFFIT_NONE, BRDFFIT_ERR_VALUE, message, row->value[role]);
}

static brdffit_status fail_number(const struct row *row, size_t column, size_t channel, enum io_number fault,
                                  double value)
{
    const char *message = "the field is not a number";

    switch (fault) {
    case IO_NUMBER_NAN:
        message = channel == BRDFFIT_NONE ? "the field is NaN"
                                          : "NaN is not a measurement: leave the field empty if there is none";
        break;
    case IO_NUMBER_INFINITE: message = "the number is infinite"; break;
    case IO_NUMBER_OVERFLOW: message = "the number is too large"; break;
    case IO_NUMBER_HEXADECIMAL: message = "hexadecimal numbers are not read: write it in decimal"; break;
    case IO_NUMBER_DECIMAL_COMMA: message = "a decimal comma: write numbers with a decimal point"; break;
    case IO_NUMBER_EMPTY: message = "the field is empty"; break;
    case IO_NUMBER_NO_MEMORY: return brdffit_io_no_memory(row->error);
    case IO_NUMBER_TEXT:
    case IO_NUMBER_OK: break;
    }
    return fail_field(row, column, channel, BRDFFIT_ERR_VALUE, message, value);
}

static brdffit_status fail_split(const struct row *row, enum io_split split, size_t field)
{
    return fail_field(
        row, field - 1, BRDFFIT_NONE, BRDFFIT_ERR_FORMAT,
        split == IO_SPLIT_UNTERMINATED ? "a quote is not closed on its line" : "text follows a closing quote", 0.0);
}

/* Numbers of the line: directions and weight into row->value, channels into their place in the table. */
static brdffit_status numbers(struct row *row, int *absent, int *negative)
{
    const struct csv_layout *layout = row->layout;
    double *channels = layout->channels > 0 ? row->table->array[IO_VALUES] + row->sample * layout->channels : NULL;
    size_t j, k = 0;

    for (j = 0; j < layout->columns; j++) {
        const struct io_field *field = &layout->fields[j];
        int is_channel = layout->role[j] == CSV_CHANNEL;
        double value;
        enum io_number fault = brdffit_io_number(field->text, field->length, row->c_locale, &value);

        if (is_channel && fault == IO_NUMBER_EMPTY) {
            *absent = 1;
        } else if (fault != IO_NUMBER_OK) {
            return fail_number(row, j, is_channel ? k : BRDFFIT_NONE, fault, value);
        }
        if (is_channel) {
            *negative |= value < 0.0;
            channels[k++] = value;
        } else {
            row->value[layout->role[j]] = value;
        }
    }
    return BRDFFIT_OK;
}

static brdffit_status store_angles(struct row *row)
{
    int with_phi = brdffit_io_csv_has(row->layout, CSV_PHI_I);
    const double *value = row->value;

    if (!(value[CSV_THETA_I] >= 0.0 && value[CSV_THETA_I] <= 180.0)) {
        return fail_role(row, CSV_THETA_I, "theta_i is not in [0, 180] degrees");
    }
    if (!(value[CSV_THETA_O] >= 0.0 && value[CSV_THETA_O] <= 180.0)) {
        return fail_role(row, CSV_THETA_O, "theta_o is not in [0, 180] degrees");
    }
    brdffit_io_direction(value[CSV_THETA_I], with_phi ? value[CSV_PHI_I] : 0.0,
                         row->table->array[IO_LIGHT] + 3 * row->sample);
    brdffit_io_direction(value[CSV_THETA_O], with_phi ? value[CSV_PHI_O] : 180.0,
                         row->table->array[IO_VIEW] + 3 * row->sample);
    return BRDFFIT_OK;
}

static brdffit_status store_vector(struct row *row, enum csv_role first, enum io_array array, const char *message)
{
    const double *value = row->value + first;
    double *out = row->table->array[array] + 3 * row->sample;
    int i;

    if (value[0] == 0.0 && value[1] == 0.0 && value[2] == 0.0) {
        return fail_role(row, first, message);
    }
    for (i = 0; i < 3; i++) {
        out[i] = value[i];
    }
    return BRDFFIT_OK;
}

static brdffit_status store_vectors(struct row *row)
{
    brdffit_status status = store_vector(row, CSV_LX, IO_LIGHT, "lx, ly, lz has no length");

    if (status == BRDFFIT_OK) {
        status = store_vector(row, CSV_VX, IO_VIEW, "vx, vy, vz has no length");
    }
    if (status == BRDFFIT_OK && brdffit_io_csv_has(row->layout, CSV_NX)) {
        status = store_vector(row, CSV_NX, IO_NORMAL, "nx, ny, nz has no length");
    }
    return status;
}

static brdffit_status store_coefficients(struct row *row)
{
    static const char *const message[3] = {"a is negative", "b is negative", "c is negative"};
    int i;

    for (i = 0; i < 3; i++) {
        enum csv_role role = (enum csv_role)(CSV_A + i);

        if (!(row->value[role] >= 0.0)) {
            return fail_role(row, role, message[i]);
        }
        row->table->array[IO_A + i][row->sample] = row->value[role];
    }
    return BRDFFIT_OK;
}

/* After the directions: the weight of an uncertainty of f_r depends on them. */
static brdffit_status store_weight(struct row *row)
{
    double weight = 1.0;

    if (brdffit_io_csv_has(row->layout, CSV_WEIGHT)) {
        weight = row->value[CSV_WEIGHT];
        if (!(weight >= 0.0)) {
            return fail_role(row, CSV_WEIGHT, "the weight is negative");
        }
    }
    if (brdffit_io_csv_has(row->layout, CSV_UNCERTAINTY)) {
        if (!(row->value[CSV_UNCERTAINTY] > 0.0)) {
            return fail_role(row, CSV_UNCERTAINTY, "the uncertainty is not above 0");
        }
        if (!brdffit_io_csv_weight(row->table, row->sample, row->value[CSV_UNCERTAINTY], &weight)) {
            return fail_role(row, CSV_UNCERTAINTY, "the uncertainty is too small or too large for a weight");
        }
    }
    if (row->table->width[IO_WEIGHTS]) {
        row->table->array[IO_WEIGHTS][row->sample] = weight;
    }
    return BRDFFIT_OK;
}

static brdffit_status store_geometry(struct row *row)
{
    switch (row->layout->kind) {
    case CSV_ANGLES: return store_angles(row);
    case CSV_VECTORS: return store_vectors(row);
    case CSV_COEFFICIENTS: break;
    }
    return store_coefficients(row);
}

static brdffit_status store(struct row *row)
{
    brdffit_status status = store_geometry(row);

    return status == BRDFFIT_OK ? store_weight(row) : status;
}

brdffit_status brdffit_io_csv_row(const struct io_field *line, size_t line_number, const struct csv_layout *layout,
                                  const void *c_locale, struct io_table *table, brdffit_error *error)
{
    struct row row;
    size_t found;
    int absent = 0, negative = 0;
    enum io_split split = brdffit_io_split(line, layout->separator, layout->fields, layout->columns, &found);
    brdffit_status status;

    row.layout = layout;
    row.table = table;
    row.error = error;
    row.c_locale = c_locale;
    row.line = line_number;
    row.sample = table->samples.count;
    if (split != IO_SPLIT_OK) {
        return fail_split(&row, split, found);
    }
    if (found != layout->columns) {
        return fail_field(&row, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_ERR_FORMAT,
                          found < layout->columns ? "the line has fewer fields than the header (value: fields found)"
                                                  : "the line has more fields than the header (value: fields found)",
                          (double)found);
    }
    status = numbers(&row, &absent, &negative);
    if (status == BRDFFIT_OK) {
        status = store(&row);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (absent) {
        table->dropped[BRDFFIT_IO_DROP_ABSENT]++;
        return BRDFFIT_OK;
    }
    table->open.negative += (size_t)negative;
    table->open.lines[row.sample] = line_number;
    table->samples.count++;
    return BRDFFIT_OK;
}
