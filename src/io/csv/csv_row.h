/*
 * One data line of a text table becomes one sample. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_ROW_H
#define BRDFFIT_IO_CSV_ROW_H

#include "io/csv/csv_header.h"

/*
 * Parse `line` and store it as sample table->open.samples.count, for which there is room, or count it as
 * dropped. `c_locale` as in number.h.
 */
brdffit_status brdffit_io_csv_row(const struct io_field *line, size_t line_number, const struct csv_layout *layout,
                                  const void *c_locale, struct io_table *table, brdffit_error *error);

#endif
