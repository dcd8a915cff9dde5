/*
 * Columns of a header: see layout.h. SPDX-License-Identifier: MIT
 *
 * Names say what they can (roles.h); what is left is decided here by what other columns there are: whether theta_s is of
 * the sun or of the scattered light, b a coefficient or blue, w a weight or white. Next to directions, a, b and c are
 * channels.
 */
#include "io/csv/layout.h"

#include <stdlib.h>
#include <string.h>

#include "io/bytes/memory.h"
#include "io/csv/choice.h"
#include "io/csv/kind.h"
#include "io/fail.h"

struct name {
    struct io_field field;
    size_t column;
};

/* ---- Names --------------------------------------------------------------- */

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

static int allocate(struct csv_layout *layout, size_t columns)
{
    layout->columns = columns;
    layout->meaning = brdffit_io_alloc_zero(columns, sizeof *layout->meaning);
    layout->names = brdffit_io_alloc(columns, sizeof *layout->names);
    layout->fields = brdffit_io_alloc(columns, sizeof *layout->fields);
    return layout->meaning && layout->names && layout->fields;
}

static brdffit_status split_header(struct csv_layout *layout, brdffit_error *error)
{
    size_t columns;
    enum io_split split;

    if (has_control(&layout->header)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE,
                                      "the header holds control characters: this is not a text table", error);
    }
    split = brdffit_io_split(&layout->header, layout->separator, NULL, 0, &columns);
    if (split != IO_SPLIT_OK) {
        return brdffit_io_layout_fail(layout, columns - 1,
                                      split == IO_SPLIT_UNTERMINATED ? "a quote in the header is not closed"
                                                                     : "text follows a closing quote in the header",
                                      error);
    }
    if (!allocate(layout, columns)) {
        return brdffit_io_no_memory(error);
    }
    (void)brdffit_io_split(&layout->header, layout->separator, layout->names, columns, &columns);
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
static brdffit_status check_unique(const struct csv_layout *layout, brdffit_error *error)
{
    struct name *names = brdffit_io_alloc(layout->columns, sizeof *names);
    size_t j, twice = BRDFFIT_NONE;

    if (!names) {
        return brdffit_io_no_memory(error);
    }
    for (j = 0; j < layout->columns; j++) {
        names[j].field = layout->names[j];
        names[j].column = j;
    }
    qsort(names, layout->columns, sizeof *names, compare_names);
    for (j = 1; j < layout->columns; j++) {
        const struct io_field *a = &names[j - 1].field, *b = &names[j].field;

        if (a->length > 0 && a->length == b->length && memcmp(a->text, b->text, a->length) == 0 &&
            names[j].column < twice) {
            twice = names[j].column;
        }
    }
    brdffit_io_release(names);
    return twice == BRDFFIT_NONE
               ? BRDFFIT_OK
               : brdffit_io_layout_fail(layout, twice, "this column stands in the header twice", error);
}

/* ---- Roles --------------------------------------------------------------- */

static size_t count_role(const struct csv_layout *layout, enum csv_role role)
{
    size_t j, found = 0;

    for (j = 0; j < layout->columns; j++) {
        found += layout->meaning[j].role == role;
    }
    return found;
}

static void rename_role(struct csv_layout *layout, enum csv_role from, enum csv_role to)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role == from) {
            layout->meaning[j].role = to;
        }
    }
}

/* theta_s beside theta_i is of scatter, beside theta_v of the sun; theta_d without theta_h is the detector's. */
static void settle_sides(struct csv_layout *layout)
{
    const int light = brdffit_io_layout_any(layout, CSV_THETA_I, CSV_PHI_I),
              view = brdffit_io_layout_any(layout, CSV_THETA_O, CSV_PHI_O);
    const int half = brdffit_io_layout_any(layout, CSV_THETA_H, CSV_PHI_H),
              difference = brdffit_io_layout_any(layout, CSV_THETA_D, CSV_THETA_D);

    rename_role(layout, CSV_THETA_S, light ? CSV_THETA_O : view || difference ? CSV_THETA_I : CSV_DIRECTION);
    rename_role(layout, CSV_PHI_S, light ? CSV_PHI_O : view || difference ? CSV_PHI_I : CSV_DIRECTION);
    if (!half && count_role(layout, CSV_THETA_O) == 0) {
        rename_role(layout, CSV_THETA_D, CSV_THETA_O);
        rename_role(layout, CSV_PHI_D, difference ? CSV_PHI_O : CSV_PHI);
    } else if (!half) {
        rename_role(layout, CSV_PHI_D, CSV_PHI);
    }
}

/* Half and difference angles beside the directions themselves are derived from these. */
static void settle_derived(struct csv_layout *layout)
{
    if (count_role(layout, CSV_THETA_I) > 0 && count_role(layout, CSV_THETA_O) > 0) {
        int role;

        for (role = CSV_THETA_H; role <= CSV_PHI_D; role++) {
            rename_role(layout, (enum csv_role)role, CSV_DIRECTION);
        }
    }
}

static int is_name(const struct io_field *field, const char *word)
{
    return brdffit_io_same_name(field, word, strlen(word));
}

/* Red, green and blue, whatever they are called. */
static int has_colours(const struct csv_layout *layout)
{
    size_t j;
    int found = 0;

    for (j = 0; j < layout->columns; j++) {
        found |= is_name(&layout->names[j], "r") || is_name(&layout->names[j], "red") ? 1 : 0;
        found |= is_name(&layout->names[j], "g") || is_name(&layout->names[j], "green") ? 2 : 0;
        found |= is_name(&layout->names[j], "b") || is_name(&layout->names[j], "blue") ? 4 : 0;
    }
    return found == 7;
}

static brdffit_status settle_w(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    char name[IO_QUOTED];
    size_t j;

    for (j = 0; j < layout->columns && layout->meaning[j].role != CSV_W; j++) {
    }
    if (j == layout->columns) {
        return BRDFFIT_OK;
    }
    if (has_colours(layout)) {
        return brdffit_io_layout_fail(layout, j,
                                      "this column may be a weight or white: call it weight or white, or say which by "
                                      "--column weight=w or --column channel=w",
                                      error);
    }
    layout->meaning[j].role = CSV_WEIGHT;
    if (table) {
        brdffit_io_table_note(table, 0, "column %s is taken as weights", brdffit_io_column_name(layout, j, name));
    }
    return BRDFFIT_OK;
}

/* Coefficients only where nothing says where the light is. */
static void settle_coefficients(struct csv_layout *layout)
{
    int role;

    if (brdffit_io_layout_any(layout, CSV_THETA_I, CSV_TZ) ||
        brdffit_io_layout_any(layout, CSV_DIRECTION, CSV_DIRECTION) ||
        brdffit_io_layout_any(layout, CSV_THETA_S, CSV_PHI_S)) {
        for (role = CSV_A; role <= CSV_C; role++) {
            rename_role(layout, (enum csv_role)role, CSV_CHANNEL);
        }
    }
}

static brdffit_status place_roles(struct csv_layout *layout, brdffit_error *error)
{
    size_t j;
    int role;

    for (role = 0; role < CSV_ROLE_COUNT; role++) {
        layout->column[role] = BRDFFIT_NONE;
    }
    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role >= CSV_ROLE_COUNT) {
            continue;
        }
        if (brdffit_io_csv_has(layout, layout->meaning[j].role)) {
            return brdffit_io_layout_fail(
                layout, j, "this column stands in the header twice (--column ignore=NAME leaves one out)", error);
        }
        layout->column[layout->meaning[j].role] = j;
    }
    return BRDFFIT_OK;
}

static brdffit_status assign_roles(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    brdffit_status status;
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        layout->meaning[j] = brdffit_io_meaning(&layout->names[j]);
    }
    status = brdffit_io_choose_columns(layout, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    settle_sides(layout);
    settle_derived(layout);
    settle_coefficients(layout);
    status = settle_w(layout, table, error);
    return status == BRDFFIT_OK ? place_roles(layout, error) : status;
}

brdffit_status brdffit_io_layout(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    brdffit_status status = split_header(layout, error);

    if (status == BRDFFIT_OK) {
        status = assign_roles(layout, table, error);
    }
    if (status == BRDFFIT_OK) {
        status = check_unique(layout, error);
    }
    return status == BRDFFIT_OK ? brdffit_io_layout_kind(layout, table, error) : status;
}
