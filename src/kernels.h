/*
 * Inner loops, one table per instruction set, all with the same bits (lanes.h). Layer 1.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_KERNELS_H
#define BRDFFIT_KERNELS_H

#include <stddef.h>

#include "brdffit.h"

struct kernels {
    /* phi[j] = exp(-c[j] u) for n (a multiple of LANES) values; u >= 0. */
    void (*exponential_shape)(const double *c, size_t n, double u, double *phi);
};

/* Tables that this build has; the baseline always. */
extern const struct kernels brdffit_kernels_base;
extern const struct kernels brdffit_kernels_avx2;
extern const struct kernels brdffit_kernels_avx512;

/* The table of an instruction set, NULL where the build or the processor lacks it; AUTO: the best there is. */
const struct kernels *brdffit_kernels(brdffit_isa isa);

#endif
