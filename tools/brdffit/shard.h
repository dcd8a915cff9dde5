/* shard.h: one part of a run that is split over processes. Its lines are
 * those of the whole run, each with a stamp as its last member:
 *
 *     "shard":{"part":2,"of":4,"position":6,"files":9,"run":"...","crc32":"..."}
 *
 * Part I of N has the files I, I + N, I + 2 N ... of the command line, counted
 * from 1 (position). `run` stands for all files, options and the version, so
 * that lines of different runs do not mix; `crc32` for all that is left of it
 * in the line. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_SHARD_H
#define BRDFFIT_CLI_SHARD_H

#include <stdint.h>

#include "settings.h"
#include "text.h"

struct cli_shard {
    size_t part, of; /* from 1 */
    size_t files;    /* of the whole run */
    uint64_t run;
};

/* Leave in settings->files what belongs to this part. `directions` of
 * --merl-samples FILE, or NULL. -1: no memory. */
int brdffit_cli_shard_take(struct cli_shard *shard, struct cli_settings *settings, const brdffit_options *options,
                           const brdffit_samples *directions);

/* Where on the command line file `index` of the part was, from 1. */
size_t brdffit_cli_shard_position(const struct cli_shard *shard, size_t index);

/* Add the stamp to the line that begins at `start`, still without its last brace. */
void brdffit_cli_shard_stamp(struct cli_text *text, size_t start, const struct cli_shard *shard, size_t position);

/* What *why is when the reason is none of the line. */
extern const char brdffit_cli_shard_memory[];

/* Read the stamp of a line (without its end of line). Returns the length of
 * what stands before it, or 0 with the reason in *why. */
size_t brdffit_cli_shard_read(const char *line, struct cli_shard *shard, size_t *position, const char **why);

#endif
