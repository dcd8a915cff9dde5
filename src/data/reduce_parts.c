/*
 * What every step of the reduction asks: see reduce_parts.h. SPDX-License-Identifier: MIT
 */
#include "data/reduce_parts.h"

double brdffit_reduce_value(const struct reduced *r, const brdffit_samples *samples, uint32_t j, size_t k)
{
    double value = samples->values[(size_t)r->sample[j] * samples->channels + k];

    return value / r->channel_scale[k] * r->sample_factor[j]; /* in this order, subnormal data keep their bits */
}

size_t brdffit_reduce_group_end(const struct reduced *r, size_t begin)
{
    size_t end = begin + 1;
    int g, same = 1;

    while (end < r->used) {
        for (g = 0; g < r->geometries && same; g++) {
            same = r->table[g].sample_c[r->order[end]] == r->table[g].sample_c[r->order[begin]];
        }
        if (!same) {
            break;
        }
        end++;
    }
    return end;
}
