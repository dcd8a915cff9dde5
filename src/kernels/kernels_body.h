/*
 * The loops that a fit spends its time in, in lanes (lanes.h). Included by kernels_base.c, kernels_avx2.c and
 * kernels_avx512.c, which differ only in the instruction set that they are compiled for; KERNELS names the table.
 * SPDX-License-Identifier: MIT
 */
#include "kernels/gains.h"
#include "kernels/sum_loops.h"

const struct kernels KERNELS = {
    exponential_shape, ggx_shape, ggx_slopes, weigh, central,   functionals, pair,  gains_two,
    climb_two,         gains_one, climb_one,  dot,   magnitude, subtract,    scale,
};
