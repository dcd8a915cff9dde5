/* truth.c: truth.json, what the files were made from.
 * SPDX-License-Identifier: MIT */
#include "truth.h"

static void numbers(struct gonio_file *file, const char *name, const double *values, int count)
{
    brdffit_gonio_printf(file, ", \"%s\": [", name);
    for (int i = 0; i < count; i++) {
        brdffit_gonio_printf(file, "%s%.15g", i == 0 ? "" : ", ", values[i]);
    }
    brdffit_gonio_printf(file, "]");
}

void brdffit_gonio_truth_begin(struct gonio_file *file, uint64_t seed)
{
    brdffit_gonio_printf(file, "{\"schema\": \"brdffit.truth/1\", \"seed\": %llu, \"files\": [\n",
                         (unsigned long long)seed);
}

static void parameters(struct gonio_file *file, const struct gonio_material *m)
{
    const double normal_incidence[GONIO_CHANNELS] = {m->y[0][0], m->y[1][0], m->y[2][0]};
    switch (m->model) {
    case GONIO_TWO_BECKMANN:
        brdffit_gonio_printf(file, ", \"distribution\": \"beckmann\"");
        numbers(file, "sigma", m->sigma, 2);
        numbers(file, "x", m->x, GONIO_CHANNELS);
        brdffit_gonio_printf(file, ", \"y\": [");
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            brdffit_gonio_printf(file, "%s[%.15g, %.15g]", k == 0 ? "" : ", ", m->y[k][0], m->y[k][1]);
        }
        brdffit_gonio_printf(file, "]");
        break;
    case GONIO_GGX_FRESNEL:
        brdffit_gonio_printf(file, ", \"distribution\": \"ggx_schlick\", \"alpha\": %.15g", m->sigma[0]);
        numbers(file, "f0", normal_incidence, GONIO_CHANNELS);
        break;
    case GONIO_ROUGH_MATTE:
        brdffit_gonio_printf(file, ", \"distribution\": \"oren_nayar\", \"sigma_radians\": %.15g", m->sigma[0]);
        numbers(file, "albedo", m->x, GONIO_CHANNELS);
        break;
    }
}

void brdffit_gonio_truth_add(struct gonio_file *file, const struct gonio_recipe *recipe, const unsigned char *wrong,
                             int first)
{
    brdffit_gonio_printf(file, "%s{\"file\": \"%s\", \"description\": \"%s\"", first ? "" : ",\n", recipe->name,
                         recipe->material->description);
    parameters(file, recipe->material);
    brdffit_gonio_printf(file, ", \"relative_noise\": %.15g, \"absolute_noise\": %.15g", recipe->relative_noise,
                         recipe->absolute_noise);
    brdffit_gonio_printf(file, ", \"outliers\": [");
    int printed = 0;
    for (int i = 0; wrong != NULL && i < GONIO_SAMPLES; i++) {
        if (wrong[i]) {
            brdffit_gonio_printf(file, "%s%d", printed++ == 0 ? "" : ", ", i);
        }
    }
    brdffit_gonio_printf(file, "]}");
}

void brdffit_gonio_truth_end(struct gonio_file *file)
{
    brdffit_gonio_printf(file, "\n]}\n");
}
