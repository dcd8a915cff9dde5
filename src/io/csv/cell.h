/*
 * Fields of a text table as numbers, in whatever way they are written. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CELL_H
#define BRDFFIT_IO_CELL_H

#include "io/csv/fields.h"
#include "io/csv/number.h"

enum io_cell {
    IO_CELL_NUMBER = 0,
    IO_CELL_EMPTY,
    IO_CELL_MISSING,   /* NA, NaN, -, #DIV/0! and the like */
    IO_CELL_THOUSANDS, /* digits in groups */
    IO_CELL_MIXED,     /* a decimal comma where there are decimal points, or the other way round */
    IO_CELL_WRONG      /* see the fault */
};

/* How the numbers of a file are written so far. */
struct io_writing {
    size_t commas;   /* that can only be decimal commas */
    size_t unclear;  /* 1,234: a decimal comma, or thousands? */
    size_t points;
    size_t degrees;  /* with a degree sign */
    size_t percents; /* with a percent sign: *value is a hundredth */
};

/* The number in a field; `fault` says what is wrong with IO_CELL_WRONG. */
enum io_cell brdffit_io_cell(const struct io_field *field, const void *c_locale, struct io_writing *writing,
                             double *value, enum io_number *fault);

#endif
