/*
 * What a caller says about columns: options.columns and options.channels. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CHOICE_H
#define BRDFFIT_IO_CHOICE_H

#include "io/csv/columns.h"

/* Give the columns that options name the roles that they say. Fails where there is no such role or column. */
brdffit_status brdffit_io_choose_columns(struct csv_layout *layout, brdffit_error *error);

/* 1 when options.channels names the column. */
int brdffit_io_is_chosen(const struct csv_layout *layout, size_t column);

#endif
