/* term.h: what the terminal can show: UTF-8, colour, columns.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TERM_H
#define BRDFFIT_CLI_TERM_H

#include <stdio.h>

#include "text.h"

/* Paragraphs are wrapped before this column: sane on 80. */
#define CLI_WIDTH 79

typedef struct cli_style {
    int utf8;
    int colour;
} cli_style;

/* UTF-8 from the locale (call setlocale(LC_CTYPE, "") first); colour when
 * `out` is a terminal, TERM is not "dumb" and NO_COLOR is unset or empty. */
cli_style brdffit_cli_style(FILE *out);

typedef enum cli_glyph { CLI_SIGMA, CLI_SQUARED, CLI_DEGREE, CLI_DASH, CLI_DOTS } cli_glyph;

/* The character, or its spelling in ASCII. */
const char *brdffit_cli_glyph(cli_style style, cli_glyph glyph);

typedef enum cli_ink { CLI_BOLD, CLI_GREEN, CLI_YELLOW, CLI_RED } cli_ink;

/* `string` in a colour, when there is colour. */
void brdffit_cli_ink(cli_text *text, cli_style style, cli_ink ink, const char *string);

/* Columns that `string` takes: code points of UTF-8, bytes otherwise. */
size_t brdffit_cli_width(cli_style style, const char *string);

/* A name from outside (a path, a channel): control characters, and bytes
 * that are not UTF-8 or that the terminal cannot show, become '?'. */
void brdffit_cli_name(cli_text *text, cli_style style, const char *name);

/* `lead` (coloured; NULL for none) and a paragraph, wrapped between an
 * indentation of two columns and CLI_WIDTH. A tab is a blank that does not
 * break: "3\tms". */
void brdffit_cli_paragraph(cli_text *text, cli_style style, cli_ink ink, const char *lead,
                           const char *paragraph);

/* Bytes of the UTF-8 sequence at `at`, 0 if it is none. */
size_t brdffit_cli_utf8_length(const char *at);

#endif
