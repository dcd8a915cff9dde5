/*
 * The batch: check the call, fit texel by texel, hand results out. See batch.h.
 * SPDX-License-Identifier: MIT
 */
#include "batch/batch.h"

#include <math.h>
#include <string.h>

#include "fit/fit.h"
#include "base/error.h"
#include "base/intake.h"
#include "model/geometry.h"

void brdffit_texels_init_sized(brdffit_texels *texels, size_t struct_size, const brdffit_plan *plan)
{
    brdffit_texels start = {.scale = 1.0, .channel_stride = 1};

    if (plan) {
        start.sample_stride = (ptrdiff_t)plan->geometry.channels;
        start.texel_stride = (ptrdiff_t)(plan->geometry.count * plan->geometry.channels);
    }
    intake_init(texels, struct_size, &start, sizeof start);
}

const char *brdffit_texel_status_string(brdffit_texel_status status)
{
    static const char *const name[BRDFFIT_TEXEL_STATUS_COUNT] = {"certified", "open",      "no_signal",
                                                                 "masked",    "bad_value", "refused"};

    return (unsigned)status < BRDFFIT_TEXEL_STATUS_COUNT ? name[status] : "unknown";
}

/* Columns of the diffuse term after the first. */
static size_t more_columns(const brdffit_options *options)
{
    return (size_t)brdffit_diffuse_columns(options->diffuse) - 1;
}

static void layout_terms(struct batch_result *r, struct arena *arena, const brdffit_options *options, size_t channels)
{
    size_t more = more_columns(options), lobes = (size_t)options->lobes;

    r->f0 = options->fresnel ? brdffit_arena_take(arena, channels, lobes * sizeof(double)) : NULL;
    r->x_more = more ? brdffit_arena_take(arena, channels, more * sizeof(double)) : NULL;
}

void brdffit_batch_layout(struct batch *batch, struct arena *arena, const brdffit_options *options, size_t samples,
                          size_t channels)
{
    size_t i;

    for (i = 0; i <= BATCH_TILE; i++) {
        batch->row[i] = brdffit_arena_take(arena, samples, channels * sizeof(double));
        batch->result[i].x = ARENA_DOUBLES(arena, channels);
        batch->result[i].y = brdffit_arena_take(arena, channels, (size_t)options->lobes * sizeof(double));
        batch->result[i].channel_scale = ARENA_DOUBLES(arena, channels);
        layout_terms(&batch->result[i], arena, options, channels);
    }
    if (brdffit_batch_fast_possible(options)) {
        brdffit_batch_tile_layout(&batch->tile, arena, samples, channels, options);
    }
    batch->fit_size = brdffit_fit_workspace(samples, channels, options);
    batch->fit = brdffit_arena_take(arena, batch->fit_size, 1);
    if (batch->fit_size == 0) {
        arena->failed = 1;
    }
}

static brdffit_status check(const brdffit_plan *plan, const brdffit_texels *t, const void *workspace, size_t size,
                            brdffit_error *error)
{
    if (!plan || !workspace) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "plan or workspace is NULL");
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

void brdffit_batch_gather(const brdffit_texels *t, size_t texel, size_t samples, size_t channels, double *values)
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

/* `from` may be NULL: zeros. */
static void store(double *to, size_t texel, size_t width, const double *from, int fitted)
{
    size_t j;

    for (j = 0; to && j < width; j++) {
        to[texel * width + j] = !fitted ? NAN : from ? from[j] : 0.0;
    }
}

/* Hand one texel's result to the caller. */
static void publish(const brdffit_plan *plan, const brdffit_texel_results *to, size_t texel,
                    const struct batch_result *r)
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
    store(to->sigma_floor, texel, 1, &r->sigma_floor, fitted);
    store(to->f0, texel, K * P, r->f0, fitted);
    store(to->x_more, texel, K * more_columns(&plan->options), r->x_more, fitted);
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

static void count(const brdffit_plan *plan, const double *values, const struct batch_result *r, int repeated,
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
static void flush(struct batch *batch, const brdffit_texel_results *results, brdffit_many_stats *stats)
{
    size_t i, newest = batch->filled - 1;
    double *row;
    struct batch_result result;

    if (batch->filled == 0) {
        return;
    }
    brdffit_batch_tile(batch);
    for (i = 0; i < batch->waiting; i++) {
        size_t slot = batch->slot[i];
        int repeated = i > 0 && batch->slot[i - 1] == slot;

        publish(batch->plan, results, batch->texel[i], &batch->result[slot]);
        if (stats) {
            count(batch->plan, batch->row[slot], &batch->result[slot], repeated, stats);
        }
    }
    row = batch->row[BATCH_TILE];
    batch->row[BATCH_TILE] = batch->row[newest];
    batch->row[newest] = row;
    result = batch->result[BATCH_TILE];
    batch->result[BATCH_TILE] = batch->result[newest];
    batch->result[newest] = result;
    batch->before = 1;
    batch->filled = batch->waiting = 0;
}

static int same(const struct batch *batch, const double *row, const double *other)
{
    return memcmp(row, other, batch->plan->geometry.count * batch->plan->geometry.channels * sizeof *row) == 0;
}

/* One texel that is not masked. */
static void take(struct batch *batch, const brdffit_texels *texels, size_t texel, const brdffit_texel_results *results,
                 brdffit_many_stats *stats)
{
    double *row;
    size_t slot;

    if (batch->filled == BATCH_TILE || batch->waiting == BATCH_WAITING) {
        flush(batch, results, stats);
    }
    row = batch->row[batch->filled];
    brdffit_batch_gather(texels, texel, batch->plan->geometry.count, batch->plan->geometry.channels, row);
    slot = batch->filled;
    if (slot == 0 && batch->before && same(batch, row, batch->row[BATCH_TILE])) {
        publish(batch->plan, results, texel, &batch->result[BATCH_TILE]);
        if (stats) {
            count(batch->plan, row, &batch->result[BATCH_TILE], 1, stats);
        }
        return;
    }
    if (slot > 0 && same(batch, row, batch->row[slot - 1])) {
        slot--;
    } else {
        batch->filled++;
    }
    batch->texel[batch->waiting] = texel;
    batch->slot[batch->waiting++] = slot;
}

brdffit_status brdffit_batch_run(const brdffit_plan *plan, const brdffit_texels *texels,
                                 const brdffit_texel_results *results, void *workspace, size_t workspace_size,
                                 brdffit_many_stats *stats, brdffit_error *error)
{
    static const struct batch_result masked = {.status = BRDFFIT_TEXEL_MASKED, .where = BRDFFIT_NONE};
    brdffit_status status = check(plan, texels, workspace, workspace_size, error);
    struct arena arena;
    struct batch batch;
    size_t t;

    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_arena_init(&arena, workspace, workspace_size);
    brdffit_batch_layout(&batch, &arena, &plan->options, plan->geometry.count, plan->geometry.channels);
    batch.plan = plan;
    batch.filled = batch.waiting = 0;
    batch.before = 0;
    for (t = 0; t < texels->count; t++) {
        if (texels->mask && !texels->mask[t]) {
            publish(plan, results, t, &masked);
            if (stats) {
                count(plan, NULL, &masked, 0, stats);
            }
        } else {
            take(&batch, texels, t, results, stats);
        }
    }
    flush(&batch, results, stats);
    return BRDFFIT_OK;
}
