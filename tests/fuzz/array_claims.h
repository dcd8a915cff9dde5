/*
 * What must hold after an array was opened, whatever was opened; aborts when it does not. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FUZZ_ARRAY_CLAIMS_H
#define BRDFFIT_FUZZ_ARRAY_CLAIMS_H

#include "fuzz/claims.h"

/* Element `index` of every dimension alone must be what the whole has there. */
static inline void claim_element(const brdffit_array *array, const double *all, size_t index)
{
    size_t start[BRDFFIT_IO_MAX_DIMS], one[BRDFFIT_IO_MAX_DIMS], place = 0;
    double value = 0.0;
    brdffit_error error;
    int d;

    for (d = 0; d < array->dims; d++) {
        start[d] = index % array->shape[d];
        one[d] = 1;
        place = place * array->shape[d] + start[d];
    }
    CLAIM(brdffit_io_array_read(array, start, one, &value, &error) == BRDFFIT_OK);
    CLAIM(value == all[place] || (value != value && all[place] != all[place]));
}

static inline void claim_array(const uint8_t *data, size_t size, const char *member)
{
    static const size_t zero[BRDFFIT_IO_MAX_DIMS];
    brdffit_array *array = (brdffit_array *)(uintptr_t)&zero;
    brdffit_error error;
    brdffit_status status;
    size_t product = 1, i;
    double *all;
    int d;

    memset(&error, 0, sizeof error);
    status = brdffit_io_array_open_memory(data, size, member, &array, &error);
    if (status != BRDFFIT_OK) {
        CLAIM(!array && error.status == status && error.message && error.message[0]);
        CLAIM(status == BRDFFIT_ERR_FORMAT || status == BRDFFIT_ERR_READ || status == BRDFFIT_ERR_MEMORY);
        return;
    }
    CLAIM(array->dims >= 0 && array->dims <= BRDFFIT_IO_MAX_DIMS);
    for (d = 0; d < array->dims; d++) {
        CLAIM(array->shape[d] > 0);
        product *= array->shape[d];
    }
    CLAIM(product == array->count);
    CLAIM(array->compressed || array->count * (size_t)array->item_size <= size);
    all = array->count <= 1u << 20 ? malloc(array->count * sizeof *all) : NULL;
    if (all) {
        CLAIM(brdffit_io_array_read(array, zero, array->shape, all, &error) == BRDFFIT_OK);
        for (i = 0; i < 7; i++) {
            claim_element(array, all, 5 * i);
        }
    }
    free(all);
    brdffit_io_array_close(array);
}

/* A .npy of 2 x 3 x 5 elements counted up; returns its size. `order`: "False" or "True". */
static inline size_t seed_npy(unsigned char *out, const char *type, const char *order, size_t item)
{
    unsigned char head[BRDFFIT_IO_HEADER_MAX];
    size_t i, length;

    memcpy(out, "\x93NUMPY\1\0", 8);
    length = (size_t)snprintf((char *)head, sizeof head, "{'descr': '%s', 'fortran_order': %s, 'shape': (2, 3, 5), }\n",
                              type, order);
    out[8] = (unsigned char)length;
    out[9] = 0;
    memcpy(out + 10, head, length);
    for (i = 0; i < 30 * item; i++) {
        out[10 + length + i] = (unsigned char)(i * 7);
    }
    return 10 + length + 30 * item;
}

#endif
