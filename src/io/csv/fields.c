/*
 * Lines and fields: see fields.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/fields.h"

#include <string.h>

static int is_blank(char c, char separator)
{
    return c == ' ' || (c == '\t' && separator != '\t');
}

/* One pass for both kinds of end: searching them in turn would be quadratic in a file that has only one. */
static const char *line_end(const char *at, const char *end)
{
    while (at < end && *at != '\n' && *at != '\r') {
        at++;
    }
    return at;
}

int brdffit_io_any_line(struct io_lines *lines, struct io_field *line)
{
    while (lines->at < lines->end) {
        const char *start = lines->at, *stop = line_end(start, lines->end), *first = start;

        lines->line++;
        lines->at = stop;
        if (lines->at < lines->end) {
            int pair = *stop == '\r' && lines->end - stop > 1 && stop[1] == '\n';

            lines->at += pair ? 2 : 1;
        }
        while (first < stop && is_blank(*first, 0)) {
            first++;
        }
        if (first < stop) {
            line->text = start;
            line->length = (size_t)(stop - start);
            line->quoted = 0;
            return 1;
        }
    }
    return 0;
}

const char *brdffit_io_comment(const struct io_field *line)
{
    const char *at = line->text, *end = at + line->length;

    while (at < end && is_blank(*at, 0)) {
        at++;
    }
    if (at < end && (*at == '#' || *at == '%')) {
        while (at < end && (*at == '#' || *at == '%')) {
            at++;
        }
        return at;
    }
    return end - at > 1 && at[0] == '/' && at[1] == '/' ? at + 2 : NULL;
}

int brdffit_io_next_line(struct io_lines *lines, struct io_field *line)
{
    while (brdffit_io_any_line(lines, line)) {
        if (!brdffit_io_comment(line)) {
            return 1;
        }
    }
    return 0;
}

void brdffit_io_count_separators(const struct io_field *line, size_t count[5])
{
    size_t i;
    int quoted = 0, gap = 0, begun = 0;

    memset(count, 0, 5 * sizeof *count);
    for (i = 0; i < line->length; i++) {
        const char c = line->text[i];
        const char *which = c && !quoted ? strchr(IO_SEPARATORS, c) : NULL;

        quoted ^= c == '"';
        if (c == ' ' || c == '\t') {
            gap = begun;
        } else {
            count[4] += (size_t)gap;
            gap = 0;
            begun = 1;
        }
        if (which && c != ' ') {
            count[which - IO_SEPARATORS]++;
        }
    }
}

/* The closing quote of text that starts after the opening one; NULL when there is none. */
static const char *closing_quote(const char *at, const char *end)
{
    while ((at = memchr(at, '"', (size_t)(end - at))) != NULL) {
        if (end - at < 2 || at[1] != '"') {
            return at;
        }
        at += 2;
    }
    return NULL;
}

static enum io_split quoted_field(const char **at, const char *end, char separator, struct io_field *field)
{
    const char *open = *at + 1, *close = closing_quote(open, end);

    if (!close) {
        return IO_SPLIT_UNTERMINATED;
    }
    field->text = open;
    field->length = (size_t)(close - open);
    field->quoted = 1;
    for (*at = close + 1; *at < end && **at != separator && !(separator == ' ' && **at == '\t'); (*at)++) {
        if (!is_blank(**at, separator)) {
            return IO_SPLIT_AFTER_QUOTE;
        }
    }
    return IO_SPLIT_OK;
}

static void plain_field(const char **at, const char *end, char separator, struct io_field *field)
{
    const char *start = *at, *stop = memchr(start, separator, (size_t)(end - start));

    stop = stop ? stop : end;
    *at = stop;
    while (stop > start && is_blank(stop[-1], separator)) {
        stop--;
    }
    field->text = start;
    field->length = (size_t)(stop - start);
    field->quoted = 0;
}

/* Fields between runs of blanks and tabs. */
static enum io_split split_blanks(const struct io_field *line, struct io_field *fields, size_t capacity, size_t *count)
{
    const char *at = line->text, *end = at + line->length;

    for (*count = 0;; (*count)++) {
        struct io_field field = {at, 0, 0};
        enum io_split split = IO_SPLIT_OK;

        while (at < end && is_blank(*at, 0)) {
            at++;
        }
        if (at == end) {
            return IO_SPLIT_OK;
        }
        if (*at == '"') {
            split = quoted_field(&at, end, ' ', &field);
        } else {
            field.text = at;
            while (at < end && !is_blank(*at, 0)) {
                at++;
            }
            field.length = (size_t)(at - field.text);
        }
        if (split != IO_SPLIT_OK) {
            ++*count;
            return split;
        }
        if (*count < capacity) {
            fields[*count] = field;
        }
    }
}

enum io_split brdffit_io_split(const struct io_field *line, char separator, struct io_field *fields, size_t capacity,
                               size_t *count)
{
    const char *at = line->text, *end = at + line->length;

    if (separator == ' ') {
        return split_blanks(line, fields, capacity, count);
    }
    for (*count = 1;; (*count)++) {
        struct io_field field;
        enum io_split split = IO_SPLIT_OK;

        while (at < end && is_blank(*at, separator)) {
            at++;
        }
        if (at < end && *at == '"') {
            split = quoted_field(&at, end, separator, &field);
        } else {
            plain_field(&at, end, separator, &field);
        }
        if (split != IO_SPLIT_OK) {
            return split;
        }
        if (*count <= capacity) {
            fields[*count - 1] = field;
        }
        if (at == end) {
            return IO_SPLIT_OK;
        }
        at++; /* the separator */
    }
}
