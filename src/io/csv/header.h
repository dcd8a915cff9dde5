/*
 * Where the header of a text table is, and how its fields are separated. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_HEADER_H
#define BRDFFIT_IO_HEADER_H

#include "io/csv/layout.h"

/*
 * Find the header from where `lines` is, at the start of the text, and fill the layout (layout.h), whose options must be
 * set. `lines` then is below it and below a row of units, which are obeyed.
 */
brdffit_status brdffit_io_csv_header(struct io_lines *lines, struct csv_layout *layout, struct io_table *table,
                                     brdffit_error *error);

#endif
