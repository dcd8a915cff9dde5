/*
 * The header among titles, comments and units: see header.h. SPDX-License-Identifier: MIT
 *
 * The header is the first line that names directions (layout.h) when it is split by one of the separators, tried in the
 * order of how often they stand in it, and that has as many fields as the line of numbers below. Lines of text above it are titles. A
 * comment may be the header where no such line comes before the numbers. When there is none, the line that comes nearest
 * says what is wrong.
 */
#include "io/csv/header.h"

#include <string.h>

#include "io/csv/number.h"
#include "io/fail.h"
#include "io/limits.h"

/* Fields that a line of numbers has to have before it is one. */
#define LEAST_NUMBERS 2

struct search {
    struct io_lines *lines;
    const brdffit_io_options *options;
    struct csv_layout nearest; /* of what did not do: header, line, separator */
    size_t score;              /* its brdffit_io_layout_score() */
    struct io_lines after;     /* below it */
    struct csv_layout comment; /* the last that would do */
    struct io_field first;     /* line of text */
    size_t first_line, texts;
    int numbers; /* a line of numbers has come */
    int no_memory;
    size_t numbers_line;
};

/* Separators of a line, the most frequent first; blanks last. Returns how many. */
static int separators(const struct io_field *line, char out[5])
{
    size_t count[5];
    int n = 0;

    brdffit_io_count_separators(line, count);
    for (;;) {
        int best = -1, i;

        for (i = 0; i < 4; i++) {
            best = count[i] > 0 && (best < 0 || count[i] > count[best]) ? i : best;
        }
        if (best < 0) {
            break;
        }
        out[n++] = IO_SEPARATORS[best];
        count[best] = 0;
    }
    if (count[4] > 0) {
        out[n++] = ' ';
    }
    return n;
}

static int looks_numeric(const struct io_field *field)
{
    size_t i;
    int digits = 0;

    for (i = 0; i < field->length; i++) {
        const char c = field->text[i];

        if (c >= '0' && c <= '9') {
            digits++;
        } else if (!strchr("+-.,eEdD%\xc2\xb0", c) || !c) {
            return 0;
        }
    }
    return digits > 0;
}

/* Every field a number or empty, and enough of them. */
static int is_numbers_by(const struct io_field *line, char separator)
{
    struct io_field fields[8];
    size_t found, j, numbers = 0;

    if (brdffit_io_split(line, separator, fields, 8, &found) != IO_SPLIT_OK) {
        return 0;
    }
    for (j = 0; j < found && j < 8; j++) {
        numbers += (size_t)looks_numeric(&fields[j]);
        if (fields[j].length > 0 && !looks_numeric(&fields[j])) {
            return 0;
        }
    }
    return numbers >= LEAST_NUMBERS;
}

static int is_numbers(const struct io_field *line)
{
    char list[5];
    const int n = separators(line, list);
    int i;

    for (i = 0; i < n; i++) {
        if (is_numbers_by(line, list[i])) {
            return 1;
        }
    }
    return 0;
}

/* Fields of one of the next lines are as many as the header's, columns without a name at its end apart. */
static int fits_below(struct io_lines lines, const struct csv_layout *layout)
{
    struct io_field line;
    size_t found, looked = 0, columns = layout->columns;

    while (columns > 0 && layout->names[columns - 1].length == 0) {
        columns--;
    }
    while (looked++ < 3 && brdffit_io_next_line(&lines, &line)) {
        if (brdffit_io_split(&line, layout->separator, NULL, 0, &found) == IO_SPLIT_OK && found >= columns) {
            return 1;
        }
    }
    return looked == 1;
}

/* Whether `line` is a header by `separator`; remembers it when it comes nearer than those before. */
static int try_separator(struct search *s, const struct io_field *line, char separator, struct csv_layout *found)
{
    struct csv_layout layout;
    brdffit_error ignored;
    brdffit_status status;
    size_t score;
    int fits;

    memset(&layout, 0, sizeof layout);
    layout.options = s->options;
    layout.header = *line;
    layout.line = s->lines->line;
    layout.separator = separator;
    status = brdffit_io_layout(&layout, NULL, &ignored);
    score = layout.meaning ? brdffit_io_layout_score(&layout) : 0;
    fits = status == BRDFFIT_OK && fits_below(*s->lines, &layout);
    brdffit_io_layout_free(&layout);
    if (fits) {
        *found = layout;
        return 1;
    }
    s->no_memory |= status == BRDFFIT_ERR_MEMORY;
    if (status == BRDFFIT_OK || score > s->score || s->nearest.line == 0) {
        s->nearest = layout;
        s->score = status == BRDFFIT_OK ? (size_t)-1 : score;
        s->after = *s->lines;
    }
    return 0;
}

static int try_line(struct search *s, const struct io_field *line, struct csv_layout *found)
{
    char list[5];
    const int n = separators(line, list);
    int i;

    for (i = 0; i < n; i++) {
        if (try_separator(s, line, list[i], found)) {
            return 1;
        }
    }
    return 0;
}

/* A comment that would do as a header; one that does not is only a comment. */
static void try_comment(struct search *s, const struct io_field *line)
{
    const char *text = brdffit_io_comment(line);
    const struct io_field inside = {text, line->length - (size_t)(text - line->text), 0};
    const struct search before = *s;
    struct csv_layout found;

    if (try_line(s, &inside, &found)) {
        s->comment = found;
    } else if (!s->no_memory) {
        *s = before;
    }
}

static char first_character(const struct io_field *line)
{
    size_t i = 0;

    while (i + 1 < line->length && (line->text[i] == ' ' || line->text[i] == '\t')) {
        i++;
    }
    return line->text[i];
}

/* Line by line to the numbers. 1: found. */
static int search_lines(struct search *s, struct csv_layout *found)
{
    struct io_field line;

    while (s->texts < IO_HEADER_LINES && !s->no_memory && brdffit_io_any_line(s->lines, &line)) {
        if (brdffit_io_comment(&line)) {
            try_comment(s, &line);
            continue;
        }
        if (is_numbers(&line)) {
            s->numbers = 1;
            s->numbers_line = s->lines->line;
            return 0;
        }
        if (!strchr("{[<", first_character(&line)) && try_line(s, &line, found)) {
            return 1;
        }
        if (s->texts++ == 0) {
            s->first = line;
            s->first_line = s->lines->line;
        }
    }
    return 0;
}

static brdffit_status fail_line(const struct search *s, const struct io_field *text, size_t line, const char *message,
                                brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;

    place.line = line;
    if (text) {
        brdffit_io_fault(s->options, text);
    }
    return brdffit_io_fail_at(error, BRDFFIT_ERR_FORMAT, message, &place, 0.0);
}

static int has_control(const struct io_field *line)
{
    size_t i;

    for (i = 0; i < line->length; i++) {
        if ((unsigned char)line->text[i] < 0x20 && line->text[i] != '\t') {
            return 1;
        }
    }
    return 0;
}

/* What there is instead of a header; BRDFFIT_OK: a line that the layout has to say it of. */
static brdffit_status fail_search(const struct search *s, brdffit_error *error)
{
    char list[5];

    if (s->score > 0) {
        return BRDFFIT_OK;
    }
    if (s->texts == 0 && !s->numbers) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "there is no header line");
    }
    if (s->texts == 0) {
        return fail_line(s, NULL, s->numbers_line,
                         "the first line holds numbers: a header line that names the columns is missing", error);
    }
    if (has_control(&s->first)) {
        return fail_line(s, NULL, s->first_line, "the header holds control characters: this is not a text table",
                         error);
    }
    if (strchr("{[<", first_character(&s->first))) {
        return fail_line(
            s, &s->first, s->first_line,
            "this is JSON or XML, not a table: write its samples as columns, such as theta_i,phi_i,theta_o,phi_o,r",
            error);
    }
    if (separators(&s->first, list) == 0) {
        return fail_line(s, &s->first, s->first_line,
                         "the header has one column: separate columns by comma, semicolon or tab", error);
    }
    return BRDFFIT_OK;
}

/* "sep=;" as Excel understands it: the separator is found without. */
static void skip_separator_line(struct io_lines *lines, struct io_table *table)
{
    struct io_lines ahead = *lines;
    struct io_field line;

    if (brdffit_io_any_line(&ahead, &line) && line.length >= 4 && line.length <= 6 &&
        brdffit_io_same_name(&line, "sep", 3) && memchr(line.text, '=', line.length)) {
        *lines = ahead;
        brdffit_io_table_note(table, 0, "line %zu (sep=) is skipped", ahead.line);
    }
}

static void note_place(const struct search *s, const struct csv_layout *layout, int in_comment, struct io_table *table)
{
    char text[IO_QUOTED];

    if (in_comment) {
        brdffit_io_table_note(table, 0, "line %zu, a comment, is taken as the header", layout->line);
    }
    if (s->texts > 0) {
        brdffit_io_table_note(table, 0, "the header is line %zu; %zu line%s of text above it skipped, from \"%s\"",
                              layout->line, s->texts, s->texts == 1 ? " is" : "s are",
                              brdffit_io_quote(s->first.text, s->first.length, text, sizeof text));
    }
    if (layout->separator == ' ' || layout->separator == '|') {
        brdffit_io_table_note(table, 0, "fields are separated by %s", layout->separator == ' ' ? "blanks" : "|");
    }
}

/* ---- A row of units ------------------------------------------------------ */

/* Every field a unit or empty, none a number. Of a field of an angle only that of angles will do. */
static int is_unit_row(const struct csv_layout *layout, size_t found)
{
    size_t j, units = 0;

    for (j = 0; j < found && j < layout->columns; j++) {
        const enum io_unit unit = brdffit_io_unit(&layout->fields[j]);

        if (looks_numeric(&layout->fields[j]) && unit == UNIT_NONE) {
            return 0;
        }
        units += unit != UNIT_NONE;
    }
    return units > 0 && !looks_numeric(&layout->fields[0]);
}

static brdffit_status obey_units(struct csv_layout *layout, size_t line, brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        const enum io_unit unit = brdffit_io_unit(&layout->fields[j]);

        if (brdffit_io_is_angle(layout->meaning[j].role) && unit != UNIT_DEGREES && unit != UNIT_RADIANS &&
            layout->fields[j].length > 0) {
            place.line = line;
            place.column = j + 1;
            brdffit_io_fault(layout->options, &layout->fields[j]);
            return brdffit_io_fail_at(error, BRDFFIT_ERR_FORMAT, "the unit of an angle is neither degrees nor radians",
                                      &place, 0.0);
        }
        layout->meaning[j].unit = unit != UNIT_NONE ? unit : layout->meaning[j].unit;
    }
    return BRDFFIT_OK;
}

static brdffit_status take_units(struct io_lines *lines, struct csv_layout *layout, struct io_table *table,
                                 brdffit_error *error)
{
    struct io_lines ahead = *lines;
    struct io_field line;
    size_t found;

    if (!brdffit_io_next_line(&ahead, &line) ||
        brdffit_io_split(&line, layout->separator, layout->fields, layout->columns, &found) != IO_SPLIT_OK ||
        found < layout->columns || !is_unit_row(layout, found)) {
        return BRDFFIT_OK;
    }
    *lines = ahead;
    brdffit_io_table_note(table, 0, "line %zu is taken as units", ahead.line);
    return obey_units(layout, ahead.line, error);
}

brdffit_status brdffit_io_csv_header(struct io_lines *lines, struct csv_layout *layout, struct io_table *table,
                                     brdffit_error *error)
{
    const brdffit_io_options *options = layout->options;
    struct io_lines start;
    struct search s;
    brdffit_status status;
    int in_comment = 0;

    skip_separator_line(lines, table);
    start = *lines;
    memset(&s, 0, sizeof s);
    s.lines = lines;
    s.options = options;
    if (!search_lines(&s, layout)) {
        in_comment = s.comment.line > 0;
        *layout = in_comment ? s.comment : s.nearest;
        layout->options = options;
        status = s.no_memory ? brdffit_io_no_memory(error) : in_comment ? BRDFFIT_OK : fail_search(&s, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        if (!in_comment) {
            *lines = s.after;
        } else { /* the line of numbers again */
            struct io_field skipped;

            *lines = start;
            while (lines->line < layout->line) {
                (void)brdffit_io_any_line(lines, &skipped);
            }
        }
    }
    status = brdffit_io_layout(layout, table, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    note_place(&s, layout, in_comment, table);
    return take_units(lines, layout, table, error);
}
