/*
 * The loops that a fit spends its time in, in lanes (lanes.h). Included by kernels_base.c, kernels_avx2.c and
 * kernels_avx512.c, which differ only in the instruction set that they are compiled for; KERNELS names the table.
 * SPDX-License-Identifier: MIT
 */
#include "kernels/gains.h"
#include "kernels/smith_loops.h"
#include "kernels/sum_loops.h"

/* In the order of enum smith_family. */
#define SMITH(name, family, separable)                                                                                 \
    static void name##_shape(const struct smith_point *at, const double *c, const double *light, const double *view,   \
                             size_t n, double *phi)                                                                    \
    {                                                                                                                  \
        smith_##family##_shape(at, c, light, view, n, separable, phi);                                                 \
    }                                                                                                                  \
    static void name##_slopes(const struct smith_point *at, const double *c, const double *light, const double *view,  \
                              size_t n, double *minus_ell, double *slope)                                              \
    {                                                                                                                  \
        smith_##family##_slopes(at, c, light, view, n, separable, minus_ell, slope);                                   \
    }
SMITH(smith_ggx_correlated, ggx, 0)
SMITH(smith_ggx_separable, ggx, 1)
SMITH(smith_beckmann_correlated, beckmann, 0)
SMITH(smith_beckmann_separable, beckmann, 1)

const struct kernels KERNELS = {
    .exponential_shape = exponential_shape,
    .ggx_shape = ggx_shape,
    .ggx_slopes = ggx_slopes,
    .smith_shape = {smith_ggx_correlated_shape, smith_ggx_separable_shape, smith_beckmann_correlated_shape,
                    smith_beckmann_separable_shape},
    .smith_slopes = {smith_ggx_correlated_slopes, smith_ggx_separable_slopes, smith_beckmann_correlated_slopes,
                     smith_beckmann_separable_slopes},
    .weigh = weigh,
    .central = central,
    .functionals = functionals,
    .pair = pair,
    .gains = {{{gains_1_1_1, gains_1_1_2, gains_1_1_3}, {gains_1_2_1, gains_1_2_2, gains_1_2_3}},
              {{gains_2_1_1, gains_2_1_2, gains_2_1_3}, {gains_2_2_1, gains_2_2_2, NULL}},
              {{gains_3_1_1, gains_3_1_2, gains_3_1_3}, {gains_3_2_1, gains_3_2_2, NULL}}},
    .gains_list = gains_list,
    .box_maximum = {box_maximum_1, box_maximum_2, box_maximum_3},
    .curvature = curvature,
    .functional_curvature = functional_curvature,
    .pair_curvature = pair_curvature,
    .dot = dot,
    .magnitude = magnitude,
    .subtract = subtract,
    .scale = scale,
};
