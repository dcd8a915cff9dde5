/* json_write.h: JSON into a text. Always valid: non-finite numbers become
 * null, bytes that are not UTF-8 become U+FFFD, and nothing follows the
 * locale. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JSON_WRITE_H
#define BRDFFIT_CLI_JSON_WRITE_H

#include <stddef.h>

#include "text.h"

struct cli_json {
    struct cli_text *text;
    int comma; /* a comma is due before the next value or key */
};

/* `key` NULL: an element of an array, or the outermost value. */
void brdffit_cli_json_open(struct cli_json *json, const char *key, char bracket);
void brdffit_cli_json_close(struct cli_json *json, char bracket);
void brdffit_cli_json_string(struct cli_json *json, const char *key, const char *value);
void brdffit_cli_json_number(struct cli_json *json, const char *key, double value);
void brdffit_cli_json_count(struct cli_json *json, const char *key, size_t value);
void brdffit_cli_json_null(struct cli_json *json, const char *key);
void brdffit_cli_json_bool(struct cli_json *json, const char *key, int value);

/* `values` may be NULL when `count` is 0. */
void brdffit_cli_json_numbers(struct cli_json *json, const char *key, const double *values, size_t count);

/* "file", and when the path is not UTF-8 also "file_bytes" in hexadecimal. */
void brdffit_cli_json_path(struct cli_json *json, const char *path);

#endif
