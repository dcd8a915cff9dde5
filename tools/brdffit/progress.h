/* progress.h: one line on a terminal's standard error that says how far it
 * is; silent everywhere else. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_PROGRESS_H
#define BRDFFIT_CLI_PROGRESS_H

#include <stddef.h>

#include "brdffit.h"
#include "term.h"

struct cli_progress {
    int shown;       /* standard error is a terminal and nobody said --quiet */
    int visible;     /* a line is on the screen now */
    struct cli_style style;
    const char *path;
    const char *unit; /* what is counted: "files" */
    size_t count;
    size_t done;
    double started;
    double last;     /* when the line was drawn */
};

void brdffit_cli_progress_start(struct cli_progress *progress, size_t count, int quiet);

/* The turn of file `index`, from 0. */
void brdffit_cli_progress_file(struct cli_progress *progress, size_t index, const char *path);

/* From the search: redrawn a few times a second, and only once the search
 * takes long enough to be worth a line. */
void brdffit_cli_progress_search(struct cli_progress *progress, const brdffit_progress *search);

/* `done` of `count` units, for what is no file. */
void brdffit_cli_progress_amount(struct cli_progress *progress, size_t done);

/* Make way for other output. */
void brdffit_cli_progress_erase(struct cli_progress *progress);

#endif
