/* observations.c: how many observations a fit rests on.
 * SPDX-License-Identifier: MIT */
#include "observations.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "criteria.h"
#include "sample.h"

static int is_zero(const brdffit_result *result, size_t k)
{
    const size_t lobes = (size_t)result->model->lobes;
    int zero = !(result->rms[k] > 0) && !(result->model->x[k] > 0);
    for (size_t p = 0; p < lobes; p++) {
        zero = zero && !(result->model->y[k * lobes + p] > 0);
    }
    return zero;
}

/* To the bit: only the same data give that. */
static int repeats(const brdffit_result *result, size_t k, size_t earlier)
{
    const size_t lobes = (size_t)result->model->lobes;
    int same = result->rms[k] == result->rms[earlier] && result->model->x[k] == result->model->x[earlier] &&
               result->channel_scale[k] == result->channel_scale[earlier];
    for (size_t p = 0; p < lobes; p++) {
        same = same && result->model->y[k * lobes + p] == result->model->y[earlier * lobes + p];
    }
    return same;
}

static int is_distinct(const brdffit_result *result, size_t k)
{
    int own = !is_zero(result, k);
    for (size_t earlier = 0; earlier < k && own; earlier++) {
        own = !repeats(result, k, earlier);
    }
    return own;
}

size_t brdffit_cli_distinct_channels(const brdffit_result *result)
{
    size_t count = 0;
    for (size_t k = 0; k < result->model->channels; k++) {
        count += (size_t)is_distinct(result, k);
    }
    return count;
}

size_t brdffit_cli_observations(const brdffit_result *result)
{
    return result->samples_used * brdffit_cli_distinct_channels(result);
}

/* ---- Residuals --------------------------------------------------------- */

struct powers {
    double two, four;
};

static void add_sample(struct powers *sums, const brdffit_result *result, const brdffit_samples *samples,
                       const double *fitted, size_t i)
{
    const double factor = brdffit_cli_to_radiance(samples, i), weight = brdffit_cli_weight(samples, i);
    for (size_t k = 0; k < samples->channels; k++) {
        const size_t at = i * samples->channels + k;
        const double r = (samples->values[at] - fitted[at]) * factor / result->channel_scale[k];
        if (is_distinct(result, k)) {
            sums->two += weight * r * r;
            sums->four += weight * r * r * weight * r * r;
        }
    }
}

static struct powers powers(const brdffit_result *result, const brdffit_samples *samples,
                            const brdffit_options *options, const double *fitted)
{
    struct powers sums = {0, 0};
    for (size_t i = 0; i < samples->count; i++) {
        if (brdffit_cli_is_used(samples, options, i)) {
            add_sample(&sums, result, samples, fitted, i);
        }
    }
    return sums;
}

double brdffit_cli_effective_observations(struct cli_job *job, const brdffit_options *options)
{
    const brdffit_result *const result = job->result;
    const brdffit_samples *const samples = job->table->samples;
    const double all = (double)brdffit_cli_observations(result);
    struct powers sums = {0, 0};
    if (job->table->sums != NULL || !(result->e2 > brdffit_cli_e2_floor(result, options)) ||
        samples->count > SIZE_MAX / sizeof(double) / samples->channels) {
        return all;
    }
    double *const fitted = malloc(samples->count * samples->channels * sizeof *fitted);
    if (fitted == NULL) {
        brdffit_cli_job_fail(job, BRDFFIT_ERR_MEMORY);
        return all;
    }
    if (brdffit_eval(result->model, samples, fitted, NULL) == BRDFFIT_OK) {
        sums = powers(result, samples, options, fitted);
    }
    free(fitted);
    const double effective = 3 * sums.two * sums.two / sums.four;
    return effective < all ? effective : all;
}
