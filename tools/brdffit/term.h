/* term.h: what the terminal can show: UTF-8, colour, columns.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TERM_H
#define BRDFFIT_CLI_TERM_H

#include <stdio.h>

#include "text.h"

/* Paragraphs are wrapped before this column: sane on 80. */
#define CLI_WIDTH 79

struct cli_style {
    int utf8;
    int colour;
};

/* UTF-8 from the locale (call setlocale(LC_CTYPE, "") first); colour when
 * `out` is a terminal, TERM is not "dumb" and NO_COLOR is unset or empty. */
struct cli_style brdffit_cli_style(FILE *out);

enum cli_glyph { CLI_SIGMA, CLI_SQUARED, CLI_DEGREE, CLI_DASH, CLI_DOTS };

/* The character, or its spelling in ASCII. */
const char *brdffit_cli_glyph(struct cli_style style, enum cli_glyph glyph);

enum cli_ink { CLI_BOLD, CLI_GREEN, CLI_YELLOW, CLI_RED };

/* `string` in a colour, when there is colour. */
void brdffit_cli_ink(struct cli_text *text, struct cli_style style, enum cli_ink ink, const char *string);

/* Columns that `string` takes: code points of UTF-8, bytes otherwise. */
size_t brdffit_cli_width(struct cli_style style, const char *string);

/* Bytes of the character at `at`; 0 when it is none, when it would steer the terminal, or cannot be shown on it. */
size_t brdffit_cli_safe(struct cli_style style, const char *at);

/* A name from outside (a path, a channel): what is not safe becomes '?'. */
void brdffit_cli_name(struct cli_text *text, struct cli_style style, const char *name);

/* `lead` (coloured; NULL for none) and a paragraph, wrapped between an
 * indentation of two columns and CLI_WIDTH. A tab is a blank that does not
 * break: "3\tms". */
void brdffit_cli_paragraph(struct cli_text *text, struct cli_style style, enum cli_ink ink, const char *lead,
                           const char *paragraph);

/* Bytes of the UTF-8 sequence at `at`, 0 if it is none. */
size_t brdffit_cli_utf8_length(const char *at);

#endif
