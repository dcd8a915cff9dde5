/*
 * Failures: see error.h. SPDX-License-Identifier: MIT
 */
#include "base/error.h"

brdffit_status brdffit_fail_at(brdffit_error *error, const char *message, size_t sample, size_t channel, double value)
{
    if (error) {
        error->status = BRDFFIT_ERR_VALUE;
        error->message = message;
        error->sample = sample;
        error->channel = channel;
        error->line = BRDFFIT_NONE;
        error->column = BRDFFIT_NONE;
        error->value = value;
    }
    return BRDFFIT_ERR_VALUE;
}

brdffit_status brdffit_fail(brdffit_error *error, brdffit_status status, const char *message)
{
    (void)brdffit_fail_at(error, message, BRDFFIT_NONE, BRDFFIT_NONE, 0.0);
    if (error) {
        error->status = status;
    }
    return status;
}
