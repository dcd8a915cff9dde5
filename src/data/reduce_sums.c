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

size_t brdffit_reduce_group_end(const struct reduced *r, size_t begin)
{
    double c = r->sample_c[r->order[begin]];
    size_t end = begin + 1;

    while (end < r->used && r->sample_c[r->order[end]] == c) {
        end++;
    }
    return end;
}

/* Products of geometry over places begin .. end - 1. b4 is relative to the largest b: it cannot underflow. */
struct geometry_sums {
    struct sum aa, bb, b4, ab;
};

static struct geometry_sums geometry_sums(const struct reduced *r, size_t begin, size_t end, double largest_b)
{
    struct geometry_sums s = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    double inverse = largest_b > 0.0 ? 1.0 / largest_b : 0.0;
    size_t place = begin;

    while (place < end) {
        size_t stop = end - place > REDUCE_BLOCK ? place + REDUCE_BLOCK : end;
        double aa = 0.0, bb = 0.0, b4 = 0.0, ab = 0.0;

        for (; place < stop; place++) {
            uint32_t j = r->order[place];
            double a = r->sample_a[j], b = r->sample_b[j], relative = b * inverse;

            aa += a * a;
            bb += b * b;
            b4 += (relative * relative) * (relative * relative);
            ab += a * b;
        }
        add(&s.aa, aa);
        add(&s.bb, bb);
        add(&s.b4, b4);
        add(&s.ab, ab);
    }
    return s;
}

struct channel_sums {
    struct sum ai, ii, positive, negative;
};

static struct channel_sums channel_sums(const struct reduced *r, const brdffit_samples *samples, size_t k, size_t begin,
                                        size_t end)
{
    struct channel_sums s = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    size_t place = begin;

    while (place < end) {
        size_t stop = end - place > REDUCE_BLOCK ? place + REDUCE_BLOCK : end;
        double ai = 0.0, ii = 0.0, positive = 0.0, negative = 0.0;

        for (; place < stop; place++) {
            uint32_t j = r->order[place];
            double value = brdffit_reduce_value(r, samples, j, k);
            double ib = r->sample_b[j] * value;

            ai += r->sample_a[j] * value;
            ii += value * value;
            positive += ib > 0.0 ? ib : 0.0;
            negative += ib < 0.0 ? -ib : 0.0;
        }
        add(&s.ai, ai);
        add(&s.ii, ii);
        add(&s.positive, positive);
        add(&s.negative, negative);
    }
    return s;
}

static double largest_b(const struct reduced *r, size_t begin, size_t end)
{
    double largest = 0.0;
    size_t place;

    for (place = begin; place < end; place++) {
        largest = larger(largest, r->sample_b[r->order[place]]);
    }
    return largest;
}

/* Distinct c among samples that have a lobe; they come first in the order. At least 1. */
static void distinct_c(struct reduced *r)
{
    size_t place = 0;

    r->distinct = 0;
    r->c_min = 0.0;
    while (place < r->used && isfinite(r->sample_c[r->order[place]])) {
        double c = r->sample_c[r->order[place]];

        if (r->distinct == 0) {
            r->c_min = c;
        }
        r->c[r->distinct++] = c - r->c_min;
        place = brdffit_reduce_group_end(r, place);
    }
    if (r->distinct == 0) {
        r->c[r->distinct++] = 0.0;
    }
    r->stride = PADDED(r->distinct);
}

/* Padding: c of the last, no weight. Clears every array of length stride. */
static void clear_groups(struct reduced *r)
{
    size_t j;

    for (j = r->distinct; j < r->stride; j++) {
        r->c[j] = r->c[r->distinct - 1];
    }
    for (j = 0; j < r->stride; j++) {
        r->bb[j] = 0.0;
        r->concentration[j] = 0.0;
    }
    for (j = 0; j < r->stride * (1 + 2 * r->channels); j++) {
        r->linear[j] = 0.0;
    }
}

void brdffit_reduce_groups(struct reduced *r)
{
    distinct_c(r);
    clear_groups(r);
}

static double sum_geometry(struct reduced *r)
{
    struct sum aa = {0.0, 0.0};
    size_t place, end, j;

    for (place = 0, j = 0; place < r->used; place = end, j++) {
        struct geometry_sums s;
        double bb;

        end = brdffit_reduce_group_end(r, place);
        s = geometry_sums(r, place, end, largest_b(r, place, end));
        add(&aa, value_of(&s.aa));
        bb = value_of(&s.bb);
        if (bb > 0.0) {
            double top = largest_b(r, place, end);
            double relative = bb / (top * top);

            r->bb[j] = bb;
            r->concentration[j] = value_of(&s.b4) / (relative * relative);
            r->linear[j] = value_of(&s.ab);
        }
    }
    return value_of(&aa);
}

static int sum_channel(struct reduced *r, const brdffit_samples *samples, size_t k)
{
    struct sum ai = {0.0, 0.0}, ii = {0.0, 0.0};
    double *positive = r->linear + (1 + k) * r->stride;
    double *negative = r->linear + (1 + r->channels + k) * r->stride;
    size_t place, end, j;
    int any_negative = 0;

    for (place = 0, j = 0; place < r->used; place = end, j++) {
        struct channel_sums s;

        end = brdffit_reduce_group_end(r, place);
        s = channel_sums(r, samples, k, place, end);
        add(&ai, value_of(&s.ai));
        add(&ii, value_of(&s.ii));
        if (j < r->distinct) {
            positive[j] = value_of(&s.positive);
            negative[j] = value_of(&s.negative);
            any_negative = any_negative || negative[j] > 0.0;
        }
    }
    r->ai[k] = value_of(&ai);
    r->ii[k] = value_of(&ii);
    return any_negative;
}

void brdffit_reduce_sums(struct reduced *r, const brdffit_samples *samples)
{
    struct sum weight = {0.0, 0.0};
    int any_negative = 0;
    size_t j, k;

    brdffit_reduce_groups(r);
    r->aa = sum_geometry(r);
    r->total = 0.0;
    for (k = 0; k < r->channels; k++) {
        any_negative = sum_channel(r, samples, k) || any_negative;
        r->total += r->ii[k];
    }
    for (j = 0; j < r->used; j++) {
        add(&weight, samples->weights ? samples->weights[r->sample[j]] / r->scale_w : 1.0);
    }
    r->weight_sum = value_of(&weight);
    r->functionals = any_negative ? 1 + 2 * r->channels : 1 + r->channels;
}
