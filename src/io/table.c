/*
 * What is behind a brdffit_table: see table.h. SPDX-License-Identifier: MIT
 */
#include "io/table.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/intake.h"
#include "io/bytes/memory.h"

void brdffit_io_table_connect(struct io_table *table)
{
    table->open.samples = &table->samples;
    table->open.dropped = table->dropped;
}

struct io_table *brdffit_io_table_new(void)
{
    struct io_table *table = brdffit_io_alloc_zero(1, sizeof *table);

    if (table) {
        brdffit_samples_init_sized(&table->samples, INTAKE_LEAST(brdffit_samples, weights));
        brdffit_io_table_connect(table);
    }
    return table;
}

int brdffit_io_table_channels(struct io_table *table, size_t channels)
{
    table->open.channel_names = brdffit_io_alloc_zero(channels, sizeof *table->open.channel_names);
    if (!table->open.channel_names) {
        return 0;
    }
    table->samples.channels = channels;
    table->width[IO_VALUES] = channels;
    return 1;
}

int brdffit_io_table_name(struct io_table *table, size_t k, const char *text, size_t length)
{
    char *name = brdffit_io_alloc(length + 1, 1);

    if (!name) {
        return 0;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    table->open.channel_names[k] = name;
    return 1;
}

int brdffit_io_table_reserve(struct io_table *table, size_t rows)
{
    size_t i;

    if (rows <= table->capacity) {
        return 1;
    }
    for (i = 0; i < IO_ARRAY_COUNT; i++) {
        double *moved;

        if (table->width[i] == 0) {
            continue;
        }
        if (rows > SIZE_MAX / sizeof(double) / table->width[i]) {
            return 0;
        }
        moved = brdffit_io_resize(table->array[i], rows * table->width[i], sizeof(double));
        if (!moved) {
            return 0;
        }
        table->array[i] = moved;
    }
    if (table->with_lines) {
        size_t *moved = brdffit_io_resize(table->open.lines, rows, sizeof *moved);

        if (!moved) {
            return 0;
        }
        table->open.lines = moved;
    }
    table->capacity = rows;
    return 1;
}

void brdffit_io_table_publish(struct io_table *table)
{
    brdffit_samples *samples = &table->samples;

    samples->light = table->array[IO_LIGHT];
    samples->view = table->array[IO_VIEW];
    samples->normal = table->array[IO_NORMAL];
    samples->cos_light = table->array[IO_COS_LIGHT];
    samples->cos_view = table->array[IO_COS_VIEW];
    samples->tan2_half = table->array[IO_TAN2_HALF];
    samples->cos_difference = table->array[IO_COS_DIFFERENCE];
    samples->a = table->array[IO_A];
    samples->b = table->array[IO_B];
    samples->c = table->array[IO_C];
    samples->weights = table->array[IO_WEIGHTS];
    samples->values = table->array[IO_VALUES];
    samples->tangent = table->array[IO_TANGENT];
    if (samples->tangent) { /* a program of before there was one is told that it knows not all of them */
        samples->struct_size = sizeof *samples;
    }
}

/* Room for one more note with `size` bytes of text behind it; NULL: no memory. */
static brdffit_io_note *new_note(struct io_table *table, size_t size)
{
    brdffit_io_note **more = brdffit_io_resize(table->notes, table->open.note_count + 1, sizeof(brdffit_io_note *));
    brdffit_io_note *note = more ? brdffit_io_alloc(sizeof *note + size, 1) : NULL;

    if (more) {
        table->notes = more;
        table->open.notes = (const brdffit_io_note *const *)more;
    }
    if (note) {
        note->text = (char *)(note + 1);
        table->notes[table->open.note_count++] = note;
    }
    return note;
}

void brdffit_io_table_note(struct io_table *table, int warning, const char *format, ...)
{
    va_list arguments;
    brdffit_io_note *note;
    int length;

    va_start(arguments, format);
    length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    note = length < 0 ? NULL : new_note(table, (size_t)length + 1);
    if (!note) {
        table->notes_failed = 1;
        return;
    }
    va_start(arguments, format);
    (void)vsnprintf((char *)(note + 1), (size_t)length + 1, format, arguments);
    va_end(arguments);
    note->warning = (size_t)warning;
}

static void free_notes(struct io_table *table)
{
    size_t i;

    for (i = 0; i < table->open.note_count; i++) {
        brdffit_io_release(table->notes[i]);
    }
    brdffit_io_release(table->notes);
}

void brdffit_io_table_drop_sums(struct io_table *table)
{
    brdffit_io_release(table->sums_memory);
    table->sums_memory = NULL;
    table->open.sums = NULL;
    brdffit_io_unmap(&table->map);
    brdffit_io_bytes_free(&table->bytes);
}

void brdffit_io_free(brdffit_table *table)
{
    struct io_table *whole = (struct io_table *)(void *)table;
    size_t i;

    if (!table) {
        return;
    }
    for (i = 0; i < IO_ARRAY_COUNT; i++) {
        brdffit_io_release(whole->array[i]);
    }
    for (i = 0; table->channel_names && i < whole->samples.channels; i++) {
        brdffit_io_release(table->channel_names[i]);
    }
    brdffit_io_table_drop_sums(whole);
    free_notes(whole);
    brdffit_io_release(table->channel_names);
    brdffit_io_release(table->lines);
    brdffit_io_release(whole);
}
