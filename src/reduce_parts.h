/*
 * The two halves of the reduction after sorting; only reduce.c calls them. Layer 2.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REDUCE_PARTS_H
#define BRDFFIT_REDUCE_PARTS_H

#include "reduce.h"

/* Samples that are summed plainly, or triangularised at once, before the next step. */
#define REDUCE_BLOCK 64u

/* Sums over samples of equal c; sets distinct, stride, c_min and every sum. */
void brdffit_reduce_sums(struct reduced *reduced, const brdffit_samples *samples);

/* Rows of the vector form, from the same groups; and `total` of norms other than l2. */
void brdffit_reduce_rows(struct reduced *reduced, const brdffit_samples *samples, brdffit_norm norm);

/* Weighted value of used sample j in channel k, in internal units. */
double brdffit_reduce_value(const struct reduced *reduced, const brdffit_samples *samples, uint32_t j, size_t k);

/* One past the last place in `order` whose c equals that of place `begin`. */
size_t brdffit_reduce_group_end(const struct reduced *reduced, size_t begin);

#endif
