/*
 * The dictionary in the header of a .npy: see npy_literal.h. SPDX-License-Identifier: MIT
 *
 * A Python literal, of which NumPy writes very little: one dictionary of three keys, strings without escapes, True
 * or False, and a tuple of integers (with an L behind each from Python 2). That much is understood, in any order
 * and with any blanks; everything else is refused at its byte.
 */
#include "io/arrays/npy_literal.h"

#include <stdint.h>
#include <string.h>

#include "io/fail.h"

struct cursor {
    const char *at, *end, *start;
    size_t base;
    brdffit_error *error;
};

static brdffit_status refuse(const struct cursor *c, const char *message)
{
    return brdffit_io_fail_value(c->error, BRDFFIT_ERR_FORMAT, message, (double)(c->base + (size_t)(c->at - c->start)));
}

static int is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void blanks(struct cursor *c)
{
    while (c->at < c->end && is_blank(*c->at)) {
        c->at++;
    }
}

/* Take `mark` if it is next. */
static int take(struct cursor *c, char mark)
{
    blanks(c);
    if (c->at < c->end && *c->at == mark) {
        c->at++;
        return 1;
    }
    return 0;
}

static int take_word(struct cursor *c, const char *word)
{
    size_t length = strlen(word);

    blanks(c);
    if ((size_t)(c->end - c->at) >= length && memcmp(c->at, word, length) == 0) {
        c->at += length;
        return 1;
    }
    return 0;
}

static brdffit_status string(struct cursor *c, const char **text, size_t *length)
{
    char quote;

    blanks(c);
    if (c->at >= c->end || (*c->at != '\'' && *c->at != '"')) {
        return refuse(c, "the NPY header lacks a string (value: at byte)");
    }
    quote = *c->at++;
    *text = c->at;
    while (c->at < c->end && *c->at != quote && *c->at != '\\') {
        c->at++;
    }
    if (c->at >= c->end || *c->at != quote) {
        return refuse(c, "the NPY header has a string without its end (value: at byte)");
    }
    *length = (size_t)(c->at++ - *text);
    return BRDFFIT_OK;
}

static int known_type(char kind, int size)
{
    switch (kind) {
    case 'b': return size == 1;
    case 'i':
    case 'u': return size == 1 || size == 2 || size == 4 || size == 8;
    case 'f': return size == 2 || size == 4 || size == 8;
    default: return 0;
    }
}

/* '<f4': byte order, kind, bytes. */
static brdffit_status description(struct cursor *c, brdffit_array *array)
{
    const char *text;
    size_t length;
    brdffit_status status;

    blanks(c);
    if (c->at < c->end && *c->at == '[') {
        return refuse(c, "the NPY array is of records, not of numbers (value: at byte)");
    }
    status = string(c, &text, &length);
    if (status != BRDFFIT_OK) {
        return status;
    }
    c->at = text; /* errors below are about the string */
    if (length != 3 || !strchr("<>|=", text[0]) || text[2] < '1' || text[2] > '8' ||
        !known_type(text[1], text[2] - '0')) {
        return refuse(c,
                      "the NPY array is of a type that is not bool, (u)int8 to 64 or float16 to 64 (value: at byte)");
    }
    if (text[0] == '=' || (text[0] == '|' && text[2] != '1')) {
        return refuse(c, "the NPY header does not say the byte order (value: at byte)");
    }
    array->kind = text[1];
    array->item_size = text[2] - '0';
    array->big_endian = text[0] == '>' && text[2] != '1';
    c->at = text + length + 1;
    return BRDFFIT_OK;
}

static brdffit_status truth(struct cursor *c, int *value)
{
    *value = take_word(c, "True");
    if (*value || take_word(c, "False")) {
        return BRDFFIT_OK;
    }
    return refuse(c, "fortran_order in the NPY header is neither True nor False (value: at byte)");
}

static brdffit_status dimension(struct cursor *c, size_t *value)
{
    size_t number = 0;

    blanks(c);
    if (c->at >= c->end || *c->at < '0' || *c->at > '9') {
        return refuse(c, "the NPY header has a shape that is not a tuple of whole numbers (value: at byte)");
    }
    for (; c->at < c->end && *c->at >= '0' && *c->at <= '9'; c->at++) {
        size_t digit = (size_t)(*c->at - '0');

        if (number > (SIZE_MAX - digit) / 10) {
            return refuse(c, "the NPY header has a shape beyond all memory (value: at byte)");
        }
        number = 10 * number + digit;
    }
    (void)take(c, 'L');
    *value = number;
    return BRDFFIT_OK;
}

static brdffit_status shape(struct cursor *c, brdffit_array *array)
{
    array->dims = 0;
    if (!take(c, '(')) {
        return refuse(c, "the NPY header has a shape that is not a tuple of whole numbers (value: at byte)");
    }
    while (!take(c, ')')) {
        brdffit_status status;

        if (array->dims == BRDFFIT_IO_MAX_DIMS) {
            return refuse(c, "the NPY array has more than 8 dimensions (value: at byte)");
        }
        status = dimension(c, &array->shape[array->dims]);
        if (status != BRDFFIT_OK) {
            return status;
        }
        array->dims++;
        if (!take(c, ',')) {
            if (array->dims > 1 && take(c, ')')) { /* (3) alone would be a number, not a tuple */
                break;
            }
            return refuse(c, "the NPY header has a shape that is not a tuple of whole numbers (value: at byte)");
        }
    }
    return BRDFFIT_OK;
}

/* One "key: value"; `seen` has a bit a key. */
static brdffit_status entry(struct cursor *c, brdffit_array *array, unsigned *seen)
{
    static const char *const keys[] = {"descr", "fortran_order", "shape"};
    const char *text;
    size_t length;
    unsigned which = 0;
    brdffit_status status = string(c, &text, &length);

    if (status != BRDFFIT_OK) {
        return status;
    }
    while (which < 3 && !(strlen(keys[which]) == length && memcmp(keys[which], text, length) == 0)) {
        which++;
    }
    if (which == 3 || (*seen & 1u << which)) {
        c->at = text;
        return refuse(c, "the NPY header has an unknown key, or one twice (value: at byte)");
    }
    *seen |= 1u << which;
    if (!take(c, ':')) {
        return refuse(c, "the NPY header lacks a colon (value: at byte)");
    }
    switch (which) {
    case 0: return description(c, array);
    case 1: return truth(c, &array->fortran_order);
    default: return shape(c, array);
    }
}

brdffit_status brdffit_io_npy_literal(const char *text, size_t size, size_t base, brdffit_array *array,
                                      brdffit_error *error)
{
    struct cursor c = {text, text + size, text, base, error};
    unsigned seen = 0;

    if (!take(&c, '{')) {
        return refuse(&c, "the NPY header is not a dictionary (value: at byte)");
    }
    while (!take(&c, '}')) {
        brdffit_status status = entry(&c, array, &seen);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (!take(&c, ',')) {
            if (take(&c, '}')) {
                break;
            }
            return refuse(&c, "the NPY header lacks a comma or its closing brace (value: at byte)");
        }
    }
    blanks(&c);
    if (c.at < c.end) {
        return refuse(&c, "the NPY header goes on behind its dictionary (value: at byte)");
    }
    return seen == 7 ? BRDFFIT_OK : refuse(&c, "the NPY header lacks descr, fortran_order or shape (value: at byte)");
}
