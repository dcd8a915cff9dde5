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

int brdffit_io_next_line(struct io_lines *lines, struct io_field *line)
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
        if (first < stop && *first != '#') {
            line->text = start;
            line->length = (size_t)(stop - start);
            line->quoted = 0;
            return 1;
        }
    }
    return 0;
}

char brdffit_io_separator(const struct io_field *header)
{
    static const char candidates[3] = {',', ';', '\t'}; /* ties go to the first */
    size_t count[3] = {0, 0, 0}, i;
    int quoted = 0, best = 0, j;

    for (i = 0; i < header->length; i++) {
        quoted ^= header->text[i] == '"';
        for (j = 0; j < 3 && !quoted; j++) {
            count[j] += header->text[i] == candidates[j];
        }
    }
    for (j = 1; j < 3; j++) {
        best = count[j] > count[best] ? j : best;
    }
    return count[best] > 0 ? candidates[best] : 0;
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
    for (*at = close + 1; *at < end && **at != separator; (*at)++) {
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

enum io_split brdffit_io_split(const struct io_field *line, char separator, struct io_field *fields, size_t capacity,
                               size_t *count)
{
    const char *at = line->text, *end = at + line->length;

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
