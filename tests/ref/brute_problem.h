/*
 * Slow reference, part 2 of 3: the paper's problem in long double.
 *
 * Samples: radiance f_r (n.l), incidence at most 60 degrees, each channel divided by its largest radiance.
 * Coefficients as theory section 1 writes them, normal +z. SPDX-License-Identifier: MIT
 */
#ifndef BRUTE_PROBLEM_H
#define BRUTE_PROBLEM_H

#include "brute_read.h"
#include "ref_exact.h"

#define BRUTE_PI 3.14159265358979323846264338327950288L
#define BRUTE_MAX_INCIDENCE 60.0L

struct brute_problem {
    struct ref_rows sample; /* one row a sample */
    struct ref_basis basis; /* one row a distinct c, and one more */
    int ggx;
};

/* a, b, c of one pair of directions; 0 when the sample does not count. */
static int brute_geometry(const long double angle[4], long double *a, long double *b, long double *c)
{
    long double degree = BRUTE_PI / 180.0L, light[3], view[3], half[3], length = 0.0L, nl, nv, nh, vh = 0.0L, g;
    int j;

    if (!(fabsl(angle[0]) <= BRUTE_MAX_INCIDENCE && fabsl(angle[2]) < 90.0L)) {
        return 0;
    }
    light[0] = sinl(angle[0] * degree) * cosl(angle[1] * degree);
    light[1] = sinl(angle[0] * degree) * sinl(angle[1] * degree);
    light[2] = cosl(angle[0] * degree);
    view[0] = sinl(angle[2] * degree) * cosl(angle[3] * degree);
    view[1] = sinl(angle[2] * degree) * sinl(angle[3] * degree);
    view[2] = cosl(angle[2] * degree);
    for (j = 0; j < 3; j++) {
        half[j] = light[j] + view[j];
        length += half[j] * half[j];
    }
    length = sqrtl(length);
    for (j = 0; j < 3; j++) {
        half[j] /= length;
        vh += view[j] * half[j];
    }
    nl = light[2];
    nv = view[2];
    nh = half[2];
    g = fminl(1.0L, fminl(2.0L * nh * nv / vh, 2.0L * nh * nl / vh));
    *a = nl / BRUTE_PI;
    *b = g / (BRUTE_PI * nv * nh * nh * nh * nh);
    *c = (half[0] * half[0] + half[1] * half[1]) / (nh * nh);
    return 1;
}

/* Divide each channel by its largest value. */
static void brute_normalise(struct ref_rows *rows)
{
    size_t i, k;

    for (k = 0; k < rows->channels; k++) {
        long double *data = rows->data + k * rows->count, largest = 0.0L;

        for (i = 0; i < rows->count; i++) {
            largest = fmaxl(largest, data[i]);
        }
        for (i = 0; largest > 0.0L && i < rows->count; i++) {
            data[i] /= largest;
        }
    }
}

static struct ref_rows brute_samples(const struct brute_table *table)
{
    size_t first = table->directions ? 4 : 3, channels = table->fields - first, room = table->rows, i, k;
    struct ref_rows rows = ref_rows_new(room, channels);

    rows.count = 0;
    for (i = 0; i < room; i++) {
        const long double *cell = table->cell + i * table->fields;
        size_t n = rows.count;

        if (!table->directions) {
            rows.a[n] = cell[0];
            rows.b[n] = cell[1];
            rows.c[n] = cell[2];
        } else if (!brute_geometry(cell, &rows.a[n], &rows.b[n], &rows.c[n])) {
            continue;
        }
        for (k = 0; k < channels; k++) {
            rows.data[k * room + n] = cell[first + k] * (table->directions ? BRUTE_PI * rows.a[n] : 1.0L);
        }
        rows.count++;
    }
    for (k = 1; k < channels; k++) { /* close the gaps that skipped samples left */
        memmove(rows.data + k * rows.count, rows.data + k * room, rows.count * sizeof *rows.data);
    }
    brute_normalise(&rows);
    return rows;
}

static void brute_problem_new(struct brute_problem *p, const struct brute_table *table, int ggx)
{
    p->ggx = ggx;
    p->sample = brute_samples(table);
    p->basis = ref_basis_new(&p->sample);
}

static void brute_problem_free(struct brute_problem *p)
{
    ref_rows_free(&p->sample);
    ref_rows_free(&p->basis.rows);
}

/* E^2 at given roughnesses, from the N samples themselves. */
static long double brute_objective(const struct brute_problem *p, const long double *sigma, int lobes)
{
    size_t count = p->sample.count;
    long double *room = ref_allocate(2 * count + ref_exact_room(&p->sample), sizeof *room), e2;
    const long double *column[REF_COLUMNS] = {p->sample.a, room, room + count};
    int j;

    for (j = 0; j < lobes; j++) {
        ref_lobe(&p->sample, p->ggx, sigma[j], room + (size_t)j * count);
    }
    e2 = ref_exact(&p->sample, column, 1 + lobes, room + 2 * count, NULL);
    free(room);
    return e2;
}

#endif
