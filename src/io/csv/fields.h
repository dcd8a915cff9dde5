/*
 * Lines of a text table and their fields. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_FIELDS_H
#define BRDFFIT_IO_FIELDS_H

#include <stddef.h>

/* A piece of the text, not terminated. */
struct io_field {
    const char *text;
    size_t length;
    int quoted; /* text is what stands between the quotes; "" in it is still two characters */
};

/* Where reading has got to; `line` counts from 1 and belongs to the line last returned. */
struct io_lines {
    const char *at, *end;
    size_t line;
};

/*
 * The next line that is neither blank nor a '#' comment, without its end (LF, CRLF or CR). 0: there is none.
 */
int brdffit_io_next_line(struct io_lines *lines, struct io_field *line);

/* Comma, semicolon or tab: whichever the header has most of outside quotes; 0 when it has none. */
char brdffit_io_separator(const struct io_field *header);

enum io_split { IO_SPLIT_OK = 0, IO_SPLIT_UNTERMINATED, IO_SPLIT_AFTER_QUOTE };

/*
 * Split a line. Blanks around a field are stripped, quotes removed. *count becomes the number of fields
 * found; the first `capacity` of them are stored. On failure *count is the number of the field at fault, from 1.
 */
enum io_split brdffit_io_split(const struct io_field *line, char separator, struct io_field *fields, size_t capacity,
                               size_t *count);

#endif
