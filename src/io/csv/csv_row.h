/*
 * One data line of a text table. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_ROW_H
#define BRDFFIT_IO_CSV_ROW_H

#include "io/csv/csv_reader.h"

/* Append the line to the table: as a sample, or as a count of `dropped`, or not at all when it is blank. */
brdffit_status brdffit_io_csv_row(struct csv_reader *reader, const struct io_field *line);

#endif
