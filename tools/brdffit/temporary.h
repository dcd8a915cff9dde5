/* temporary.h: files that are written beside their target and then renamed. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TEMPORARY_H
#define BRDFFIT_CLI_TEMPORARY_H

#include <sys/types.h>

/* A new file beside `target`, open to be written, which no other process has or takes, and no link leads to; *path is its
 * name, to be freed. -1: none, errno says why, and *path is NULL. As long as the descriptor is open no sweep takes the
 * file away, so rename it before closing. */
int brdffit_cli_temporary(const char *target, mode_t mode, char **path);

/* Remove what runs that are dead (killed, or their machine) left beside `target`. */
void brdffit_cli_sweep(const char *target);

#endif
