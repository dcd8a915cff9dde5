/* parse.h: what parse.c and parse_check.c share. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_PARSE_H
#define BRDFFIT_CLI_PARSE_H

#include "settings.h"

struct parser {
    unsigned command;
    const char *command_name;
    struct cli_settings *settings;
};

/* The whole of `text` as a count; 0 where it is none. */
int brdffit_cli_whole_number(const char *text, size_t *value);

/* Once the reason is on stderr: where help is. */
enum cli_parse brdffit_cli_parse_failed(const struct parser *p);

/* Options that do not go together, files that do not suit the command, an output that would replace an input. */
enum cli_parse brdffit_cli_parse_check(const struct parser *p);

#endif
