/*
 * NumPy's .npy: header in, header out. SPDX-License-Identifier: MIT
 *
 * "\x93NUMPY", version, the header's length (two bytes in version 1, four in 2 and 3), a Python dictionary, then the
 * elements and nothing else. Version 3 allows UTF-8 in names of fields, which no array of numbers has.
 */
#include <stdio.h>
#include <string.h>

#include "io/arrays/array.h"
#include "io/fail.h"
#include "io/limits.h"
#include "io/bytes/memory.h"
#include "io/arrays/npy_literal.h"

static const char magic[] = "\x93NUMPY";
#define MAGIC (sizeof magic - 1)

static brdffit_status length_of(const struct io_array *array, uint64_t *at, size_t *length, brdffit_error *error)
{
    unsigned char start[MAGIC + 6];
    brdffit_status status;
    size_t wide;

    if (array->end - array->data < sizeof start) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "the file is too short for NPY (value: bytes found)",
                                     (double)(array->end - array->data));
    }
    status = brdffit_io_store_read(&array->store, array->data, start, sizeof start, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (memcmp(start, magic, MAGIC) != 0) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "it does not begin as NPY does (value: at byte)",
                                     (double)array->data);
    }
    if (start[MAGIC] < 1 || start[MAGIC] > 3 || start[MAGIC + 1] != 0) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "an unknown version of NPY (value: version)",
                                     start[MAGIC] + start[MAGIC + 1] / 1000.0);
    }
    wide = start[MAGIC] == 1 ? 2 : 4;
    *length = (size_t)start[MAGIC + 2] | (size_t)start[MAGIC + 3] << 8;
    if (wide == 4) {
        *length |= (size_t)start[MAGIC + 4] << 16 | (size_t)start[MAGIC + 5] << 24;
    }
    *at = array->data + MAGIC + 2 + wide;
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_npy_open(struct io_array *array, brdffit_error *error)
{
    uint64_t at = 0;
    size_t length = 0;
    char *text;
    brdffit_status status = length_of(array, &at, &length, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (length > IO_LIMIT_NPY_HEADER) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "the NPY header claims more bytes than any has",
                                     (double)length);
    }
    if (length > array->end - at) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "the file ends within the NPY header (value: at byte)",
                                     (double)array->end);
    }
    text = brdffit_io_alloc(length, 1);
    if (!text) {
        return brdffit_io_no_memory(error);
    }
    status = brdffit_io_store_read(&array->store, at, text, length, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_io_npy_literal(text, length, (size_t)at, &array->open, error);
    }
    brdffit_io_release(text);
    array->data = at + length;
    return status == BRDFFIT_OK ? brdffit_io_array_check(array, error) : status;
}

static int writable(char kind, int item_size)
{
    return (kind == 'f' && (item_size == 4 || item_size == 8)) ||
           (kind == 'u' && (item_size == 1 || item_size == 2 || item_size == 4 || item_size == 8)) ||
           (kind == 'b' && item_size == 1);
}

size_t brdffit_io_npy_header(char kind, int item_size, int dims, const size_t *shape,
                             unsigned char out[BRDFFIT_IO_HEADER_MAX])
{
    char *text = (char *)out + MAGIC + 4;
    size_t room = BRDFFIT_IO_HEADER_MAX - MAGIC - 4, used, total;
    int d;

    if (!writable(kind, item_size) || dims < 0 || dims > BRDFFIT_IO_MAX_DIMS) {
        return 0;
    }
    used = (size_t)snprintf(text, room, "{'descr': '%c%c%d', 'fortran_order': False, 'shape': (",
                            item_size == 1 ? '|' : '<', kind, item_size);
    for (d = 0; d < dims; d++) {
        used += (size_t)snprintf(text + used, room - used, d == 0 ? (dims == 1 ? "%zu," : "%zu") : ", %zu", shape[d]);
    }
    used += (size_t)snprintf(text + used, room - used, "), }");
    /* Elements begin at a multiple of 64 bytes. */
    total = (MAGIC + 4 + used + 1 + 63) / 64 * 64;
    memset(text + used, ' ', total - MAGIC - 4 - used);
    out[total - 1] = '\n';
    memcpy(out, magic, MAGIC);
    out[MAGIC] = 1;
    out[MAGIC + 1] = 0;
    out[MAGIC + 2] = (unsigned char)((total - MAGIC - 4) & 255);
    out[MAGIC + 3] = (unsigned char)((total - MAGIC - 4) >> 8);
    return total;
}
