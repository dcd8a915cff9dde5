/*
 * Random problems for the campaign, one small function a family. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_DRAW_H
#define BRDFFIT_TESTS_DRAW_H

#include <stdint.h>
#include <stdio.h>

#include "fit_view.h"

enum draw_route {
    DRAW_FIT = 0, /* brdffit_fit_new() */
    DRAW_SUMS,    /* brdffit_fit_sums() */
    DRAW_BINS,    /* the same of bins */
    DRAW_MANY     /* brdffit_fit_many() */
};

struct draw {
    uint64_t state; /* random numbers: splitmix64 */
    brdffit_samples samples;
    struct fit_question question; /* of samples */
    enum draw_route route;
    size_t groups, texels;
    int bits;
    int no_diffuse; /* of the truth */
    int wide; /* of any Fresnel, diffuse and masking; 2: of one fixed column and one a lobe */
    /* What samples points at, writable; values of all texels, samples.values those of the first. */
    double *light, *view, *normal, *cos_light, *cos_view, *tan2_half, *cos_difference, *a, *b, *c, *weights, *values;
    double *block;
};

struct draw_family {
    const char *name;
    void (*draw)(struct draw *d);
};

extern const struct draw_family draw_families[];
extern const int draw_family_count;

void draw_problem(struct draw *d, const struct draw_family *family, uint64_t seed);
void draw_free(struct draw *d);

/* Comment lines with the options, then the samples as a table that brdffit_io_read() takes (form ANGLES: that has
 * no such table, its own columns). Numbers are exact. */
void draw_print(const struct draw *d, size_t texel, FILE *to);

/* What draw_print() wrote; 0 when there is no sample. */
int draw_read(struct draw *d, FILE *from);

const char *draw_route_string(enum draw_route route); /* "fit", "sums", "bins", "many" */

/* ---- For families (draw.c) ------------------------------------------------------------------------------------- */

uint64_t draw_bits(struct draw *d);
double draw_uniform(struct draw *d, double low, double high);
double draw_power(struct draw *d, double low, double high); /* 10 to a uniform number */
size_t draw_below(struct draw *d, size_t n);
int draw_one_in(struct draw *d, size_t n);
double draw_normal(struct draw *d);

/* Room for count samples, channels and texels of a form; a random distribution, lobes and quantity. */
void draw_shape(struct draw *d, size_t count, size_t channels, size_t texels, brdffit_form form);

/* Gaps, normalisation, engine, norm (small problems only), budget. */
void draw_options(struct draw *d);

/* Unit vector from angles in degrees. */
void draw_direction(double theta, double phi, double *out);
/* Light and view of all samples anywhere above the horizon up to these degrees, or angles and coefficients alike. */
void draw_geometry(struct draw *d, double steepest);
void draw_random_weights(struct draw *d, double low, double high); /* powers of ten */

/*
 * Values of every texel and channel from a random model with sigma in [low, high] (1/sqrt(n) for exponents), and noise
 * relative to the largest; the specular peak is 0.01 to 1000 times the largest diffuse radiance.
 */
void draw_truth(struct draw *d, double low, double high, double noise);
/* The same from the distribution of the fit or, now and then, another; noise of a random size, now and then none. */
void draw_values(struct draw *d);

#endif
