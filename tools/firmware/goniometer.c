/*
 * See goniometer.h. SPDX-License-Identifier: MIT
 */
#include "goniometer.h"

#include "brdffit.h"

/* Measurements are to be the same everywhere. The library sees to itself; this file is compiled like anybody's. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif

/* Two lobes over a diffuse ground. */
static const double sigma[2] = {0.14, 0.42}, x[CHANNELS] = {0.31, 0.22, 0.08};
static const double y[2 * CHANNELS] = {0.03, 0.05, 0.03, 0.04, 0.03, 0.03};

void goniometer_start(struct goniometer *g, uint32_t seed)
{
    g->queue.written = g->queue.read = 0;
    g->position = 0;
    g->noise = seed;
}

/* A direction from the tangent t of half its angle with the normal, towards the azimuth of half tangent a. */
static void direction(double t, double a, double out[3])
{
    double sine = 2.0 * t / (1.0 + t * t), cosine = (1.0 - t * t) / (1.0 + t * t);

    out[0] = sine * ((1.0 - a * a) / (1.0 + a * a));
    out[1] = sine * (2.0 * a / (1.0 + a * a));
    out[2] = cosine;
}

/* Positions are scattered over the scan (37 and 84 have no common factor), light up to 53 degrees, 7 x 12 of them. */
static void aim(uint32_t position, struct measurement *m)
{
    uint32_t at = position * 37u % SCAN, light = at % 7u, view = at / 7u;

    direction(0.5 * (double)light / 6.0, 0.0, m->light);
    direction(0.06 * (double)view, -8.0 - (double)(view % 5u), m->view); /* about opposite to the light */
}

/* In [-1, 1). */
static double noise(struct goniometer *g)
{
    g->noise = g->noise * 1664525u + 1013904223u;
    return (double)(int32_t)g->noise / 2147483648.0;
}

int goniometer_measure(struct goniometer *g)
{
    struct queue *q = &g->queue;
    struct measurement *m = &q->slot[q->written % QUEUE_LENGTH];
    brdffit_samples at;
    brdffit_model model;
    int k;

    if (q->written - q->read == QUEUE_LENGTH) {
        return 0;
    }
    aim(g->position++, m);
    brdffit_samples_init(&at);
    at.count = 1;
    at.light = m->light;
    at.view = m->view;
    brdffit_model_init(&model);
    model.lobes = 2;
    model.channels = CHANNELS;
    model.sigma = sigma;
    model.x = x;
    model.y = y;
    if (brdffit_eval(&model, &at, m->value, NULL) != BRDFFIT_OK) {
        return 0;
    }
    for (k = 0; k < CHANNELS; k++) {
        m->value[k] *= 1.0 + 0.02 * noise(g);
    }
    q->written++; /* last: the reader may look at any time */
    return 1;
}

int goniometer_take(struct goniometer *g, struct measurement *out)
{
    struct queue *q = &g->queue;

    if (q->written == q->read) {
        return 0;
    }
    *out = q->slot[q->read % QUEUE_LENGTH];
    q->read++;
    return 1;
}
