/*
 * Codes and their constant strings. SPDX-License-Identifier: MIT
 */
#include "brdffit.h"

#define PICK(table, i) ((unsigned)(i) < sizeof(table) / sizeof((table)[0]) ? (table)[(unsigned)(i)] : "unknown")

const char *brdffit_version(void)
{
    return BRDFFIT_VERSION_STRING;
}

const char *brdffit_status_string(brdffit_status status)
{
    static const char *const text[BRDFFIT_STATUS_COUNT] = {
        "success",
        "invalid argument",
        "an option is out of its range",
        "not supported by this build",
        "the workspace is too small",
        "invalid sample data",
        "no samples are left to fit",
        "out of memory",
        "the file cannot be opened",
        "the file cannot be read",
        "the file is not in the expected format",
    };
    return PICK(text, status);
}

const char *brdffit_stop_string(brdffit_stop stop)
{
    static const char *const text[BRDFFIT_STOP_COUNT] = {
        "relative_gap", "absolute_gap", "resolution", "rounding", "budget", "memory", "cancelled", "contradiction",
    };
    return PICK(text, stop);
}

const char *brdffit_skip_string(brdffit_skip reason)
{
    static const char *const text[BRDFFIT_SKIP_COUNT] = {"zero_weight", "light_below_horizon", "view_below_horizon",
                                                         "incidence"};
    return PICK(text, reason);
}

const char *brdffit_engine_string(brdffit_engine engine)
{
    static const char *const text[BRDFFIT_ENGINE_COUNT] = {"moment", "socp"};
    return PICK(text, engine);
}

const char *brdffit_norm_string(brdffit_norm norm)
{
    static const char *const text[BRDFFIT_NORM_COUNT] = {"l2", "l1", "linf"};
    return PICK(text, norm);
}
