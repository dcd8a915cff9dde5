/*
 * Shared by the tests: random numbers, synthetic samples of known truth, and a fit that is judged.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_SUPPORT_H
#define BRDFFIT_TESTS_SUPPORT_H

#include <stddef.h>
#include <stdint.h>

#include "brdffit.h"
#include "verify.h"

/* ---- Random numbers: splitmix64, the same on every platform ------------------------------------------- */

struct brdffit_test_random {
    uint64_t state; /* any seed */
};

uint64_t brdffit_test_bits(struct brdffit_test_random *random);
/* Uniform in [low, high). */
double brdffit_test_uniform(struct brdffit_test_random *random, double low, double high);
/* Logarithm uniform; 0 < low <= high. */
double brdffit_test_log_uniform(struct brdffit_test_random *random, double low, double high);
/* Uniform in 0 ... count - 1. */
size_t brdffit_test_below(struct brdffit_test_random *random, size_t count);
/* Mean 0, variance 1 (sum of 12 uniforms: no libm). */
double brdffit_test_normal(struct brdffit_test_random *random);

/* ---- Synthetic samples -------------------------------------------------------------------------------- */

enum brdffit_test_layout {
    BRDFFIT_TEST_RANDOM = 0, /* directions anywhere above the horizon, incidence up to 80 degrees */
    BRDFFIT_TEST_GRID,       /* a goniometer: 4 views, lights 0 to 60 degrees in plane and across */
    BRDFFIT_TEST_IN_PLANE    /* 4 views, lights 0 to 60 degrees in plane: every c is distinct */
};

struct brdffit_test_spec {
    uint64_t seed;
    size_t count, channels;
    enum brdffit_test_layout layout;
    brdffit_form form;
    brdffit_quantity quantity;
    brdffit_distribution distribution; /* of the truth */
    int lobes;                         /* of the truth */
    double sigma[BRDFFIT_MAX_LOBES];
    double diffuse, specular[BRDFFIT_MAX_LOBES]; /* channel k has (1 + k / 4) / (1 + k / 8) times that */
    double noise;                                /* relative to the largest radiance of the channel */
    int weighted, normals;                       /* 1: random weights, some zero; a random normal a sample */
};

/* 84 samples of a goniometer, 3 channels of radiance, two Beckmann lobes (0.1 and 0.4), no noise. */
struct brdffit_test_spec brdffit_test_spec_default(void);

struct brdffit_test_data {
    brdffit_samples samples;
    double *values;  /* samples.values, writable */
    double *weights; /* samples.weights, writable; NULL without */
    double *block;
};

void brdffit_test_data_new(const struct brdffit_test_spec *spec, struct brdffit_test_data *data);
void brdffit_test_data_free(struct brdffit_test_data *data);

/* Samples of form COEFFICIENTS around the caller's arrays. */
brdffit_samples brdffit_test_coefficients(size_t count, size_t channels, const double *a, const double *b,
                                          const double *c, const double *values);

/* All of a problem as text on stderr, to freeze it as a regression. */
void brdffit_test_print(const brdffit_samples *samples, const brdffit_options *options);

/* ---- Fit ---------------------------------------------------------------------------------------------- */

struct brdffit_test_fit {
    struct brdffit_test_result result;
    void *workspace;
    size_t workspace_size;
};

/* brdffit_fit() and brdffit_fit_sums() with a flat result; untouched on failure. */
brdffit_status brdffit_test_run(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                size_t size, struct brdffit_test_result *result, brdffit_error *error);
brdffit_status brdffit_test_run_sums(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                     size_t size, struct brdffit_test_result *result, brdffit_error *error);

/*
 * Fit in a workspace of exactly the size asked for and have the result judged by brdffit_test_verify(). The cmocka
 * test fails, with the problem printed, when either fails. options may be NULL.
 */
void brdffit_test_fit(const brdffit_samples *samples, const brdffit_options *options, struct brdffit_test_fit *fit);
void brdffit_test_fit_free(struct brdffit_test_fit *fit);

/* Expect failure `status`, an untouched result, and a filled-in error, which is returned. */
brdffit_error brdffit_test_fit_fails(const brdffit_samples *samples, const brdffit_options *options,
                                     brdffit_status status);

#endif
