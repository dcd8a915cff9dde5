/*
 * Which kind of directions a header names. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_KIND_H
#define BRDFFIT_IO_KIND_H

#include "io/csv/columns.h"

/* Set layout->kind, or say what is missing. Columns that look like directions and are none are left out, noted in `table`
 * (NULL: not), where the directions are complete without them, else refused. */
brdffit_status brdffit_io_layout_kind(struct csv_layout *layout, struct io_table *table, brdffit_error *error);

#endif
