/* misfit.h: whether a fit's model describes its data, in words.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_MISFIT_H
#define BRDFFIT_CLI_MISFIT_H

#include "job.h"
#include "term.h"

/* snake_case name of one BRDFFIT_MISFIT_* bit. */
const char *brdffit_cli_misfit_name(unsigned bit);

/* Paragraphs on how far the fit is to be trusted: a model that does not describe the data, as many parameters as samples,
 * more light than came. */
void brdffit_cli_misfit_warnings(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                                 const brdffit_options *options);

/* The first two on standard error, where no report is written. */
void brdffit_cli_say_misfit(const struct cli_job *job);

#endif
