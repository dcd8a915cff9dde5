/* criteria.h: how a fit is weighed against its number of parameters
 * (docs/compare.md). SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_CRITERIA_H
#define BRDFFIT_CLI_CRITERIA_H

#include <stddef.h>

#include "brdffit.h"

enum cli_criterion { CLI_BIC, CLI_AIC, CLI_AICC };

/* A difference below this is no evidence to speak of: "positive" at most to Kass and Raftery (1995, 3.2), whose "strong"
 * begins here. */
#define CLI_TELLING 6

struct cli_criteria {
    double value[3]; /* by cli_criterion; NaN where there is none */
};

/*
 * Of a model with p parameters (the size of the noise among them) that leaves E^2 on n observations with independent
 * Gaussian noise of one unknown variance, in the units that were minimised, divided by the weights:
 *
 *     -2 ln L = n ln(E^2 / n) + constant;     AIC + 2 p     AICc + 2 p n / (n - p - 1)     BIC + p ln n
 *
 * Source: Burnham and Anderson 2002, 2.2 to 2.4; Schwarz 1978. All NaN unless e2 > 0 and n > p; AICc also unless n > p + 1.
 */
struct cli_criteria brdffit_cli_criteria(double e2, double n, size_t p);

/* What is E^2 to the criteria: no less than this, where the certificate ends and ln would only see rounding. */
double brdffit_cli_e2_floor(const brdffit_result *result, const brdffit_options *options);

/* "BIC", "AIC", "AICc". */
const char *brdffit_cli_criterion_title(enum cli_criterion criterion);

#endif
