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
#include "io/fail.h"

struct name {
    struct io_field field;
    size_t column;
};

int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role)
{
    return layout->column[role] != BRDFFIT_NONE;
}

void brdffit_io_layout_free(struct csv_layout *layout)
{
    brdffit_io_release(layout->meaning);
    brdffit_io_release(layout->names);
    brdffit_io_release(layout->fields);
    layout->meaning = NULL;
    layout->names = layout->fields = NULL;
    layout->columns = layout->channels = 0;
}

void brdffit_io_fault(const brdffit_io_options *options, const struct io_field *field)
{
    if (options->fault && options->fault_size > 8) {
        (void)brdffit_io_quote(field->text, field->length, options->fault, options->fault_size);
    }
}

const char *brdffit_io_column_name(const struct csv_layout *layout, size_t column, char out[IO_QUOTED])
{
    return brdffit_io_quote(layout->names[column].text, layout->names[column].length, out, IO_QUOTED);
}

brdffit_status brdffit_io_layout_fail(const struct csv_layout *layout, size_t column, const char *message,
                                      brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;

    place.line = layout->line;
    place.column = column == BRDFFIT_NONE ? column : column + 1;
    if (column != BRDFFIT_NONE && layout->names && column < layout->columns) {
        brdffit_io_fault(layout->options, &layout->names[column]);
    }
    return brdffit_io_fail_at(error, BRDFFIT_ERR_FORMAT, message, &place, 0.0);
}

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

static int any_of(const struct csv_layout *layout, enum csv_role first, enum csv_role last)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role >= first && layout->meaning[j].role <= last) {
            return 1;
        }
    }
    return 0;
}

/* theta_s beside theta_i is of scatter, beside theta_v of the sun; theta_d without theta_h is the detector's. */
static void settle_sides(struct csv_layout *layout)
{
    const int light = any_of(layout, CSV_THETA_I, CSV_PHI_I), view = any_of(layout, CSV_THETA_O, CSV_PHI_O);
    const int half = any_of(layout, CSV_THETA_H, CSV_PHI_H), difference = any_of(layout, CSV_THETA_D, CSV_THETA_D);

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

    if (any_of(layout, CSV_THETA_I, CSV_NZ) || any_of(layout, CSV_DIRECTION, CSV_DIRECTION) ||
        any_of(layout, CSV_THETA_S, CSV_PHI_S)) {
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

/* ---- Kinds of geometry --------------------------------------------------- */

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

static brdffit_status check_angles(struct csv_layout *layout, brdffit_error *error)
{
    const int phi_i = brdffit_io_csv_has(layout, CSV_PHI_I), phi_o = brdffit_io_csv_has(layout, CSV_PHI_O);

    layout->kind = CSV_ANGLES;
    if (any_of(layout, CSV_LX, CSV_NZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header mixes angles and vectors", error);
    }
    if (!brdffit_io_csv_has(layout, CSV_THETA_I) || !brdffit_io_csv_has(layout, CSV_THETA_O)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs both theta_i and theta_o", error);
    }
    if (brdffit_io_csv_has(layout, CSV_PHI) && (phi_i || phi_o)) {
        return brdffit_io_layout_fail(layout, layout->column[CSV_PHI],
                                      "an azimuth beside phi_i or phi_o: which is it (--column phi_o=NAME)?", error);
    }
    if (phi_i && !phi_o) {
        return brdffit_io_layout_fail(
            layout, BRDFFIT_NONE, "the header needs both phi_i and phi_o, or neither, or phi between the two", error);
    }
    return BRDFFIT_OK;
}

static brdffit_status check_half_angles(struct csv_layout *layout, brdffit_error *error)
{
    layout->kind = CSV_HALF_ANGLES;
    if (any_of(layout, CSV_LX, CSV_NZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header mixes angles and vectors", error);
    }
    if (!brdffit_io_csv_has(layout, CSV_THETA_H) || !brdffit_io_csv_has(layout, CSV_THETA_D) ||
        !brdffit_io_csv_has(layout, CSV_PHI_D)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of theta_h, theta_d, phi_d", error);
    }
    return BRDFFIT_OK;
}

static brdffit_status check_vectors(struct csv_layout *layout, brdffit_error *error)
{
    layout->kind = CSV_VECTORS;
    if (!all_of(layout, CSV_LX, CSV_VZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of lx, ly, lz, vx, vy, vz", error);
    }
    if (any_of(layout, CSV_NX, CSV_NZ) && !all_of(layout, CSV_NX, CSV_NZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of nx, ny, nz, or none", error);
    }
    return BRDFFIT_OK;
}

/* The first column whose name looks like a direction and is none. */
static brdffit_status fail_direction(const struct csv_layout *layout, brdffit_error *error)
{
    size_t j = 0;

    while (layout->meaning[j].role != CSV_DIRECTION) {
        j++;
    }
    return brdffit_io_layout_fail(layout, j,
                                  "this column looks like a direction (theta, phi ...) but is not understood, its unit "
                                  "included: say what it is by --column phi=NAME, or ignore=NAME",
                                  error);
}

static brdffit_status check_kind(struct csv_layout *layout, brdffit_error *error)
{
    if (any_of(layout, CSV_THETA_H, CSV_PHI_D) && !any_of(layout, CSV_THETA_I, CSV_PHI)) {
        return check_half_angles(layout, error);
    }
    if (any_of(layout, CSV_THETA_I, CSV_PHI_D)) {
        return check_angles(layout, error);
    }
    if (any_of(layout, CSV_LX, CSV_NZ)) {
        return check_vectors(layout, error);
    }
    layout->kind = CSV_COEFFICIENTS;
    if (any_of(layout, CSV_DIRECTION, CSV_DIRECTION)) {
        return fail_direction(layout, error);
    }
    if (!all_of(layout, CSV_A, CSV_C)) {
        return brdffit_io_layout_fail(
            layout, BRDFFIT_NONE,
            "the header names no directions (theta_i,phi_i,theta_o,phi_o or lx,ly,lz,vx,vy,vz or "
            "a,b,c; --column theta_i=NAME,... says what others mean)",
            error);
    }
    return BRDFFIT_OK;
}

/* A name with theta or phi in it that is not understood: harmless only where the directions are complete without it. */
static brdffit_status check_directions(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    const int complete = layout->kind != CSV_ANGLES || brdffit_io_csv_has(layout, CSV_PHI) ||
                         brdffit_io_csv_has(layout, CSV_PHI_O);
    char name[IO_QUOTED];
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role != CSV_DIRECTION) {
            continue;
        }
        if (!complete) {
            return fail_direction(layout, error);
        }
        layout->meaning[j].role = CSV_IGNORED;
        if (table) {
            brdffit_io_table_note(table, 0, "column %s is left out: it looks like an angle that the directions imply",
                                  brdffit_io_column_name(layout, j, name));
        }
    }
    return BRDFFIT_OK;
}

size_t brdffit_io_layout_score(const struct csv_layout *layout)
{
    size_t j, score = 0;

    for (j = 0; j < layout->columns; j++) {
        score += layout->meaning[j].role <= CSV_C || layout->meaning[j].role == CSV_DIRECTION;
    }
    return score;
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
    if (status == BRDFFIT_OK) {
        status = check_kind(layout, error);
    }
    return status == BRDFFIT_OK ? check_directions(layout, table, error) : status;
}
