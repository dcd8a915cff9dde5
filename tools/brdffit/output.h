/* output.h: where results go. A file is written whole or not at all: beside
 * its target under a temporary name, synced, then renamed.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_OUTPUT_H
#define BRDFFIT_CLI_OUTPUT_H

#include <stdio.h>

#include "text.h"

struct cli_output {
    FILE *file;
    char *target;    /* resolved path to rename to; NULL: nothing to rename */
    char *temporary; /* NULL once renamed or removed */
    const char *shown; /* the name for messages */
    int written;       /* 1 once there was something to write */
    int may_be_empty;  /* nothing to write is a result, too; else the target then stays as it was */
};

/* `path` NULL or "-": standard output. A target that exists and is no
 * regular file (a pipe, a device) is written directly. 0 on success,
 * otherwise the reason is on stderr. */
int brdffit_cli_output_open(struct cli_output *output, const char *path);

/* A file of this program's own, in its work folder: `path` itself is replaced, also where it is a link. */
int brdffit_cli_output_replace(struct cli_output *output, const char *path);

/* Write and flush. 0 on success; otherwise the reason is on stderr, save for
 * a reader that went away (EPIPE), which is no news to anybody. */
int brdffit_cli_output_write(struct cli_output *output, const struct cli_text *text);

/* The same without flushing, for long tables. */
int brdffit_cli_output_add(struct cli_output *output, const struct cli_text *text);

/* Finish: sync and rename, when there was something to write. 0 on success. */
int brdffit_cli_output_commit(struct cli_output *output);

/* Give up: the target stays as it was. */
void brdffit_cli_output_abandon(struct cli_output *output);

/* A text to standard output, of more than a buffer holds; a failure is said, and left to brdffit_cli_close_stdout(). */
void brdffit_cli_say(const char *text);

/* Flush and close standard output; 0 when all of it arrived. */
int brdffit_cli_close_stdout(void);

#endif
