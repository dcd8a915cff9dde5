/* text.h: a growable string. Reports and JSON lines are built whole in one
 * of these, so that what reaches a file is never half a line.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TEXT_H
#define BRDFFIT_CLI_TEXT_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define CLI_PRINTF(string, first) __attribute__((format(printf, string, first)))
#else
#define CLI_PRINTF(string, first)
#endif

/* Zero-initialise. `data` is NULL or ends with a NUL that `size` does not
 * count. Once memory has run out, `failed` stays 1, also when
 * the text is cleared, and nothing is added. */
struct cli_text {
    char *data;
    size_t size;
    size_t capacity;
    int failed;
};

void brdffit_cli_text_add(struct cli_text *text, const char *bytes, size_t size);
void brdffit_cli_text_puts(struct cli_text *text, const char *string);
void brdffit_cli_text_pad(struct cli_text *text, size_t spaces);
void brdffit_cli_text_printf(struct cli_text *text, const char *format, ...) CLI_PRINTF(2, 3);
void brdffit_cli_text_clear(struct cli_text *text);
void brdffit_cli_text_free(struct cli_text *text);

/* FNV-1a of 64 bits. */
uint64_t brdffit_cli_text_hash(const struct cli_text *text);

/* The text as a C string; "" when it is empty. */
const char *brdffit_cli_text_string(const struct cli_text *text);

#endif
