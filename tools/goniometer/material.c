/* material.c: materials whose reflectance is known exactly.
 * SPDX-License-Identifier: MIT */
#include "material.h"

#include <math.h>

#define PI 3.14159265358979323846

const struct gonio_material brdffit_gonio_satin = {
    GONIO_TWO_BECKMANN, "satin paint: diffuse, a narrow and a wide Beckmann lobe", {0.12, 0.45},
    {0.35, 0.22, 0.10}, {{0.020, 0.060}, {0.019, 0.045}, {0.018, 0.030}},
};

const struct gonio_material brdffit_gonio_metal = {
    GONIO_GGX_FRESNEL,
    "metal: GGX with Smith shadowing and Schlick's Fresnel, no diffuse part",
    {0.18, 0},
    {0, 0, 0},
    {{0.95, 0}, {0.79, 0}, {0.45, 0}},
};

const struct gonio_material brdffit_gonio_matte = {
    GONIO_ROUGH_MATTE, "plaster: Oren-Nayar, no specular part", {0.35, 0}, {0.62, 0.41, 0.28}, {{0, 0}, {0, 0}, {0, 0}},
};

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static void half_vector(const double light[3], const double view[3], double half[3])
{
    double length = 0;
    for (int i = 0; i < 3; i++) {
        half[i] = light[i] + view[i];
        length += half[i] * half[i];
    }
    for (int i = 0; i < 3; i++) {
        half[i] /= sqrt(length);
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Cook and Torrance 1982 as the paper writes it:
 * f_r (n.l) = (n.l)/pi x + sum_p y_p G exp(-tan^2 a/s^2) / (pi (n.v) cos^4 a s^2) */
static double two_beckmann(const struct gonio_material *m, int channel, const double light[3], const double view[3])
{
    double half[3];
    half_vector(light, view, half);
    const double nl = light[2], nv = view[2], nh = half[2], vh = dot(view, half);
    const double tan2 = (half[0] * half[0] + half[1] * half[1]) / (nh * nh);
    const double valley = 2 * nh * smaller(nl, nv) / vh;
    const double shadowing = smaller(1, valley);
    double specular = 0;
    for (int p = 0; p < 2; p++) {
        const double s2 = m->sigma[p] * m->sigma[p];
        specular += m->y[channel][p] * exp(-tan2 / s2) / s2;
    }
    return m->x[channel] / PI + specular * shadowing / (PI * nl * nv * pow(nh, 4));
}

/* Walter et al. 2007; height-correlated Smith term of Heitz 2014. */
static double ggx_fresnel(const struct gonio_material *m, int channel, const double light[3], const double view[3])
{
    double half[3];
    half_vector(light, view, half);
    const double nl = light[2], nv = view[2], nh = half[2];
    const double a2 = m->sigma[0] * m->sigma[0];
    const double spread = nh * nh * (a2 - 1) + 1;
    const double distribution = a2 / (PI * spread * spread);
    const double visible = 0.5 / (nl * sqrt(nv * nv * (1 - a2) + a2) + nv * sqrt(nl * nl * (1 - a2) + a2));
    const double normal_incidence = m->y[channel][0];
    const double grazing = pow(1 - dot(view, half), 5);
    return distribution * visible * (normal_incidence + (1 - normal_incidence) * grazing);
}

/* Oren and Nayar 1994, equation 30. */
static double rough_matte(const struct gonio_material *m, int channel, const double light[3], const double view[3])
{
    const double s2 = m->sigma[0] * m->sigma[0];
    const double a = 1 - 0.5 * s2 / (s2 + 0.33);
    const double b = 0.45 * s2 / (s2 + 0.09);
    const double sine_light = hypot(light[0], light[1]), sine_view = hypot(view[0], view[1]);
    double azimuth = 0;
    if (sine_light > 0 && sine_view > 0) {
        azimuth = (light[0] * view[0] + light[1] * view[1]) / (sine_light * sine_view);
    }
    /* sin(larger angle) tan(smaller angle) */
    const double steep = light[2] < view[2] ? sine_light : sine_view;
    const double flat = light[2] < view[2] ? sine_view / view[2] : sine_light / light[2];
    return m->x[channel] / PI * (a + b * (azimuth > 0 ? azimuth : 0) * steep * flat);
}

double brdffit_gonio_brdf(const struct gonio_material *material, int channel, const double light[3],
                          const double view[3])
{
    switch (material->model) {
    case GONIO_TWO_BECKMANN: return two_beckmann(material, channel, light, view);
    case GONIO_GGX_FRESNEL: return ggx_fresnel(material, channel, light, view);
    case GONIO_ROUGH_MATTE: return rough_matte(material, channel, light, view);
    }
    return 0;
}
