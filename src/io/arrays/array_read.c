/*
 * Any block of an array, from the file to doubles. SPDX-License-Identifier: MIT
 *
 * Dimensions are taken in the file's order, the fastest last. The trailing ones that are wanted whole lie side by
 * side with the one before them: that is one run of the file. Runs are read in pieces, converted, and put where the
 * output's order wants them.
 */
#include <string.h>

#include "io/arrays/array.h"
#include "io/fail.h"
#include "io/limits.h"

struct walk {
    int dims, outer;      /* dimensions in the file's order; the first `outer` are stepped through, the rest a run */
    size_t start[BRDFFIT_IO_MAX_DIMS], count[BRDFFIT_IO_MAX_DIMS];
    size_t file[BRDFFIT_IO_MAX_DIMS], out[BRDFFIT_IO_MAX_DIMS]; /* strides, elements */
    size_t at[BRDFFIT_IO_MAX_DIMS];
    size_t run;           /* elements */
    int straight;         /* a run has the output's order */
};

static int set_up(const struct io_array *array, const size_t *start, const size_t *count, struct walk *w)
{
    const brdffit_array *a = &array->open;
    size_t file = 1, out[BRDFFIT_IO_MAX_DIMS], stride = 1;
    int d, i;

    w->dims = a->dims;
    for (d = a->dims; d-- > 0; stride *= count[d]) {
        if (count[d] == 0 || start[d] >= a->shape[d] || count[d] > a->shape[d] - start[d]) {
            return 0;
        }
        out[d] = stride;
    }
    for (i = a->dims; i-- > 0;) {
        d = a->fortran_order ? a->dims - 1 - i : i;
        w->start[i] = start[d];
        w->count[i] = count[d];
        w->file[i] = file;
        w->out[i] = out[d];
        w->at[i] = 0;
        file *= a->shape[d];
    }
    w->run = 1;
    w->straight = 1;
    for (i = a->dims; i-- > 0;) {
        d = a->fortran_order ? a->dims - 1 - i : i;
        if (i == 0 && array->bottom_up) {
            i++;
            break;
        }
        w->straight &= w->out[i] == w->run || w->count[i] == 1;
        w->run *= w->count[i];
        if (w->count[i] != a->shape[d]) {
            break;
        }
    }
    w->outer = i < 0 ? 0 : i;
    return 1;
}

/* The next element's place in the output, within a run. */
static void advance(struct walk *w, size_t *place)
{
    int i;

    for (i = w->dims; i-- > w->outer;) {
        *place += w->out[i];
        if (++w->at[i] < w->count[i]) {
            return;
        }
        *place -= w->out[i] * w->count[i];
        w->at[i] = 0;
    }
}

static brdffit_status read_run(const struct io_array *array, struct walk *w, uint64_t from, size_t place, double *out,
                               brdffit_error *error)
{
    unsigned char raw[8 * IO_ELEMENTS];
    double values[IO_ELEMENTS];
    size_t left = w->run, n, i;

    for (; left > 0; left -= n) {
        brdffit_status status;

        n = left < IO_ELEMENTS ? left : IO_ELEMENTS;
        status = brdffit_io_store_read(&array->store, from, raw, n * (size_t)array->open.item_size, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        from += n * (size_t)array->open.item_size;
        brdffit_io_elements(&array->open, raw, n, w->straight ? out + place : values);
        if (w->straight) {
            place += n;
            continue;
        }
        for (i = 0; i < n; i++) {
            out[place] = values[i];
            advance(w, &place);
        }
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_array_read(const brdffit_array *open, const size_t *start, const size_t *count, double *out,
                                     brdffit_error *error)
{
    const struct io_array *array = (const struct io_array *)open;
    struct walk w;
    int i;

    if (!open || !out || (open->dims > 0 && (!start || !count)) || !set_up(array, start, count, &w)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "reading an array: NULL, or a block outside of it");
    }
    for (;;) {
        uint64_t from = 0;
        size_t place = 0;
        brdffit_status status;

        for (i = 0; i < w.dims; i++) {
            size_t index = w.start[i] + (i < w.outer ? w.at[i] : 0);

            if (i == 0 && array->bottom_up) {
                index = open->shape[0] - 1 - index;
            }
            from += (uint64_t)index * w.file[i];
            place += i < w.outer ? w.at[i] * w.out[i] : 0;
        }
        status = read_run(array, &w, array->data + from * (uint64_t)open->item_size, place, out, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        for (i = w.outer; i-- > 0;) {
            if (++w.at[i] < w.count[i]) {
                break;
            }
            w.at[i] = 0;
        }
        if (i < 0) {
            return BRDFFIT_OK;
        }
    }
}
