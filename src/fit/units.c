/*
 * Internal units to the caller's. SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>

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

/*
 * A level of the caller's in objective units, never less than it stands for: what lies below it is claimed not to exist,
 * or to be all that is near. The quotient underflows where weights of 1e100 scale the objective (0 would be "proven" by
 * every bound), and has no value where the scale itself is beyond the range.
 */
double brdffit_fit_level(double level, double scale)
{
    return isfinite(scale) ? fmax(level / scale, DBL_MIN) : INFINITY;
}
