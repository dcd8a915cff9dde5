/*
 * The header line of a text table: what each column means. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_HEADER_H
#define BRDFFIT_IO_CSV_HEADER_H

#include "io/csv/fields.h"
#include "io/table.h"

enum csv_role {
    CSV_THETA_I = 0,
    CSV_PHI_I,
    CSV_THETA_O,
    CSV_PHI_O,
    CSV_LX,
    CSV_LY,
    CSV_LZ,
    CSV_VX,
    CSV_VY,
    CSV_VZ,
    CSV_NX,
    CSV_NY,
    CSV_NZ,
    CSV_A,
    CSV_B,
    CSV_C,
    CSV_WEIGHT,
    CSV_UNCERTAINTY, /* standard deviation of the values: of weight 1 / u^2, see csv_weight.h */
    CSV_ROLE_COUNT,
    CSV_CHANNEL = CSV_ROLE_COUNT
};

enum csv_kind { CSV_ANGLES, CSV_VECTORS, CSV_COEFFICIENTS };

struct csv_layout {
    char separator;
    enum csv_kind kind;
    size_t columns;
    size_t channels;
    int directions_only;             /* no channel is fine */
    enum csv_role *role;             /* per column */
    size_t column[CSV_ROLE_COUNT];   /* per role, the column from 0; BRDFFIT_NONE: absent */
    struct io_field *fields;         /* room for one line */
};

/*
 * Read the header: fill the layout and name the table's channels in their order. The caller releases the layout
 * with brdffit_io_csv_layout_free(), on failure too (it must start as all zero bytes).
 */
brdffit_status brdffit_io_csv_header(const struct io_field *line, size_t line_number, struct csv_layout *layout,
                                     struct io_table *table, brdffit_error *error);

void brdffit_io_csv_layout_free(struct csv_layout *layout);

/* 1 when the role has a column. */
int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role);

#endif
