/*
 * Columns by the caller's word: see choice.h. SPDX-License-Identifier: MIT
 *
 * Lists are separated by commas. A name that holds one is given by the column's number: "#3", from 1, as any other may be.
 */
#include "io/csv/choice.h"

#include <string.h>

#include "io/fail.h"

/* The next item of a list; 0: there is none. */
static int next_item(const char **at, struct io_field *item)
{
    if (!*at || !**at) {
        return 0;
    }
    item->text = *at;
    item->length = strcspn(*at, ",");
    *at += item->length + ((*at)[item->length] == ',');
    while (item->length > 0 && item->text[0] == ' ') {
        item->text++;
        item->length--;
    }
    while (item->length > 0 && item->text[item->length - 1] == ' ') {
        item->length--;
    }
    return 1;
}

/* "#3" to 2, or BRDFFIT_NONE. */
static size_t by_number(const struct io_field *item)
{
    size_t number = 0, i;

    if (item->length < 2 || item->length > 9 || item->text[0] != '#') {
        return BRDFFIT_NONE;
    }
    for (i = 1; i < item->length; i++) {
        if (item->text[i] < '0' || item->text[i] > '9') {
            return BRDFFIT_NONE;
        }
        number = 10 * number + (size_t)(item->text[i] - '0');
    }
    return number > 0 ? number - 1 : BRDFFIT_NONE;
}

static int is_exactly(const struct io_field *a, const struct io_field *b)
{
    return a->length == b->length && memcmp(a->text, b->text, a->length) == 0;
}

/* The column that an item names: exactly, else but for case and punctuation; BRDFFIT_NONE: none. */
static size_t find(const struct csv_layout *layout, const struct io_field *item)
{
    const size_t number = by_number(item);
    size_t j;

    if (number < layout->columns) {
        return number;
    }
    for (j = 0; j < layout->columns; j++) {
        if (is_exactly(&layout->names[j], item)) {
            return j;
        }
    }
    for (j = 0; j < layout->columns; j++) {
        if (brdffit_io_same_name(&layout->names[j], item->text, item->length)) {
            return j;
        }
    }
    return BRDFFIT_NONE;
}

static brdffit_status fail_item(const struct csv_layout *layout, const struct io_field *item, const char *message,
                                brdffit_error *error)
{
    brdffit_io_fault(layout->options, item);
    return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, message);
}

/* One "role=name". */
static brdffit_status assign(struct csv_layout *layout, const struct io_field *item, brdffit_error *error)
{
    const char *equals = memchr(item->text, '=', item->length);
    const size_t length = equals ? (size_t)(equals - item->text) : 0;
    const struct io_field name = {equals ? equals + 1 : item->text, equals ? item->length - length - 1 : 0, 0};
    const enum csv_role role = brdffit_io_role_named(item->text, length);
    const size_t column = find(layout, &name);

    if (!equals || role == CSV_NAMED_ROLES) {
        return fail_item(layout, item, "columns are given as role=name, and this is no role", error);
    }
    if (column == BRDFFIT_NONE) {
        return fail_item(layout, &name, "the file has no column of this name", error);
    }
    layout->meaning[column].role = role;
    layout->meaning[column].elevation = 0;
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_choose_columns(struct csv_layout *layout, brdffit_error *error)
{
    const char *at = layout->options->columns;
    struct io_field item;

    while (next_item(&at, &item)) {
        const brdffit_status status = assign(layout, &item, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
    }
    at = layout->options->channels;
    while (next_item(&at, &item)) {
        const size_t column = find(layout, &item);

        if (column == BRDFFIT_NONE) {
            return fail_item(layout, &item, "the file has no column of this name to be a channel", error);
        }
        layout->meaning[column].role = CSV_CHANNEL;
    }
    return BRDFFIT_OK;
}

int brdffit_io_is_chosen(const struct csv_layout *layout, size_t column)
{
    const char *at = layout->options->channels;
    struct io_field item;

    while (next_item(&at, &item)) {
        if (find(layout, &item) == column) {
            return 1;
        }
    }
    return 0;
}
