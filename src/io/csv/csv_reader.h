/*
 * What the parts of the text reader share while they read. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_READER_H
#define BRDFFIT_IO_CSV_READER_H

#include "io/csv/cell.h"
#include "io/csv/columns.h"
#include "io/fail.h"

/* What has been seen so far, for what is said at the end. */
struct csv_reader {
    const struct csv_layout *layout;
    struct io_table *table; /* its arrays have room for one more sample */
    const void *c_locale;
    brdffit_error *error;
    double *wavelength; /* of each sample, with room like the table's; NULL: no such column */
    size_t line;
    struct io_writing writing;
    struct io_place unclear; /* the first number with one comma that may part thousands */
    struct io_field unclear_text;
    size_t missing;     /* samples without a value that is a word or options.missing, not an empty field */
    size_t longer;      /* lines with empty fields at their end that the header has not */
    size_t azimuths;    /* missing at the normal */
    size_t headers;     /* repeated */
    size_t polar_signed, polar_broken; /* polar angles below 0; that are no whole degrees */
    size_t light_at_right, near_normal; /* of 90 degrees; of less than 1, both sides */
    double polar_most; /* absolute, as written */
};

#endif
