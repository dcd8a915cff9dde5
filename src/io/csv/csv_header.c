/*
 * The header of a text table: see csv_header.h. SPDX-License-Identifier: MIT
 *
 * Names are compared as they are written: `b` is coefficient b only in a table without directions; next to
 * angles or vectors it is the blue channel.
 */
#include "io/csv/csv_header.h"

#include <stdlib.h>
#include <string.h>

#include "io/fail.h"
#include "io/bytes/memory.h"
#include "io/csv/number.h"

static const char *const role_name[CSV_ROLE_COUNT] = {
    "theta_i", "phi_i", "theta_o", "phi_o", "lx", "ly", "lz", "vx",     "vy",
    "vz",      "nx",    "ny",      "nz",    "a",  "b",  "c",  "weight", "uncertainty",
};

struct name {
    struct io_field field;
    size_t column;
};

int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role)
{
    return layout->column[role] != BRDFFIT_NONE;
}

void brdffit_io_csv_layout_free(struct csv_layout *layout)
{
    brdffit_io_release(layout->role);
    brdffit_io_release(layout->fields);
    layout->role = NULL;
    layout->fields = NULL;
}

static brdffit_status fail_column(brdffit_error *error, size_t line, size_t column, const char *message)
{
    struct io_place place = IO_NOWHERE;

    place.line = line;
    place.column = column == BRDFFIT_NONE ? column : column + 1;
    return brdffit_io_fail_at(error, BRDFFIT_ERR_FORMAT, message, &place, 0.0);
}

static int field_is(const struct io_field *field, const char *word)
{
    return field->length == strlen(word) && memcmp(field->text, word, field->length) == 0;
}

static enum csv_role role_of(struct io_field field)
{
    static const char suffix[] = "_deg";
    const size_t length = sizeof suffix - 1;
    int role, angle;

    if (field_is(&field, "w")) {
        return CSV_WEIGHT;
    }
    if (field_is(&field, "stddev") || field_is(&field, "std")) {
        return CSV_UNCERTAINTY;
    }
    for (role = 0; role < CSV_ROLE_COUNT; role++) {
        if (field_is(&field, role_name[role])) {
            return (enum csv_role)role;
        }
    }
    angle = field.length > length && memcmp(field.text + field.length - length, suffix, length) == 0;
    field.length -= angle ? length : 0;
    for (role = CSV_THETA_I; angle && role <= CSV_PHI_O; role++) {
        if (field_is(&field, role_name[role])) {
            return (enum csv_role)role;
        }
    }
    return CSV_CHANNEL;
}

static int any_of(const struct csv_layout *layout, enum csv_role first, enum csv_role last)
{
    int role;

    for (role = (int)first; role <= (int)last; role++) {
        if (brdffit_io_csv_has(layout, (enum csv_role)role)) {
            return 1;
        }
    }
    return 0;
}

static int all_of(const struct csv_layout *layout, enum csv_role first, enum csv_role last)
{
    int role;

    for (role = (int)first; role <= (int)last; role++) {
        if (!brdffit_io_csv_has(layout, (enum csv_role)role)) {
            return 0;
        }
    }
    return 1;
}

static brdffit_status assign_roles(struct csv_layout *layout, size_t line, brdffit_error *error)
{
    size_t j;
    int role;

    for (role = 0; role < CSV_ROLE_COUNT; role++) {
        layout->column[role] = BRDFFIT_NONE;
    }
    for (j = 0; j < layout->columns; j++) {
        layout->role[j] = role_of(layout->fields[j]);
        if (layout->role[j] == CSV_CHANNEL) {
            continue;
        }
        if (brdffit_io_csv_has(layout, layout->role[j])) {
            return fail_column(error, line, j, "this column stands in the header twice");
        }
        layout->column[layout->role[j]] = j;
    }
    /* Next to directions, a, b and c are channels. */
    if (any_of(layout, CSV_THETA_I, CSV_NZ)) {
        for (role = CSV_A; role <= CSV_C; role++) {
            if (brdffit_io_csv_has(layout, (enum csv_role)role)) {
                layout->role[layout->column[role]] = CSV_CHANNEL;
                layout->column[role] = BRDFFIT_NONE;
            }
        }
    }
    return BRDFFIT_OK;
}

static brdffit_status check_angles(const struct csv_layout *layout, size_t line, brdffit_error *error)
{
    if (any_of(layout, CSV_LX, CSV_NZ)) {
        return fail_column(error, line, BRDFFIT_NONE, "the header mixes angles and vectors");
    }
    if (!brdffit_io_csv_has(layout, CSV_THETA_I) || !brdffit_io_csv_has(layout, CSV_THETA_O)) {
        return fail_column(error, line, BRDFFIT_NONE, "the header needs both theta_i and theta_o");
    }
    if (brdffit_io_csv_has(layout, CSV_PHI_I) != brdffit_io_csv_has(layout, CSV_PHI_O)) {
        return fail_column(error, line, BRDFFIT_NONE, "the header needs both phi_i and phi_o, or neither");
    }
    return BRDFFIT_OK;
}

static brdffit_status check_kind(struct csv_layout *layout, size_t line, brdffit_error *error)
{
    if (any_of(layout, CSV_THETA_I, CSV_PHI_O)) {
        layout->kind = CSV_ANGLES;
        return check_angles(layout, line, error);
    }
    if (any_of(layout, CSV_LX, CSV_NZ)) {
        layout->kind = CSV_VECTORS;
        if (!all_of(layout, CSV_LX, CSV_VZ)) {
            return fail_column(error, line, BRDFFIT_NONE, "the header needs all of lx, ly, lz, vx, vy, vz");
        }
        if (any_of(layout, CSV_NX, CSV_NZ) && !all_of(layout, CSV_NX, CSV_NZ)) {
            return fail_column(error, line, BRDFFIT_NONE, "the header needs all of nx, ny, nz, or none");
        }
        return BRDFFIT_OK;
    }
    layout->kind = CSV_COEFFICIENTS;
    if (!all_of(layout, CSV_A, CSV_C)) {
        return fail_column(error, line, BRDFFIT_NONE,
                           "the header names no directions (theta_i,phi_i,theta_o,phi_o or lx,ly,lz,vx,vy,vz or "
                           "a,b,c)");
    }
    return BRDFFIT_OK;
}

static int compare_names(const void *left, const void *right)
{
    const struct name *a = left, *b = right;
    size_t shorter = a->field.length < b->field.length ? a->field.length : b->field.length;
    int order = memcmp(a->field.text, b->field.text, shorter);

    if (order != 0) {
        return order;
    }
    if (a->field.length != b->field.length) {
        return a->field.length < b->field.length ? -1 : 1;
    }
    return a->column < b->column ? -1 : a->column > b->column;
}

/* Sorted, so that a hostile header of a million names takes no time squared. */
static brdffit_status check_unique(const struct csv_layout *layout, size_t line, brdffit_error *error)
{
    struct name *names = brdffit_io_alloc(layout->columns, sizeof *names);
    size_t j, twice = BRDFFIT_NONE;

    if (!names) {
        return brdffit_io_no_memory(error);
    }
    for (j = 0; j < layout->columns; j++) {
        names[j].field = layout->fields[j];
        names[j].column = j;
    }
    qsort(names, layout->columns, sizeof *names, compare_names);
    for (j = 1; j < layout->columns; j++) {
        const struct io_field *a = &names[j - 1].field, *b = &names[j].field;

        if (a->length == b->length && memcmp(a->text, b->text, a->length) == 0 && names[j].column < twice) {
            twice = names[j].column;
        }
    }
    brdffit_io_release(names);
    return twice == BRDFFIT_NONE ? BRDFFIT_OK
                                 : fail_column(error, line, twice, "this column stands in the header twice");
}

static int has_control(const struct io_field *line)
{
    size_t i;

    for (i = 0; i < line->length; i++) {
        unsigned char c = (unsigned char)line->text[i];

        if ((c < 0x20 && c != '\t') || c == 0x7f) {
            return 1;
        }
    }
    return 0;
}

static brdffit_status check_names(const struct csv_layout *layout, size_t line, brdffit_error *error)
{
    size_t j, numbers = 0;

    for (j = 0; j < layout->columns; j++) {
        const struct io_field *field = &layout->fields[j];

        if (field->length == 0) {
            return fail_column(error, line, j, "a column of the header has no name");
        }
        numbers += (size_t)brdffit_io_is_number(field->text, field->length);
    }
    if (numbers == layout->columns) {
        return fail_column(error, line, BRDFFIT_NONE,
                           "the first line holds numbers: a header line that names the columns is missing");
    }
    return BRDFFIT_OK;
}

static brdffit_status split_header(const struct io_field *line, size_t number, struct csv_layout *layout,
                                   brdffit_error *error)
{
    size_t column;
    enum io_split split;

    if (has_control(line)) {
        return fail_column(error, number, BRDFFIT_NONE,
                           "the header holds control characters: this is not a text table");
    }
    layout->separator = brdffit_io_separator(line);
    if (layout->separator == 0) {
        return fail_column(error, number, BRDFFIT_NONE,
                           "the header has one column: separate columns by comma, semicolon or tab");
    }
    split = brdffit_io_split(line, layout->separator, NULL, 0, &column);
    if (split != IO_SPLIT_OK) {
        return fail_column(error, number, column - 1,
                           split == IO_SPLIT_UNTERMINATED ? "a quote in the header is not closed"
                                                          : "text follows a closing quote in the header");
    }
    layout->columns = column;
    layout->role = brdffit_io_alloc(column, sizeof *layout->role);
    layout->fields = brdffit_io_alloc(column, sizeof *layout->fields);
    if (!layout->role || !layout->fields) {
        return brdffit_io_no_memory(error);
    }
    (void)brdffit_io_split(line, layout->separator, layout->fields, column, &column);
    return BRDFFIT_OK;
}

/* Two quotes inside quotes stand for one. */
static void undouble(char *name)
{
    char *to = name, *from = name;

    while (*from) {
        from += from[0] == '"' && from[1] == '"';
        *to++ = *from++;
    }
    *to = '\0';
}

static brdffit_status name_channels(struct csv_layout *layout, size_t line, struct io_table *table,
                                    brdffit_error *error)
{
    size_t j, k = 0;

    for (j = 0; j < layout->columns; j++) {
        layout->channels += layout->role[j] == CSV_CHANNEL;
    }
    if (layout->channels == 0 && !layout->directions_only) {
        return fail_column(error, line, BRDFFIT_NONE, "the header names no channel (such as r,g,b)");
    }
    if (layout->channels > 0 && !brdffit_io_table_channels(table, layout->channels)) {
        return brdffit_io_no_memory(error);
    }
    for (j = 0; j < layout->columns; j++) {
        if (layout->role[j] != CSV_CHANNEL) {
            continue;
        }
        if (!brdffit_io_table_name(table, k, layout->fields[j].text, layout->fields[j].length)) {
            return brdffit_io_no_memory(error);
        }
        if (layout->fields[j].quoted) {
            undouble(table->open.channel_names[k]);
        }
        k++;
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_csv_header(const struct io_field *line, size_t line_number, struct csv_layout *layout,
                                     struct io_table *table, brdffit_error *error)
{
    brdffit_status status = split_header(line, line_number, layout, error);

    if (status == BRDFFIT_OK) {
        status = check_names(layout, line_number, error);
    }
    if (status == BRDFFIT_OK) {
        status = assign_roles(layout, line_number, error);
    }
    if (status == BRDFFIT_OK) {
        status = check_unique(layout, line_number, error);
    }
    if (status == BRDFFIT_OK) {
        status = check_kind(layout, line_number, error);
    }
    return status == BRDFFIT_OK ? name_channels(layout, line_number, table, error) : status;
}
