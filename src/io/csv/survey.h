/*
 * What columns hold whose names do not say what they are for. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_SURVEY_H
#define BRDFFIT_IO_SURVEY_H

#include "io/csv/columns.h"

/*
 * Make every column of the layout a role, a channel or ignored, looking through the lines where that takes their numbers;
 * count and name the channels. What is left out is noted in the table; what could be wrong to leave out is refused.
 */
brdffit_status brdffit_io_csv_survey(struct io_lines lines, struct csv_layout *layout, const void *c_locale,
                                     struct io_table *table, brdffit_error *error);

#endif
