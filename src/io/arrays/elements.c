/*
 * How many elements an array has, and these, of any type and byte order, to doubles. SPDX-License-Identifier: MIT
 *
 * Bytes are put together by shifts, so that neither the machine's byte order nor alignment matters.
 */
#include <string.h>

#include "io/arrays/array.h"
#include "io/fail.h"

brdffit_status brdffit_io_array_check(struct io_array *array, brdffit_error *error)
{
    brdffit_array *open = &array->open;
    size_t bytes = (size_t)open->item_size;
    uint64_t there = array->end - array->data;
    int d;

    for (d = 0; d < open->dims; d++) {
        if (open->shape[d] == 0) {
            return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the array has no elements");
        }
        if (bytes > SIZE_MAX / open->shape[d]) {
            return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the array claims more bytes than can be addressed");
        }
        bytes *= open->shape[d];
    }
    open->count = bytes / (size_t)open->item_size;
    if (bytes > there) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT,
                                     "the file is shorter than its header says (value: bytes missing)",
                                     (double)(bytes - there));
    }
    if (bytes < there) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT,
                                     "the file is longer than its header says (value: bytes too many)",
                                     (double)(there - bytes));
    }
    return BRDFFIT_OK;
}

static uint64_t gather(const unsigned char *from, int size, int big_endian)
{
    uint64_t bits = 0;
    int i;

    for (i = 0; i < size; i++) {
        bits |= (uint64_t)from[big_endian ? size - 1 - i : i] << 8 * i;
    }
    return bits;
}

static double as_double(uint64_t bits)
{
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

static double as_float(uint64_t bits)
{
    uint32_t low = (uint32_t)bits;
    float value;

    memcpy(&value, &low, sizeof value);
    return (double)value;
}

/* float16: sign, 5 bits of exponent (bias 15), 10 of fraction. */
static double as_half(uint64_t bits)
{
    double sign = bits & 0x8000 ? -1.0 : 1.0;
    unsigned exponent = (unsigned)(bits >> 10) & 31, fraction = (unsigned)bits & 1023;

    if (exponent == 31) {
        return fraction ? as_double(UINT64_C(0x7ff8000000000000)) : sign * as_double(UINT64_C(0x7ff0000000000000));
    }
    if (exponent == 0) {
        return sign * (double)fraction / 16777216.0; /* 2^-24 */
    }
    return sign * (double)(1024 + fraction) * (double)(UINT64_C(1) << exponent) / 33554432.0; /* 2^25 */
}

static double as_signed(uint64_t bits, int size)
{
    uint64_t sign = UINT64_C(1) << (8 * size - 1);

    return bits & sign ? -(double)(((bits ^ (sign | (sign - 1))) & (sign | (sign - 1))) + 1) : (double)bits;
}

static double element(const brdffit_array *array, const unsigned char *from)
{
    uint64_t bits = gather(from, array->item_size, array->big_endian);

    switch (array->kind) {
    case 'f': return array->item_size == 8 ? as_double(bits) : array->item_size == 4 ? as_float(bits) : as_half(bits);
    case 'i': return as_signed(bits, array->item_size);
    case 'b': return bits ? 1.0 : 0.0;
    default: return (double)bits;
    }
}

/* The commonest type, several at a time where the machine has its byte order. */
static void little_floats(const unsigned char *from, size_t count, double *to)
{
    size_t i = 0;

#if defined(__GNUC__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    typedef float narrow __attribute__((vector_size(16)));
    typedef double wide __attribute__((vector_size(32)));

    for (; i + 4 <= count; i += 4) {
        narrow four;
        wide converted;

        memcpy(&four, from + 4 * i, sizeof four);
        converted = __builtin_convertvector(four, wide);
        memcpy(to + i, &converted, sizeof converted);
    }
#endif
    for (; i < count; i++) {
        to[i] = as_float(gather(from + 4 * i, 4, 0));
    }
}

void brdffit_io_elements(const brdffit_array *array, const unsigned char *from, size_t count, double *to)
{
    size_t i, step = (size_t)array->item_size;

    if (array->kind == 'f' && array->item_size == 4 && !array->big_endian) {
        little_floats(from, count, to);
        return;
    }
    for (i = 0; i < count; i++) {
        to[i] = element(array, from + i * step);
    }
}
