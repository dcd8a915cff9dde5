/* criteria.c: how a fit is weighed against its number of parameters.
 * SPDX-License-Identifier: MIT */
#include "criteria.h"

#include <math.h>

struct cli_criteria brdffit_cli_criteria(double e2, size_t n, size_t p)
{
    struct cli_criteria out = {{NAN, NAN, NAN}};
    const double observations = (double)n, parameters = (double)p;
    if (!(e2 > 0) || !(n > p)) {
        return out;
    }
    const double deviance = observations * log(e2 / observations);
    out.value[CLI_BIC] = deviance + parameters * log(observations);
    out.value[CLI_AIC] = deviance + 2 * parameters;
    if (n > p + 1) {
        out.value[CLI_AICC] = deviance + 2 * parameters * observations / (observations - parameters - 1);
    }
    return out;
}

/* Of the sum of squares, when --absolute-gap is smaller: the sums of an exact fit leave less. */
#define ROUNDING 1e-20

double brdffit_cli_e2_floor(const brdffit_result *result, const brdffit_options *options)
{
    return fmax(options->absolute_gap, ROUNDING) * result->sum_of_squares;
}

static int is_zero(const brdffit_result *result, size_t k)
{
    const size_t lobes = (size_t)result->model->lobes;
    int zero = !(result->rms[k] > 0) && !(result->model->x[k] > 0);
    for (size_t p = 0; p < lobes; p++) {
        zero = zero && !(result->model->y[k * lobes + p] > 0);
    }
    return zero;
}

/* To the bit: only the same data give that. */
static int repeats(const brdffit_result *result, size_t k, size_t earlier)
{
    const size_t lobes = (size_t)result->model->lobes;
    int same = result->rms[k] == result->rms[earlier] && result->model->x[k] == result->model->x[earlier] &&
               result->channel_scale[k] == result->channel_scale[earlier];
    for (size_t p = 0; p < lobes; p++) {
        same = same && result->model->y[k * lobes + p] == result->model->y[earlier * lobes + p];
    }
    return same;
}

size_t brdffit_cli_distinct_channels(const brdffit_result *result)
{
    size_t count = 0;
    for (size_t k = 0; k < result->model->channels; k++) {
        int own = !is_zero(result, k);
        for (size_t earlier = 0; earlier < k && own; earlier++) {
            own = !repeats(result, k, earlier);
        }
        count += (size_t)own;
    }
    return count;
}

const char *brdffit_cli_criterion_title(enum cli_criterion criterion)
{
    static const char *const titles[] = {"BIC", "AIC", "AICc"};
    return titles[criterion];
}
