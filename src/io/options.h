/*
 * Checking brdffit_io_options. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_OPTIONS_H
#define BRDFFIT_IO_OPTIONS_H

#include "brdffit_io.h"

/* Copy `given` (NULL: the defaults) to `out` after checking every field, the directions' vectors included. */
brdffit_status brdffit_io_options_check(const brdffit_io_options *given, brdffit_io_options *out, brdffit_error *error);

/* The samples that options->directions points to, as this version knows them; 0 when it does not. */
int brdffit_io_directions(const brdffit_io_options *options, brdffit_samples *own);

/* 1 when something is asked for that only text tables can be read by. */
int brdffit_io_wants_text(const brdffit_io_options *options);

/* The limits that these options set, in bytes: of a file, and of what a gzip stream unpacks to. */
size_t brdffit_io_file_limit(const brdffit_io_options *options);
size_t brdffit_io_unpacked_limit(const brdffit_io_options *options);

#endif
