/*
 * Rows of wavelengths to channels: see pivot.h. SPDX-License-Identifier: MIT
 *
 * Rows are sorted by directions and wavelength; where both repeat (a measurement that was made again), the n-th of a
 * wavelength belongs to the n-th of the others. Samples keep the order of their first rows.
 */
#include "io/csv/pivot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/bytes/memory.h"

/* Wavelengths at most: more than any spectrometer has, few enough for a channel each. */
#define MOST_CHANNELS 4096

struct entry {
    const double *direction[4]; /* light, view, and what there is of normal and tangent; the rest NULL */
    double wavelength;
    size_t sample;
    size_t turn;  /* of this wavelength at these directions, from 0 */
    size_t first; /* the first row of its group */
};

struct pivot {
    struct csv_reader *reader;
    struct entry *entries;
    size_t count;
    double *wavelengths;
    size_t channels;
};

static int compare_doubles(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;

    return a < b ? -1 : a > b;
}

static int compare_directions(const struct entry *a, const struct entry *b)
{
    int k, d;

    for (k = 0; k < 4 && a->direction[k]; k++) {
        for (d = 0; d < 3; d++) {
            if (a->direction[k][d] != b->direction[k][d]) {
                return a->direction[k][d] < b->direction[k][d] ? -1 : 1;
            }
        }
    }
    return 0;
}

static int compare_sizes(size_t a, size_t b)
{
    return a < b ? -1 : a > b;
}

static int by_wavelength(const void *left, const void *right)
{
    const struct entry *a = left, *b = right;
    int order = compare_directions(a, b);

    order = order ? order : compare_doubles(&a->wavelength, &b->wavelength);
    return order ? order : compare_sizes(a->sample, b->sample);
}

static int by_turn(const void *left, const void *right)
{
    const struct entry *a = left, *b = right;
    int order = compare_directions(a, b);

    order = order ? order : compare_sizes(a->turn, b->turn);
    return order ? order : compare_doubles(&a->wavelength, &b->wavelength);
}

static int by_first(const void *left, const void *right)
{
    const struct entry *a = left, *b = right;
    const int order = compare_sizes(a->first, b->first);

    return order ? order : compare_doubles(&a->wavelength, &b->wavelength);
}

static brdffit_status fail(const struct pivot *p, const char *message)
{
    const struct csv_layout *layout = p->reader->layout;

    return brdffit_io_layout_fail(layout, layout->column[CSV_WAVELENGTH], message, p->reader->error);
}

static void make_entries(struct pivot *p)
{
    const struct io_table *t = p->reader->table;
    size_t i;

    for (i = 0; i < p->count; i++) {
        p->entries[i].direction[0] = t->array[IO_LIGHT] + 3 * i;
        p->entries[i].direction[1] = t->array[IO_VIEW] + 3 * i;
        p->entries[i].direction[2] = p->entries[i].direction[3] = NULL;
        if (t->width[IO_NORMAL]) {
            p->entries[i].direction[2] = t->array[IO_NORMAL] + 3 * i;
        }
        if (t->width[IO_TANGENT]) {
            p->entries[i].direction[t->width[IO_NORMAL] ? 3 : 2] = t->array[IO_TANGENT] + 3 * i;
        }
        p->entries[i].wavelength = p->wavelengths[i] = p->reader->wavelength[i];
        p->entries[i].sample = i;
        p->entries[i].turn = p->entries[i].first = 0;
    }
}

/* Sorted, each once. */
static void distinct_wavelengths(struct pivot *p)
{
    size_t i;

    qsort(p->wavelengths, p->count, sizeof *p->wavelengths, compare_doubles);
    p->channels = p->count > 0;
    for (i = 1; i < p->count; i++) {
        if (p->wavelengths[i] != p->wavelengths[p->channels - 1]) {
            p->wavelengths[p->channels++] = p->wavelengths[i];
        }
    }
}

static void count_turns(struct pivot *p)
{
    size_t i;

    qsort(p->entries, p->count, sizeof *p->entries, by_wavelength);
    for (i = 1; i < p->count; i++) {
        const struct entry *before = &p->entries[i - 1];

        if (compare_directions(before, &p->entries[i]) == 0 && before->wavelength == p->entries[i].wavelength) {
            p->entries[i].turn = before->turn + 1;
        }
    }
}

/* Ends of the group that begins at `at`: the same directions and turn. */
static size_t group_end(const struct pivot *p, size_t at)
{
    size_t end = at + 1;

    while (end < p->count && p->entries[end].turn == p->entries[at].turn &&
           compare_directions(&p->entries[end], &p->entries[at]) == 0) {
        end++;
    }
    return end;
}

static void find_firsts(struct pivot *p)
{
    size_t at, end, i;

    qsort(p->entries, p->count, sizeof *p->entries, by_turn);
    for (at = 0; at < p->count; at = end) {
        size_t first = p->entries[at].sample;

        end = group_end(p, at);
        for (i = at; i < end; i++) {
            first = p->entries[i].sample < first ? p->entries[i].sample : first;
        }
        for (i = at; i < end; i++) {
            p->entries[i].first = first;
        }
    }
    qsort(p->entries, p->count, sizeof *p->entries, by_first);
}

static brdffit_status name_channels(struct pivot *p)
{
    struct io_table *t = p->reader->table;
    size_t k;

    brdffit_io_release(t->open.channel_names[0]);
    brdffit_io_release(t->open.channel_names);
    t->samples.channels = 0;
    if (!brdffit_io_table_channels(t, p->channels)) {
        return brdffit_io_no_memory(p->reader->error);
    }
    for (k = 0; k < p->channels; k++) {
        char name[32];
        const int length = snprintf(name, sizeof name, "%.10g", p->wavelengths[k]);

        if (!brdffit_io_table_name(t, k, name, (size_t)length)) {
            return brdffit_io_no_memory(p->reader->error);
        }
    }
    return BRDFFIT_OK;
}

static void move_sample(struct io_table *t, size_t from, size_t to)
{
    int i;

    for (i = 0; i < IO_ARRAY_COUNT; i++) {
        if (t->width[i] && i != IO_VALUES) {
            memmove(t->array[i] + to * t->width[i], t->array[i] + from * t->width[i], t->width[i] * sizeof(double));
        }
    }
    t->open.lines[to] = t->open.lines[from];
}

/* Complete groups become samples. First rows ascend, so that nothing is overwritten before it has moved. */
static void gather(struct pivot *p, const double *old, double *values)
{
    struct io_table *t = p->reader->table;
    size_t at, end, k, out = 0;

    t->open.negative = 0;
    for (at = 0; at < p->count; at = end) {
        int negative = 0;

        for (end = at + 1; end < p->count && p->entries[end].first == p->entries[at].first; end++) {
        }
        if (end - at < p->channels) {
            t->dropped[BRDFFIT_IO_DROP_ABSENT]++;
            continue;
        }
        for (k = 0; k < p->channels; k++) {
            values[out * p->channels + k] = old[p->entries[at + k].sample];
            negative |= values[out * p->channels + k] < 0.0;
        }
        t->open.negative += (size_t)negative;
        move_sample(t, p->entries[at].first, out++);
    }
    t->samples.count = out;
    t->capacity = out;
}

/* Weights belong to samples: the wavelengths of one must agree. */
static int weights_agree(const struct pivot *p)
{
    const struct io_table *t = p->reader->table;
    size_t i;

    for (i = 1; t->width[IO_WEIGHTS] && i < p->count; i++) {
        if (p->entries[i].first == p->entries[i - 1].first &&
            t->array[IO_WEIGHTS][p->entries[i].sample] != t->array[IO_WEIGHTS][p->entries[i - 1].sample]) {
            return 0;
        }
    }
    return 1;
}

static brdffit_status rebuild(struct pivot *p)
{
    struct io_table *t = p->reader->table;
    double *old = t->array[IO_VALUES], *values;
    const size_t absent = t->dropped[BRDFFIT_IO_DROP_ABSENT];
    size_t i;
    brdffit_status status;

    values = brdffit_io_alloc(p->count, sizeof *values); /* complete samples have no more */
    if (!values) {
        return brdffit_io_no_memory(p->reader->error);
    }
    t->array[IO_VALUES] = values;
    gather(p, old, values);
    brdffit_io_release(old);
    t->open.rows = t->samples.count;
    for (i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        t->open.rows += t->dropped[i];
    }
    status = name_channels(p);
    brdffit_io_table_note(t, 0, "%zu rows of %zu wavelengths become %zu samples of %zu channels%s", p->count,
                          p->channels, t->samples.count, p->channels,
                          t->dropped[BRDFFIT_IO_DROP_ABSENT] > absent ? "; directions without all of them are left out"
                                                                      : "");
    return status;
}

static brdffit_status pivot(struct pivot *p)
{
    if (p->reader->table->samples.channels != 1 || p->reader->layout->kind == CSV_COEFFICIENTS) {
        return fail(p, "a column of wavelengths beside more than one channel: leave it out by --column ignore=NAME, or "
                       "choose the channel by --channels NAME");
    }
    make_entries(p);
    distinct_wavelengths(p);
    if (p->channels > MOST_CHANNELS) {
        return fail(p, "more than 4096 wavelengths: is this a column of wavelengths (--column ignore=NAME)?");
    }
    count_turns(p);
    find_firsts(p);
    if (!weights_agree(p)) {
        return fail(p, "weights differ between the wavelengths of a sample: weights are of samples");
    }
    return rebuild(p);
}

brdffit_status brdffit_io_csv_pivot(struct csv_reader *reader)
{
    struct pivot p = {reader, NULL, reader->table->samples.count, NULL, 0};
    brdffit_status status;

    p.entries = brdffit_io_alloc(p.count, sizeof *p.entries);
    p.wavelengths = brdffit_io_alloc(p.count, sizeof *p.wavelengths);
    status = p.entries && p.wavelengths ? pivot(&p) : brdffit_io_no_memory(reader->error);
    brdffit_io_release(p.entries);
    brdffit_io_release(p.wavelengths);
    return status;
}
