/*
 * The proof of a fit, box by box, and the same bound verified by another engine. SPDX-License-Identifier: MIT
 */
#include <brdffit.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SAMPLES 60

struct proof {
    size_t boxes;
    int deepest;
    double narrowest; /* log10 of high / low */
};

/* The box is the library's: it is there until this returns. */
static void see(void *user, const brdffit_box *box)
{
    struct proof *proof = user;

    proof->boxes++;
    proof->deepest = box->level > proof->deepest ? box->level : proof->deepest;
    proof->narrowest = fmin(proof->narrowest, log10(box->sigma_high[0] / box->sigma_low[0]));
}

static int measure(brdffit_samples *samples)
{
    static const double sigma = 0.2, x = 0.3, y = 0.03;
    static double light[3 * SAMPLES], view[3 * SAMPLES], values[SAMPLES];
    brdffit_model model;

    for (int i = 0; i < SAMPLES; i++) {
        double theta = (double)i * 3.14159265358979323846 / 180.0;

        light[3 * i] = sin(theta);
        light[3 * i + 2] = cos(theta);
        view[3 * i] = -0.5;
        view[3 * i + 2] = sqrt(0.75);
    }
    brdffit_samples_init(samples);
    samples->count = SAMPLES;
    samples->channels = 1;
    samples->light = light;
    samples->view = view;
    samples->values = values;
    brdffit_model_init(&model);
    model.channels = 1;
    model.sigma = &sigma;
    model.x = &x;
    model.y = &y;
    if (brdffit_eval(&model, samples, values, NULL) != BRDFFIT_OK) {
        return 0;
    }
    for (int i = 0; i < SAMPLES; i++) {
        values[i] *= i % 3 ? 1.02 : 0.96; /* what no model explains */
    }
    return 1;
}

/* By engine socp alone, with a margin: its bounds are of first order. */
static int verify(const brdffit_samples *samples, const brdffit_options *given, double level)
{
    brdffit_options options = *given;
    const brdffit_verification *found;
    brdffit_error error;
    brdffit_status status;
    size_t size;
    void *workspace;
    int good;

    options.engine = BRDFFIT_ENGINE_SOCP;
    options.box = NULL;
    size = brdffit_workspace_size(samples->count, samples->channels, &options);
    workspace = malloc(size);
    if (!workspace) {
        return 0;
    }
    status = brdffit_verify(samples, &options, level, workspace, size, &found, &error);
    if (status == BRDFFIT_OK) {
        printf("verified: %s that no model has an E^2 below %.3g, by %zu boxes\n",
               found->proven ? "proven again" : "not proven", found->level, found->leaves);
    } else {
        printf("verified: %s\n", error.message); /* a library without ECOS */
    }
    good = status == BRDFFIT_OK ? found->proven : status == BRDFFIT_ERR_UNSUPPORTED;
    free(workspace); /* which *found lies in */
    return good;
}

int main(void)
{
    struct proof proof = {0, 0, INFINITY};
    brdffit_samples samples;
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;
    int good;

    brdffit_options_init(&options);
    options.box = see;
    options.box_user = &proof;
    if (!measure(&samples) || brdffit_fit_new(&samples, &options, &result, &error) != BRDFFIT_OK) {
        return 1;
    }
    printf("sigma %.4f, E^2 %.3g, bound %.3g\n", result->model->sigma[0], result->e2, result->lower_bound);
    printf("%zu boxes, halved up to %d times, the narrowest %.2g decades wide\n", proof.boxes, proof.deepest,
           proof.narrowest);
    good = result->certified && proof.boxes == result->boxes && verify(&samples, &options, 0.9 * result->lower_bound);
    brdffit_result_free(result);
    return good ? 0 : 1;
}
