/*
 * The order of samples in a reduction: by c of the first geometry, then of the others, then by tangents (with Smith's
 * masking, the same in every geometry), then by index.
 * SPDX-License-Identifier: MIT
 */
#include "data/reduce_parts.h"

/* Beyond geometry 0, whose c agree. */
static int not_after_beyond(const struct reduced *r, uint32_t p, uint32_t q)
{
    const struct table *first = &r->table[0];
    int g;

    for (g = 1; g < r->geometries; g++) {
        const double *c = r->table[g].sample_c;

        if (c[p] != c[q]) {
            return c[p] < c[q];
        }
    }
    if (first->masked && first->sample_light[p] != first->sample_light[q]) {
        return first->sample_light[p] < first->sample_light[q];
    }
    if (first->masked && first->sample_view[p] != first->sample_view[q]) {
        return first->sample_view[p] < first->sample_view[q];
    }
    return p < q;
}

static inline int not_after(const struct reduced *r, const double *c, uint32_t p, uint32_t q)
{
    return c[p] < c[q] || (c[p] == c[q] && not_after_beyond(r, p, q));
}

/* Runs of SHORT_RUN, each put in order by insertion: cheaper than the first passes of merging. */
#define SHORT_RUN 8u

static void sort_short_runs(const struct reduced *r, const double *c, uint32_t *order)
{
    size_t n = r->used, begin, i, j;

    for (begin = 0; begin < n; begin += SHORT_RUN) {
        size_t end = n - begin < SHORT_RUN ? n : begin + SHORT_RUN;

        for (i = begin; i < end; i++) {
            uint32_t item = (uint32_t)i;

            for (j = i; j > begin && !not_after(r, c, order[j - 1], item); j--) {
                order[j] = order[j - 1];
            }
            order[j] = item;
        }
    }
}

/* Order by c, then by index: bottom-up merge sort that starts from runs already ascending (a MERL table is one). */
void brdffit_reduce_sort(struct reduced *r)
{
    const double *c = r->table[0].sample_c;
    uint32_t *from = r->order, *to = r->merge;
    size_t n = r->used, begin;
    int merged = 1;

    sort_short_runs(r, c, from);
    while (merged) {
        merged = 0;
        for (begin = 0; begin < n;) {
            size_t middle = begin + 1, end, left = begin, right, out = begin;

            while (middle < n && not_after(r, c, from[middle - 1], from[middle])) {
                middle++;
            }
            end = middle < n ? middle + 1 : n;
            while (end < n && not_after(r, c, from[end - 1], from[end])) {
                end++;
            }
            merged = merged || middle < n;
            for (right = middle; out < end; out++) {
                int take_left = left < middle && (right == end || not_after(r, c, from[left], from[right]));

                to[out] = take_left ? from[left++] : from[right++];
            }
            begin = end;
        }
        r->order = to;
        r->merge = from;
        from = r->order;
        to = r->merge;
    }
}
