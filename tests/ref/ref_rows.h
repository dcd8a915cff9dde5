/*
 * References, shared part 1 of 2: least-squares rows in long double.
 *
 * A row is one squared residual: (a x + sum_p y_p b phi(c, s_p) - data)^2, s = 1 / sigma^2.
 *
 * Rows of equal c have proportional lobes whatever sigma, so each group of equal c spans one unit vector
 * e_d = b / |b| (within the group). Lobes, and the part of the data that a fit can reach, live in the space of
 * all e_d and of what is left of `a`: groups + 1 rows instead of N, and a constant that no fit reaches.
 * That is an orthonormal change of basis, not an approximation. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REF_ROWS_H
#define BRDFFIT_REF_ROWS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ref_rows {
    size_t count, channels;
    long double *a, *b, *c;
    long double *data; /* channels x count */
};

static inline void *ref_allocate(size_t count, size_t size)
{
    void *block = calloc(count ? count : 1, size);

    if (!block) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return block;
}

static inline struct ref_rows ref_rows_new(size_t count, size_t channels)
{
    struct ref_rows rows = {count, channels, NULL, NULL, NULL, NULL};

    rows.a = ref_allocate(count, sizeof *rows.a);
    rows.b = ref_allocate(count, sizeof *rows.b);
    rows.c = ref_allocate(count, sizeof *rows.c);
    rows.data = ref_allocate(count * channels, sizeof *rows.data);
    return rows;
}

static inline void ref_rows_free(struct ref_rows *rows)
{
    free(rows->a);
    free(rows->b);
    free(rows->c);
    free(rows->data);
}

/* Lobe of roughness sigma, of length 1; the sharpest row's phi is 1 before that, so that nothing underflows. */
static inline void ref_lobe(const struct ref_rows *rows, int ggx, long double sigma, long double *column)
{
    long double s = 1.0L / (sigma * sigma), c_min = INFINITY, norm = 0.0L;
    size_t i;

    for (i = 0; i < rows->count; i++) {
        c_min = rows->b[i] > 0.0L ? fminl(c_min, rows->c[i]) : c_min;
    }
    for (i = 0; i < rows->count; i++) {
        long double ratio = (1.0L + c_min * s) / (1.0L + rows->c[i] * s);

        column[i] = 0.0L;
        if (rows->b[i] > 0.0L) {
            column[i] = rows->b[i] * (ggx ? ratio * ratio : expl(-(rows->c[i] - c_min) * s));
        }
        norm += column[i] * column[i];
    }
    for (i = 0; norm > 0.0L && i < rows->count; i++) {
        column[i] /= sqrtl(norm);
    }
}

/* Rows in the basis above. */
struct ref_basis {
    struct ref_rows rows;
    long double unreachable; /* sum of squares of the data outside of it */
};

struct ref_key {
    long double c;
    size_t index;
};

static inline int ref_compare_keys(const void *first, const void *second)
{
    long double x = ((const struct ref_key *)first)->c, y = ((const struct ref_key *)second)->c;

    return (x > y) - (x < y);
}

/* group[i] numbers the distinct c of row i; c within 1e-15 of each other are one geometry, rounded. */
static inline size_t ref_group(const struct ref_rows *rows, size_t *group)
{
    struct ref_key *key = ref_allocate(rows->count, sizeof *key);
    size_t groups = 0, i;

    for (i = 0; i < rows->count; i++) {
        key[i].c = rows->c[i];
        key[i].index = i;
    }
    qsort(key, rows->count, sizeof *key, ref_compare_keys);
    for (i = 0; i < rows->count; i++) {
        groups += i == 0 || !(key[i].c - key[i - 1].c <= 1e-15L * key[i].c);
        group[key[i].index] = groups - 1;
    }
    free(key);
    return groups;
}

/* Row d of the basis: length of b in its group, and coordinates of a and of the data along e_d. */
static inline void ref_project_groups(const struct ref_rows *from, const size_t *group, size_t groups,
                                      struct ref_rows *to)
{
    size_t i, k, d;

    for (i = 0; i < from->count; i++) {
        to->b[group[i]] += from->b[i] * from->b[i];
        to->c[group[i]] = from->c[i];
    }
    for (d = 0; d < groups; d++) {
        to->b[d] = sqrtl(to->b[d]);
    }
    for (i = 0; i < from->count; i++) {
        long double e = to->b[group[i]] > 0.0L ? from->b[i] / to->b[group[i]] : 0.0L;

        to->a[group[i]] += from->a[i] * e;
        for (k = 0; k < from->channels; k++) {
            to->data[k * to->count + group[i]] += from->data[k * from->count + i] * e;
        }
    }
}

/* What is left of a outside of the groups' vectors, of length 1; returns its length, 0 when nothing is left. */
static inline long double ref_rest(const struct ref_rows *from, const size_t *group, const struct ref_rows *to,
                                   long double *rest)
{
    long double *along = ref_allocate(to->count, sizeof *along), norm = 0.0L, whole = 0.0L;
    size_t i;
    int pass;

    memcpy(rest, from->a, from->count * sizeof *rest);
    for (pass = 0; pass < 2; pass++) { /* twice: once leaves a direction of rounding errors when little is left */
        memset(along, 0, to->count * sizeof *along);
        for (i = 0; i < from->count; i++) {
            along[group[i]] += to->b[group[i]] > 0.0L ? rest[i] * (from->b[i] / to->b[group[i]]) : 0.0L;
        }
        for (i = 0; i < from->count; i++) {
            rest[i] -= to->b[group[i]] > 0.0L ? along[group[i]] * (from->b[i] / to->b[group[i]]) : 0.0L;
        }
    }
    for (i = 0; i < from->count; i++) {
        norm += rest[i] * rest[i];
        whole += from->a[i] * from->a[i];
    }
    norm = sqrtl(norm) > 1e-16L * sqrtl(whole) ? sqrtl(norm) : 0.0L;
    for (i = 0; i < from->count; i++) {
        rest[i] = norm > 0.0L ? rest[i] / norm : 0.0L;
    }
    free(along);
    return norm;
}

/* Last row: along what is left of a. Returns the squares of the data that no row reaches. */
static inline long double ref_project_rest(const struct ref_rows *from, const size_t *group, size_t last,
                                           struct ref_rows *to)
{
    long double *rest = ref_allocate(from->count, sizeof *rest), unreachable = 0.0L;
    size_t i, k;

    to->a[last] = ref_rest(from, group, to, rest);
    for (k = 0; k < from->channels; k++) {
        const long double *data = from->data + k * from->count;
        long double *row = to->data + k * to->count;

        for (i = 0; i < from->count; i++) {
            row[last] += data[i] * rest[i];
        }
        for (i = 0; i < from->count; i++) {
            long double b = to->b[group[i]], reached = row[last] * rest[i];

            reached += b > 0.0L ? row[group[i]] * (from->b[i] / b) : 0.0L;
            unreachable += (data[i] - reached) * (data[i] - reached);
        }
    }
    free(rest);
    return unreachable;
}

static inline struct ref_basis ref_basis_new(const struct ref_rows *rows)
{
    size_t *group = ref_allocate(rows->count, sizeof *group), groups = ref_group(rows, group);
    struct ref_basis basis = {ref_rows_new(groups + 1, rows->channels), 0.0L};

    ref_project_groups(rows, group, groups, &basis.rows);
    basis.unreachable = ref_project_rest(rows, group, groups, &basis.rows);
    free(group);
    return basis;
}

#endif
