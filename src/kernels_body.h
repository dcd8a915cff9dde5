/*
 * The loops that a fit spends its time in, in lanes (lanes.h). Included by kernels_base.c, kernels_avx2.c and
 * kernels_avx512.c, which differ only in the instruction set that they are compiled for; KERNELS names the table.
 * Layer 1. SPDX-License-Identifier: MIT
 */
#include "kernels.h"
#include "lanes.h"

static void exponential_shape(const double *c, size_t n, double u, double *phi)
{
    lanes minus_u = lanes_set(-u);
    size_t j;

    for (j = 0; j < n; j += LANES) {
        lanes_store(phi + j, lanes_exp(lanes_load(c + j) * minus_u));
    }
}

const struct kernels KERNELS = {
    exponential_shape,
};
