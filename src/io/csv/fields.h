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

/* The next line that is not blank, without its end (LF, CRLF or CR). 0: there is none. */
int brdffit_io_any_line(struct io_lines *lines, struct io_field *line);

/* The next line that is no comment either. */
int brdffit_io_next_line(struct io_lines *lines, struct io_field *line);

/* What follows the mark of a comment (#, % or //), or NULL: the line is none. */
const char *brdffit_io_comment(const struct io_field *line);

/* Separators, in the order in which a tie goes; ' ' stands for any run of blanks and tabs. */
#define IO_SEPARATORS ",;\t| "

/* How often each of them stands outside quotes; ' ': between two fields that only blanks part. */
void brdffit_io_count_separators(const struct io_field *line, size_t count[5]);

enum io_split { IO_SPLIT_OK = 0, IO_SPLIT_UNTERMINATED, IO_SPLIT_AFTER_QUOTE };

/*
 * Split a line; `separator` is one of IO_SEPARATORS. Blanks around a field are stripped, quotes removed. *count becomes the number of fields
 * found; the first `capacity` of them are stored. On failure *count is the number of the field at fault, from 1.
 */
enum io_split brdffit_io_split(const struct io_field *line, char separator, struct io_field *fields, size_t capacity,
                               size_t *count);

#endif
