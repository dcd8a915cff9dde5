/* tell.c: messages to a person. SPDX-License-Identifier: MIT
 *
 * The format is walked conversion by conversion: a number goes through snprintf(), a string through brdffit_cli_safe().
 * All of a message is written at once, as far as a buffer holds it. */
#include "tell.h"

#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include "term.h"

struct teller {
    FILE *out;
    struct cli_style style;
    size_t size;
    char buffer[2048];
};

static void flush(struct teller *t)
{
    (void)fwrite(t->buffer, 1, t->size, t->out);
    t->size = 0;
}

static void put(struct teller *t, const char *bytes, size_t size)
{
    if (size > sizeof t->buffer - t->size) {
        flush(t);
    }
    if (size > sizeof t->buffer) {
        (void)fwrite(bytes, 1, size, t->out);
        return;
    }
    memcpy(t->buffer + t->size, bytes, size);
    t->size += size;
}

static void put_foreign(struct teller *t, const char *string, size_t limit)
{
    for (size_t at = 0; at < limit && string[at] != '\0';) {
        const size_t length = brdffit_cli_safe(t->style, string + at), character = brdffit_cli_utf8_length(string + at);
        const int safe = length > 0 && length <= limit - at;
        put(t, safe ? string + at : "?", safe ? length : 1);
        at += character > 0 ? character : 1;
    }
}

/* What stands between % and the letter: "" "z" ".17" "0*" "016l" ... */
struct conversion {
    char text[24]; /* whole, for snprintf() */
    char letter, size;
    int star; /* an int comes first: of %.*s */
};

static const char *parse(const char *at, struct conversion *c)
{
    const size_t flags = strspn(at + 1, "-+ #0123456789.*lzjt"), whole = flags + 2;
    memset(c, 0, sizeof *c);
    if (whole < sizeof c->text) {
        memcpy(c->text, at, whole);
    }
    c->letter = at[flags + 1];
    c->size = flags > 0 ? at[flags] : 0;
    c->star = memchr(at, '*', whole) != NULL;
    return at + whole;
}

/* The formats are literals of this program, held to their arguments by the compiler where they stand. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#endif
static void put_number(struct teller *t, const struct conversion *c, va_list *arguments)
{
    char number[512] = "";
    if (strchr("eEfgG", c->letter) != NULL) {
        (void)snprintf(number, sizeof number, c->text, va_arg(*arguments, double));
    } else if (c->size == 'z') {
        (void)snprintf(number, sizeof number, c->text, va_arg(*arguments, size_t));
    } else if (c->size == 'l' && strstr(c->text, "ll") != NULL) {
        (void)snprintf(number, sizeof number, c->text, va_arg(*arguments, unsigned long long));
    } else if (c->size == 'l') {
        (void)snprintf(number, sizeof number, c->text, va_arg(*arguments, unsigned long));
    } else {
        (void)snprintf(number, sizeof number, c->text, va_arg(*arguments, int));
    }
    put(t, number, strlen(number));
}
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static void put_argument(struct teller *t, const struct conversion *c, va_list *arguments)
{
    if (c->letter == '%') {
        put(t, "%", 1);
    } else if (c->letter == 's') {
        const int limit = c->star ? va_arg(*arguments, int) : -1;
        const char *const string = va_arg(*arguments, const char *);
        put_foreign(t, string, limit < 0 ? SIZE_MAX : (size_t)limit);
    } else if (c->letter == 'c') {
        const char character[2] = {(char)va_arg(*arguments, int), '\0'};
        put_foreign(t, character, 1);
    } else {
        put_number(t, c, arguments);
    }
}

static void tell(FILE *out, const char *format, va_list *arguments)
{
    struct teller t;
    t.out = out;
    t.style = brdffit_cli_style(out);
    t.size = 0;
    while (*format != '\0') {
        const size_t plain = strcspn(format, "%");
        put(&t, format, plain);
        format += plain;
        if (*format == '%') {
            struct conversion c;
            format = parse(format, &c);
            put_argument(&t, &c, arguments);
        }
    }
    flush(&t);
}

void brdffit_cli_tell_to(FILE *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(out, format, &arguments);
    va_end(arguments);
}

void brdffit_cli_tell(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(stderr, format, &arguments);
    va_end(arguments);
}
