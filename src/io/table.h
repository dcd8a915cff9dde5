/*
 * What is behind a brdffit_table: growing arrays, owned by it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_TABLE_H
#define BRDFFIT_IO_TABLE_H

#include "brdffit_io.h"

enum io_array {
    IO_LIGHT = 0, /* 3 a sample */
    IO_VIEW,
    IO_NORMAL,
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
    double *array[IO_ARRAY_COUNT];
    size_t width[IO_ARRAY_COUNT]; /* doubles a sample; 0: not in use */
    int with_lines;
    size_t capacity; /* in samples */
};

/* Empty, everything zero. NULL: no memory. Released by brdffit_io_free(&table->open). */
struct io_table *brdffit_io_table_new(void);

/* Room for the names of that many channels, all NULL; sets samples.channels and the width of the values.
 * 0: no memory. */
int brdffit_io_table_channels(struct io_table *table, size_t channels);

/* Name channel k with text[0 .. length). 0: no memory. */
int brdffit_io_table_name(struct io_table *table, size_t k, const char *text, size_t length);

/* Room for at least `rows` samples in every array in use. 0: no memory. Pages that stay unused are not touched. */
int brdffit_io_table_reserve(struct io_table *table, size_t rows);

/* Let samples.* point at the arrays. Call once, when they have stopped moving. */
void brdffit_io_table_publish(struct io_table *table);

#endif
