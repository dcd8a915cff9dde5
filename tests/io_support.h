/*
 * What the tests of the file readers share: texts, tables and files to read. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TEST_IO_SUPPORT_H
#define BRDFFIT_TEST_IO_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <zlib.h>

#include "brdffit_io.h"

/* Equal as numbers, and NaN equals NaN. */
#define assert_same(actual, expected) io_assert_same((actual), (expected), __FILE__, __LINE__)

static inline void io_assert_same(double actual, double expected, const char *file, int line)
{
    if (!(actual == expected || (actual != actual && expected != expected))) {
        print_error("%s:%d: got %.17g, expected %.17g\n", file, line, actual, expected);
        fail();
    }
}

static inline void io_assert_near(double actual, long double expected, double tolerance)
{
    double off = (double)((long double)actual - expected);

    if (!(off <= tolerance && off >= -tolerance)) {
        print_error("got %.17g, expected %.17Lg +- %g\n", actual, expected, tolerance);
        fail();
    }
}

static inline brdffit_status io_text(const char *text, const brdffit_io_options *options, brdffit_table **table,
                                     brdffit_error *error)
{
    return brdffit_io_read_memory(text, strlen(text), options, table, error);
}

/* Read a text that must be accepted. */
static inline brdffit_table *io_good(const char *text)
{
    brdffit_table *table = NULL;
    brdffit_error error;

    memset(&error, 0, sizeof error);
    if (io_text(text, NULL, &table, &error) != BRDFFIT_OK) {
        print_error("refused: %s (line %zu)\n", error.message, error.line);
        fail();
    }
    return table;
}

/* Assert that a reading failed, and why. */
static inline void io_assert_failed(brdffit_status status, const brdffit_table *table, const brdffit_error *error,
                                    brdffit_status expected, const char *part_of_message)
{
    assert_null(table);
    assert_non_null(error->message);
    if (status != expected || !strstr(error->message, part_of_message)) {
        print_error("got %d '%s', expected %d '%s'\n", (int)status, error->message, (int)expected, part_of_message);
        fail();
    }
    assert_int_equal(error->status, status);
}

/* ---- MERL files in memory ------------------------------------------------ */

struct io_merl {
    unsigned char *data;
    size_t size;
    size_t cells;
};

static inline void io_put_int(unsigned char *at, int32_t value)
{
    uint32_t bits = (uint32_t)value;
    int i;

    for (i = 0; i < 4; i++) {
        at[i] = (unsigned char)(bits >> 8 * i);
    }
}

static inline void io_put(struct io_merl *merl, size_t channel, size_t cell, double value)
{
    unsigned char *at = merl->data + 12 + 8 * (channel * merl->cells + cell);
    uint64_t bits;
    int i;

    memcpy(&bits, &value, sizeof bits);
    for (i = 0; i < 8; i++) {
        at[i] = (unsigned char)(bits >> 8 * i);
    }
}

/* Entry of cell i in channel k is 1 + i + 10000 k. Release with free(merl.data). */
static inline struct io_merl io_merl_new(int32_t n_h, int32_t n_d, int32_t n_p)
{
    struct io_merl merl;
    size_t i, k;

    merl.cells = (size_t)n_h * (size_t)n_d * (size_t)n_p;
    merl.size = 12 + 24 * merl.cells;
    merl.data = malloc(merl.size);
    assert_non_null(merl.data);
    io_put_int(merl.data, n_h);
    io_put_int(merl.data + 4, n_d);
    io_put_int(merl.data + 8, n_p);
    for (k = 0; k < 3; k++) {
        for (i = 0; i < merl.cells; i++) {
            io_put(&merl, k, i, (double)(1 + i + 10000 * k));
        }
    }
    return merl;
}

/* ---- gzip ---------------------------------------------------------------- */

/* One gzip member. Release with free(). */
static inline unsigned char *io_gzip(const void *data, size_t size, size_t *packed)
{
    z_stream stream;
    unsigned char *out;

    memset(&stream, 0, sizeof stream);
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    *packed = deflateBound(&stream, size);
    out = malloc(*packed);
    assert_non_null(out);
    stream.next_in = (Bytef *)(uintptr_t)data;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)*packed;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    *packed -= stream.avail_out;
    deflateEnd(&stream);
    return out;
}

#endif
