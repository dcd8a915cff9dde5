/*
 * A fit in a renderer: fit, make it ready for shading, and light it from everywhere by draws from the material. The mean of
 * f_r (n.l) / density is the albedo, whatever the draws are; the closer their density, the less it scatters.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>

#include <brdffit.h>
#include <brdffit_shade.h>

/* The material that is measured: diffuse 0.25, a GGX lobe of 0.3 with Smith's masking. */
static void measure(double light[][3], double view[][3], double *values, int count)
{
    static const double sigma[] = {0.3}, x[] = {0.25}, y[] = {0.1};
    static struct brdffit_shade_d truth;
    struct brdffit_shade_description d = {
        1, 1, {BRDFFIT_SHADE_GGX}, BRDFFIT_SHADE_SMITH, BRDFFIT_SHADE_LAMBERT, 0, sigma, x, y, NULL, NULL};
    int i;

    (void)brdffit_shade_make_d(&truth, &d);
    for (i = 0; i < count; i++) {
        double t = 0.1 + 0.05 * (i % 16), u = 0.1 + 0.11 * (i / 16), phi = 3.0 + 0.1 * (i % 5);

        light[i][0] = sin(t);
        light[i][1] = 0.0;
        light[i][2] = cos(t);
        view[i][0] = sin(u) * cos(phi);
        view[i][1] = sin(u) * sin(phi);
        view[i][2] = cos(u);
        brdffit_shade_eval_d(&truth, light[i], view[i], &values[i]);
    }
}

/* Number i of a sequence that fills [0, 1)^3 evenly (Roberts 2018). */
static void spread(int i, float u[3])
{
    u[0] = (float)fmod(0.5 + 0.8191725133961645 * i, 1.0);
    u[1] = (float)fmod(0.5 + 0.6710436067037893 * i, 1.0);
    u[2] = (float)fmod(0.5 + 0.5497004779019703 * i, 1.0);
}

int main(void)
{
    static double light[160][3], view[160][3], values[160];
    static struct brdffit_shade_f material;
    static const float viewer[3] = {0.6f, 0.0f, 0.8f};
    const brdffit_result *result;
    struct brdffit_shade_description description;
    brdffit_samples samples;
    brdffit_options options;
    brdffit_error error;
    float albedo[1];
    double sum = 0.0;
    int i, draws = 4096;

    measure(light, view, values, 160);
    brdffit_samples_init(&samples);
    samples.count = 160;
    samples.channels = 1;
    samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples.light = light[0];
    samples.view = view[0];
    samples.values = values;
    brdffit_options_init(&options);
    options.distribution = BRDFFIT_GGX;
    options.masking = BRDFFIT_MASKING_SMITH;
    if (brdffit_fit_new(&samples, &options, &result, &error) != BRDFFIT_OK) {
        fprintf(stderr, "%s: %s\n", brdffit_status_string(error.status), error.message);
        return 1;
    }
    description = brdffit_shade_of_model(result->model);
    if (!brdffit_shade_make_f(&material, &description)) {
        return 1;
    }
    for (i = 0; i < draws; i++) {
        float u[3], toward[3], value[1], density;

        spread(i, u);
        density = brdffit_shade_sample_f(&material, viewer, u, toward);
        brdffit_shade_eval_f(&material, toward, viewer, value);
        sum += density > 0.0f ? (double)(value[0] / density) : 0.0;
    }
    brdffit_shade_albedo_f(&material, viewer, albedo);
    printf("sigma %.4f; albedo %.3f by %d draws, %.3f by the table\n", result->model->sigma[0], sum / draws, draws,
           (double)albedo[0]);
    brdffit_result_free(result);
    return 0;
}
