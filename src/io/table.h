/*
 * What is behind a brdffit_table: growing arrays, owned by it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_TABLE_H
#define BRDFFIT_IO_TABLE_H

#include "base/ieee.h"
#include "brdffit_io.h"
#include "io/bytes/bytes.h"
#include "io/bytes/map.h"

enum io_array {
    IO_LIGHT = 0, /* 3 a sample */
    IO_VIEW,
    IO_NORMAL,
    IO_TANGENT,
    IO_COS_LIGHT, /* 1 a sample */
    IO_COS_VIEW,
    IO_TAN2_HALF,
    IO_COS_DIFFERENCE,
    IO_A,
    IO_B,
    IO_C,
    IO_WEIGHTS,
    IO_VALUES, /* `channels` a sample */
    IO_ARRAY_COUNT
};

/* `open` comes first: a pointer to it is a pointer to the whole. */
struct io_table {
    brdffit_table open;
    brdffit_samples samples; /* of open.samples, and so on */
    size_t dropped[BRDFFIT_IO_DROP_COUNT];
    double *array[IO_ARRAY_COUNT];
    size_t width[IO_ARRAY_COUNT]; /* doubles a sample; 0: not in use */
    int with_lines;
    size_t capacity; /* in samples */

    brdffit_io_note **notes; /* of open.notes, each a block with its text */
    int notes_failed;       /* memory for one ran out: the reading fails */

    void *sums_memory; /* of open.sums; then the file stays, mapped or read, until samples are asked for */
    struct io_map map;
    struct io_bytes bytes;
    brdffit_io_options options;
};

/* Empty, everything zero. NULL: no memory. Released by brdffit_io_free(&table->open). */
struct io_table *brdffit_io_table_new(void);

/* Let open.* point to what the table holds: after it was copied. */
void brdffit_io_table_connect(struct io_table *table);

/* Room for the names of that many channels, all NULL; sets samples.channels and the width of the values.
 * 0: no memory. */
int brdffit_io_table_channels(struct io_table *table, size_t channels);

/* Name channel k with text[0 .. length). 0: no memory. */
int brdffit_io_table_name(struct io_table *table, size_t k, const char *text, size_t length);

/* Room for at least `rows` samples in every array in use. 0: no memory. Pages that stay unused are not touched. */
int brdffit_io_table_reserve(struct io_table *table, size_t rows);

/* Add a note, as of printf; text from a file is to be passed through brdffit_io_quote(). */
void brdffit_io_table_note(struct io_table *table, int warning, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Forget the sums and the file that they came from. */
void brdffit_io_table_drop_sums(struct io_table *table);

/* Unpacked content into a new table (read.c). */
brdffit_status brdffit_io_parse(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                brdffit_table **out, brdffit_error *error);

/* Let samples.* point at the arrays. Call once, when they have stopped moving. */
void brdffit_io_table_publish(struct io_table *table);

#endif
