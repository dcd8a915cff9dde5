/* text.c: a growable string. SPDX-License-Identifier: MIT */
#include "text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Make room for `extra` bytes and the final NUL; 0 when there is none. */
static int reserve(struct cli_text *text, size_t extra)
{
    if (text->failed) {
        return 0;
    }
    if (text->capacity - text->size > extra) {
        return 1;
    }
    size_t capacity = text->capacity < 256 ? 256 : text->capacity;
    while (capacity - text->size <= extra) {
        if (capacity > SIZE_MAX / 2) {
            text->failed = 1;
            return 0;
        }
        capacity *= 2;
    }
    char *data = realloc(text->data, capacity);
    if (data == NULL) {
        text->failed = 1;
        return 0;
    }
    text->data = data;
    text->capacity = capacity;
    return 1;
}

void brdffit_cli_text_add(struct cli_text *text, const char *bytes, size_t size)
{
    if (!reserve(text, size)) {
        return;
    }
    memcpy(text->data + text->size, bytes, size);
    text->size += size;
    text->data[text->size] = '\0';
}

void brdffit_cli_text_puts(struct cli_text *text, const char *string)
{
    brdffit_cli_text_add(text, string, strlen(string));
}

void brdffit_cli_text_pad(struct cli_text *text, size_t spaces)
{
    for (; spaces > 0; spaces--) {
        brdffit_cli_text_add(text, " ", 1);
    }
}

void brdffit_cli_text_printf(struct cli_text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    va_list again;
    va_copy(again, arguments);
    const int size = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (size < 0) {
        text->failed = 1;
    } else if (reserve(text, (size_t)size)) {
        (void)vsnprintf(text->data + text->size, (size_t)size + 1, format, again);
        text->size += (size_t)size;
    }
    va_end(again);
}

void brdffit_cli_text_clear(struct cli_text *text)
{
    text->size = 0; /* `failed` stays: what was lost before is lost */
    if (text->data != NULL) {
        text->data[0] = '\0';
    }
}

void brdffit_cli_text_free(struct cli_text *text)
{
    free(text->data);
    memset(text, 0, sizeof *text);
}

uint64_t brdffit_cli_text_hash(const struct cli_text *text)
{
    uint64_t value = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < text->size; i++) {
        value = (value ^ (unsigned char)text->data[i]) * UINT64_C(1099511628211);
    }
    return value;
}

const char *brdffit_cli_text_string(const struct cli_text *text)
{
    return text->data == NULL ? "" : text->data;
}
