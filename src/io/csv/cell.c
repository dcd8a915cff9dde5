/*
 * Numbers as people and spreadsheets write them: see cell.h. SPDX-License-Identifier: MIT
 *
 * A comma between digits is a decimal comma as long as no number of the file has a point, and where one of them cannot be
 * thousands: 0,5 can only be a half, 1,234 may be either. What may be thousands, and files with both, are refused.
 */
#include "io/csv/cell.h"

#include <string.h>

/* Longest number with a decimal comma. */
#define LONGEST 64

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

static int is_missing(const struct io_field *f)
{
    static const char *const words[] = {"na",    "n/a",       "#n/a",    "#na",    "nan",     "null",    "none",
                                        "nil",   "nd",        "n.d.",    "n.a.",   "missing", "-",       "--",
                                        "---",   ".",         "?",       "*",      "#div/0!", "#value!", "#ref!",
                                        "#num!", "#name?",    "#null!",  "<null>", "(null)",  "-nan",    "+nan",
                                        "#n/d",  "-nan(ind)", "1.#qnan", "1.#ind", "-1.#ind", "nodata",  "..."};
    size_t i, j;

    for (i = 0; i < sizeof words / sizeof *words; i++) {
        for (j = 0; j < f->length && words[i][j] && lower(f->text[j]) == words[i][j]; j++) {
        }
        if (j == f->length && !words[i][j]) {
            return 1;
        }
    }
    return 0;
}

/* Take a sign of the end off: 1 when it was there. */
static int strip(struct io_field *f, const char *sign)
{
    const size_t n = strlen(sign);

    if (f->length <= n || memcmp(f->text + f->length - n, sign, n) != 0) {
        return 0;
    }
    f->length -= n;
    while (f->length > 1 && f->text[f->length - 1] == ' ') {
        f->length--;
    }
    return 1;
}

/* Digits in groups of three, by blanks, commas, points or apostrophes: not told apart from what was meant. */
static int is_grouped(const struct io_field *f)
{
    size_t i, run = 0, groups = 0, full = 0; /* groups of three, but for the first */

    for (i = f->length > 0 && strchr("+-", f->text[0]) ? 1 : 0; i < f->length; i++) {
        const char c = f->text[i];

        if (is_digit(c)) {
            run++;
        } else if (c && strchr(" ,.'_", c) && run > 0 && (groups == 0 || run == 3)) {
            full += groups++ > 0;
            run = 0;
        } else {
            return 0;
        }
    }
    return full + (groups > 0 && run == 3) > 0 && run > 0;
}

/* With a comma: where it stands, and whether it may part thousands. */
static enum io_cell decimal_comma(const struct io_field *f, const void *c_locale, struct io_writing *writing,
                                  double *value)
{
    const char *comma = memchr(f->text, ',', f->length);
    const size_t at = (size_t)(comma - f->text), first = f->text[0] == '-' || f->text[0] == '+';
    const int thousands = at - first >= 1 && at - first <= 3 && f->text[first] != '0' && f->length - at == 4;
    char text[LONGEST];

    if (f->length >= sizeof text) {
        return IO_CELL_WRONG;
    }
    memcpy(text, f->text, f->length);
    text[at] = '.';
    if (brdffit_io_number(text, f->length, c_locale, value) != IO_NUMBER_OK) {
        return is_grouped(f) ? IO_CELL_THOUSANDS : IO_CELL_WRONG;
    }
    if (writing->points > 0) {
        return thousands ? IO_CELL_THOUSANDS : IO_CELL_MIXED;
    }
    writing->commas += !thousands;
    writing->unclear += (size_t)thousands;
    return IO_CELL_NUMBER;
}

enum io_cell brdffit_io_cell(const struct io_field *field, const void *c_locale, struct io_writing *writing,
                             double *value, enum io_number *fault)
{
    struct io_field f = *field;
    enum io_cell cell = IO_CELL_NUMBER;
    int percent;

    *value = 0.0;
    *fault = IO_NUMBER_TEXT;
    if (f.length == 0) {
        return IO_CELL_EMPTY;
    }
    *fault = brdffit_io_number(f.text, f.length, c_locale, value);
    if (*fault == IO_NUMBER_OK) {
        writing->points += memchr(f.text, '.', f.length) != NULL;
        return writing->points > 0 && writing->commas + writing->unclear > 0 ? IO_CELL_MIXED : IO_CELL_NUMBER;
    }
    if (is_missing(&f)) {
        return IO_CELL_MISSING;
    }
    writing->degrees += strip(&f, "\xc2\xb0") || strip(&f, "\xc2\xba") || strip(&f, "\xb0");
    percent = strip(&f, "%");
    writing->percents += (size_t)percent;
    if (memchr(f.text, ',', f.length)) {
        cell = decimal_comma(&f, c_locale, writing, value);
    } else {
        const enum io_number again = f.length < field->length ? brdffit_io_number(f.text, f.length, c_locale, value)
                                                              : *fault;

        writing->points += again == IO_NUMBER_OK && memchr(f.text, '.', f.length);
        cell = again == IO_NUMBER_OK ? IO_CELL_NUMBER : is_grouped(&f) ? IO_CELL_THOUSANDS : IO_CELL_WRONG;
    }
    *value *= percent ? 0.01 : 1.0;
    return cell;
}
