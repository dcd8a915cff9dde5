/*
 * Filling in brdffit_error: see fail.h. SPDX-License-Identifier: MIT
 */
#include "io/fail.h"

#include <string.h>

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

/* Bytes of the character at `at`, 0 when it is not UTF-8 that can be shown. */
static size_t character(const unsigned char *at, size_t left)
{
    const size_t length = at[0] < 0x80   ? 1
                          : at[0] < 0xc2 ? 0
                          : at[0] < 0xe0 ? 2
                          : at[0] < 0xf0 ? 3
                          : at[0] < 0xf5 ? 4
                                         : 0;
    size_t i;

    if (length == 0 || length > left || at[0] < 0x20 || at[0] == 0x7f || (at[0] == 0xc2 && left > 1 && at[1] < 0xa0)) {
        return 0;
    }
    for (i = 1; i < length; i++) {
        if ((at[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    if ((at[0] == 0xe0 && at[1] < 0xa0) || (at[0] == 0xed && at[1] > 0x9f) || (at[0] == 0xf0 && at[1] < 0x90) ||
        (at[0] == 0xf4 && at[1] > 0x8f)) {
        return 0;
    }
    return length;
}

const char *brdffit_io_quote(const char *text, size_t length, char *out, size_t size)
{
    size_t at = 0, used = 0;

    while (at < length) {
        const size_t step = character((const unsigned char *)text + at, length - at), take = step ? step : 1;

        if (used + take + 3 >= size) { /* room for dots */
            memcpy(out + used, "...", 3);
            used += 3;
            break;
        }
        memcpy(out + used, step ? text + at : "?", take);
        used += take;
        at += take;
    }
    out[used] = '\0';
    return out;
}
