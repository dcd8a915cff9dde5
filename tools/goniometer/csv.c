/* csv.c: a goniometer that turns light and view about a flat sample and
 * writes f_r. A few lights stand beyond 60 degrees, where fits by default do
 * not look. SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "instrument.h"
#include "random.h"

static const double views[] = {0, 20, 40, 60};
static const double azimuths[] = {0, 10, 30, 90, 180};
#define ELEVATIONS 15
#define ELEVATION_STEP 5.0

struct sample {
    double theta_i, phi_i, theta_o, phi_o; /* degrees */
    double exact[GONIO_CHANNELS];
    double value[GONIO_CHANNELS];
};

static void direction(double theta, double phi, double out[3])
{
    const double radian = 3.14159265358979323846 / 180;
    out[0] = sin(theta * radian) * cos(phi * radian);
    out[1] = sin(theta * radian) * sin(phi * radian);
    out[2] = cos(theta * radian);
}

/* The mirror direction is theta_i = theta_o at phi_i = 0. */
static void expose(const struct gonio_material *material, struct sample *samples)
{
    struct sample *s = samples;
    for (size_t v = 0; v < sizeof views / sizeof *views; v++) {
        for (int e = 0; e < ELEVATIONS; e++) {
            for (size_t a = 0; a < sizeof azimuths / sizeof *azimuths; a++, s++) {
                double light[3], view[3];
                s->theta_i = ELEVATION_STEP * e;
                s->phi_i = azimuths[a];
                s->theta_o = views[v];
                s->phi_o = 180;
                direction(s->theta_i, s->phi_i, light);
                direction(s->theta_o, s->phi_o, view);
                for (int k = 0; k < GONIO_CHANNELS; k++) {
                    s->exact[k] = brdffit_gonio_brdf(material, k, light, view);
                }
            }
        }
    }
}

static void disturb(const struct gonio_recipe *recipe, struct gonio_random *random, struct sample *samples)
{
    for (int i = 0; i < GONIO_SAMPLES; i++) {
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            struct sample *const s = &samples[i];
            s->value[k] = s->exact[k];
            if (recipe->relative_noise > 0) {
                s->value[k] *= 1 + recipe->relative_noise * brdffit_gonio_normal(random);
            }
            if (recipe->absolute_noise > 0) {
                s->value[k] += recipe->absolute_noise * brdffit_gonio_normal(random);
            }
        }
    }
}

/* Stray light: anything between a half and one and a half of the channel's
 * largest value, in exactly round(fraction N) samples, each picked once. */
static void spoil(const struct gonio_recipe *recipe, struct gonio_random *random, struct sample *samples,
                  unsigned char *wrong)
{
    size_t order[GONIO_SAMPLES];
    double largest[GONIO_CHANNELS] = {0};
    const size_t count = (size_t)(recipe->outliers * GONIO_SAMPLES + 0.5);
    for (size_t i = 0; i < GONIO_SAMPLES; i++) {
        order[i] = i;
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            largest[k] = fmax(largest[k], samples[i].exact[k]);
        }
    }
    for (size_t i = 0; i < count; i++) {
        const size_t pick = i + brdffit_gonio_below(random, GONIO_SAMPLES - i);
        const size_t index = order[pick];
        order[pick] = order[i];
        wrong[index] = 1;
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            samples[index].value[k] = largest[k] * (0.5 + brdffit_gonio_uniform(random));
        }
    }
}

static void truth_lines(struct gonio_file *file, const struct gonio_recipe *recipe, uint64_t seed)
{
    const struct gonio_material *const m = recipe->material;
    brdffit_gonio_printf(file, "# synthetic: %s\n", m->description);
    if (m->model == GONIO_TWO_BECKMANN) {
        brdffit_gonio_printf(file, "# truth: sigma %.15g %.15g\n", m->sigma[0], m->sigma[1]);
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            brdffit_gonio_printf(file, "# truth: channel %c: x %.15g, y %.15g %.15g\n", "rgb"[k], m->x[k], m->y[k][0],
                                 m->y[k][1]);
        }
    } else if (m->model == GONIO_GGX_FRESNEL) {
        brdffit_gonio_printf(file, "# truth: GGX alpha %.15g, F0 %.15g %.15g %.15g\n", m->sigma[0], m->y[0][0],
                             m->y[1][0], m->y[2][0]);
    } else {
        brdffit_gonio_printf(file, "# truth: sigma %.15g rad, albedo %.15g %.15g %.15g\n", m->sigma[0], m->x[0],
                             m->x[1], m->x[2]);
    }
    brdffit_gonio_printf(file, "# noise: %.15g relative, %.15g 1/sr absolute; outliers: %.15g\n",
                         recipe->relative_noise, recipe->absolute_noise, recipe->outliers);
    brdffit_gonio_printf(file, "# seed: %llu; angles in degrees, values f_r in 1/sr\n", (unsigned long long)seed);
}

void brdffit_gonio_csv(struct gonio_file *file, const struct gonio_recipe *recipe, uint64_t seed, unsigned char *wrong)
{
    struct sample samples[GONIO_SAMPLES];
    struct gonio_random random = brdffit_gonio_random(seed, recipe->stream);
    /* An instrument records nine digits; the exact file has them all. */
    const int exact = !(recipe->relative_noise > 0) && !(recipe->absolute_noise > 0);
    memset(wrong, 0, GONIO_SAMPLES);
    expose(recipe->material, samples);
    disturb(recipe, &random, samples);
    if (recipe->outliers > 0) {
        spoil(recipe, &random, samples, wrong);
    }
    truth_lines(file, recipe, seed);
    brdffit_gonio_printf(file, "theta_i,phi_i,theta_o,phi_o,r,g,b\n");
    for (int i = 0; i < GONIO_SAMPLES; i++) {
        const struct sample *const s = &samples[i];
        brdffit_gonio_printf(file, "%g,%g,%g,%g", s->theta_i, s->phi_i, s->theta_o, s->phi_o);
        for (int k = 0; k < GONIO_CHANNELS; k++) {
            brdffit_gonio_printf(file, ",%.*g", exact ? 17 : 9, s->value[k]);
        }
        brdffit_gonio_printf(file, "\n");
    }
}
