/*
 * Directions in another frame than they are read in: see suspect.h. SPDX-License-Identifier: MIT
 *
 * - Radians: no polar angle above a quarter turn of 1.6, and some that are no whole degrees.
 * - Elevation: polar angles of exactly 90, where nothing can be measured, but none near 0.
 * - A light that travels to the surface: every light below the horizon, every viewer above it; y-up likewise by its axis.
 * - Mirror direction at azimuth 0: the brightest samples are near it when the viewer is turned by half a turn, and far
 *   from it as they stand. A material that reflects back shows the same, so this one is only said.
 */
#include "io/csv/suspect.h"

#include <math.h>
#include <stdlib.h>

#include "io/bytes/memory.h"
#include "io/csv/csv_directions.h"
#include "io/csv/csv_weight.h"

/* Samples below which directions say nothing. */
#define TELLING 8

/* Largest angle of a quarter turn, radians, with room for rounding. */
#define QUARTER 1.6

struct sides {
    size_t light, view, both; /* below the horizon: of each, and of both at once */
    size_t y_down;            /* light or viewer with y <= 0 */
};

static brdffit_status refuse(struct csv_reader *r, size_t column, const char *message)
{
    return brdffit_io_layout_fail(r->layout, column, message, r->error);
}

static int has_unit(const struct csv_layout *layout, enum csv_role role)
{
    return layout->column[role] != BRDFFIT_NONE && layout->meaning[layout->column[role]].unit != UNIT_NONE;
}

static brdffit_status check_radians(struct csv_reader *r)
{
    const struct csv_layout *l = r->layout;
    const enum csv_role first = l->kind == CSV_ANGLES ? CSV_THETA_I : CSV_THETA_H;

    if ((l->options->directions_as & (BRDFFIT_IO_DEGREES | BRDFFIT_IO_RADIANS)) || has_unit(l, first) ||
        has_unit(l, CSV_THETA_O) || r->table->samples.count < 3 || r->polar_broken < 2 || r->polar_most > QUARTER) {
        return BRDFFIT_OK;
    }
    return refuse(
        r, l->column[first],
        "no polar angle is above 1.6: are these radians (--directions radians), or degrees (--directions degrees)?");
}

static void note_elevation(struct csv_reader *r)
{
    const struct csv_layout *l = r->layout;

    if (r->light_at_right > 0 && r->near_normal == 0 && r->table->samples.count >= TELLING &&
        !(l->options->directions_as & (BRDFFIT_IO_ELEVATION | BRDFFIT_IO_AS_WRITTEN)) &&
        !brdffit_io_in_radians(l, CSV_THETA_I)) {
        brdffit_io_table_note(
            r->table, 1,
            "polar angles of 90 degrees, where nothing can be measured, and none near 0: are these angles above "
            "the surface (--directions elevation)?");
    }
}

/* Strictly, so that grazing directions are on neither side. */
static struct sides count_sides(const struct io_table *t)
{
    struct sides s = {0, 0, 0, 0};
    size_t i;

    for (i = 0; i < t->samples.count; i++) {
        const int light = brdffit_io_csv_cosine(t, IO_LIGHT, i) < -1e-9,
                  view = brdffit_io_csv_cosine(t, IO_VIEW, i) < -1e-9;

        s.light += (size_t)light;
        s.view += (size_t)view;
        s.both += (size_t)(light && view);
        s.y_down += t->array[IO_LIGHT][3 * i + 1] <= 0.0 || t->array[IO_VIEW][3 * i + 1] <= 0.0;
    }
    return s;
}

static brdffit_status check_sides(struct csv_reader *r)
{
    const struct io_table *t = r->table;
    const struct sides s = count_sides(t);
    const size_t n = t->samples.count, below = s.light + s.view - s.both;
    const int vectors = r->layout->kind == CSV_VECTORS;

    if (n < TELLING || below == 0) {
        return BRDFFIT_OK;
    }
    if (vectors && !t->width[IO_NORMAL] && s.y_down == 0 && 10 * below > n) {
        return refuse(
            r, r->layout->column[CSV_LX],
            "light and viewer are on the side of +y everywhere, and below +z in many samples: a frame with y up "
            "(--directions y-up)?");
    }
    if (10 * s.light > 9 * n && 10 * s.view < n) {
        return refuse(
            r, r->layout->column[vectors ? CSV_LX : CSV_THETA_I],
            "the light comes from below the surface in nearly every sample: its direction points the way that light "
            "travels (--directions light-travels)?");
    }
    if (3 * below > n) {
        brdffit_io_table_note(
            r->table, 1,
            "%zu of %zu samples have the light or the viewer below the horizon of +z: another frame, or "
            "transmission? (--directions y-up, light-travels)",
            below, n);
    }
    return BRDFFIT_OK;
}

/* ---- Where the brightest samples are ------------------------------------- */

struct bright {
    double value, half, turned; /* squared tangents of the half angle, as it stands and with the viewer turned */
};

static int by_value(const void *left, const void *right)
{
    const double a = ((const struct bright *)left)->value, b = ((const struct bright *)right)->value;

    return a > b ? -1 : a < b;
}

static double half_angle(const double *light, const double *view, double turn)
{
    const double l = sqrt(light[0] * light[0] + light[1] * light[1] + light[2] * light[2]);
    const double v = sqrt(view[0] * view[0] + view[1] * view[1] + view[2] * view[2]);
    const double x = light[0] / l + turn * view[0] / v, y = light[1] / l + turn * view[1] / v;

    return atan2(sqrt(x * x + y * y), light[2] / l + view[2] / v);
}

static size_t take_bright(const struct io_table *t, struct bright *out)
{
    size_t i, k, used = 0;

    for (i = 0; i < t->samples.count; i++) {
        const double *light = t->array[IO_LIGHT] + 3 * i, *view = t->array[IO_VIEW] + 3 * i;
        double sum = 0.0;

        for (k = 0; k < t->samples.channels; k++) {
            sum += t->array[IO_VALUES][i * t->samples.channels + k];
        }
        if (light[2] > 0.0 && view[2] > 0.0) {
            out[used].value = sum;
            out[used].half = half_angle(light, view, 1.0);
            out[used++].turned = half_angle(light, view, -1.0);
        }
    }
    return used;
}

/* Of the brightest tenth; only where it stands out, and where the turn makes a difference. */
static int peaks_opposite(struct bright *b, size_t n)
{
    const size_t few = n / 10 > 4 ? n / 10 : 4;
    double half = 0.0, turned = 0.0, all = 0.0;
    size_t i, apart = 0;

    qsort(b, n, sizeof *b, by_value);
    for (i = 0; i < n; i++) {
        all += b[i].half / (double)n;
        apart += fabs(b[i].half - b[i].turned) > 0.05;
    }
    for (i = 0; i < few; i++) {
        half += b[i].half / (double)few;
        turned += b[i].turned / (double)few;
    }
    return b[few - 1].value > 1.5 * b[n / 2].value && 4 * apart > n && turned < 0.6 * half && half > 0.8 * all &&
           half > 0.1;
}

static brdffit_status note_mirror(struct csv_reader *r)
{
    const struct io_table *t = r->table;
    struct bright *b;
    size_t n;

    if (t->samples.count < 20 || t->samples.channels == 0 || t->width[IO_NORMAL] ||
        (r->layout->options->directions_as & BRDFFIT_IO_AS_WRITTEN)) {
        return BRDFFIT_OK;
    }
    b = brdffit_io_alloc(t->samples.count, sizeof *b);
    if (!b) {
        return brdffit_io_no_memory(r->error);
    }
    n = take_bright(t, b);
    if (n >= 20 && peaks_opposite(b, n)) {
        brdffit_io_table_note(
            r->table, 1,
            "the brightest samples are where the light comes from, not in the mirror direction: a "
            "retro-reflector, or azimuths that count from the mirror direction (--directions mirror-at-0)?");
    }
    brdffit_io_release(b);
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_suspect_directions(struct csv_reader *reader)
{
    const struct csv_layout *l = reader->layout;
    brdffit_status status = BRDFFIT_OK;

    if (l->kind == CSV_COEFFICIENTS) {
        return BRDFFIT_OK;
    }
    if (l->kind != CSV_VECTORS) {
        status = check_radians(reader);
        note_elevation(reader);
    }
    if (status == BRDFFIT_OK && !(l->options->directions_as & BRDFFIT_IO_AS_WRITTEN)) {
        status = check_sides(reader);
    }
    return status == BRDFFIT_OK ? note_mirror(reader) : status;
}
