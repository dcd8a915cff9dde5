/*
 * Lobes by textbook formulas on vectors, in long double, and a scene of directions to see them from; for
 * test_distribution.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_DISTRIBUTION_SCENE_H
#define BRDFFIT_TESTS_DISTRIBUTION_SCENE_H

#include <math.h>
#include <stddef.h>

#include "brdffit.h"

#define PI 3.14159265358979323846264338327950288L

static inline int by_exponent(brdffit_distribution distribution)
{
    switch (distribution) { /* no default: the compiler names a distribution that is missing */
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_TORRANCE_SPARROW:
    case BRDFFIT_WARD:
    case BRDFFIT_RETRO:
    case BRDFFIT_DISTRIBUTION_COUNT: return 0;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
    case BRDFFIT_LAFORTUNE: return 1;
    }
    return 0;
}

/* ---- textbook formulas -------------------------------------------------------------------------------- */

static inline long double dot(const long double *u, const long double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* What y multiplies, as radiance under normal +z; parameter: sigma, or the exponent. */
static inline long double textbook(brdffit_distribution distribution, const double *light, const double *view,
                                   long double parameter)
{
    long double l[3], v[3], h[3], r[3], length[3], alpha, g, tangent, nh, vh;
    int j;

    for (j = 0; j < 3; j++) {
        l[j] = light[j];
        v[j] = view[j];
    }
    length[0] = sqrtl(dot(l, l));
    length[1] = sqrtl(dot(v, v));
    for (j = 0; j < 3; j++) {
        l[j] /= length[0];
        v[j] /= length[1];
        h[j] = l[j] + v[j];
        r[j] = (j == 2 ? 2.0L * l[2] : 0.0L) - l[j];
    }
    length[2] = sqrtl(dot(h, h));
    for (j = 0; j < 3; j++) {
        h[j] /= length[2];
    }
    nh = h[2];
    vh = dot(v, h);
    alpha = atan2l(hypotl(h[0], h[1]), nh);
    tangent = tanl(alpha);
    g = fminl(1.0L, fminl(2.0L * nh * v[2] / vh, 2.0L * nh * l[2] / vh));
    switch (distribution) {
    case BRDFFIT_BECKMANN:
        return g / (PI * v[2] * powl(nh, 4.0L)) * expl(-powl(tangent / parameter, 2.0L)) / (parameter * parameter);
    case BRDFFIT_GGX:
        return g / (PI * v[2] * powl(nh, 4.0L)) / powl(parameter * (1.0L + powl(tangent / parameter, 2.0L)), 2.0L);
    case BRDFFIT_TORRANCE_SPARROW: return g / (PI * v[2]) * expl(-powl(alpha / parameter, 2.0L));
    case BRDFFIT_WARD:
        return l[2] / sqrtl(l[2] * v[2]) * expl(-powl(tangent / parameter, 2.0L)) / (4.0L * PI * parameter * parameter);
    case BRDFFIT_BLINN_PHONG: return l[2] * (parameter + 2.0L) / (2.0L * PI) * powl(nh, parameter);
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
        return l[2] * (parameter + 1.0L) / (8.0L * PI) * powl(nh, parameter) / (vh * fmaxl(l[2], v[2]));
    case BRDFFIT_LAFORTUNE: return l[2] * (parameter + 2.0L) / (2.0L * PI) * powl(fmaxl(dot(r, v), 0.0L), parameter);
    case BRDFFIT_RETRO:
        for (j = 0; j < 3; j++) {
            r[j] = l[j] - v[j];
        }
        return l[2] * expl(-dot(r, r) / (parameter * parameter)) / (PI * parameter * parameter);
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return NAN;
}

/* ---- directions: half vectors from 1e-4 rad of the normal to the horizon ------------------------------ */

#define HALF_ANGLES 72
#define COUNT (4 * HALF_ANGLES)

struct scene {
    double light[3 * COUNT], view[3 * COUNT], values[2 * COUNT];
    double cosine[4][COUNT]; /* of form ANGLES: n.l, n.v, tan^2 alpha, v.h */
    size_t count;
};

/* Half and difference angles (Rusinkiewicz) to directions; 0 where one is too near the horizon. */
static inline int place(struct scene *s, long double half, long double phi, long double apart, long double turn)
{
    long double d[3] = {sinl(apart) * cosl(turn), sinl(apart) * sinl(turn), cosl(apart)};
    long double h[3] = {sinl(half) * cosl(phi), sinl(half) * sinl(phi), cosl(half)};
    long double side[3] = {cosl(half) * cosl(phi), cosl(half) * sinl(phi), -sinl(half)};
    long double up[3] = {-sinl(phi), cosl(phi), 0.0L};
    double *l = s->light + 3 * s->count, *v = s->view + 3 * s->count;
    int j;

    for (j = 0; j < 3; j++) {
        long double along = d[2] * h[j], across = d[0] * side[j] + d[1] * up[j];

        l[j] = (double)(along + across);
        v[j] = (double)(along - across);
    }
    s->cosine[0][s->count] = l[2];
    s->cosine[1][s->count] = v[2];
    s->cosine[2][s->count] = (double)powl(tanl(half), 2.0L);
    s->cosine[3][s->count] = (double)cosl(apart);
    return l[2] > 0.05 && v[2] > 0.05;
}

static inline void scene_new(struct scene *s)
{
    int i, j;

    s->count = 0;
    for (i = 0; i < HALF_ANGLES; i++) {
        long double half = 1e-4L * powl(1.45e4L, (long double)i / (HALF_ANGLES - 1));

        for (j = 0; j < 4; j++) {
            s->count += (size_t)place(s, half, 0.3L * i, 0.05L + 0.3L * j, 0.4L + 0.7L * j + 0.1L * i);
        }
    }
}

static inline brdffit_samples scene_samples(const struct scene *s, brdffit_form form)
{
    brdffit_samples samples;

    brdffit_samples_init(&samples);
    samples.count = s->count;
    samples.channels = 2;
    samples.form = form;
    samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples.light = s->light;
    samples.view = s->view;
    samples.cos_light = s->cosine[0];
    samples.cos_view = s->cosine[1];
    samples.tan2_half = s->cosine[2];
    samples.cos_difference = s->cosine[3];
    samples.values = s->values;
    return samples;
}

/* Lobes whose peaks are about as high as the diffuse term; y of channel 0, channel 1 has three times as much. */
static inline long double coefficient(brdffit_distribution distribution, long double parameter, int lobe)
{
    long double peak = parameter * parameter;

    if (distribution == BRDFFIT_TORRANCE_SPARROW) {
        peak = 1.0L;
    } else if (distribution == BRDFFIT_ASHIKHMIN_SHIRLEY) {
        peak = 8.0L / (parameter + 1.0L);
    } else if (by_exponent(distribution)) {
        peak = 2.0L / (parameter + 2.0L);
    }

    return peak * (0.5L + (long double)lobe);
}

static inline void scene_values(struct scene *s, brdffit_distribution distribution, const double *truth, int lobes)
{
    size_t i, k;
    int p;

    for (i = 0; i < s->count; i++) {
        for (k = 0; k < 2; k++) {
            const double *l = s->light + 3 * i;
            long double length = hypotl(hypotl(l[0], l[1]), l[2]);
            long double value = 0.3L * l[2] / length / PI;

            for (p = 0; p < lobes; p++) {
                value += (k ? 3.0L : 1.0L) * coefficient(distribution, truth[p], p) *
                         textbook(distribution, l, s->view + 3 * i, truth[p]);
            }
            s->values[2 * i + k] = (double)value;
        }
    }
}

#endif
