/*
 * A goniometer that is not there: what it measures is a model of the library and noise. SPDX-License-Identifier: MIT
 *
 * Values come from brdffit_eval() and integers, so that they have the same bits on every processor. A real one would fill
 * the same queue from its interrupt.
 */
#ifndef GONIOMETER_H
#define GONIOMETER_H

#include <stdint.h>

#define CHANNELS 3

/* One measurement: unit vectors around the normal +z, and f_r. */
struct measurement {
    double light[3], view[3], value[CHANNELS];
};

/* Measurements on their way from an interrupt to the program: one writer, one reader, no lock. */
#define QUEUE_LENGTH 8u
struct queue {
    struct measurement slot[QUEUE_LENGTH];
    volatile uint32_t written, read;
};

struct goniometer {
    struct queue queue;
    uint32_t position; /* of the scan */
    uint32_t noise;    /* state of its generator */
};

/* Scans of so many positions repeat. */
#define SCAN 84u

void goniometer_start(struct goniometer *g, uint32_t seed);

/* Move on and measure, as an interrupt would; 0 when the queue is full, and nothing is measured. */
int goniometer_measure(struct goniometer *g);

/* The next measurement, or 0. */
int goniometer_take(struct goniometer *g, struct measurement *out);

#endif
