/* term.c: what the terminal can show. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "term.h"

#include <langinfo.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

static int names_utf8(const char *codeset)
{
    return strcasecmp(codeset, "UTF-8") == 0 || strcasecmp(codeset, "utf8") == 0;
}

/* A locale that is named but not installed leaves the C locale in force;
 * what the terminal shows still follows the name. */
static int locale_is_utf8(void)
{
    if (names_utf8(nl_langinfo(CODESET))) {
        return 1;
    }
    static const char *const variables[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    for (size_t i = 0; i < sizeof variables / sizeof *variables; i++) {
        const char *value = getenv(variables[i]);
        if (value == NULL || *value == '\0') {
            continue;
        }
        const char *dot = strchr(value, '.');
        char codeset[16] = "";
        if (dot != NULL) {
            for (size_t k = 0; k + 1 < sizeof codeset && dot[k + 1] && dot[k + 1] != '@'; k++) {
                codeset[k] = dot[k + 1];
            }
        }
        return names_utf8(codeset);
    }
    return 0;
}

struct cli_style brdffit_cli_style(FILE *out)
{
    const char *no_color = getenv("NO_COLOR");
    const char *term = getenv("TERM");
    struct cli_style style;
    style.utf8 = locale_is_utf8();
    style.colour = isatty(fileno(out)) && (no_color == NULL || *no_color == '\0') && term != NULL &&
                   strcmp(term, "dumb") != 0;
    return style;
}

const char *brdffit_cli_glyph(struct cli_style style, enum cli_glyph glyph)
{
    switch (glyph) {
    case CLI_SIGMA: return style.utf8 ? "σ" : "sigma";
    case CLI_SQUARED: return style.utf8 ? "²" : "^2";
    case CLI_DEGREE: return style.utf8 ? "°" : " deg";
    case CLI_DASH: return style.utf8 ? "–" : "-";
    case CLI_DOTS: return style.utf8 ? "…" : "...";
    }
    return "";
}

void brdffit_cli_ink(struct cli_text *text, struct cli_style style, enum cli_ink ink, const char *string)
{
    static const char *const codes[] = {"\033[1m", "\033[32m", "\033[33m", "\033[31m"};
    if (style.colour) {
        brdffit_cli_text_puts(text, codes[ink]);
    }
    brdffit_cli_text_puts(text, string);
    if (style.colour) {
        brdffit_cli_text_puts(text, "\033[0m");
    }
}

/* Well-formed UTF-8 as RFC 3629 has it: no overlong forms, no surrogates. */
size_t brdffit_cli_utf8_length(const char *at)
{
    const unsigned char *u = (const unsigned char *)at;
    if (u[0] < 0x80) {
        return 1;
    }
    unsigned low = 0x80, high = 0xBF;
    size_t length;
    if (u[0] >= 0xC2 && u[0] <= 0xDF) {
        length = 2;
    } else if (u[0] >= 0xE0 && u[0] <= 0xEF) {
        length = 3;
        low = u[0] == 0xE0 ? 0xA0 : 0x80;
        high = u[0] == 0xED ? 0x9F : 0xBF;
    } else if (u[0] >= 0xF0 && u[0] <= 0xF4) {
        length = 4;
        low = u[0] == 0xF0 ? 0x90 : 0x80;
        high = u[0] == 0xF4 ? 0x8F : 0xBF;
    } else {
        return 0;
    }
    if (!(u[1] >= low && u[1] <= high)) {
        return 0;
    }
    for (size_t i = 2; i < length; i++) {
        if ((u[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    return length;
}

size_t brdffit_cli_width(struct cli_style style, const char *string)
{
    if (!style.utf8) {
        return strlen(string);
    }
    size_t width = 0;
    for (; *string; string++) {
        width += ((unsigned char)*string & 0xC0) != 0x80;
    }
    return width;
}

/* Controls of one byte, U+0080 to U+009F, and those that turn the direction of writing (U+202A to U+202E, U+2066 to
 * U+2069). */
static int steers(const unsigned char *at, size_t length)
{
    if (length == 1) {
        return at[0] < 0x20 || at[0] == 0x7F;
    }
    if (length == 2) {
        return at[0] == 0xC2 && at[1] < 0xA0;
    }
    return at[0] == 0xE2 &&
           ((at[1] == 0x80 && at[2] >= 0xAA && at[2] <= 0xAE) || (at[1] == 0x81 && at[2] >= 0xA6 && at[2] <= 0xA9));
}

size_t brdffit_cli_safe(struct cli_style style, const char *at)
{
    const size_t length = brdffit_cli_utf8_length(at);
    return length == 0 || (length > 1 && !style.utf8) || steers((const unsigned char *)at, length) ? 0 : length;
}

void brdffit_cli_name(struct cli_text *text, struct cli_style style, const char *name)
{
    while (*name) {
        const size_t length = brdffit_cli_safe(style, name);
        /* What the terminal cannot show is one '?' a character, what is none one a byte. */
        const size_t character = brdffit_cli_utf8_length(name);
        brdffit_cli_text_add(text, length == 0 ? "?" : name, length == 0 ? 1 : length);
        name += character == 0 ? 1 : character;
    }
}

void brdffit_cli_paragraph(struct cli_text *text, struct cli_style style, enum cli_ink ink, const char *lead,
                           const char *paragraph)
{
    size_t column = 2;
    brdffit_cli_text_pad(text, 2);
    if (lead != NULL) {
        brdffit_cli_ink(text, style, ink, lead);
        column += brdffit_cli_width(style, lead);
    }
    struct cli_text word = {0};
    while (*paragraph) {
        const size_t length = strcspn(paragraph, " ");
        brdffit_cli_text_clear(&word);
        brdffit_cli_text_add(&word, paragraph, length);
        const size_t width = brdffit_cli_width(style, brdffit_cli_text_string(&word));
        if (column > 2 && column + 1 + width > CLI_WIDTH) {
            brdffit_cli_text_puts(text, "\n  ");
            column = 2;
        } else if (column > 2) {
            brdffit_cli_text_puts(text, " ");
            column++;
        }
        for (size_t i = 0; i < length; i++) {
            brdffit_cli_text_add(text, paragraph[i] == '\t' ? " " : paragraph + i, 1);
        }
        column += width;
        paragraph += length + strspn(paragraph + length, " ");
    }
    brdffit_cli_text_puts(text, "\n");
    text->failed |= word.failed;
    brdffit_cli_text_free(&word);
}
