/*
 * The columns of a text table, and what is said of them. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_COLUMNS_H
#define BRDFFIT_IO_COLUMNS_H

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

void brdffit_io_layout_free(struct csv_layout *layout);

/* 1 when the role has a column. */
int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role);

/* How many columns have been understood as directions, or as a, b, c. */
size_t brdffit_io_layout_score(const struct csv_layout *layout);

/* Failures at a column of the header, from 0 (BRDFFIT_NONE: at none), whose name becomes the fault's text. */
brdffit_status brdffit_io_layout_fail(const struct csv_layout *layout, size_t column, const char *message,
                                      brdffit_error *error);

/* The name of a column, printable, in `out`. */
#define IO_QUOTED 64
const char *brdffit_io_column_name(const struct csv_layout *layout, size_t column, char out[IO_QUOTED]);

/* 1 when some column has a role from first to last. */
int brdffit_io_layout_any(const struct csv_layout *layout, enum csv_role first, enum csv_role last);

/* Hand the text at fault to who asked for it. */
void brdffit_io_fault(const brdffit_io_options *options, const struct io_field *field);

#endif
