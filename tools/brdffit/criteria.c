/* criteria.c: how a fit is weighed against its number of parameters.
 * SPDX-License-Identifier: MIT */
#include "criteria.h"

#include <math.h>

struct cli_criteria brdffit_cli_criteria(double e2, double n, size_t p)
{
    struct cli_criteria out = {{NAN, NAN, NAN}};
    const double parameters = (double)p;
    if (!(e2 > 0) || !(n > parameters)) {
        return out;
    }
    const double deviance = n * log(e2 / n);
    out.value[CLI_BIC] = deviance + parameters * log(n);
    out.value[CLI_AIC] = deviance + 2 * parameters;
    if (n > parameters + 1) {
        out.value[CLI_AICC] = deviance + 2 * parameters * n / (n - parameters - 1);
    }
    return out;
}

/* Of the sum of squares, when --absolute-gap is smaller: the sums of an exact fit leave less. */
#define ROUNDING 1e-20

double brdffit_cli_e2_floor(const brdffit_result *result, const brdffit_options *options)
{
    return fmax(options->absolute_gap, ROUNDING) * result->sum_of_squares;
}

const char *brdffit_cli_criterion_title(enum cli_criterion criterion)
{
    static const char *const titles[] = {"BIC", "AIC", "AICc"};
    return titles[criterion];
}
