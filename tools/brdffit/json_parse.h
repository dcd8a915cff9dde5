/* json_parse.h: cJSON, and whether it was memory that it lacked. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JSON_PARSE_H
#define BRDFFIT_CLI_JSON_PARSE_H

#include <cjson/cJSON.h>

/* The value that begins at `text`, of at most `size` bytes; *end is where it ends, or what is wrong stands. NULL: it is
 * none; or, with *no_memory 1, there was no memory for it. */
cJSON *brdffit_cli_json_parse(const char *text, size_t size, const char **end, int *no_memory);

#endif
