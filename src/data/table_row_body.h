/*
 * Strips in lanes: see table_row.h. Included by table_row_base.c, table_row_avx2.c and table_row_avx512.c, which differ only in the
 * instruction set that they are compiled for; TABLE_ROW_KERNELS names the table. SPDX-License-Identifier: MIT
 *
 * Two sweeps over a strip: geometry, which leaves l and b of every cell in two arrays, 0 where the cell does not count;
 * then each channel, which needs no mask any more. A block's smallest and largest cosine bound its l and v (rounding
 * is monotone, so these bounds hold to the bit), and most blocks need less: below the horizon the entries are only
 * looked at, beyond the incidence limit only counted.
 *
 * GCC takes vectors wider than the machine's apart, comparisons even to single doubles. So the LANES are worked on in
 * parts of VEC, as many as a register holds, one part after the other over the whole strip: a lane adds the same
 * terms in the same order whatever VEC is.
 */
#include <string.h>

#include "data/table_row.h"

/* Doubles; 2 KiB. */
#define TABLE_ROW_AHEAD 256u

typedef double table_row_entries __attribute__((vector_size(VEC * 8), aligned(1), may_alias));

/* The last doubles of a plane, and 0 for those that are not there; a call of its own, for it is rare. */
static __attribute__((noinline)) void table_row_tail(const unsigned char *at, size_t readable, double *tail)
{
    size_t i;

    for (i = 0; i < VEC; i++) {
        tail[i] = 0.0;
    }
    memcpy(tail, at, readable * sizeof(double));
}

/* Cells p .. p + VEC - 1 of a plane; those that may not be read are 0. */
LANES_INLINE vec table_row_load(const struct strip *s, size_t channel, size_t p)
{
    const unsigned char *at = s->plane[channel] + (s->first + p) * sizeof(double);

    if (__builtin_expect(p + VEC > s->readable, 0)) {
        double tail[VEC];

        table_row_tail(at, p < s->readable ? s->readable - p : 0, tail);
        return vec_load(tail);
    }
    return *(const table_row_entries *)at;
}

/* The planes are read side by side, and the hardware follows none of them across a page. */
LANES_INLINE void table_row_prefetch(const struct strip *s, size_t channel, size_t p)
{
    if (p + TABLE_ROW_AHEAD < s->readable) {
        __builtin_prefetch(s->plane[channel] + (s->first + p + TABLE_ROW_AHEAD) * sizeof(double));
    }
}

LANES_INLINE vec table_row_b(enum table_row_kind kind, vec light, vec view, double shared)
{
    switch (kind) {
    case TABLE_ROW_SHADOWED: return vec_min(vec_min(light, view) * shared, vec_set(1.0)) / view;
    case TABLE_ROW_ROOT: return vec_sqrt(light / view);
    case TABLE_ROW_SIDE: return (light * shared) / vec_max(light, view);
    default: return light;
    }
}

LANES_INLINE vec table_row_and(vec_mask mask, vec x)
{
    return (vec)(mask & (vec_mask)x);
}

/* high + low += term, exactly but for the roundings of low. */
LANES_INLINE void table_row_fold(double *high, double *low, vec term)
{
    vec h = vec_load(high), sum = h + term, back = sum - h;

    vec_store(high, sum);
    vec_store(low, vec_load(low) + ((h - (sum - back)) + (term - back)));
}

LANES_INLINE int64_t table_row_count(vec_mask minus_ones)
{
    int64_t sum = 0;
    size_t i;

    for (i = 0; i < VEC; i++) {
        sum -= minus_ones[i];
    }
    return sum;
}

/* First and one past the last cell, in whole blocks, between which cells count. */
struct table_row_range {
    size_t begin, end;
};

/* What the sweep over geometry adds up. */
struct table_row_sweep {
    vec seen, ll, lb, bb, b4;
    vec_mask used, below, absent;
};

/* Cells of which some may be above the horizon and, unless beyond_limit, some may count. Leaves l and b. */
LANES_INLINE void table_row_cells(const struct strip *s, enum table_row_kind kind, size_t p, vec_mask negative,
                                  int beyond_limit, double *l, double *b, struct table_row_sweep *w)
{
    vec cosine = vec_load(s->cosine + p), swing = cosine * s->across;
    vec light = s->upright - swing, view = s->upright + swing, horizon = vec_set(s->horizon), lobe;
    vec_mask cell = cosine == cosine, above = (light > horizon) & (view > horizon), use;

    w->below += cell & ~above;
    w->absent += above & negative;
    if (beyond_limit) {
        return;
    }
    use = above & ~negative & (light >= vec_set(s->min_cosine));
    lobe = table_row_and(use, table_row_b(kind, light, view, s->shared));
    light = table_row_and(use, light);
    w->used += use;
    vec_store(l + p, light);
    vec_store(b + p, lobe);
    w->ll += light * light;
    w->lb += light * lobe;
    w->bb += lobe * lobe;
    w->b4 += (lobe * lobe) * (lobe * lobe);
}

/* The sweep over geometry in lanes `lane` .. `lane` + VEC - 1. */
LANES_INLINE struct table_row_range table_row_lanes(const struct strip *s, enum table_row_kind kind, size_t channels,
                                                    size_t lane, double *l, double *b, struct table_row_totals *t)
{
    struct table_row_sweep w = {{0.0}, {0.0}, {0.0}, {0.0}, {0.0}, {0}, {0}, {0}};
    struct table_row_range range = {0, 0};
    size_t p, k, block;

    w.seen = vec_load(t->seen + lane);
    for (p = lane, block = 0; p < PADDED(s->cells); p += LANES, block++) {
        double light = s->upright - s->across * s->low[block], view = s->upright + s->across * s->high[block];
        vec value = table_row_load(s, 0, p), all = value;
        vec_mask negative = value < vec_set(0.0);

        if (lane == 0) {
            for (k = 0; k < channels; k++) {
                table_row_prefetch(s, k, p);
            }
        }
        for (k = 1; k < channels; k++) {
            value = table_row_load(s, k, p);
            negative |= value < vec_set(0.0);
            all += value;
        }
        w.seen += all;
        if (light > s->horizon && view > s->horizon) {
            if (light >= s->min_cosine) {
                table_row_cells(s, kind, p, negative, 0, l, b, &w);
                range.begin = range.end ? range.begin : p - lane;
                range.end = p - lane + LANES;
                continue;
            }
            table_row_cells(s, kind, p, negative, 1, l, b, &w);
        } else {
            w.below += vec_load(s->cosine + p) == vec_load(s->cosine + p);
        }
        vec_store(l + p, vec_set(0.0));
        vec_store(b + p, vec_set(0.0));
    }
    vec_store(t->seen + lane, w.seen);
    table_row_fold(t->high + lane, t->low + lane, w.ll);
    table_row_fold(t->high + LANES + lane, t->low + LANES + lane, w.lb);
    table_row_fold(t->high + 2 * LANES + lane, t->low + 2 * LANES + lane, w.bb);
    table_row_fold(t->high + 3 * LANES + lane, t->low + 3 * LANES + lane, w.b4);
    t->used += table_row_count(w.used);
    t->below += table_row_count(w.below);
    t->absent += table_row_count(w.absent);
    return range;
}

/* A channel in lanes `lane` .. `lane` + VEC - 1. */
LANES_INLINE void table_row_channel(const struct strip *s, size_t channel, size_t lane, struct table_row_range range,
                                    const double *l, const double *b, struct table_row_totals *t)
{
    size_t first = LANES * (4 + 3 * channel) + lane, p;
    double *high = t->high + first, *low = t->low + first, *largest = t->largest + LANES * channel + lane;
    vec li = vec_set(0.0), bi = li, ii = li, top = vec_load(largest);

    for (p = range.begin + lane; p < range.end; p += LANES) {
        vec light = vec_load(l + p), radiance = (table_row_load(s, channel, p) * s->scale[channel]) * light;

        li += light * radiance;
        bi += vec_load(b + p) * radiance;
        ii += radiance * radiance;
        top = vec_max(radiance, top);
    }
    table_row_fold(high, low, li);
    table_row_fold(high + LANES, low + LANES, bi);
    table_row_fold(high + 2 * LANES, low + 2 * LANES, ii);
    vec_store(largest, top);
}

/* The copy is nobody else's: no store can change it, so its members may stay in registers. */
LANES_INLINE void table_row_add(const struct strip *strip, enum table_row_kind kind, size_t channels,
                                struct table_row_totals *t)
{
    const struct strip s = *strip;
    double l[TABLE_ROW_CELLS], b[TABLE_ROW_CELLS];
    size_t lane, k;

    for (lane = 0; lane < LANES; lane += VEC) {
        struct table_row_range range = table_row_lanes(&s, kind, channels, lane, l, b, t);

        for (k = 0; k < channels && range.end > range.begin; k++) {
            table_row_channel(&s, k, lane, range, l, b, t);
        }
    }
}

static void table_row_any(const struct strip *s, struct table_row_totals *t)
{
    switch (s->kind) {
    case TABLE_ROW_ROOT: table_row_add(s, TABLE_ROW_ROOT, s->channels, t); return;
    case TABLE_ROW_LIGHT: table_row_add(s, TABLE_ROW_LIGHT, s->channels, t); return;
    case TABLE_ROW_SIDE: table_row_add(s, TABLE_ROW_SIDE, s->channels, t); return;
    default: break;
    }
    if (s->channels == 3) { /* what nearly every table is: the loop over channels unrolls */
        table_row_add(s, TABLE_ROW_SHADOWED, 3, t);
    } else {
        table_row_add(s, TABLE_ROW_SHADOWED, s->channels, t);
    }
}

const struct table_row_kernels TABLE_ROW_KERNELS = {
    table_row_any,
};
