/*
 * Decimal numbers: see number.h. SPDX-License-Identifier: MIT
 *
 * The grammar is checked here, so strtod() never gets to see what it would accept and we do not (hexadecimal,
 * nan, inf, leading blanks). Up to 2^53 of significand and 10^22 of scale, both are exact doubles and one
 * multiplication or division rounds correctly (Clinger 1990); this is most of the numbers that people write.
 * The rest goes to strtod() under the "C" locale of this thread.
 */
#define _POSIX_C_SOURCE 200809L
#include "io/csv/number.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "io/bytes/memory.h"

#define MAX_EXACT_SCALE 22
#define MAX_EXACT_DIGITS 19 /* fit an uint64_t */
#define LARGE_EXPONENT 100000000L /* enough to be 0 or infinite; ten times it still fits a 32-bit long */
/* Numbers longer than this are copied to the heap for strtod(). */
#define SHORT_TEXT 128

struct scan {
    uint64_t digits; /* the significand's first MAX_EXACT_DIGITS digits */
    int count;       /* of significant digits, capped just above that */
    long scale;      /* power of ten that `digits` is to be multiplied by */
    int negative;
};

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* D and Q are how Fortran writes double and quadruple precision. */
static int is_exponent(char c)
{
    return c && strchr("eEdDqQ", c);
}

static const char *scan_digits(const char *at, const char *end, int fraction, struct scan *scan)
{
    for (; at < end && is_digit(*at); at++) {
        if (scan->count > 0 || *at != '0') {
            scan->count += scan->count <= MAX_EXACT_DIGITS;
        }
        if (scan->count <= MAX_EXACT_DIGITS) {
            scan->digits = 10 * scan->digits + (uint64_t)(*at - '0');
            scan->scale -= fraction;
        }
    }
    return at;
}

static const char *scan_exponent(const char *at, const char *end, struct scan *scan)
{
    const char *start = at;
    int negative = 0;
    long exponent = 0;

    at++;
    if (at < end && (*at == '+' || *at == '-')) {
        negative = *at++ == '-';
    }
    if (at == end || !is_digit(*at)) {
        return start;
    }
    for (; at < end && is_digit(*at); at++) {
        if (exponent < LARGE_EXPONENT) {
            exponent = 10 * exponent + (*at - '0');
        }
    }
    scan->scale += negative ? -exponent : exponent;
    return at;
}

/* End of the longest number that text starts with; text itself when there is none. */
static const char *scan_number(const char *text, const char *end, struct scan *scan)
{
    const char *at = text, *whole, *point;
    size_t digits;

    memset(scan, 0, sizeof *scan);
    if (at < end && (*at == '+' || *at == '-')) {
        scan->negative = *at++ == '-';
    }
    whole = at;
    at = scan_digits(at, end, 0, scan);
    digits = (size_t)(at - whole);
    if (at < end && *at == '.') {
        point = ++at;
        at = scan_digits(at, end, 1, scan);
        digits += (size_t)(at - point);
    }
    if (digits == 0) {
        return text;
    }
    return at < end && is_exponent(*at) ? scan_exponent(at, end, scan) : at;
}

int brdffit_io_is_number(const char *text, size_t length)
{
    struct scan scan;

    return length > 0 && scan_number(text, text + length, &scan) == text + length;
}

/* Text without sign, any case. */
static int says(const char *at, const char *end, const char *word)
{
    for (; at < end && *word; at++, word++) {
        if ((*at | 0x20) != *word) {
            return 0;
        }
    }
    return at == end && !*word;
}

static enum io_number name_fault(const char *text, const char *end, const char *stop, double *value)
{
    const char *at = text;
    int negative = 0;

    if (at < end && (*at == '+' || *at == '-')) {
        negative = *at++ == '-';
    }
    if (says(at, end, "nan")) {
        *value = (double)NAN;
        return IO_NUMBER_NAN;
    }
    if (says(at, end, "inf") || says(at, end, "infinity")) {
        *value = negative ? -(double)INFINITY : (double)INFINITY;
        return IO_NUMBER_INFINITE;
    }
    if (end - at > 2 && at[0] == '0' && (at[1] | 0x20) == 'x') {
        return IO_NUMBER_HEXADECIMAL;
    }
    if (stop > text && end - stop > 1 && *stop == ',' && is_digit(stop[1])) {
        return IO_NUMBER_DECIMAL_COMMA;
    }
    return IO_NUMBER_TEXT;
}

static int convert_fast(const struct scan *scan, double *value)
{
#if FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1
    static const double power[MAX_EXACT_SCALE + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                      1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                      1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    double exact = (double)scan->digits;

    if (scan->count > MAX_EXACT_DIGITS || scan->digits > (uint64_t)1 << DBL_MANT_DIG || scan->scale > MAX_EXACT_SCALE ||
        scan->scale < -MAX_EXACT_SCALE) {
        return 0;
    }
    exact = scan->scale < 0 ? exact / power[-scan->scale] : exact * power[scan->scale];
    *value = scan->negative ? -exact : exact;
    return 1;
#else
    (void)scan;
    (void)value;
    return 0;
#endif
}

/* strtod() needs a terminated string, and text need not be one. */
static int convert_any(const char *text, size_t length, locale_t c_locale, double *value)
{
    char room[SHORT_TEXT];
    char *copy = length < sizeof room ? room : brdffit_io_alloc(length + 1, 1);
    locale_t before;

    if (!copy) {
        return 0;
    }
    memcpy(copy, text, length);
    copy[length] = '\0';
    copy[strcspn(copy, "dDqQ")] = copy[strcspn(copy, "dDqQ")] ? 'e' : '\0'; /* the grammar allows one */
    before = uselocale(c_locale);
    *value = strtod(copy, NULL);
    (void)uselocale(before);
    if (copy != room) {
        brdffit_io_release(copy);
    }
    return 1;
}

enum io_number brdffit_io_number(const char *text, size_t length, const void *c_locale, double *value)
{
    const char *end = text + length, *stop;
    struct scan scan;

    *value = 0.0;
    if (length == 0) {
        return IO_NUMBER_EMPTY;
    }
    stop = scan_number(text, end, &scan);
    if (stop != end) {
        return name_fault(text, end, stop, value);
    }
    if (convert_fast(&scan, value)) {
        return IO_NUMBER_OK;
    }
    if (!convert_any(text, length, *(const locale_t *)c_locale, value)) {
        return IO_NUMBER_NO_MEMORY;
    }
    return isinf(*value) ? IO_NUMBER_OVERFLOW : IO_NUMBER_OK;
}
