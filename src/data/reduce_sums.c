/*
 * Sums over samples of equal c (theory 4.1). SPDX-License-Identifier: MIT
 *
 * Rounding: every sum adds REDUCE_BLOCK products plainly and adds such blocks, and groups, with compensation
 * (Neumaier), so that its relative error is below REDUCE_BLOCK + 8 units however many samples there are (sums
 * of terms of one sign; `ai`, of mixed sign when values are negative, has that error relative to sum |a I|,
 * at most the product of the norms).
 */
#include "data/reduce_parts.h"

#include <math.h>

#include "base/vector.h"

/* A compensated sum: high + low is the sum so far. */
struct sum {
    double high, low;
};

static void add(struct sum *s, double term)
{
    double total = s->high + term;

    s->low += fabs(s->high) >= fabs(term) ? (s->high - total) + term : (term - total) + s->high;
    s->high = total;
}

static double value_of(const struct sum *s)
{
    return s->high + s->low;
}

static size_t block_end(size_t begin, size_t end)
{
    return end - begin > REDUCE_BLOCK ? begin + REDUCE_BLOCK : end;
}

/* Products of b of one geometry with itself and with a, the first fixed column. b4 is relative to the largest b: it cannot underflow. */
struct geometry_sums {
    double aa, bb, b4, ab;
};

/* Over places begin .. end - 1, at most REDUCE_BLOCK of them. */
static struct geometry_sums geometry_block(const struct reduced *r, const struct table *t, size_t begin, size_t end,
                                           double inverse)
{
    struct geometry_sums s = {0.0, 0.0, 0.0, 0.0};
    size_t place;

    for (place = begin; place < end; place++) {
        uint32_t j = r->order[place];
        double a = r->sample_a[j], b = t->sample_b[j], relative = b * inverse;

        s.aa += a * a;
        s.bb += b * b;
        s.b4 += (relative * relative) * (relative * relative);
        s.ab += a * b;
    }
    return s;
}

static struct geometry_sums geometry_sums(const struct reduced *r, const struct table *t, size_t begin, size_t end,
                                          double largest_b)
{
    double inverse = largest_b > 0.0 ? 1.0 / largest_b : 0.0;
    struct sum aa = {0.0, 0.0}, bb = aa, b4 = aa, ab = aa;

    if (end - begin <= REDUCE_BLOCK) { /* most groups: one block is its own sum */
        return geometry_block(r, t, begin, end, inverse);
    }
    while (begin < end) {
        size_t stop = block_end(begin, end);
        struct geometry_sums block = geometry_block(r, t, begin, stop, inverse);

        add(&aa, block.aa);
        add(&bb, block.bb);
        add(&b4, block.b4);
        add(&ab, block.ab);
        begin = stop;
    }
    return (struct geometry_sums){value_of(&aa), value_of(&bb), value_of(&b4), value_of(&ab)};
}

/* u.v over places begin .. end - 1. */
static double product_sum(const struct reduced *r, const double *u, const double *v, size_t begin, size_t end)
{
    struct sum s = {0.0, 0.0};

    while (begin < end) {
        size_t stop = block_end(begin, end);
        double part = 0.0;

        for (; begin < stop; begin++) {
            part += u[r->order[begin]] * v[r->order[begin]];
        }
        add(&s, part);
    }
    return value_of(&s);
}

/* Products of a channel with the first a, with itself and with b of one geometry, those above and those below 0. */
struct channel_sums {
    double ai, ii, positive, negative;
};

/* Over places begin .. end - 1, at most REDUCE_BLOCK of them. */
static struct channel_sums channel_block(const struct reduced *r, const struct table *t, const brdffit_samples *samples,
                                         size_t k, size_t begin, size_t end)
{
    struct channel_sums s = {0.0, 0.0, 0.0, 0.0};
    size_t place;

    for (place = begin; place < end; place++) {
        uint32_t j = r->order[place];
        double value = brdffit_reduce_value(r, samples, j, k);
        double ib = t->sample_b[j] * value;

        s.ai += r->sample_a[j] * value;
        s.ii += value * value;
        s.positive += ib > 0.0 ? ib : 0.0;
        s.negative += ib < 0.0 ? -ib : 0.0;
    }
    return s;
}

static struct channel_sums channel_sums(const struct reduced *r, const struct table *t, const brdffit_samples *samples,
                                        size_t k, size_t begin, size_t end)
{
    struct sum ai = {0.0, 0.0}, ii = ai, positive = ai, negative = ai;

    if (end - begin <= REDUCE_BLOCK) {
        return channel_block(r, t, samples, k, begin, end);
    }
    while (begin < end) {
        size_t stop = block_end(begin, end);
        struct channel_sums block = channel_block(r, t, samples, k, begin, stop);

        add(&ai, block.ai);
        add(&ii, block.ii);
        add(&positive, block.positive);
        add(&negative, block.negative);
        begin = stop;
    }
    return (struct channel_sums){value_of(&ai), value_of(&ii), value_of(&positive), value_of(&negative)};
}

static double largest_b(const struct reduced *r, const struct table *t, size_t begin, size_t end)
{
    double largest = 0.0;
    size_t place;

    for (place = begin; place < end; place++) {
        largest = larger(largest, t->sample_b[r->order[place]]);
    }
    return largest;
}

static double smallest_c(const struct reduced *r, const struct table *t)
{
    double c_min = INFINITY;
    size_t j;

    for (j = 0; j < r->distinct; j++) {
        c_min = smaller(c_min, t->sample_c[r->order[r->begin[j]]]);
    }
    return isfinite(c_min) ? c_min : 0.0;
}

/* c of each group; where it has no lobe in this geometry any number will do. Padding: c of the last, no weight. */
static void fill_c(struct reduced *r, struct table *t)
{
    size_t j;

    for (j = 0; j < r->distinct; j++) {
        double c = t->sample_c[r->order[r->begin[j]]];

        t->c[j] = isfinite(c) ? c - t->c_min : 0.0;
    }
    for (; j < r->stride; j++) {
        t->c[j] = j ? t->c[j - 1] : 0.0;
    }
}

/* Tangents of each group, as c; where it has no lobe they mean as little. */
static void fill_sight(struct reduced *r, struct table *t)
{
    struct lobe_sight *sight = &t->sight;
    size_t j;

    *sight = (struct lobe_sight){.c_min = t->c_min, .c = t->c, .light = t->light, .view = t->view};
    for (j = 0; j < r->distinct && t->masked; j++) {
        t->light[j] = t->sample_light[r->order[r->begin[j]]];
        t->view[j] = t->sample_view[r->order[r->begin[j]]];
        sight->tan2_most = larger(sight->tan2_most, t->view[j]);
    }
    for (; j < r->stride && t->masked; j++) {
        t->light[j] = t->view[j] = 0.0;
    }
}

/* Smallest c - c_min that a lobe of this geometry sees: of second columns it may be above 0. */
static double lowest_c(const struct reduced *r, const struct table *t)
{
    double low = INFINITY;
    size_t j;

    for (j = 0; j < r->distinct; j++) {
        low = isfinite(t->sample_c[r->order[r->begin[j]]]) ? smaller(low, t->c[j]) : low;
    }
    return isfinite(low) ? low : 0.0;
}

static void clear(double *v, size_t n)
{
    size_t j;

    for (j = 0; j < n; j++) {
        v[j] = 0.0;
    }
}

void brdffit_reduce_groups(struct reduced *r)
{
    int g, h;

    r->stride = PADDED(r->distinct ? r->distinct : 1);
    for (g = 0; g < r->geometries; g++) {
        struct table *t = &r->table[g];

        /* Columns of one lobe have one phi. */
        t->c_min = g < r->bases ? smallest_c(r, t) : r->table[g - r->bases].c_min;
        fill_c(r, t);
        fill_sight(r, t);
        t->c_low = g < r->bases ? 0.0 : lowest_c(r, t);
        clear(t->bb, r->stride);
        clear(t->concentration, r->stride);
        clear(t->linear, r->stride * ((size_t)r->fixed + 2 * r->channels));
        for (h = 0; h < g; h++) {
            clear(r->cross[g * (g - 1) / 2 + h], r->stride);
        }
    }
    r->distinct = r->distinct ? r->distinct : 1; /* at least 1, if an empty one */
}

/* The sums of group j that need no values. Returns sum a^2. */
static double sum_group(struct reduced *r, size_t j)
{
    struct geometry_sums s = {0.0, 0.0, 0.0, 0.0};
    size_t begin = r->begin[j], end = r->begin[j + 1], f;
    int g, h;

    for (g = 0; g < r->geometries; g++) {
        struct table *t = &r->table[g];
        double top = largest_b(r, t, begin, end), bb;

        s = geometry_sums(r, t, begin, end, top);
        bb = s.bb;
        if (bb > 0.0) {
            double relative = bb / (top * top);

            t->bb[j] = bb;
            t->concentration[j] = s.b4 / (relative * relative);
            t->linear[j] = s.ab;
            for (f = 1; f < (size_t)r->fixed; f++) {
                t->linear[f * r->stride + j] = product_sum(r, r->sample_a + f * r->room, t->sample_b, begin, end);
            }
        }
        for (h = 0; h < g && j < r->distinct; h++) {
            r->cross[g * (g - 1) / 2 + h][j] = product_sum(r, t->sample_b, r->table[h].sample_b, begin, end);
        }
    }
    return s.aa;
}

static void sum_geometry(struct reduced *r)
{
    struct sum aa = {0.0, 0.0};
    size_t j, f, g;

    for (j = 0; j < r->groups; j++) {
        add(&aa, sum_group(r, j));
    }
    r->aa[0][0] = value_of(&aa);
    for (f = 1; f < (size_t)r->fixed; f++) {
        for (g = 0; g <= f; g++) {
            r->aa[f][g] = r->aa[g][f] = product_sum(r, r->sample_a + f * r->room, r->sample_a + g * r->room, 0,
                                                    r->used);
        }
    }
}

/* sum w a I of fixed column f and channel k. */
static double sum_along(const struct reduced *r, const brdffit_samples *samples, size_t f, size_t k)
{
    const double *a = r->sample_a + f * r->room;
    struct sum s = {0.0, 0.0};
    size_t place;

    for (place = 0; place < r->used; place++) {
        add(&s, a[r->order[place]] * brdffit_reduce_value(r, samples, r->order[place], k));
    }
    return value_of(&s);
}

static int sum_channel(struct reduced *r, const brdffit_samples *samples, size_t k)
{
    struct sum ai = {0.0, 0.0}, ii = {0.0, 0.0};
    size_t j, f, F = (size_t)r->fixed;
    int any_negative = 0, g;

    for (j = 0; j < r->groups; j++) {
        for (g = 0; g < r->geometries; g++) {
            struct table *t = &r->table[g];
            struct channel_sums s = channel_sums(r, t, samples, k, r->begin[j], r->begin[j + 1]);

            if (g == 0) {
                add(&ai, s.ai);
                add(&ii, s.ii);
            }
            if (j < r->distinct) {
                double below = s.negative;

                t->linear[(F + k) * r->stride + j] = s.positive;
                t->linear[(F + r->channels + k) * r->stride + j] = below;
                any_negative = any_negative || below > 0.0;
            }
        }
    }
    r->ai[k] = value_of(&ai);
    for (f = 1; f < F; f++) {
        r->ai[f * r->channels + k] = sum_along(r, samples, f, k);
    }
    r->ii[k] = value_of(&ii);
    return any_negative;
}

void brdffit_reduce_sums(struct reduced *r, const brdffit_samples *samples)
{
    struct sum weight = {0.0, 0.0};
    int any_negative = 0;
    size_t j, k;

    brdffit_reduce_group(r);
    brdffit_reduce_groups(r);
    sum_geometry(r);
    r->total = 0.0;
    for (k = 0; k < r->channels; k++) {
        any_negative = sum_channel(r, samples, k) || any_negative;
        r->total += r->ii[k];
    }
    for (j = 0; j < r->used; j++) {
        add(&weight, samples->weights ? samples->weights[r->sample[j]] / r->scale_w : 1.0);
    }
    r->weight_sum = value_of(&weight);
    r->functionals = (size_t)r->fixed + (any_negative ? 2 : 1) * r->channels;
}
