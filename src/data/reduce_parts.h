/*
 * The steps of the reduction, for reduce.c and for sums_reduce.c, whose "samples" are groups.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REDUCE_PARTS_H
#define BRDFFIT_REDUCE_PARTS_H

#include <math.h>

#include "data/reduce.h"

/* Samples that are summed plainly, or triangularised at once, before the next step. */
#define REDUCE_BLOCK 64u

/* Divisor of each channel, from its largest value in channel_scale and its largest magnitude in ii. */
brdffit_status brdffit_reduce_channel_scales(struct reduced *reduced, const brdffit_options *options,
                                             brdffit_error *error);

/* Divide values by one power of two more, so that the largest is about 1: `magnitude` is what it is now. */
void brdffit_reduce_value_scale(struct reduced *reduced, double magnitude);

/* Order by c of each geometry in turn, then by index. */
void brdffit_reduce_sort(struct reduced *reduced);

/* Give half-vector angles within rounding one c, and order again. s_end: end of the search's range (brdffit_reduce_end). */
void brdffit_reduce_snap(struct reduced *reduced, const double *s_end);

/* The largest s of the search, of each geometry. */
void brdffit_reduce_ends(const struct model *model, const brdffit_options *options, double *s_end);

/* After brdffit_reduce_group(): sets stride, c_min and c of each geometry; clears what is summed over them. */
void brdffit_reduce_groups(struct reduced *reduced);

/* Sums over samples of equal c; sets distinct, stride, c_min and every sum. */
void brdffit_reduce_sums(struct reduced *reduced, const brdffit_samples *samples);

/* After the sums: bounds look at every channel, until brdffit_reduce_channels(). */
void brdffit_reduce_every_channel(struct reduced *reduced);

/* Rows of the vector form, from the same groups; and `total` of norms other than l2. */
void brdffit_reduce_rows(struct reduced *reduced, const brdffit_samples *samples, brdffit_norm norm);

/* Where groups begin, and how many have a lobe; `order` is final. */
void brdffit_reduce_group(struct reduced *reduced);

/* Weighted value of used sample j in channel k, in internal units; in this order, subnormal data keep their bits. */
static inline double brdffit_reduce_value(const struct reduced *r, const brdffit_samples *samples, uint32_t j, size_t k)
{
    return samples->values[(size_t)r->sample[j] * samples->channels + k] / r->channel_scale[k] * r->sample_factor[j];
}

#endif
