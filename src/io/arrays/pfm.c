/*
 * Portable float maps: header in, header out. SPDX-License-Identifier: MIT
 *
 * "PF" (three channels) or "Pf" (one), width, height, a scale whose sign tells the byte order (negative: little
 * endian) and whose size nothing here uses, each ended by white space, the last by exactly one; then float32, rows
 * from the bottom up.
 */
#include <stdio.h>
#include <string.h>

#include "io/arrays/array.h"
#include "io/fail.h"

struct cursor {
    const unsigned char *at, *end;
};

static int is_white(unsigned char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static int whole(struct cursor *c, size_t *value)
{
    size_t number = 0;
    const unsigned char *start;

    while (c->at < c->end && is_white(*c->at)) {
        c->at++;
    }
    start = c->at;
    for (; c->at < c->end && *c->at >= '0' && *c->at <= '9'; c->at++) {
        if (c->at - start == 9) {
            return 0;
        }
        number = 10 * number + (size_t)(*c->at - '0');
    }
    *value = number;
    return c->at > start && number > 0;
}

/* The scale's sign; its digits are only checked to be a number that is not zero. */
static int scale(struct cursor *c, int *negative)
{
    int digits = 0, nonzero = 0;

    while (c->at < c->end && is_white(*c->at)) {
        c->at++;
    }
    *negative = c->at < c->end && *c->at == '-';
    c->at += c->at < c->end && (*c->at == '-' || *c->at == '+');
    for (; c->at < c->end && !is_white(*c->at); c->at++) {
        if (!strchr("0123456789.eE+-", *c->at) || *c->at == 0) {
            return 0;
        }
        digits |= *c->at >= '0' && *c->at <= '9';
        nonzero |= *c->at >= '1' && *c->at <= '9';
    }
    return digits && nonzero && c->at < c->end;
}

brdffit_status brdffit_io_pfm_open(struct io_array *array, brdffit_error *error)
{
    unsigned char start[128];
    size_t size = array->end - array->data < sizeof start ? (size_t)(array->end - array->data) : sizeof start;
    struct cursor c;
    int negative = 0;
    size_t width = 0, height = 0;
    brdffit_status status = brdffit_io_store_read(&array->store, array->data, start, size, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    c.at = start + (size < 2 ? size : 2);
    c.end = start + size;
    if (size < 3 || start[0] != 'P' || (start[1] != 'F' && start[1] != 'f') || !is_white(start[2]) ||
        !whole(&c, &width) || c.at >= c.end || !is_white(*c.at) || !whole(&c, &height) || c.at >= c.end ||
        !is_white(*c.at) || !scale(&c, &negative)) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "the PFM header is damaged (value: at byte)",
                                     (double)(c.at - start));
    }
    array->data += (uint64_t)(c.at - start) + 1;
    array->bottom_up = 1;
    array->open.kind = 'f';
    array->open.item_size = 4;
    array->open.big_endian = !negative;
    array->open.dims = start[1] == 'F' ? 3 : 2;
    array->open.shape[0] = height;
    array->open.shape[1] = width;
    array->open.shape[2] = 3;
    return brdffit_io_array_check(array, error);
}

size_t brdffit_io_pfm_header(size_t width, size_t height, int channels, unsigned char out[BRDFFIT_IO_HEADER_MAX])
{
    if ((channels != 1 && channels != 3) || width == 0 || height == 0) {
        return 0;
    }
    return (size_t)snprintf((char *)out, BRDFFIT_IO_HEADER_MAX, "P%c\n%zu %zu\n-1.0\n", channels == 3 ? 'F' : 'f',
                            width, height);
}
