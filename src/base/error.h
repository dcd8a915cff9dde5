/*
 * Failures as the caller sees them. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_ERROR_H
#define BRDFFIT_ERROR_H

#include "base/ieee.h"
#include "brdffit.h"

/* Fill *error (may be NULL) and return status. */
brdffit_status brdffit_fail(brdffit_error *error, brdffit_status status, const char *message);

/* The same with BRDFFIT_ERR_VALUE and where: BRDFFIT_NONE for what does not apply. */
brdffit_status brdffit_fail_at(brdffit_error *error, const char *message, size_t sample, size_t channel, double value);

#endif
