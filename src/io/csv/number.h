/*
 * Decimal numbers, independent of the locale, correctly rounded. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_NUMBER_H
#define BRDFFIT_IO_NUMBER_H

#include <stddef.h>

#include "base/ieee.h"

enum io_number {
    IO_NUMBER_OK = 0,
    IO_NUMBER_EMPTY,
    IO_NUMBER_NAN,           /* the text says NaN; *value is NaN */
    IO_NUMBER_INFINITE,      /* the text says infinity; *value is infinite */
    IO_NUMBER_OVERFLOW,      /* beyond the largest double; *value is infinite */
    IO_NUMBER_HEXADECIMAL,   /* 0x... */
    IO_NUMBER_DECIMAL_COMMA, /* digits, a comma, digits */
    IO_NUMBER_TEXT,          /* anything else */
    IO_NUMBER_NO_MEMORY
};

/*
 * The value of text[0 .. length): [+-] digits [. digits] [e|E|d|D|q|Q [+-] digits], with a digit before or after the
 * point, and nothing else: blanks are the caller's to strip. Numbers too small for a double round to 0 or a
 * subnormal. *value is 0 unless said otherwise above. `c_locale` points to a locale_t with the numeric rules
 * of "C" (const void *, so that this header needs no POSIX).
 */
enum io_number brdffit_io_number(const char *text, size_t length, const void *c_locale, double *value);

/* 1 when the text is such a number, of whatever size. */
int brdffit_io_is_number(const char *text, size_t length);

#endif
