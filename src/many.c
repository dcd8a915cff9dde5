/*
 * The batch: check the call, fit texel by texel, hand results out. See many.h. Layer 5.
 * SPDX-License-Identifier: MIT
 */
#include "many.h"

#include <math.h>
#include <string.h>

#include "fit.h"
#include "geometry.h"

void brdffit_texels_init(brdffit_texels *texels, const brdffit_plan *plan)
{
    static const brdffit_texels zero;

    *texels = zero;
    texels->struct_size = sizeof *texels;
    texels->scale = 1.0;
    texels->channel_stride = 1;
    texels->sample_stride = plan ? (ptrdiff_t)plan->geometry.channels : 0;
    texels->texel_stride = plan ? (ptrdiff_t)(plan->geometry.count * plan->geometry.channels) : 0;
}

void brdffit_texel_results_init(brdffit_texel_results *results)
{
    static const brdffit_texel_results zero;

    *results = zero;
    results->struct_size = sizeof *results;
}

void brdffit_many_stats_init(brdffit_many_stats *stats)
{
    static const brdffit_many_stats zero;

    *stats = zero;
    stats->struct_size = sizeof *stats;
}

const char *brdffit_texel_status_string(brdffit_texel_status status)
{
    static const char *const name[BRDFFIT_TEXEL_STATUS_COUNT] = {"certified", "open",      "no_signal",
                                                                 "masked",    "bad_value", "refused"};

    return (unsigned)status < BRDFFIT_TEXEL_STATUS_COUNT ? name[status] : "unknown";
}

void brdffit_many_layout(struct many *many, struct arena *arena, const brdffit_options *options, size_t samples,
                         size_t channels)
{
    size_t i;

    for (i = 0; i <= MANY_TILE; i++) {
        many->row[i] = brdffit_arena_take(arena, samples, channels * sizeof(double));
        many->result[i].x = ARENA_DOUBLES(arena, channels);
        many->result[i].y = brdffit_arena_take(arena, channels, (size_t)options->lobes * sizeof(double));
        many->result[i].channel_scale = ARENA_DOUBLES(arena, channels);
    }
    if (brdffit_many_fast_possible(options)) {
        brdffit_many_tile_layout(&many->tile, arena, samples, channels);
    }
    many->fit_size = brdffit_fit_workspace(samples, channels, options);
    many->fit = brdffit_arena_take(arena, many->fit_size, 1);
    if (many->fit_size == 0) {
        arena->failed = 1;
    }
}

static brdffit_status check(const brdffit_plan *plan, const brdffit_texels *t, const brdffit_texel_results *results,
                            const void *workspace, size_t size, const brdffit_many_stats *stats, brdffit_error *error)
{
    if (!plan || !workspace || (stats && stats->struct_size != sizeof *stats)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "plan or workspace is NULL, or stats of another version");
    }
    if (!t || t->struct_size != sizeof *t || !results || results->struct_size != sizeof *results) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "texels or results: NULL or of another version's size");
    }
    if (t->count && !t->values) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "texels: values is NULL");
    }
    if (!((unsigned)t->type < BRDFFIT_TYPE_COUNT)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "texels: unknown type of element");
    }
    if (!(t->scale > 0.0 && isfinite(t->scale))) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "texels: scale must be finite and > 0");
    }
    if (size < plan->workspace_size) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE,
                            "the workspace is smaller than brdffit_many_workspace_size()");
    }
    return BRDFFIT_OK;
}

/* Three channels are what a camera has; any other number takes the second loop. */
#define GATHER(type)                                                                                                   \
    do {                                                                                                               \
        const type *from = (const type *)t->values + start;                                                            \
                                                                                                                       \
        for (i = 0; i < samples && channels == 3; i++, from += t->sample_stride, values += 3) {                        \
            values[0] = (double)from[0] * scale;                                                                       \
            values[1] = (double)from[t->channel_stride] * scale;                                                       \
            values[2] = (double)from[2 * t->channel_stride] * scale;                                                   \
        }                                                                                                              \
        for (; i < samples; i++, from += t->sample_stride, values += channels) {                                       \
            for (k = 0; k < channels; k++) {                                                                           \
                values[k] = (double)from[(ptrdiff_t)k * t->channel_stride] * scale;                                    \
            }                                                                                                          \
        }                                                                                                              \
    } while (0)

void brdffit_many_gather(const brdffit_texels *t, size_t texel, size_t samples, size_t channels, double *values)
{
    ptrdiff_t start = (ptrdiff_t)texel * t->texel_stride;
    double scale = t->scale;
    size_t i, k;

    switch (t->type) {
    case BRDFFIT_TYPE_FLOAT: GATHER(float); break;
    case BRDFFIT_TYPE_UINT16: GATHER(uint16_t); break;
    default: GATHER(double); break;
    }
}

static void store(double *to, size_t texel, size_t width, const double *from, int fitted)
{
    size_t j;

    for (j = 0; to && j < width; j++) {
        to[texel * width + j] = fitted ? from[j] : NAN;
    }
}

/* Hand one texel's result to the caller. */
static void publish(const brdffit_plan *plan, const brdffit_texel_results *to, size_t texel,
                    const struct many_result *r)
{
    size_t K = plan->geometry.channels, P = (size_t)plan->options.lobes;
    int fitted = r->status == BRDFFIT_TEXEL_CERTIFIED || r->status == BRDFFIT_TEXEL_OPEN ||
                 r->status == BRDFFIT_TEXEL_NO_SIGNAL;

    store(to->sigma, texel, P, r->sigma, fitted);
    store(to->x, texel, K, r->x, fitted);
    store(to->y, texel, K * P, r->y, fitted);
    store(to->channel_scale, texel, K, r->channel_scale, fitted);
    store(to->e2, texel, 1, &r->e2, fitted);
    store(to->lower_bound, texel, 1, &r->lower_bound, fitted);
    store(to->sum_of_squares, texel, 1, &r->sum_of_squares, fitted);
    if (to->status) {
        to->status[texel] = (unsigned char)r->status;
    }
    if (to->stop) {
        to->stop[texel] = (unsigned char)(r->status <= BRDFFIT_TEXEL_OPEN ? r->stop : BRDFFIT_STOP_COUNT);
    }
    if (to->where) {
        to->where[texel] = r->where;
    }
    if (to->boxes) {
        to->boxes[texel] = r->boxes;
    }
}

/* Whether two channels of a texel hold the same bits. */
static int equal_channels(const double *values, size_t samples, size_t K, size_t k, size_t other)
{
    size_t i;

    for (i = 0; i < samples; i++) {
        if (memcmp(&values[i * K + k], &values[i * K + other], sizeof *values) != 0) {
            return 0;
        }
    }
    return 1;
}

static int zero_channel(const double *values, size_t samples, size_t K, size_t k)
{
    size_t i;

    for (i = 0; i < samples; i++) {
        if (values[i * K + k] != 0.0) {
            return 0;
        }
    }
    return 1;
}

static void count_channels(const brdffit_plan *plan, const double *values, brdffit_many_stats *stats)
{
    size_t n = plan->geometry.count, K = plan->geometry.channels, k, other;

    for (k = 0; k < K; k++) {
        int equal = 0;

        if (zero_channel(values, n, K, k)) {
            stats->zero_channels++;
            continue;
        }
        for (other = 0; other < k && !equal; other++) {
            equal = equal_channels(values, n, K, k, other);
        }
        stats->equal_channels += (size_t)equal;
    }
}

static void count(const brdffit_plan *plan, const double *values, const struct many_result *r, int repeated,
                  brdffit_many_stats *s)
{
    size_t *const of[BRDFFIT_TEXEL_STATUS_COUNT] = {&s->certified, &s->open,      &s->no_signal,
                                                    &s->masked,    &s->bad_value, &s->refused};

    s->texels++;
    ++*of[r->status];
    if (r->status > BRDFFIT_TEXEL_OPEN) {
        s->equal += (size_t)repeated;
        return;
    }
    s->equal += (size_t)repeated;
    s->one_lobe_enough += (size_t)r->one_lobe_enough;
    if (!repeated) {
        s->general += (size_t)r->general;
        s->boxes += r->boxes;
        s->nodes += r->nodes;
        count_channels(plan, values, s);
    }
}

/* Fit what waits and hand it out; the newest row becomes the one before. */
static void flush(struct many *many, const brdffit_texel_results *results, brdffit_many_stats *stats)
{
    size_t i, newest = many->filled - 1;
    double *row;
    struct many_result result;

    if (many->filled == 0) {
        return;
    }
    brdffit_many_tile(many);
    for (i = 0; i < many->waiting; i++) {
        size_t slot = many->slot[i];
        int repeated = i > 0 && many->slot[i - 1] == slot;

        publish(many->plan, results, many->texel[i], &many->result[slot]);
        if (stats) {
            count(many->plan, many->row[slot], &many->result[slot], repeated, stats);
        }
    }
    row = many->row[MANY_TILE];
    many->row[MANY_TILE] = many->row[newest];
    many->row[newest] = row;
    result = many->result[MANY_TILE];
    many->result[MANY_TILE] = many->result[newest];
    many->result[newest] = result;
    many->before = 1;
    many->filled = many->waiting = 0;
}

static int same(const struct many *many, const double *row, const double *other)
{
    return memcmp(row, other, many->plan->geometry.count * many->plan->geometry.channels * sizeof *row) == 0;
}

/* One texel that is not masked. */
static void take(struct many *many, const brdffit_texels *texels, size_t texel, const brdffit_texel_results *results,
                 brdffit_many_stats *stats)
{
    double *row;
    size_t slot;

    if (many->filled == MANY_TILE || many->waiting == MANY_WAITING) {
        flush(many, results, stats);
    }
    row = many->row[many->filled];
    brdffit_many_gather(texels, texel, many->plan->geometry.count, many->plan->geometry.channels, row);
    slot = many->filled;
    if (slot == 0 && many->before && same(many, row, many->row[MANY_TILE])) {
        publish(many->plan, results, texel, &many->result[MANY_TILE]);
        if (stats) {
            count(many->plan, row, &many->result[MANY_TILE], 1, stats);
        }
        return;
    }
    if (slot > 0 && same(many, row, many->row[slot - 1])) {
        slot--;
    } else {
        many->filled++;
    }
    many->texel[many->waiting] = texel;
    many->slot[many->waiting++] = slot;
}

brdffit_status brdffit_many_run(const brdffit_plan *plan, const brdffit_texels *texels,
                                const brdffit_texel_results *results, void *workspace, size_t workspace_size,
                                brdffit_many_stats *stats, brdffit_error *error)
{
    static const struct many_result masked = {.status = BRDFFIT_TEXEL_MASKED, .where = BRDFFIT_NONE};
    brdffit_status status = check(plan, texels, results, workspace, workspace_size, stats, error);
    struct arena arena;
    struct many many;
    size_t t;

    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_arena_init(&arena, workspace, workspace_size);
    brdffit_many_layout(&many, &arena, &plan->options, plan->geometry.count, plan->geometry.channels);
    many.plan = plan;
    many.filled = many.waiting = 0;
    many.before = 0;
    for (t = 0; t < texels->count; t++) {
        if (texels->mask && !texels->mask[t]) {
            publish(plan, results, t, &masked);
            if (stats) {
                count(plan, NULL, &masked, 0, stats);
            }
        } else {
            take(&many, texels, t, results, stats);
        }
    }
    flush(&many, results, stats);
    return BRDFFIT_OK;
}
