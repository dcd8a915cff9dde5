/* report.h: a fit as a table that a person can read.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_REPORT_H
#define BRDFFIT_CLI_REPORT_H

#include "job.h"
#include "term.h"

void brdffit_cli_report_fit(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                            const struct cli_fitter *fitter);

/* "name: 84 of 96 samples used" and what was skipped and why; `verb` is what
 * happens to the samples. Shared with info. */
void brdffit_cli_report_title(struct cli_text *text, struct cli_style style, const struct cli_job *job, size_t used,
                              const size_t *skipped, double max_incidence, const char *verb);

/* `string` in a column of `width`, to the right or (negative) to the left. */
void brdffit_cli_cell(struct cli_text *text, struct cli_style style, const char *string, int width);

/* A number in a column, as %.*g. */
void brdffit_cli_number_cell(struct cli_text *text, double value, int digits, int width);

/* Columns that names of channels take, at least 7. */
int brdffit_cli_channel_width(struct cli_style style, const brdffit_table *table);

/* A channel's name, cut or filled to the width. */
void brdffit_cli_channel_cell(struct cli_text *text, struct cli_style style, const brdffit_table *table, size_t channel,
                              int width);

/* Of a file none of whose samples could be fitted: on standard error, why not. */
void brdffit_cli_say_skipped(const struct cli_job *job, const struct cli_fitter *fitter);

#endif
