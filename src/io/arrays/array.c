/*
 * Opening arrays, whatever their container. SPDX-License-Identifier: MIT
 */
#include "io/arrays/array.h"

#include <string.h>

#include "io/fail.h"
#include "io/bytes/memory.h"
#include "io/arrays/zip_read.h"

static brdffit_status open_npz(struct io_array *array, const char *member, brdffit_error *error)
{
    brdffit_status status = brdffit_io_zip_select(array, member, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_io_npy_open(array, error);
    }
    array->open.container = BRDFFIT_IO_NPZ;
    return status;
}

/* By the first bytes; what has none of them is explained as NPY. */
static brdffit_status open_store(struct io_array *array, const char *member, brdffit_error *error)
{
    unsigned char start[4] = {0};
    size_t size = array->store.size < sizeof start ? (size_t)array->store.size : sizeof start;
    brdffit_status status = brdffit_io_store_read(&array->store, 0, start, size, error);

    array->end = array->store.size;
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (start[0] == 'P' && start[1] == 'K' && ((start[2] == 3 && start[3] == 4) || (start[2] == 5 && start[3] == 6))) {
        return open_npz(array, member, error);
    }
    if (member) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "a member is asked for, and this is no .npz");
    }
    if (start[0] == 'P' && (start[1] == 'F' || start[1] == 'f')) {
        array->open.container = BRDFFIT_IO_PFM;
        return brdffit_io_pfm_open(array, error);
    }
    if (start[0] != 0x93 || start[1] != 'N') {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the file is neither NPY, NPZ nor PFM");
    }
    return brdffit_io_npy_open(array, error);
}

static brdffit_status finish(struct io_array *array, brdffit_status status, brdffit_array **out)
{
    if (status != BRDFFIT_OK) {
        brdffit_io_array_close(&array->open);
        return status;
    }
    *out = &array->open;
    return BRDFFIT_OK;
}

static struct io_array *start(brdffit_array **out, int given, brdffit_status *status, brdffit_error *error)
{
    struct io_array *array;

    if (!out || !given) {
        *status = brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "opening an array: its place or source is NULL");
        return NULL;
    }
    *out = NULL;
    array = brdffit_io_alloc_zero(1, sizeof *array);
    if (!array) {
        *status = brdffit_io_no_memory(error);
        return NULL;
    }
    array->store.descriptor = -1;
    *status = BRDFFIT_OK;
    return array;
}

brdffit_status brdffit_io_array_open(const char *path, const char *member, brdffit_array **out, brdffit_error *error)
{
    brdffit_status status;
    struct io_array *array = start(out, path != NULL, &status, error);

    if (!array) {
        return status;
    }
    status = brdffit_io_store_open(path, &array->store, error);
    if (status == BRDFFIT_OK) {
        status = open_store(array, member, error);
    }
    return finish(array, status, out);
}

brdffit_status brdffit_io_array_open_memory(const void *data, size_t size, const char *member, brdffit_array **out,
                                            brdffit_error *error)
{
    brdffit_status status;
    struct io_array *array = start(out, data != NULL, &status, error);

    if (!array) {
        return status;
    }
    brdffit_io_store_memory(data, size, &array->store);
    return finish(array, open_store(array, member, error), out);
}

void brdffit_io_array_close(brdffit_array *array)
{
    struct io_array *whole = (struct io_array *)array;

    if (whole) {
        brdffit_io_store_close(&whole->store);
        brdffit_io_release(whole);
    }
}
