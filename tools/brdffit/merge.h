/* merge.h: what the files merge_*.c and cmd_merge.c share.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_MERGE_H
#define BRDFFIT_CLI_MERGE_H

#include "settings.h"

/* merge_fit.c: the lines of `fit --json --shard` in the files of `settings`,
 * as one run would have written them. Returns the exit code of that run, or
 * that of a failure; then the reason is on stderr and nothing was written. */
int brdffit_cli_merge_fits(const struct cli_settings *settings);

/* merge_map.c: the maps of `target` from what the parts left in its work
 * folder. The exit code, as above. */
int brdffit_cli_merge_map(struct cli_settings *settings, const char *target);

struct cli_map;

/* What a manifest of `size` bytes says; 0 when it is damaged. Map and settings go on pointing into it. */
int brdffit_cli_parse_manifest(struct cli_map *map, struct cli_settings *settings, char *manifest, size_t size);

#endif
