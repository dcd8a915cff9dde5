/*
 * Samples to reduced data: see reduce.h. This file classifies samples, chooses the internal units and sorts by
 * c; reduce_sums.c and reduce_rows.c do the rest. SPDX-License-Identifier: MIT
 */
#include "data/reduce.h"

#include <math.h>

#include "base/error.h"
#include "model/geometry.h"
#include "model/lobe.h"
#include "data/reduce_parts.h"
#include "base/tolerance.h"
#include "base/vector.h"

void brdffit_reduce_layout(struct reduced *reduced, struct arena *arena, size_t count, size_t channels)
{
    size_t width = channels + 2;
    size_t stride = PADDED(count);

    if (channels > SIZE_MAX / 64 || count > UINT32_MAX || width > SIZE_MAX / 8 / (width + REDUCE_BLOCK)) {
        arena->failed = 1;
        return;
    }
    reduced->channels = channels;
    reduced->c = ARENA_DOUBLES(arena, stride);
    reduced->bb = ARENA_DOUBLES(arena, stride);
    reduced->concentration = ARENA_DOUBLES(arena, stride);
    reduced->linear = brdffit_arena_take(arena, stride, (1 + 2 * channels) * sizeof(double));
    reduced->bound_channel = brdffit_arena_take(arena, channels, sizeof *reduced->bound_channel);
    reduced->bound_root = ARENA_DOUBLES(arena, channels);
    reduced->ai = ARENA_DOUBLES(arena, channels);
    reduced->ii = ARENA_DOUBLES(arena, channels);
    reduced->channel_scale = ARENA_DOUBLES(arena, channels);
    reduced->row_a = ARENA_DOUBLES(arena, count);
    reduced->row_b = ARENA_DOUBLES(arena, count);
    reduced->row_value = brdffit_arena_take(arena, count, channels * sizeof(double));
    reduced->row_c = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->row_square = ARENA_DOUBLES(arena, count);
    reduced->sample_a = ARENA_DOUBLES(arena, count);
    reduced->sample_b = ARENA_DOUBLES(arena, count);
    reduced->sample_c = ARENA_DOUBLES(arena, count);
    reduced->sample_factor = ARENA_DOUBLES(arena, count);
    reduced->sample = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->order = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->merge = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->block = ARENA_DOUBLES(arena, width * (width + REDUCE_BLOCK));
    brdffit_charge_layout(&reduced->charge, arena, stride); /* charge */
}

/* Values of one sample that counts: all finite; keep each channel's largest radiance, and in ii its magnitude. */
static brdffit_status check_values(struct reduced *r, const brdffit_samples *s, size_t i, double to_radiance,
                                   brdffit_error *error)
{
    const double *value = s->values + i * s->channels;
    size_t k;

    for (k = 0; k < s->channels; k++) {
        double radiance = value[k] * to_radiance;

        if (!isfinite(value[k])) {
            return brdffit_fail_at(error, "value is not finite", i, k, value[k]);
        }
        r->channel_scale[k] = larger(r->channel_scale[k], radiance);
        r->ii[k] = larger(r->ii[k], fabs(radiance));
    }
    return BRDFFIT_OK;
}

/* First pass: (a, b, c) of every sample that counts, in sample_*; the number of used and skipped ones. */
static brdffit_status classify(struct reduced *r, const brdffit_samples *s, const brdffit_options *options,
                               brdffit_error *error)
{
    double min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    size_t i, k;

    r->used = 0;
    brdffit_charge_none(&r->charge); /* charge */
    for (k = 0; k < BRDFFIT_SKIP_COUNT; k++) {
        r->skipped[k] = 0;
    }
    for (k = 0; k < s->channels; k++) {
        r->channel_scale[k] = 0.0;
        r->ii[k] = 0.0;
    }
    for (i = 0; i < s->count; i++) {
        struct geometry g = {0};
        brdffit_status status;
        brdffit_skip skip = brdffit_geometry_sample(s, options->distribution, min_cosine, i, &g, &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            r->skipped[skip]++;
            continue;
        }
        if (s->quantity == BRDFFIT_QUANTITY_RADIANCE) {
            g.cos_light = 1.0;
        }
        status = check_values(r, s, i, g.cos_light, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        r->sample[r->used] = (uint32_t)i;
        r->sample_a[r->used] = g.a;
        r->sample_b[r->used] = g.b;
        r->sample_c[r->used] = g.c;
        brdffit_charge_sample(&r->charge, r->used, &g); /* charge */
        r->sample_factor[r->used] = g.cos_light;
        r->used++;
    }
    return r->used ? BRDFFIT_OK : brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
}

/* Divisor of each channel; with NORMALISE_NONE one power of two for all, undone in the result. */
brdffit_status brdffit_reduce_channel_scales(struct reduced *r, const brdffit_options *options, brdffit_error *error)
{
    double magnitude = vector_largest(r->ii, r->channels);
    size_t k;

    if (options->normalise == BRDFFIT_NORMALISE_NONE && !(magnitude <= LIMIT_VALUE)) {
        return brdffit_fail_at(error, "a value is too large to minimise in the data's units", BRDFFIT_NONE,
                               BRDFFIT_NONE, magnitude);
    }
    for (k = 0; k < r->channels; k++) {
        if (options->normalise == BRDFFIT_NORMALISE_NONE) {
            r->channel_scale[k] = power_of_two(magnitude);
        } else if (!(r->channel_scale[k] > 0.0)) {
            r->channel_scale[k] = 1.0;
        }
        if (r->ii[k] > 0.0 && !(r->ii[k] >= LIMIT_SMALLEST)) {
            return brdffit_fail_at(error, "a channel's values are all below 1e-304: scale them", BRDFFIT_NONE, k,
                                   r->ii[k]);
        }
        if (!(r->ii[k] / r->channel_scale[k] <= LIMIT_VALUE)) {
            return brdffit_fail_at(error, "a channel's values span more than 150 orders of magnitude", BRDFFIT_NONE, k,
                                   r->ii[k]);
        }
    }
    return BRDFFIT_OK;
}

/* What a sample of weight w (relative to scale_w) is multiplied by. */
static double root_of(double w, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_LINF ? 1.0 : norm == BRDFFIT_NORM_L1 ? w : sqrt(w);
}

/* Scales of a, b and w; sample_a, sample_b and sample_factor get their final, weighted values. */
static brdffit_status choose_scales(struct reduced *r, const brdffit_samples *s, brdffit_norm norm,
                                    brdffit_error *error)
{
    double largest_a = 0.0, largest_b = 0.0, largest_w = s->weights ? 0.0 : 1.0;
    size_t j;

    for (j = 0; j < r->used; j++) {
        largest_a = larger(largest_a, r->sample_a[j]);
        largest_b = larger(largest_b, r->sample_b[j]);
        if (s->weights) {
            largest_w = larger(largest_w, s->weights[r->sample[j]]);
        }
    }
    r->scale_a = power_of_two(largest_a);
    r->scale_b = power_of_two(largest_b);
    r->scale_w = s->weights ? power_of_two(largest_w) : 1.0;
    for (j = 0; j < r->used; j++) {
        double root = s->weights ? root_of(s->weights[r->sample[j]] / r->scale_w, norm) : 1.0;
        double b = r->sample_b[j] / r->scale_b * root;

        if (r->sample_b[j] > 0.0 && !(b * LIMIT_COEFFICIENT_RATIO >= 1.0)) {
            return brdffit_fail_at(error, "b (with its weight) spans more than 140 orders of magnitude", r->sample[j],
                                   BRDFFIT_NONE, r->sample_b[j]);
        }
        r->sample_a[j] = r->sample_a[j] / r->scale_a * root;
        r->sample_b[j] = b;
        r->sample_factor[j] *= root;
        if (b == 0.0) {
            r->sample_c[j] = INFINITY; /* no lobe here, so c means nothing: sort it last */
            r->charge.b[j] *= root / r->scale_b; /* charge: what it hides */
        }
    }
    return BRDFFIT_OK;
}

static int not_after(const double *c, uint32_t p, uint32_t q)
{
    return c[p] < c[q] || (c[p] == c[q] && p < q);
}

/* Order by c, then by index: bottom-up merge sort that starts from runs already ascending (a MERL table is one). */
void brdffit_reduce_sort(struct reduced *r)
{
    uint32_t *from = r->order, *to = r->merge;
    size_t n = r->used, begin, i;
    int merged = 1;

    for (i = 0; i < n; i++) {
        from[i] = (uint32_t)i;
    }
    while (merged) {
        merged = 0;
        for (begin = 0; begin < n;) {
            size_t middle = begin + 1, end, left = begin, right, out = begin;

            while (middle < n && not_after(r->sample_c, from[middle - 1], from[middle])) {
                middle++;
            }
            end = middle < n ? middle + 1 : n;
            while (end < n && not_after(r->sample_c, from[end - 1], from[end])) {
                end++;
            }
            merged = merged || middle < n;
            for (right = middle; out < end; out++) {
                int take_left = left < middle && (right == end || not_after(r->sample_c, from[left], from[right]));

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

/* How far a half-vector angle may be from that of c and still be the same. */
static double snap_reach(double c)
{
    return (2.0 * sqrt(c) * (1.0 + c) + TOL_ANGLE) * TOL_ANGLE;
}

/*
 * Largest change of c that joins c_min. The search looks at s up to TAIL_EXPONENT or so over the next c - c_min, where a
 * change of TOL_JOIN / s is nothing: that next c is the first one beyond reach.
 */
static double join_reach(const struct reduced *r, double s_end)
{
    double low = r->sample_c[r->order[0]], reach = snap_reach(low);
    size_t i = 1;

    while (i < r->used && r->sample_c[r->order[i]] - low <= reach) {
        i++;
    }
    if (i < r->used && isfinite(r->sample_c[r->order[i]])) {
        s_end = smaller(s_end, 2.0 * TAIL_EXPONENT / (r->sample_c[r->order[i]] - low));
    }
    return smaller(reach, TOL_JOIN / s_end);
}

/*
 * Half-vector angles within TOL_ANGLE are one angle: mirror images of a direction differ in the last bits, and their
 * sums merge once they have one c; not where lobes of s <= s_end could tell them apart. The change is one more error of
 * that sample's c (charge.h), and relative to c - c_min it is kept for the moments.
 */
void brdffit_reduce_snap(struct reduced *r, double s_end)
{
    double low = r->sample_c[r->order[0]], first = low, join = join_reach(r, s_end);
    size_t i;

    for (i = 1; i < r->used; i++) {
        double *c = &r->sample_c[r->order[i]], change = *c - first;

        if (!(first == low ? change <= join : change <= snap_reach(first) && change <= TOL_SNAP * (first - low))) {
            first = *c;
        } else if (change > 0.0) {
            r->snapped = first == low ? r->snapped : larger(r->snapped, change / (first - low));
            r->charge.c[r->order[i]] += change; /* charge, and the next line */
            r->charge.joined = first == low ? larger(r->charge.joined, change) : r->charge.joined;
            *c = first;
        }
    }
}

double brdffit_reduce_end(const brdffit_options *o)
{
    return brdffit_lobe_kind_of(o->distribution)->by_exponent ? o->exponent_max : 1.0 / (o->sigma_min * o->sigma_min);
}

brdffit_status brdffit_reduce(struct reduced *reduced, const brdffit_samples *samples, const brdffit_options *options,
                              brdffit_error *error)
{
    brdffit_status status = classify(reduced, samples, options, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_reduce_channel_scales(reduced, options, error);
    }
    if (status == BRDFFIT_OK) {
        status = choose_scales(reduced, samples, options->norm, error);
    }
    if (status == BRDFFIT_OK) {
        brdffit_reduce_sort(reduced);
        reduced->snapped = 0.0;
        reduced->counted = reduced->used;
        if (samples->form == BRDFFIT_FORM_DIRECTIONS) {
            brdffit_reduce_snap(reduced, brdffit_reduce_end(options));
        }
        brdffit_reduce_sums(reduced, samples);
        brdffit_reduce_every_channel(reduced);
        brdffit_reduce_rows(reduced, samples, options->norm);
        brdffit_charge_samples(reduced, samples, options->norm); /* charge */
    }
    return status;
}
