/*
 * Columns by what they hold: see survey.h. SPDX-License-Identifier: MIT
 *
 * Leaving a column out is safe when it is the same in every row, a running number, text, or about the measurement and not
 * of it. A mask or a kind of measurement that changes from row to row is not: what the rows that it marks are worth only the
 * user knows.
 */
#include "io/csv/survey.h"

#include <string.h>

#include "io/bytes/memory.h"
#include "io/csv/cell.h"
#include "io/csv/choice.h"
#include "io/fail.h"

/* Rows from which on numbers say what a column is. */
#define TELLING 3
#define TELLING_ORDER 8

struct column {
    size_t numbers, texts, empty;
    double first, last;
    struct io_field text; /* the first that is there */
    int same, running, rising, falling, binary;
};

struct survey {
    struct csv_layout *layout;
    struct io_table *table;
    brdffit_error *error;
    struct column *columns;
    size_t rows;
};

static void see_number(struct column *c, double value)
{
    if (c->numbers++ == 0) {
        c->first = value;
        c->same = c->running = c->rising = c->falling = 1;
        c->binary = 1;
    } else {
        c->same &= value == c->last;
        c->running &= value == c->last + 1.0;
        c->rising &= value > c->last;
        c->falling &= value < c->last;
    }
    c->binary &= value == 0.0 || value == 1.0;
    c->last = value;
}

static void see_text(struct column *c, const struct io_field *field)
{
    if (c->texts++ == 0) {
        c->text = *field;
        c->same = c->numbers == 0;
    }
    c->same &= c->text.length == field->length && memcmp(c->text.text, field->text, field->length) == 0;
}

static void see_row(struct survey *s, size_t found, const void *c_locale)
{
    size_t j;

    s->rows++;
    for (j = 0; j < s->layout->columns && j < found; j++) {
        struct io_writing writing = {0, 0, 0, 0, 0};
        enum io_number fault;
        double value;

        if (s->layout->meaning[j].role <= CSV_IGNORED && s->layout->meaning[j].role != CSV_WAVELENGTH) {
            continue;
        }
        switch (brdffit_io_cell(&s->layout->fields[j], c_locale, &writing, &value, &fault)) {
        case IO_CELL_NUMBER: see_number(&s->columns[j], value); break;
        case IO_CELL_EMPTY:
        case IO_CELL_MISSING: s->columns[j].empty++; break;
        default: see_text(&s->columns[j], &s->layout->fields[j]); break;
        }
    }
}

static void see_all(struct survey *s, struct io_lines lines, const void *c_locale)
{
    struct io_field line;
    size_t found;

    while (brdffit_io_next_line(&lines, &line)) {
        if (brdffit_io_split(&line, s->layout->separator, s->layout->fields, s->layout->columns, &found) ==
            IO_SPLIT_OK) {
            see_row(s, found, c_locale);
        }
    }
}

/* ---- Verdicts ------------------------------------------------------------ */

static void leave_out_as(struct survey *s, size_t j, int warning, const char *why)
{
    char name[IO_QUOTED];

    s->layout->meaning[j].role = CSV_IGNORED;
    if (s->layout->names[j].length > 0) {
        brdffit_io_table_note(s->table, warning, "column %s is left out: %s",
                              brdffit_io_column_name(s->layout, j, name), why);
    } else {
        brdffit_io_table_note(s->table, 0, "column %zu, which has no name, is left out: %s", j + 1, why);
    }
}

static void leave_out(struct survey *s, size_t j, const char *why)
{
    leave_out_as(s, j, 0, why);
}

/* Refused, unless only directions are wanted. */
static brdffit_status refuse(struct survey *s, size_t j, const char *message)
{
    if (s->layout->options->directions_only) {
        leave_out(s, j, "it is no direction");
        return BRDFFIT_OK;
    }
    return brdffit_io_layout_fail(s->layout, j, message, s->error);
}

/* Columns that are channels for sure, and those that may be. */
static size_t count_channels(const struct survey *s, int may_be)
{
    size_t j, found = 0;

    for (j = 0; j < s->layout->columns; j++) {
        found += s->layout->meaning[j].role == CSV_CHANNEL || (may_be && s->layout->meaning[j].role == CSV_UNKNOWN);
    }
    return found;
}

static brdffit_status judge_unnamed(struct survey *s, size_t j)
{
    const struct column *c = &s->columns[j];

    if (s->rows > 0 && c->numbers + c->texts == 0) {
        leave_out(s, j, "it is empty");
    } else if (c->numbers >= TELLING && c->texts == 0 && c->running) {
        leave_out(s, j, "it is a running number");
    } else {
        return refuse(s, j, "a column of the header has no name");
    }
    return BRDFFIT_OK;
}

static brdffit_status judge_unknown(struct survey *s, size_t j)
{
    const struct column *c = &s->columns[j];
    const size_t sure = count_channels(s, 0), others = count_channels(s, 1) - 1;
    char name[IO_QUOTED];

    if (s->rows > 0 && c->numbers + c->texts == 0) {
        leave_out(s, j, "it is empty");
    } else if (c->texts > c->numbers) {
        leave_out(s, j, "it is text");
    } else if (c->numbers >= TELLING && c->running) {
        leave_out(s, j, "it is a running number");
    } else if (c->numbers >= TELLING && c->same && c->first != 0.0 && others > 0) {
        leave_out(s, j, "it is the same in every row");
    } else if (c->numbers >= TELLING && c->binary && !c->same && others > 0) {
        return refuse(s, j,
                      "this column holds 0 and 1 only: is it a mask (--column weight=NAME keeps rows of 1), or to be "
                      "left out (--column ignore=NAME)?");
    } else if (c->numbers >= TELLING_ORDER && (c->rising || c->falling) && sure > 0) {
        leave_out(s, j, "it rises or falls from row to row, as a time or a number does");
    } else {
        s->layout->meaning[j].role = CSV_CHANNEL;
        if (sure > 0) {
            brdffit_io_table_note(s->table, 0, "column %s is taken as a channel",
                                  brdffit_io_column_name(s->layout, j, name));
        }
    }
    return BRDFFIT_OK;
}

static brdffit_status judge_mask(struct survey *s, size_t j)
{
    if (!s->columns[j].same) {
        return refuse(s, j,
                      "this column marks rows, but not which ones to keep: --column weight=NAME keeps those above 0, "
                      "--column ignore=NAME all");
    }
    leave_out(s, j, "it is the same in every row");
    return BRDFFIT_OK;
}

static brdffit_status judge_group(struct survey *s, size_t j)
{
    const struct column *c = &s->columns[j];

    if (c->numbers > 0 && c->texts == 0 && count_channels(s, 1) == 0 && !c->same) {
        s->layout->meaning[j].role = CSV_CHANNEL;
        return BRDFFIT_OK;
    }
    if (!c->same && c->numbers + c->texts > 0) {
        return refuse(s, j,
                      "this column tells rows of several kinds apart: a fit is of one; split the file, or leave the "
                      "column out by --column ignore=NAME");
    }
    leave_out(s, j, "it is the same in every row");
    return BRDFFIT_OK;
}

static int names_samples(const struct io_field *name)
{
    return brdffit_io_same_name(name, "sample", 6) || brdffit_io_same_name(name, "samples", 7) ||
           brdffit_io_same_name(name, "sampleid", 8) || brdffit_io_same_name(name, "samplename", 10);
}

static brdffit_status judge_index(struct survey *s, size_t j)
{
    const struct column *c = &s->columns[j];

    if (names_samples(&s->layout->names[j]) && !c->same && !(c->texts == 0 && (c->rising || c->falling))) {
        return judge_group(s, j);
    }
    leave_out(s, j, "it is a number or name of the row");
    return BRDFFIT_OK;
}

/* Of a long table, unless it is the same throughout. */
static void judge_wavelength(struct survey *s, size_t j)
{
    if (s->columns[j].same && s->columns[j].numbers > 0) {
        s->layout->column[CSV_WAVELENGTH] = BRDFFIT_NONE;
        leave_out(s, j, "the wavelength is the same in every row");
    }
}

static brdffit_status judge(struct survey *s, size_t j)
{
    switch (s->layout->meaning[j].role) {
    case CSV_UNNAMED: return judge_unnamed(s, j);
    case CSV_UNKNOWN: return judge_unknown(s, j);
    case CSV_MASK: return judge_mask(s, j);
    case CSV_GROUP: return judge_group(s, j);
    case CSV_INDEX: return judge_index(s, j);
    case CSV_WAVELENGTH: judge_wavelength(s, j); return BRDFFIT_OK;
    case CSV_SPREAD:
        leave_out_as(s, j, !s->columns[j].same,
                     "it looks like an uncertainty or weight of some kind (--column uncertainty=NAME uses one)");
        return BRDFFIT_OK;
    case CSV_CONDITION: leave_out(s, j, "it is about the measurement, not of it"); return BRDFFIT_OK;
    case CSV_CORRECTION:
        leave_out_as(s, j, !s->columns[j].same, "values are taken as corrected for it");
        return BRDFFIT_OK;
    case CSV_REMARK: leave_out(s, j, "it is a remark"); return BRDFFIT_OK;
    case CSV_LOGARITHM:
        return refuse(s, j,
                      "this column looks like a logarithm (dB): fits are of values, so write 10^(dB/10), or give it a "
                      "name that says value");
    default: return BRDFFIT_OK;
    }
}

/* With options.channels nothing is guessed: the rest is left out. */
static void keep_chosen(struct csv_layout *layout)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role >= CSV_CHANNEL && !brdffit_io_is_chosen(layout, j)) {
            layout->meaning[j].role = CSV_IGNORED;
        }
    }
}

static int needs_survey(const struct csv_layout *layout)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role > CSV_IGNORED || layout->meaning[j].role == CSV_WAVELENGTH) {
            return 1;
        }
    }
    return 0;
}

/* Unknown columns last: what else is a channel counts for them. */
static brdffit_status judge_all(struct survey *s)
{
    brdffit_status status = BRDFFIT_OK;
    int pass;
    size_t j;

    for (pass = 0; pass < 2; pass++) {
        for (j = 0; j < s->layout->columns && status == BRDFFIT_OK; j++) {
            if ((s->layout->meaning[j].role == CSV_UNKNOWN) == pass) {
                status = judge(s, j);
            }
        }
    }
    return status;
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

static brdffit_status name_channels(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    size_t j, k = 0;

    for (j = 0; j < layout->columns; j++) {
        layout->channels += layout->meaning[j].role == CSV_CHANNEL;
    }
    if (layout->channels == 0 && !layout->options->directions_only) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header names no channel (such as r,g,b)", error);
    }
    if (layout->channels > 0 && !brdffit_io_table_channels(table, layout->channels)) {
        return brdffit_io_no_memory(error);
    }
    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role != CSV_CHANNEL) {
            continue;
        }
        if (!brdffit_io_table_name(table, k, layout->names[j].text, layout->names[j].length)) {
            return brdffit_io_no_memory(error);
        }
        if (layout->names[j].quoted) {
            undouble(table->open.channel_names[k]);
        }
        k++;
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_csv_survey(struct io_lines lines, struct csv_layout *layout, const void *c_locale,
                                     struct io_table *table, brdffit_error *error)
{
    struct survey s = {layout, table, error, NULL, 0};
    brdffit_status status = BRDFFIT_OK;

    if (layout->options->channels) {
        keep_chosen(layout);
    }
    if (needs_survey(layout)) {
        s.columns = brdffit_io_alloc_zero(layout->columns, sizeof *s.columns);
        if (!s.columns) {
            return brdffit_io_no_memory(error);
        }
        see_all(&s, lines, c_locale);
        status = judge_all(&s);
        brdffit_io_release(s.columns);
    }
    return status == BRDFFIT_OK ? name_channels(layout, table, error) : status;
}
