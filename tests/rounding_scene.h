/*
 * Directions that ask the worst of geometry, random and adversarial, and what they are in 113 bits. Include once in a test.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ROUNDING_SCENE_H
#define BRDFFIT_TESTS_ROUNDING_SCENE_H

#include <math.h>
#include <string.h>

#include "io/csv/angle.h"
#include "rounding_oracle.h"
#include "support.h"

struct scene {
    double light[3], view[3], normal[3];
    int general;
};

static inline double power(struct brdffit_test_random *random, double low, double high)
{
    return pow(10.0, brdffit_test_uniform(random, low, high));
}

static inline void spherical(double theta, double phi, double *out)
{
    out[0] = sin(theta) * cos(phi);
    out[1] = sin(theta) * sin(phi);
    out[2] = cos(theta);
}

static inline void nudge(struct brdffit_test_random *random, double by, double *v)
{
    int j;

    for (j = 0; j < 3; j++) {
        v[j] += by * brdffit_test_uniform(random, -1.0, 1.0);
    }
}

/* Around +z: what the kind asks for. */
static inline void make_upright(struct brdffit_test_random *random, int kind, struct scene *s)
{
    double theta = brdffit_test_uniform(random, 0.0, 1.57), phi = brdffit_test_uniform(random, 0.0, 6.3), graze;

    spherical(theta, phi, s->light);
    spherical(brdffit_test_uniform(random, 0.0, 1.57), brdffit_test_uniform(random, 0.0, 6.3), s->view);
    switch (kind) {
    case 1: /* near the mirror direction */
        s->view[0] = -s->light[0];
        s->view[1] = -s->light[1];
        s->view[2] = s->light[2];
        nudge(random, power(random, -17.0, -1.0), s->view);
        break;
    case 2: /* near the light */
        memcpy(s->view, s->light, sizeof s->view);
        nudge(random, power(random, -17.0, -1.0), s->view);
        break;
    case 3: /* 90 degrees off the mirror direction, in plane or not */
        spherical(1.5707963267948966 - theta, phi + (brdffit_test_below(random, 2) ? 0.0 : power(random, -9.0, 0.0)),
                  s->view);
        nudge(random, power(random, -18.0, -3.0), s->view);
        break;
    case 4: /* the viewer, the light, or both graze; opposite to each other, perhaps */
        graze = power(random, -20.0, -1.0);
        s->view[2] = graze;
        if (brdffit_test_below(random, 2)) {
            s->light[2] = brdffit_test_below(random, 2) ? graze : power(random, -20.0, -1.0);
        }
        if (brdffit_test_below(random, 3) == 0) {
            s->view[0] = -s->light[0];
            s->view[1] = -s->light[1];
            nudge(random, power(random, -17.0, -1.0), s->view);
        }
        break;
    case 5: /* mirror images as a table of angles has them */
        brdffit_io_direction(brdffit_test_uniform(random, 0.0, 89.0), 0.0, s->light);
        s->view[0] = -s->light[0];
        s->view[1] = s->light[1];
        s->view[2] = s->light[2];
        break;
    default: break;
    }
}

/* Turned to a random normal: everything rounds, so that what was exact is no more. */
static inline void turn(struct brdffit_test_random *random, struct scene *s)
{
    double theta = brdffit_test_uniform(random, 0.0, 3.14), phi = brdffit_test_uniform(random, 0.0, 6.3), frame[3][3];
    double *part[2] = {s->light, s->view}, old[3];
    int i, j;

    spherical(theta + 1.5707963267948966, phi, frame[0]);
    spherical(1.5707963267948966, phi + 1.5707963267948966, frame[1]);
    spherical(theta, phi, frame[2]);
    for (i = 0; i < 2; i++) {
        memcpy(old, part[i], sizeof old);
        for (j = 0; j < 3; j++) {
            part[i][j] = old[0] * frame[0][j] + old[1] * frame[1][j] + old[2] * frame[2][j];
        }
    }
    memcpy(s->normal, frame[2], sizeof s->normal);
    s->general = 1;
}

static inline void lengthen(struct brdffit_test_random *random, double *v)
{
    static const double factor[] = {1.0, 1.0, 3.0, 1e-290, 1e290, 1.6e308, 1e-307, 0x1p-1000};
    double by = factor[brdffit_test_below(random, sizeof factor / sizeof factor[0])];
    int j;

    for (j = 0; j < 3; j++) {
        v[j] *= by;
    }
}

static inline void make_scene(struct brdffit_test_random *random, struct scene *s)
{
    make_upright(random, (int)brdffit_test_below(random, 6), s);
    s->normal[0] = s->normal[1] = 0.0;
    s->normal[2] = 1.0;
    s->general = 0;
    if (brdffit_test_below(random, 2)) {
        turn(random, s);
    }
    lengthen(random, s->light);
    lengthen(random, s->view);
    if (s->general) {
        lengthen(random, s->normal);
    }
}

static inline void samples_of(const struct scene *s, brdffit_samples *samples)
{
    brdffit_samples_init(samples);
    samples->count = samples->channels = 1;
    samples->quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples->light = s->light;
    samples->view = s->view;
    samples->normal = s->general ? s->normal : NULL;
}

/* Unit vector of doubles, moved by `by` radians in a random direction. */
static inline void moved(struct brdffit_test_random *random, const double *from, quad by, quad *to)
{
    quad length = 0, along = 0, size = 0, off[3];
    int j;

    for (j = 0; j < 3; j++) {
        to[j] = from[j];
        off[j] = brdffit_test_uniform(random, -1.0, 1.0);
    }
    length = sqrtq(oracle_dot(to, to));
    for (j = 0; j < 3; j++) {
        to[j] /= length;
        along += to[j] * off[j];
    }
    for (j = 0; j < 3; j++) {
        off[j] -= along * to[j];
        size += off[j] * off[j];
    }
    for (j = 0; j < 3; j++) {
        to[j] += by * off[j] / sqrtq(size);
    }
}

static inline struct oracle_angles truth_of(struct brdffit_test_random *random, const struct scene *s, quad by)
{
    quad l[3], v[3], n[3] = {0, 0, 1};

    moved(random, s->light, by, l);
    moved(random, s->view, by, v);
    if (s->general) {
        moved(random, s->normal, by, n);
    }
    return oracle_angles(l, v, n);
}

#endif
