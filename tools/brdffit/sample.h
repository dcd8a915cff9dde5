/* sample.h: single samples of a table: their angles, and whether a fit would
 * use them. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_SAMPLE_H
#define BRDFFIT_CLI_SAMPLE_H

#include "brdffit.h"

struct cli_angles {
    double cos_light; /* n.l; NaN for a,b,c */
    double cos_view;  /* n.v; NaN for a,b,c */
    double tan2_half; /* tan^2 alpha; c for a,b,c */
};

void brdffit_cli_angles(const brdffit_samples *samples, size_t i, struct cli_angles *angles);

/* Sample i alone, as samples of its own that point into `samples`. */
void brdffit_cli_slice(const brdffit_samples *samples, size_t i, brdffit_samples *one);

/* 1 when a fit with these options would use sample i: the core's own answer. */
int brdffit_cli_is_used(const brdffit_samples *samples, const brdffit_options *options, size_t i);

/* 1, or the cosine that turns the value of a sample into radiance. */
double brdffit_cli_to_radiance(const brdffit_samples *samples, size_t i);

double brdffit_cli_weight(const brdffit_samples *samples, size_t i);

#endif
