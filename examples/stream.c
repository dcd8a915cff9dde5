/*
 * A goniometer that never stops: samples are added up as they come and not kept, and fitted at any time.
 * SPDX-License-Identifier: MIT
 */
#include <brdffit.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define CHUNK 1000
#define GROUPS 32768

static double light[3 * CHUNK], view[3 * CHUNK], values[CHUNK];

static double uniform(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* A direction from the upper hemisphere, at most 60 degrees from its pole. */
static void direction(uint64_t *state, double *out)
{
    double z = 0.5 + 0.5 * uniform(state), phi = 6.283185307179586 * uniform(state);

    out[0] = sqrt(1.0 - z * z) * cos(phi);
    out[1] = sqrt(1.0 - z * z) * sin(phi);
    out[2] = z;
}

/* The next samples of a surface with two lobes, with 1 % noise. */
static int measure(uint64_t *state, brdffit_samples *samples)
{
    static const double sigma[2] = {0.1, 0.4}, x = 0.3, y[2] = {0.01, 0.05};
    brdffit_model model;

    for (size_t i = 0; i < CHUNK; i++) {
        direction(state, light + 3 * i);
        direction(state, view + 3 * i);
    }
    brdffit_samples_init(samples);
    samples->count = CHUNK;
    samples->channels = 1;
    samples->light = light;
    samples->view = view;
    samples->values = values;
    brdffit_model_init(&model);
    model.lobes = 2;
    model.channels = 1;
    model.sigma = sigma;
    model.x = &x;
    model.y = y;
    if (brdffit_eval(&model, samples, values, NULL) != BRDFFIT_OK) {
        return 0;
    }
    for (size_t i = 0; i < CHUNK; i++) {
        values[i] *= 1.0 + 0.01 * (uniform(state) + uniform(state) - 1.0);
    }
    return 1;
}

/* Fit what was added so far. The workspace grows with the groups in use, not with the samples. */
static int fit(const brdffit_sums *sums, const brdffit_options *options)
{
    size_t size = brdffit_sums_workspace_size(sums, options), used;
    void *workspace = malloc(size);
    brdffit_error error = {.message = "no memory"};
    const brdffit_result *result;

    if (!workspace || brdffit_fit_sums(sums, options, workspace, size, &result, &error) != BRDFFIT_OK) {
        fprintf(stderr, "stream: %s\n", error.message);
        free(workspace);
        return 0;
    }
    brdffit_sums_count(sums, &used, NULL, 0);
    printf("%6zu samples: sigma %.4f and %.4f, E^2 %.5g +- %.1g, bound %.5g (%s)\n", used, result->model->sigma[0],
           result->model->sigma[1], result->e2, result->e2_error, result->lower_bound,
           brdffit_stop_string(result->stop));
    free(workspace);
    return 1;
}

int main(void)
{
    size_t size = brdffit_sums_size(1, GROUPS);
    void *memory = malloc(size);
    brdffit_error error = {.message = "no memory"};
    brdffit_samples samples;
    brdffit_options options;
    brdffit_sums *sums;
    uint64_t state = 1;
    int good;

    brdffit_options_init(&options);
    options.lobes = 2;
    options.relative_gap = 0.01;
    /* Random directions: every c is another one, so that samples share bins, 2^11 an octave. */
    good = memory && brdffit_sums_init(memory, size, 1, GROUPS, &options, &sums, &error) == BRDFFIT_OK &&
           brdffit_sums_bins(sums, 11, &error) == BRDFFIT_OK;
    for (int chunk = 1; good && chunk <= 100; chunk++) {
        good = measure(&state, &samples) && brdffit_sums_add(sums, &samples, &error) == BRDFFIT_OK;
        if (chunk == 1 || chunk == 10 || chunk == 100) {
            good = good && fit(sums, &options);
        }
    }
    free(memory);
    return good ? 0 : 1;
}
