/*
 * What the columns of a header are for. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_LAYOUT_H
#define BRDFFIT_IO_LAYOUT_H

#include "io/csv/columns.h"

/*
 * Split the header by its separator and find out what its columns are for; columns that are left out or taken on a guess
 * are noted in `table` (NULL: not). What only the numbers can tell is left as it is: brdffit_io_csv_survey(). Release with
 * brdffit_io_layout_free(), on failure too (it must start as all zero bytes but for options, header, line and separator).
 */
brdffit_status brdffit_io_layout(struct csv_layout *layout, struct io_table *table, brdffit_error *error);

#endif
