/*
 * Long tables: a row a wavelength. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_PIVOT_H
#define BRDFFIT_IO_PIVOT_H

#include "io/csv/csv_reader.h"

/*
 * Make one sample of the rows of the same directions, with a channel for each wavelength, ascending. Directions without
 * some wavelength are dropped as absent. `table->rows` then counts samples and what was dropped.
 */
brdffit_status brdffit_io_csv_pivot(struct csv_reader *reader);

#endif
