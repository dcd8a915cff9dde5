/*
 * Filling in brdffit_error: see fail.h. SPDX-License-Identifier: MIT
 */
#include "io/fail.h"

brdffit_status brdffit_io_fail_at(brdffit_error *error, brdffit_status status, const char *message,
                                  const struct io_place *place, double value)
{
    if (error) {
        error->status = status;
        error->message = message;
        error->sample = place->sample;
        error->channel = place->channel;
        error->line = place->line;
        error->column = place->column;
        error->value = value;
    }
    return status;
}

brdffit_status brdffit_io_fail_value(brdffit_error *error, brdffit_status status, const char *message, double value)
{
    static const struct io_place nowhere = IO_NOWHERE;

    return brdffit_io_fail_at(error, status, message, &nowhere, value);
}

brdffit_status brdffit_io_fail(brdffit_error *error, brdffit_status status, const char *message)
{
    return brdffit_io_fail_value(error, status, message, 0.0);
}

brdffit_status brdffit_io_no_memory(brdffit_error *error)
{
    return brdffit_io_fail(error, BRDFFIT_ERR_MEMORY, "out of memory");
}
