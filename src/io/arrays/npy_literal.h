/*
 * The dictionary in the header of a .npy. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_NPY_LITERAL_H
#define BRDFFIT_IO_NPY_LITERAL_H

#include "brdffit_io.h"

/*
 * Read {'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), } into kind, item_size, big_endian, fortran_order,
 * dims and shape. error->value: the byte of the text, counted from `base`.
 */
brdffit_status brdffit_io_npy_literal(const char *text, size_t size, size_t base, brdffit_array *array,
                                      brdffit_error *error);

#endif
