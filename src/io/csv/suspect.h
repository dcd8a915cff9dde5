/*
 * Tables that read well and are wrong: what their numbers look like. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_SUSPECT_H
#define BRDFFIT_IO_SUSPECT_H

#include "io/csv/csv_reader.h"

/* Marks of missing values are refused (options.missing); negative and saturated values are noted. */
brdffit_status brdffit_io_suspect_values(struct csv_reader *reader);

/* Radians, lights that point to the surface and y-up frames are refused; elevation, another azimuth of the mirror
 * direction and samples below the horizon are noted (options.directions_as). */
brdffit_status brdffit_io_suspect_directions(struct csv_reader *reader);

#endif
