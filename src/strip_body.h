/*
 * Strips in lanes: see strip.h. Included by strip_base.c, strip_avx2.c and strip_avx512.c, which differ only in the
 * instruction set that they are compiled for; STRIP_KERNELS names the table. Layer 1. SPDX-License-Identifier: MIT
 *
 * Two sweeps over a strip: geometry, which leaves l and b of every cell in two arrays, 0 where the cell does not count;
 * then each channel, which needs no mask any more. A block's smallest and largest cosine bound its l and v (rounding
 * is monotone, so these bounds hold to the bit), and most blocks need less: below the horizon the entries are only
 * looked at, beyond the incidence limit only counted.
 */
#include <math.h>
#include <string.h>

#include "strip.h"

typedef double strip_unaligned __attribute__((vector_size(64), aligned(1), may_alias));

/* Cells p .. p + LANES - 1 of a plane; those that may not be read are 0. */
LANES_INLINE lanes strip_load(const struct strip *s, size_t channel, size_t p)
{
    const unsigned char *at = s->plane[channel] + (s->first + p) * sizeof(double);
    double tail[LANES] = {0.0};

    if (p + LANES <= s->readable) {
        return *(const strip_unaligned *)at;
    }
    memcpy(tail, at, (s->readable - p) * sizeof(double));
    return lanes_load(tail);
}

LANES_INLINE lanes strip_and(lanes_mask mask, lanes x)
{
    return (lanes)(mask & (lanes_mask)x);
}

LANES_INLINE lanes strip_root(lanes x)
{
    double v[LANES];
    size_t i;

    lanes_store(v, x);
    for (i = 0; i < LANES; i++) {
        v[i] = sqrt(v[i]);
    }
    return lanes_load(v);
}

LANES_INLINE lanes strip_b(enum strip_kind kind, lanes light, lanes view, double shared)
{
    switch (kind) {
    case STRIP_SHADOWED: return lanes_min(lanes_min(light, view) * shared, lanes_set(1.0)) / view;
    case STRIP_ROOT: return strip_root(light / view);
    case STRIP_SIDE: return (light * shared) / lanes_max(light, view);
    default: return light;
    }
}

/* high + low += term, exactly but for the roundings of low. */
LANES_INLINE void strip_fold(double *high, double *low, lanes term)
{
    lanes h = lanes_load(high), sum = h + term, back = sum - h;

    lanes_store(high, sum);
    lanes_store(low, lanes_load(low) + ((h - (sum - back)) + (term - back)));
}

LANES_INLINE int64_t strip_count(lanes_mask minus_ones)
{
    int64_t sum = 0;
    size_t i;

    for (i = 0; i < LANES; i++) {
        sum -= minus_ones[i];
    }
    return sum;
}

/* First and one past the last block with cells that count. */
struct strip_range {
    size_t begin, end;
};

/* What the sweep over geometry adds up. */
struct strip_sweep {
    lanes seen, ll, lb, bb, b4;
    lanes_mask used, below, absent;
};

/* A block whose cells may all be looked at but not all count. Leaves l and b. */
LANES_INLINE void strip_cells(const struct strip *s, enum strip_kind kind, size_t p, lanes_mask negative,
                              int within_limit, double *l, double *b, struct strip_sweep *w)
{
    lanes cosine = lanes_load(s->cosine + p), swing = cosine * s->across;
    lanes light = s->upright - swing, view = s->upright + swing, horizon = lanes_set(s->horizon), lobe;
    lanes_mask cell = cosine == cosine, above = (light > horizon) & (view > horizon), use;

    w->below += cell & ~above;
    w->absent += above & negative;
    if (!within_limit) {
        return;
    }
    use = above & ~negative & (light >= lanes_set(s->min_cosine));
    lobe = strip_and(use, strip_b(kind, light, view, s->shared));
    light = strip_and(use, light);
    w->used += use;
    lanes_store(l + p, light);
    lanes_store(b + p, lobe);
    w->ll += light * light;
    w->lb += light * lobe;
    w->bb += lobe * lobe;
    w->b4 += (lobe * lobe) * (lobe * lobe);
}

LANES_INLINE struct strip_range strip_geometry(const struct strip *s, enum strip_kind kind, size_t channels, double *l,
                                               double *b, struct strip_totals *totals)
{
    struct strip_sweep w = {{0.0}, {0.0}, {0.0}, {0.0}, {0.0}, {0}, {0}, {0}};
    struct strip_range range = {0, 0};
    size_t p, k, block;

    w.seen = lanes_load(totals->seen);
    for (p = 0, block = 0; p < s->cells; p += LANES, block++) {
        double light = s->upright - s->across * s->low[block], view = s->upright + s->across * s->high[block];
        int may_count = light >= s->min_cosine, below = !(light > s->horizon && view > s->horizon);
        lanes value = strip_load(s, 0, p), all = value;
        lanes_mask negative = value < lanes_set(0.0);

        for (k = 1; k < channels; k++) {
            value = strip_load(s, k, p);
            negative |= value < lanes_set(0.0);
            all += value;
        }
        w.seen += all;
        if (below) {
            w.below += lanes_load(s->cosine + p) == lanes_load(s->cosine + p);
        } else if (may_count) {
            strip_cells(s, kind, p, negative, 1, l, b, &w);
            range.begin = range.end ? range.begin : block;
            range.end = block + 1;
            continue;
        } else {
            strip_cells(s, kind, p, negative, 0, l, b, &w);
        }
        lanes_store(l + p, lanes_set(0.0));
        lanes_store(b + p, lanes_set(0.0));
    }
    lanes_store(totals->seen, w.seen);
    strip_fold(totals->high, totals->low, w.ll);
    strip_fold(totals->high + LANES, totals->low + LANES, w.lb);
    strip_fold(totals->high + 2 * LANES, totals->low + 2 * LANES, w.bb);
    strip_fold(totals->high + 3 * LANES, totals->low + 3 * LANES, w.b4);
    totals->used += strip_count(w.used);
    totals->below += strip_count(w.below);
    totals->absent += strip_count(w.absent);
    return range;
}

LANES_INLINE void strip_channel(const struct strip *s, size_t channel, struct strip_range range, const double *l,
                                const double *b, struct strip_totals *totals)
{
    size_t first = LANES * (4 + 3 * channel), p;
    double *high = totals->high + first, *low = totals->low + first, *largest = totals->largest + LANES * channel;
    lanes li = lanes_set(0.0), bi = li, ii = li, top = lanes_load(largest);

    for (p = range.begin * LANES; p < range.end * LANES; p += LANES) {
        lanes light = lanes_load(l + p), radiance = (strip_load(s, channel, p) * s->scale[channel]) * light;

        li += light * radiance;
        bi += lanes_load(b + p) * radiance;
        ii += radiance * radiance;
        top = lanes_max(radiance, top);
    }
    strip_fold(high, low, li);
    strip_fold(high + LANES, low + LANES, bi);
    strip_fold(high + 2 * LANES, low + 2 * LANES, ii);
    lanes_store(largest, top);
}

LANES_INLINE void strip_add(const struct strip *s, enum strip_kind kind, size_t channels,
                            struct strip_totals *totals)
{
    double l[STRIP_CELLS], b[STRIP_CELLS];
    struct strip_range range = strip_geometry(s, kind, channels, l, b, totals);
    size_t k;

    for (k = 0; k < channels && range.end > range.begin; k++) {
        strip_channel(s, k, range, l, b, totals);
    }
}

static void strip_any(const struct strip *s, struct strip_totals *totals)
{
    switch (s->kind) {
    case STRIP_ROOT: strip_add(s, STRIP_ROOT, s->channels, totals); return;
    case STRIP_LIGHT: strip_add(s, STRIP_LIGHT, s->channels, totals); return;
    case STRIP_SIDE: strip_add(s, STRIP_SIDE, s->channels, totals); return;
    default: break;
    }
    if (s->channels == 3) { /* what nearly every table is: the loop over channels unrolls */
        strip_add(s, STRIP_SHADOWED, 3, totals);
    } else {
        strip_add(s, STRIP_SHADOWED, s->channels, totals);
    }
}

const struct strip_kernels STRIP_KERNELS = {
    strip_any,
};
