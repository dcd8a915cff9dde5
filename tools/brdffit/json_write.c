/* json_write.c: JSON into a text. SPDX-License-Identifier: MIT */
#include "json_write.h"

#include <string.h>

#include "term.h"

static void quote(struct cli_text *text, const char *string)
{
    brdffit_cli_text_puts(text, "\"");
    while (*string) {
        const size_t length = brdffit_cli_utf8_length(string);
        const unsigned char first = (unsigned char)*string;
        if (length == 0) {
            brdffit_cli_text_puts(text, "\\ufffd");
        } else if (first == '"' || first == '\\') {
            brdffit_cli_text_printf(text, "\\%c", first);
        } else if (first < 0x20 || first == 0x7F) {
            brdffit_cli_text_printf(text, "\\u%04x", (unsigned)first);
        } else {
            brdffit_cli_text_add(text, string, length);
        }
        string += length == 0 ? 1 : length;
    }
    brdffit_cli_text_puts(text, "\"");
}

static void begin(struct cli_json *json, const char *key)
{
    if (json->comma) {
        brdffit_cli_text_puts(json->text, ",");
    }
    json->comma = 1;
    if (key != NULL) {
        quote(json->text, key);
        brdffit_cli_text_puts(json->text, ":");
    }
}

void brdffit_cli_json_open(struct cli_json *json, const char *key, char bracket)
{
    begin(json, key);
    brdffit_cli_text_add(json->text, &bracket, 1);
    json->comma = 0;
}

void brdffit_cli_json_close(struct cli_json *json, char bracket)
{
    brdffit_cli_text_add(json->text, &bracket, 1);
    json->comma = 1;
}

void brdffit_cli_json_string(struct cli_json *json, const char *key, const char *value)
{
    begin(json, key);
    quote(json->text, value);
}

void brdffit_cli_json_number(struct cli_json *json, const char *key, double value)
{
    begin(json, key);
    if (value - value == 0) {
        brdffit_cli_text_printf(json->text, "%.17g", value);
    } else {
        brdffit_cli_text_puts(json->text, "null");
    }
}

void brdffit_cli_json_count(struct cli_json *json, const char *key, size_t value)
{
    begin(json, key);
    brdffit_cli_text_printf(json->text, "%zu", value);
}

void brdffit_cli_json_null(struct cli_json *json, const char *key)
{
    begin(json, key);
    brdffit_cli_text_puts(json->text, "null");
}

void brdffit_cli_json_bool(struct cli_json *json, const char *key, int value)
{
    begin(json, key);
    brdffit_cli_text_puts(json->text, value ? "true" : "false");
}

void brdffit_cli_json_numbers(struct cli_json *json, const char *key, const double *values, size_t count)
{
    brdffit_cli_json_open(json, key, '[');
    for (size_t i = 0; i < count; i++) {
        brdffit_cli_json_number(json, NULL, values[i]);
    }
    brdffit_cli_json_close(json, ']');
}

void brdffit_cli_json_path(struct cli_json *json, const char *path)
{
    int valid = 1;
    for (const char *at = path; *at && valid;) {
        const size_t length = brdffit_cli_utf8_length(at);
        valid = length != 0;
        at += length;
    }
    brdffit_cli_json_string(json, "file", path);
    if (valid) {
        return;
    }
    begin(json, "file_bytes");
    brdffit_cli_text_puts(json->text, "\"");
    for (const char *at = path; *at; at++) {
        brdffit_cli_text_printf(json->text, "%02x", (unsigned)(unsigned char)*at);
    }
    brdffit_cli_text_puts(json->text, "\"");
}
