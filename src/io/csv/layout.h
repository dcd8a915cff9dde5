/*
 * The columns of a text table: what each is for. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_LAYOUT_H
#define BRDFFIT_IO_LAYOUT_H

#include "io/csv/fields.h"
#include "io/csv/roles.h"
#include "io/table.h"

enum csv_kind { CSV_ANGLES, CSV_HALF_ANGLES, CSV_VECTORS, CSV_COEFFICIENTS };

struct csv_layout {
    const brdffit_io_options *options;
    struct io_field header;          /* the line, without the mark of a comment */
    size_t line;                     /* its number */
    char separator;
    enum csv_kind kind;
    size_t columns;
    size_t channels;
    struct csv_meaning *meaning;     /* per column */
    size_t column[CSV_ROLE_COUNT];   /* per role, the column from 0; BRDFFIT_NONE: absent */
    struct io_field *names;          /* per column */
    struct io_field *fields;         /* room for one line */
};

/*
 * Split the header by its separator and find out what its columns are for; columns that are left out or taken on a guess
 * are noted in `table` (NULL: not). What only the numbers can tell is left as it is: brdffit_io_csv_survey(). Release with
 * brdffit_io_layout_free(), on failure too (it must start as all zero bytes but for options, header, line and separator).
 */
brdffit_status brdffit_io_layout(struct csv_layout *layout, struct io_table *table, brdffit_error *error);

void brdffit_io_layout_free(struct csv_layout *layout);

/* 1 when the role has a column. */
int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role);

/* How many columns have been understood as directions, or as a, b, c. */
size_t brdffit_io_layout_score(const struct csv_layout *layout);

/* Failures at a column of the header, from 0 (BRDFFIT_NONE: at none), whose name becomes the fault's text. */
brdffit_status brdffit_io_layout_fail(const struct csv_layout *layout, size_t column, const char *message,
                                      brdffit_error *error);

/* Hand the text at fault to who asked for it. */
void brdffit_io_fault(const brdffit_io_options *options, const struct io_field *field);

/* The name of a column, printable, in `out`. */
#define IO_QUOTED 64
const char *brdffit_io_column_name(const struct csv_layout *layout, size_t column, char out[IO_QUOTED]);

#endif
