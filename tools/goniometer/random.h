/* random.h: the same random numbers everywhere from the same seed.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_GONIO_RANDOM_H
#define BRDFFIT_GONIO_RANDOM_H

#include <stddef.h>
#include <stdint.h>

struct gonio_random {
    uint64_t state;
};

/* Stream number `stream` of a seed: what one file draws does not move the
 * numbers of another. */
struct gonio_random brdffit_gonio_random(uint64_t seed, uint64_t stream);

/* Uniform in (0, 1). */
double brdffit_gonio_uniform(struct gonio_random *random);

/* Standard normal, by Box and Muller. */
double brdffit_gonio_normal(struct gonio_random *random);

/* Uniform in 0 .. count - 1. */
size_t brdffit_gonio_below(struct gonio_random *random, size_t count);

#endif
