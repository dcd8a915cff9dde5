/*
 * Text tables: comma, semicolon or tab separated. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_H
#define BRDFFIT_IO_CSV_H

#include "io/table.h"

/* Fill `table` (new and empty) from the text. The caller frees the table, on failure too. */
brdffit_status brdffit_io_csv_read(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                   struct io_table *table, brdffit_error *error);

#endif
