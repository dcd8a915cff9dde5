/*
 * The zip around the arrays of a .npz. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_ZIP_READ_H
#define BRDFFIT_IO_ZIP_READ_H

#include "io/arrays/array.h"

/* Find `member` (NULL: the only one) and set data and end to it, unpacked into the store if it is deflated. */
brdffit_status brdffit_io_zip_select(struct io_array *array, const char *member, brdffit_error *error);

#endif
