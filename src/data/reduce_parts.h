/*
 * The steps of the reduction, for reduce.c and for sums_reduce.c, whose "samples" are groups.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REDUCE_PARTS_H
#define BRDFFIT_REDUCE_PARTS_H

#include "data/reduce.h"

/* Samples that are summed plainly, or triangularised at once, before the next step. */
#define REDUCE_BLOCK 64u

/* Divisor of each channel, from its largest value in channel_scale and its largest magnitude in ii. */
brdffit_status brdffit_reduce_channel_scales(struct reduced *reduced, const brdffit_options *options,
                                             brdffit_error *error);

/* Order by c, then by index. */
void brdffit_reduce_sort(struct reduced *reduced);

/* Give half-vector angles within rounding one c. s_end: end of the search's range (brdffit_reduce_end). */
void brdffit_reduce_snap(struct reduced *reduced, double s_end);
double brdffit_reduce_end(const brdffit_options *options);

/* Sets distinct, stride, c_min and c; clears what is summed over them. */
void brdffit_reduce_groups(struct reduced *reduced);

/* Sums over samples of equal c; sets distinct, stride, c_min and every sum. */
void brdffit_reduce_sums(struct reduced *reduced, const brdffit_samples *samples);

/* After the sums: bounds look at every channel, until brdffit_reduce_channels(). */
void brdffit_reduce_every_channel(struct reduced *reduced);

/* Rows of the vector form, from the same groups; and `total` of norms other than l2. */
void brdffit_reduce_rows(struct reduced *reduced, const brdffit_samples *samples, brdffit_norm norm);

/* Weighted value of used sample j in channel k, in internal units. */
double brdffit_reduce_value(const struct reduced *reduced, const brdffit_samples *samples, uint32_t j, size_t k);

/* One past the last place in `order` whose c equals that of place `begin`. */
size_t brdffit_reduce_group_end(const struct reduced *reduced, size_t begin);

#endif
