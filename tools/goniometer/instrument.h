/* instrument.h: what the synthetic instruments record.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_GONIO_INSTRUMENT_H
#define BRDFFIT_GONIO_INSTRUMENT_H

#include <stddef.h>
#include <stdint.h>

#include "file.h"
#include "material.h"

/* Four views, fifteen light elevations, five azimuths. */
#define GONIO_SAMPLES 300

struct gonio_recipe {
    const char *name; /* of the file */
    const struct gonio_material *material;
    double relative_noise; /* standard deviation, as a fraction of the value */
    double absolute_noise; /* standard deviation, 1/sr */
    double outliers;       /* fraction of samples that are grossly wrong */
    uint64_t stream;       /* of random numbers */
};

/* A table of directions and f_r, truth in its comment lines. `wrong`, of
 * GONIO_SAMPLES entries, is set to 1 for outliers. */
void brdffit_gonio_csv(struct gonio_file *file, const struct gonio_recipe *recipe, uint64_t seed, unsigned char *wrong);

/* A table in MERL's layout: noise-free, entries at the lower edges of their
 * bins, some cells masked. */
#define GONIO_HALF_BINS 30
#define GONIO_DIFFERENCE_BINS 15
#define GONIO_AZIMUTH_BINS 30
void brdffit_gonio_merl(struct gonio_file *file, const struct gonio_material *material, uint64_t seed, uint64_t stream);

#endif
