/*
 * Internal units to the caller's. SPDX-License-Identifier: MIT
 */
#include "fit/fit.h"

/* Objective units to the caller's: weights and, without normalisation, one power of two for all channels. */
double brdffit_fit_scale(const struct reduced *data, const brdffit_options *o)
{
    double value = data->value_scale * (o->normalise == BRDFFIT_NORMALISE_NONE ? data->channel_scale[0] : 1.0);

    if (o->norm == BRDFFIT_NORM_LINF) {
        return value; /* weights do not multiply the largest residual */
    }
    return o->norm == BRDFFIT_NORM_L1 ? data->scale_w * value : data->scale_w * value * value;
}
