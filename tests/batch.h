/*
 * Many texels of one geometry, each with its own truth and noise, and their fits by brdffit_fit_many().
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_BATCH_H
#define BRDFFIT_TESTS_BATCH_H

#include "support.h"

struct brdffit_test_batch {
    size_t count, samples, channels, lobes;
    brdffit_options options;
    struct brdffit_test_data data; /* geometry */
    double *values;                /* texel, sample, channel */
    void *memory;
    const brdffit_plan *plan;
    brdffit_texel_results results;
    double *block;
    unsigned char *status, *stop;
    size_t *where, *boxes;
    brdffit_many_stats stats;
};

/* `count` texels over the geometry of spec; options are the defaults, with these lobes. */
void brdffit_test_batch_new(struct brdffit_test_batch *b, struct brdffit_test_spec spec, size_t count, int lobes,
                            uint64_t seed);
void brdffit_test_batch_free(struct brdffit_test_batch *b);

/* Arrays for all results of b->count texels; brdffit_test_batch_new() does it. */
void brdffit_test_batch_results(struct brdffit_test_batch *b);

/* Make the plan; fails the test when the library does. */
void brdffit_test_batch_plan(struct brdffit_test_batch *b);

/* Fit all texels (making the plan when there is none), or some in another layout; one malloc, of the workspace. */
void brdffit_test_batch_fit(struct brdffit_test_batch *b);
void brdffit_test_batch_fit_texels(struct brdffit_test_batch *b, const brdffit_texels *texels);

/* The samples of one texel, for everybody else. */
brdffit_samples brdffit_test_batch_samples(const struct brdffit_test_batch *b, size_t t);

/*
 * How far two evaluations of one sum of squares may be apart: residuals carry a few u of the data each, and the (a, b,
 * c) here differ from the library's by a few u too (verify_samples.h); 64 u stands for all of that.
 */
double brdffit_test_batch_rounding(double e2, double total);

/* Both certified: neither E^2 may lie below the other's bound, and each is within the gap of the other's bound. */
void brdffit_test_batch_against_fit(const struct brdffit_test_batch *b, size_t t);

#endif
