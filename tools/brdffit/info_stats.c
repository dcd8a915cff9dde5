/* info_stats.c: what is in a table and what a fit would use of it.
 * SPDX-License-Identifier: MIT */
#include "info_stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sample.h"

static double degrees(double radians)
{
    return radians * (180 / 3.14159265358979323846);
}

static void widen(struct cli_range *range, double value)
{
    if (value < range->low) {
        range->low = value;
    }
    if (value > range->high) {
        range->high = value;
    }
}

static double angle_of(double cosine)
{
    return degrees(acos(cosine > 1 ? 1 : cosine < -1 ? -1 : cosine));
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void channel_stats(const brdffit_samples *samples, struct cli_channel_stats *channel)
{
    for (size_t k = 0; k < samples->channels; k++) {
        struct cli_channel_stats s = {INFINITY, 0, -INFINITY, 0};
        for (size_t i = 0; i < samples->count; i++) {
            const double value = samples->values[i * samples->channels + k];
            s.low = value < s.low ? value : s.low;
            s.high = value > s.high ? value : s.high;
            s.negative += value < 0;
            /* A running mean: a sum could overflow. */
            s.mean += (value - s.mean) / (double)(i + 1);
        }
        channel[k] = s;
    }
}

/* Count what is distinct in `alpha`, in radians, sorted on return. */
static void count_distinct(struct cli_stats *stats, double *alpha, size_t count)
{
    double last = -1;
    qsort(alpha, count, sizeof *alpha, ascending);
    for (size_t i = 0; i < count; i++) {
        if (stats->distinct > 0 && !(alpha[i] - last > CLI_SAME_ANGLE)) {
            continue;
        }
        if (stats->distinct < 3) {
            stats->smallest[stats->distinct] = degrees(alpha[i]);
        }
        stats->distinct++;
        last = alpha[i];
    }
}

static void angle_stats(const brdffit_samples *samples, const brdffit_options *options, struct cli_stats *stats,
                        double *alpha)
{
    size_t used = 0;
    for (size_t i = 0; i < samples->count; i++) {
        if (!brdffit_cli_is_used(samples, options, i)) {
            continue;
        }
        struct cli_angles angles;
        brdffit_cli_angles(samples, i, &angles);
        alpha[used] = atan(sqrt(angles.tan2_half));
        widen(&stats->half, degrees(alpha[used++]));
        if (samples->form == BRDFFIT_FORM_COEFFICIENTS) {
            continue;
        }
        widen(&stats->incidence, angle_of(angles.cos_light));
        widen(&stats->view, angle_of(angles.cos_view));
    }
    count_distinct(stats, alpha, used);
}

brdffit_status brdffit_cli_stats(const brdffit_table *table, const brdffit_options *options, struct cli_stats *stats,
                                 brdffit_error *error)
{
    static const struct cli_range empty = {INFINITY, -INFINITY};
    const brdffit_samples *const samples = table->samples;
    memset(stats, 0, sizeof *stats);
    stats->incidence = stats->view = stats->half = empty;
    const brdffit_status status = brdffit_inspect(samples, options, &stats->used, stats->skipped, BRDFFIT_SKIP_COUNT,
                                                  error);
    /* That nothing is left is an answer here, not a failure. */
    if (status != BRDFFIT_OK && status != BRDFFIT_ERR_NO_SAMPLES) {
        return status;
    }
    stats->channel = calloc(samples->channels, sizeof *stats->channel);
    double *const alpha = calloc(stats->used + 1, sizeof *alpha);
    if (stats->channel == NULL || alpha == NULL) {
        free(alpha);
        brdffit_cli_stats_free(stats);
        error->status = BRDFFIT_ERR_MEMORY;
        error->message = brdffit_status_string(BRDFFIT_ERR_MEMORY);
        error->sample = error->channel = error->line = error->column = BRDFFIT_NONE;
        error->value = 0;
        return BRDFFIT_ERR_MEMORY;
    }
    channel_stats(samples, stats->channel);
    angle_stats(samples, options, stats, alpha);
    free(alpha);
    return BRDFFIT_OK;
}

void brdffit_cli_stats_free(struct cli_stats *stats)
{
    free(stats->channel);
    stats->channel = NULL;
}

double brdffit_cli_resolved_sigma(const struct cli_stats *stats)
{
    if (stats->distinct < 3) {
        return NAN;
    }
    return tan(stats->smallest[2] / (180 / 3.14159265358979323846));
}
