/*
 * A measurement, fitted: the five calls that a program needs first. SPDX-License-Identifier: MIT
 */
#include <brdffit.h>
#include <math.h>
#include <stdio.h>

/* f_r of a sheet of satin plastic, seen 20 degrees from its normal, for lights from -60 to 60 degrees in plane. */
static const double measured[13] = {0.0806, 0.0807, 0.0797, 0.0798, 0.0882, 0.1328, 0.2473,
                                    0.4140, 0.5257, 0.4673, 0.3035, 0.1596, 0.0976};

static void in_plane(double degrees, double *out)
{
    out[0] = sin(degrees * 3.14159265358979323846 / 180.0);
    out[1] = 0.0;
    out[2] = cos(degrees * 3.14159265358979323846 / 180.0);
}

int main(void)
{
    double light[3 * 13], view[3 * 13], fitted[13];
    brdffit_samples samples;
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;

    for (int i = 0; i < 13; i++) {
        in_plane(-60.0 + 10.0 * i, light + 3 * i);
        in_plane(-20.0, view + 3 * i);
    }
    brdffit_samples_init(&samples); /* f_r, around the normal +z */
    samples.count = 13;
    samples.channels = 1;
    samples.light = light;
    samples.view = view;
    samples.values = measured;
    brdffit_options_init(&options); /* one Beckmann lobe and a diffuse term */
    if (brdffit_fit_new(&samples, &options, &result, &error) != BRDFFIT_OK) {
        fprintf(stderr, "first_fit: %s\n", error.message);
        return 1;
    }
    printf("sigma %.4f, diffuse %.4f, specular %.4f\n", result->model->sigma[0], result->model->x[0],
           result->model->y[0]);
    printf("E^2 %.3g, and no such model has less than %.3g: %s\n", result->e2, result->lower_bound,
           result->certified ? "proven" : "stopped early");
    if (brdffit_eval(result->model, &samples, fitted, &error) == BRDFFIT_OK) {
        printf("at the mirror direction: measured %.4f, fitted %.4f\n", measured[8], fitted[8]);
    }
    brdffit_result_free(result);
    return 0;
}
