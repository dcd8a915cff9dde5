/*
 * The loops that a fit spends its time in, in lanes (lanes.h). Included by kernels_base.c, kernels_avx2.c and
 * kernels_avx512.c, which differ only in the instruction set that they are compiled for; KERNELS names the table.
 * SPDX-License-Identifier: MIT
 */
#include "kernels/gains.h"
#include "kernels/smith_loops.h"
#include "kernels/sum_loops.h"

/* What a copy has instances of: see FIXED_MOST. */
#if SIDES_MOST == 1
#define SIDES(one, two, three) {one}
#elif SIDES_MOST == 2
#define SIDES(one, two, three) {one, two}
#else
#define SIDES(one, two, three) {one, two, three}
#endif
#if EACH_MOST == 1
#define EACH(one, two) {one}
#else
#define EACH(one, two) {one, two}
#endif
#if FIXED_MOST == 1
#define FIXED(one, two, three) {one}
#else
#define FIXED(one, two, three) {one, two, three}
#endif

#ifndef BRDFFIT_WITHOUT_MASKING
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
#endif

const struct kernels KERNELS = {
    .contracts = ieee_contracts,
    .exponential_shape = exponential_shape,
    .ggx_shape = ggx_shape,
    .ggx_slopes = ggx_slopes,
#ifndef BRDFFIT_WITHOUT_MASKING
    .smith_shape = {smith_ggx_correlated_shape, smith_ggx_separable_shape, smith_beckmann_correlated_shape,
                    smith_beckmann_separable_shape},
    .smith_slopes = {smith_ggx_correlated_slopes, smith_ggx_separable_slopes, smith_beckmann_correlated_slopes,
                     smith_beckmann_separable_slopes},
#endif
    .weigh = weigh,
    .central = central,
    .functionals = functionals,
    .pair = pair,
    .gains = FIXED(EACH(SIDES(gains_1_1_1, gains_1_1_2, gains_1_1_3), SIDES(gains_1_2_1, gains_1_2_2, gains_1_2_3)),
                   EACH(SIDES(gains_2_1_1, gains_2_1_2, gains_2_1_3), SIDES(gains_2_2_1, gains_2_2_2, NULL)),
                   EACH(SIDES(gains_3_1_1, gains_3_1_2, gains_3_1_3), SIDES(gains_3_2_1, gains_3_2_2, NULL))),
    .gains_list = gains_list,
    .box_maximum = SIDES(box_maximum_1, box_maximum_2, box_maximum_3),
    .curvature = curvature,
    .functional_curvature = functional_curvature,
    .pair_curvature = pair_curvature,
    .dot = dot,
    .magnitude = magnitude,
    .subtract = subtract,
    .scale = scale,
};
