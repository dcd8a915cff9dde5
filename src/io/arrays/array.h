/*
 * A numeric array in a file, as the readers of the containers hand it to each other. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_ARRAY_H
#define BRDFFIT_IO_ARRAY_H

#include <stdint.h>

#include "brdffit_io.h"
#include "io/bytes/store.h"

struct io_array {
    brdffit_array open; /* first: what the caller sees */
    struct io_store store;
    uint64_t data;    /* where its elements begin */
    uint64_t end;     /* where the array's bytes end in the store */
    int bottom_up;    /* the first dimension runs backwards in the file (PFM) */
};

/* A name within a container; `text` is not NUL-terminated. */
struct io_name {
    const char *text;
    size_t length;
};

/* Read the header at `array->data` of what ends at `array->end`; move `data` to the elements. */
brdffit_status brdffit_io_npy_open(struct io_array *array, brdffit_error *error);
brdffit_status brdffit_io_pfm_open(struct io_array *array, brdffit_error *error);

/* Fill in count from shape; what shape and item_size say must be what lies between `data` and `end`. */
brdffit_status brdffit_io_array_check(struct io_array *array, brdffit_error *error);

/* One element, or a run of them, as the file has them, to doubles. */
void brdffit_io_elements(const brdffit_array *array, const unsigned char *from, size_t count, double *to);

#endif
