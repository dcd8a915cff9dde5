/*
 * Values that are no measurements: see suspect.h. SPDX-License-Identifier: MIT
 *
 * A mark of missing values is far off all others: -999 among reflectances, 99999 above them, or a lone -1 where nothing
 * else is negative. It is refused, since a fit of it is certified nonsense, until options.missing says what it is. A
 * detector that saturates repeats its largest value.
 */
#include "io/csv/suspect.h"

#include <math.h>

#include "io/csv/csv_weight.h"

/* Samples below which numbers say nothing. */
#define TELLING 8

/* How many times all others a mark is. */
#define FAR 10.0

/* Share of negative samples from which on the data look wrong. */
#define MANY_NEGATIVE 0.2

struct extremes {
    double least, most;             /* of all values */
    double next_least, next_most;   /* the extremes of those that are neither */
    size_t least_at, most_at;       /* index in the values */
    size_t least_count, negative;   /* values */
};

static struct extremes find_extremes(const double *values, size_t count)
{
    struct extremes e = {INFINITY, -INFINITY, INFINITY, -INFINITY, 0, 0, 0, 0};
    size_t i;

    for (i = 0; i < count; i++) {
        if (values[i] < e.least) {
            e.least = values[i];
            e.least_at = i;
        }
        if (values[i] > e.most) {
            e.most = values[i];
            e.most_at = i;
        }
    }
    for (i = 0; i < count; i++) {
        e.least_count += values[i] == e.least;
        e.negative += values[i] < 0.0;
        if (values[i] != e.least && values[i] != e.most) {
            e.next_least = fmin(e.next_least, values[i]);
            e.next_most = fmax(e.next_most, values[i]);
        }
    }
    return e;
}

/* -1, -9, -99, ... and 9, 99, 999, ... in size. */
static int is_round_mark(double size)
{
    double nines = 9.0;

    while (nines < size && nines < 1e9) {
        nines = 10.0 * nines + 9.0;
    }
    return size == 1.0 || size == nines || size == 32768.0 || size == 1000.0 || size == 9999.9;
}

static int is_low_mark(const struct extremes *e)
{
    const double others = fmax(fabs(e->next_least), fmax(fabs(e->next_most), fabs(e->most)));
    const int alone = e->negative == e->least_count;

    if (!(e->least < 0.0) || !(e->next_least <= e->next_most)) {
        return 0;
    }
    return -e->least >= FAR * others || (alone && is_round_mark(-e->least));
}

static int is_high_mark(const struct extremes *e)
{
    if (!(e->next_least <= e->next_most) || !(e->next_most > 0.0)) {
        return 0;
    }
    /* What files are filled with: 1e30, 1e36, the largest float and the largest double; other large values are data. */
    return e->most >= FAR * e->next_most && ((e->most >= 1e29 && e->most <= 3.5e38) || e->most >= 1.7e308 ||
                                             (e->most >= 99.0 && is_round_mark(e->most)));
}

/* The column of channel k. */
static size_t column_of(const struct csv_layout *layout, size_t k)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role == CSV_CHANNEL && k-- == 0) {
            return j;
        }
    }
    return BRDFFIT_NONE;
}

static brdffit_status refuse_mark(struct csv_reader *r, size_t at, double value, const char *message)
{
    const size_t channels = r->table->samples.channels, sample = at / channels;
    const int pivoted = r->wavelength != NULL;
    struct io_place place = IO_NOWHERE;
    size_t column = column_of(r->layout, pivoted ? 0 : at % channels);

    place.sample = sample;
    place.channel = at % channels;
    place.line = pivoted ? BRDFFIT_NONE : r->table->open.lines[sample];
    place.column = column == BRDFFIT_NONE || pivoted ? BRDFFIT_NONE : column + 1;
    return brdffit_io_fail_at(r->error, BRDFFIT_ERR_VALUE, message, &place, value);
}

/* Values in the file's own units: what they were converted by is the same for all, or a cosine, which makes no mark. */
static brdffit_status check_marks(struct csv_reader *r)
{
    const size_t count = r->table->samples.count * r->table->samples.channels;
    const double *values = r->table->array[IO_VALUES];
    const struct extremes e = find_extremes(values, count);

    if (r->layout->options->missing != BRDFFIT_IO_MISSING_MARKED ||
        r->layout->options->values != BRDFFIT_IO_VALUES_PLAIN) {
        return BRDFFIT_OK;
    }
    if (is_low_mark(&e)) {
        return refuse_mark(r, e.least_at, e.least,
                           "a negative value that looks like a mark of missing ones (--missing VALUE leaves it out, "
                           "--missing none keeps it)");
    }
    if (is_high_mark(&e)) {
        return refuse_mark(
            r, e.most_at, e.most,
            "a value far above all others that looks like a mark of missing ones (--missing VALUE leaves it "
            "out, --missing none keeps it)");
    }
    return BRDFFIT_OK;
}

static void note_negative(struct csv_reader *r)
{
    const size_t negative = r->table->open.negative, count = r->table->samples.count;
    const int many = (double)negative > MANY_NEGATIVE * (double)count;

    if (negative > 0) {
        brdffit_io_table_note(r->table, many && count >= TELLING, "%zu of %zu samples have a negative value%s",
                              negative, count,
                              many ? ": a dark level taken off twice, or another sign?"
                                   : ": they are fitted as they are (--missing negative leaves them out)");
    }
}

/* How often channel k has its largest value, and the largest below it. */
static void count_largest(const struct io_table *t, size_t k, double *largest, size_t *at_largest, size_t *at_next)
{
    const size_t channels = t->samples.channels;
    double next = -INFINITY;
    size_t i;

    *largest = -INFINITY;
    *at_largest = *at_next = 0;
    for (i = 0; i < t->samples.count; i++) {
        const double v = t->array[IO_VALUES][i * channels + k];

        if (v > *largest) {
            next = *largest;
            *at_next = *at_largest;
            *largest = v;
            *at_largest = 0;
        } else if (v < *largest && v > next) {
            next = v;
            *at_next = 0;
        }
        *at_largest += v == *largest;
        *at_next += v == next;
    }
}

/* A detector's full scale: the largest value again and again, the next one not. */
static void note_saturated(struct csv_reader *r)
{
    const struct io_table *t = r->table;
    size_t k;

    for (k = 0; k < t->samples.channels && t->samples.count >= TELLING; k++) {
        double largest;
        size_t at_largest, at_next;
        char name[IO_QUOTED];

        count_largest(t, k, &largest, &at_largest, &at_next);
        if (at_largest >= 4 && at_largest > 2 * at_next && 10 * at_largest < 9 * t->samples.count && largest > 0.0) {
            const char *text = t->open.channel_names[k];
            size_t length = 0;

            while (text[length]) {
                length++;
            }
            brdffit_io_table_note(
                r->table, 1,
                "channel %s has its largest value, %.6g, in %zu samples: it looks saturated (--saturated "
                "%.6g leaves them out)",
                brdffit_io_quote(text, length, name, sizeof name), largest, at_largest, largest);
        }
    }
}

/* Samples that are 0 in every channel where all others are far from it. */
static void note_zeros(struct csv_reader *r)
{
    const struct io_table *t = r->table;
    const size_t channels = t->samples.channels;
    double least = INFINITY, most = 0.0;
    size_t i, k, zeros = 0;

    for (i = 0; i < t->samples.count; i++) {
        double largest = 0.0;

        for (k = 0; k < channels; k++) {
            largest = fmax(largest, fabs(t->array[IO_VALUES][i * channels + k]));
        }
        zeros += largest == 0.0;
        least = largest > 0.0 ? fmin(least, largest) : least;
        most = fmax(most, largest);
    }
    if (zeros > 0 && t->samples.count >= TELLING && zeros < t->samples.count && least > 1e-2 * most) {
        brdffit_io_table_note(
            r->table, 1,
            "%zu sample%s 0 in every channel, and no other near it: not measured? (--missing 0 leaves them out)", zeros,
            zeros == 1 ? " is" : "s are");
    }
}

brdffit_status brdffit_io_suspect_values(struct csv_reader *reader)
{
    const struct io_table *t = reader->table;
    brdffit_status status = BRDFFIT_OK;

    if (t->samples.channels == 0) {
        return BRDFFIT_OK;
    }
    if (t->samples.count >= TELLING) {
        status = check_marks(reader);
    }
    if (status == BRDFFIT_OK) {
        note_negative(reader);
        note_saturated(reader);
        note_zeros(reader);
    }
    return status;
}
