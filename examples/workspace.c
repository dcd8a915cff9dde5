/*
 * Fits without malloc: in memory of a fixed size, one after the other. SPDX-License-Identifier: MIT
 */
#include <brdffit.h>
#include <stdio.h>

#define SAMPLES 40

/* The size asks for the number of samples and channels, the lobes and the budget of boxes, and for no values. */
static unsigned char workspace[512 * 1024];

/* Samples as a, b, c of the model: whoever has a model of the geometry at hand needs no directions. */
static double a[SAMPLES], b[SAMPLES], c[SAMPLES], radiance[SAMPLES];

/* A decaying lobe of this width on a diffuse floor, with a ripple that no model explains. */
static void measure(double slope)
{
    for (int i = 0; i < SAMPLES; i++) {
        double lobe = 1.0 / (1.0 + slope * c[i] + 0.5 * slope * slope * c[i] * c[i]);

        radiance[i] = 0.2 * a[i] + b[i] * lobe + (i % 2 ? 0.002 : -0.002);
    }
}

int main(void)
{
    brdffit_samples samples;
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;
    size_t size;

    for (int i = 0; i < SAMPLES; i++) {
        a[i] = 0.3 - 0.002 * i;
        b[i] = 0.3 + 0.001 * i;
        c[i] = 0.0004 * i * i;
    }
    brdffit_samples_init(&samples);
    samples.count = SAMPLES;
    samples.channels = 1;
    samples.form = BRDFFIT_FORM_COEFFICIENTS;
    samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples.a = a;
    samples.b = b;
    samples.c = c;
    samples.values = radiance;
    brdffit_options_init(&options);
    options.box_budget = 500; /* most of the default's workspace is for a million boxes */
    size = brdffit_workspace_size(SAMPLES, 1, &options);
    printf("%zu of %zu bytes\n", size, sizeof workspace);
    if (size == 0 || size > sizeof workspace) {
        return 1;
    }
    for (int fit = 0; fit < 3; fit++) {
        measure(8.0 + 8.0 * fit);
        if (brdffit_fit(&samples, &options, workspace, sizeof workspace, &result, &error) != BRDFFIT_OK) {
            fprintf(stderr, "workspace: %s\n", error.message);
            return 1;
        }
        /* The result lies in the workspace: to be read before the next fit. */
        printf("sigma %.4f: %s after %zu boxes\n", result->model->sigma[0], brdffit_stop_string(result->stop),
               result->boxes);
    }
    return 0;
}
