/* slurp.h: a whole file in memory. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_SLURP_H
#define BRDFFIT_CLI_SLURP_H

#include "text.h"

/* Append the content of `path` ("-": standard input). 0, or CLI_EXIT_FAILURE
 * when the reason is on stderr. */
int brdffit_cli_slurp(struct cli_text *text, const char *path);

#endif
