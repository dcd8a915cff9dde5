/* tell.h: messages to a person. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TELL_H
#define BRDFFIT_CLI_TELL_H

#include <stdio.h>

#include "text.h"

/* As fprintf(), of the conversions %s %.*s %c and those of numbers: but what a string brings along (a path, a word of
 * the command line, a line of a file) can neither steer the terminal nor begin a line (brdffit_cli_safe() of term.h).
 * Needs no memory. */
void brdffit_cli_tell_to(FILE *out, const char *format, ...) CLI_PRINTF(2, 3);

/* On standard error. */
void brdffit_cli_tell(const char *format, ...) CLI_PRINTF(1, 2);

#endif
