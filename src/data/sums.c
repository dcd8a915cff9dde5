/*
 * Sums: memory, groups, and samples one by one; rows of tables: sums_row.c. See sums.h.
 * SPDX-License-Identifier: MIT
 */
#include "data/sums.h"

#include <math.h>
#include <string.h>

#include "base/arena.h"
#include "base/error.h"
#include "model/geometry.h"
#include "base/tolerance.h"

static size_t slots_for(size_t groups)
{
    size_t slots = 8;

    while (slots / 2 < groups) {
        slots *= 2;
    }
    return slots;
}

/* 0 when it does not fit. */
static int layout(struct brdffit_sums *s, struct arena *arena)
{
    size_t K = s->channels;

    s->slots = slots_for(s->capacity);
    s->c = ARENA_DOUBLES(arena, s->capacity);
    s->product = brdffit_arena_take(arena, s->capacity, SUMS_PRODUCTS(K) * sizeof *s->product);
    s->slot = brdffit_arena_take(arena, s->slots, sizeof *s->slot);
    s->cell = brdffit_arena_take(arena, s->capacity, sizeof *s->cell);
    s->errors = brdffit_arena_take(arena, s->capacity, sizeof *s->errors);
    s->ascending = brdffit_arena_take(arena, s->capacity, sizeof *s->ascending);
    s->largest = ARENA_DOUBLES(arena, K);
    s->magnitude = ARENA_DOUBLES(arena, K);
    s->totals_memory = ARENA_DOUBLES(arena, TABLE_ROW_TOTALS_DOUBLES(K));
    return !arena->failed;
}

static int sensible(size_t channels, size_t groups)
{
    return channels > 0 && groups > 0 && channels <= SIZE_MAX / 65536 && groups <= UINT32_MAX / 4;
}

size_t brdffit_sums_size(size_t channels, size_t groups)
{
    struct brdffit_sums sums;
    struct arena arena;

    if (!sensible(channels, groups)) {
        return 0;
    }
    sums.channels = channels;
    sums.capacity = groups;
    brdffit_arena_init(&arena, NULL, 0);
    (void)brdffit_arena_take(&arena, 1, sizeof sums);
    return layout(&sums, &arena) ? arena.used : 0;
}

/* Addresses of a row's scratch, and everything 0. */
static void clear(struct brdffit_sums *s)
{
    size_t sums = TABLE_ROW_SUMS(s->channels) * LANES;

    memset(s->slot, 0, s->slots * sizeof *s->slot);
    memset(s->errors, 0, s->capacity * sizeof *s->errors);
    s->hidden_c = s->any_c = INFINITY;
    memset(s->largest, 0, s->channels * sizeof *s->largest);
    memset(s->magnitude, 0, s->channels * sizeof *s->magnitude);
    s->totals.high = s->totals_memory;
    s->totals.low = s->totals.high + sums;
    s->totals.largest = s->totals.low + sums;
    s->totals.seen = s->totals.largest + s->channels * LANES;
}

struct brdffit_sums *brdffit_sums_start(void *memory, size_t size, size_t channels, size_t groups,
                                        const brdffit_options *options)
{
    struct brdffit_sums *sums;
    struct arena arena;

    brdffit_arena_init(&arena, memory, size);
    sums = brdffit_arena_take(&arena, 1, sizeof *sums);
    memset(sums, 0, sizeof *sums);
    sums->channels = channels;
    sums->capacity = groups;
    sums->distribution = brdffit_model_asked(options, 0);
    sums->max_incidence = options->max_incidence;
    sums->min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    sums->kernels = brdffit_table_row_kernels(options->isa);
    (void)layout(sums, &arena);
    clear(sums);
    return sums;
}

void brdffit_sums_count(const brdffit_sums *sums, size_t *used, size_t *skipped, size_t reasons)
{
    size_t k;

    if (used) {
        *used = sums->used;
    }
    for (k = 0; skipped && k < reasons; k++) {
        skipped[k] = k < BRDFFIT_SKIP_COUNT ? sums->skipped[k] : 0;
    }
}

double brdffit_sums_largest(const brdffit_sums *sums, size_t channel)
{
    return channel < sums->channels ? sums->largest[channel] : 0.0;
}

/* Whether what sums cannot hold is there: the limits of brdffit.h. */
static brdffit_status check_range(const struct brdffit_sums *s, const brdffit_samples *samples, size_t i,
                                  const struct geometry *g, double to_radiance, brdffit_error *error)
{
    double w = samples->weights ? samples->weights[i] : 1.0;
    size_t k;

    if (!(w <= LIMIT_SUMS_RANGE && w >= 1.0 / LIMIT_SUMS_RANGE)) {
        return brdffit_fail_at(error, "a weight of sums must be 0 or in [1e-50, 1e50]", i, BRDFFIT_NONE, w);
    }
    if (!(g->b == 0.0 || (g->b <= LIMIT_SUMS_RANGE && g->b >= 1.0 / LIMIT_SUMS_RANGE))) {
        return brdffit_fail_at(error, "b of sums must be 0 or in [1e-50, 1e50]", i, BRDFFIT_NONE, g->b);
    }
    if (!(g->a <= LIMIT_SUMS_VALUE)) {
        return brdffit_fail_at(error, "a of sums must be at most 1e100", i, BRDFFIT_NONE, g->a);
    }
    for (k = 0; k < s->channels; k++) {
        double value = samples->values[i * s->channels + k];

        if (!isfinite(value)) {
            return brdffit_fail_at(error, "value is not finite", i, k, value);
        }
        if (!(fabs(value * to_radiance) <= LIMIT_SUMS_VALUE)) {
            return brdffit_fail_at(error, "a value of sums must be within 1e100", i, k, value);
        }
    }
    return BRDFFIT_OK;
}

static void add_to_group(struct brdffit_sums *s, struct sums_pair *product, const struct geometry *g, double w,
                         const double *value, double to_radiance)
{
    double wb = w * g->b, wa = w * g->a;
    size_t k;

    sums_add(&product[SUMS_AA], wa * g->a);
    sums_add(&product[SUMS_AB], wa * g->b);
    sums_add(&product[SUMS_BB], wb * g->b);
    sums_add(&product[SUMS_B4], (wb * g->b) * (wb * g->b));
    for (k = 0; k < s->channels; k++) {
        struct sums_pair *channel = product + SUMS_CHANNEL + SUMS_PER_CHANNEL * k;
        double radiance = value[k] * to_radiance, lobe = wb * radiance;

        sums_add(&channel[SUMS_AI], wa * radiance);
        sums_add(&channel[SUMS_II], w * radiance * radiance);
        if (lobe > 0.0) {
            sums_add(&channel[SUMS_POSITIVE], lobe);
        } else if (lobe < 0.0) {
            sums_add(&channel[SUMS_NEGATIVE], -lobe);
        }
        s->largest[k] = fmax(s->largest[k], radiance);
        s->magnitude[k] = fmax(s->magnitude[k], fabs(radiance));
    }
}

/* What a sample without a lobe may hide (charge.c). */
static void note_hidden(struct brdffit_sums *s, const struct geometry *g, double w, const double *value,
                        double to_radiance)
{
    int positive = 0;
    size_t k;

    for (k = 0; k < s->channels && g->b_hidden > 0.0; k++) {
        double radiance = value[k] * to_radiance;

        positive = positive || radiance > 0.0;
        s->hidden_data += w * (radiance > 0.0 ? 1.0 : 0.0); /* at most the channel's scale each */
    }
    if (g->b_hidden > 0.0) {
        s->any_hidden += w * g->b_hidden * g->b_hidden;
        s->any_c = fmin(s->any_c, g->c_hidden);
    }
    if (positive) {
        s->hidden += w * g->b_hidden * g->b_hidden;
        s->hidden_c = fmin(s->hidden_c, g->c_hidden);
    }
}

/* Add the sample to its group, or to the two that share it; 0 when there is no room. */
static int add_products(struct brdffit_sums *s, const struct geometry *g, double w, const double *value,
                        double to_radiance)
{
    struct sums_split split = {{0, 0}, {1.0, 1.0}};
    int i, parts = 1;

    if (s->bits && g->b > 0.0) {
        parts = brdffit_sums_split(s, g->c, w * g->b * g->b, &split);
    } else {
        split.group[0] = brdffit_sums_find(s, g->b > 0.0 ? g->c : INFINITY);
        parts = split.group[0] < s->capacity;
    }
    for (i = 0; i < parts; i++) {
        struct sums_errors errors = {g->b_error, g->c_error, g->c_error};

        sums_note_errors(&s->errors[split.group[i]], &errors);
        add_to_group(s, sums_group(s, split.group[i]), g, w * split.share[i], value, to_radiance);
    }
    return parts > 0;
}

static brdffit_status add_sample(struct brdffit_sums *s, const brdffit_samples *samples, size_t i, brdffit_error *error)
{
    struct geometry g = {.a = 0.0};
    brdffit_status status;
    brdffit_skip skip = brdffit_geometry_sample(samples, s->distribution, s->min_cosine, i, &g, &status, error);
    double to_radiance = samples->quantity == BRDFFIT_QUANTITY_RADIANCE ? 1.0 : g.cos_light;
    double w = samples->weights ? samples->weights[i] : 1.0;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (skip != BRDFFIT_SKIP_COUNT) {
        s->skipped[skip]++;
        return BRDFFIT_OK;
    }
    status = check_range(s, samples, i, &g, to_radiance, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!add_products(s, &g, w, samples->values + i * s->channels, to_radiance)) {
        (void)brdffit_fail_at(error,
                              s->bits ? "the samples need more bins than the sums have groups"
                                      : "the samples have more distinct c than the sums have groups",
                              i, BRDFFIT_NONE, g.c);
        return error ? (error->status = BRDFFIT_ERR_WORKSPACE) : BRDFFIT_ERR_WORKSPACE;
    }
    note_hidden(s, &g, w, samples->values + i * s->channels, to_radiance);
    s->light_error = fmax(s->light_error, g.light_error);
    sums_add(&s->weight, w);
    s->largest_weight = fmax(s->largest_weight, w);
    s->used++;
    return BRDFFIT_OK;
}

brdffit_status brdffit_sums_add_run(brdffit_sums *sums, const brdffit_samples *samples, brdffit_error *error)
{
    brdffit_status status;
    size_t i;

    if (!sums) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "sums is NULL");
    }
    status = brdffit_geometry_check(samples, 1, error);
    if (status != BRDFFIT_OK) {
        return status == BRDFFIT_ERR_NO_SAMPLES ? BRDFFIT_OK : status;
    }
    if (samples->channels != sums->channels) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: not as many channels as the sums");
    }
    sums->directions |= samples->form == BRDFFIT_FORM_DIRECTIONS;
    for (i = 0; i < samples->count && status == BRDFFIT_OK; i++) {
        status = add_sample(sums, samples, i, error);
    }
    return status;
}
