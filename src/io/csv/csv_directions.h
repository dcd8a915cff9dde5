/*
 * Directions of a data line into a table. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_DIRECTIONS_H
#define BRDFFIT_IO_CSV_DIRECTIONS_H

#include "io/csv/csv_reader.h"

/* From the values of its roles into the arrays at `sample`. NULL, or what is wrong and with which role. */
const char *brdffit_io_csv_store(struct csv_reader *reader, size_t sample, const double *value, enum csv_role *role);

/* 1 when angles of this role are radians, by their unit or by the options. */
int brdffit_io_in_radians(const struct csv_layout *layout, enum csv_role role);

#endif
