/* lobes_auto.h: --lobes auto: the fewest lobes that the data support.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_LOBES_AUTO_H
#define BRDFFIT_CLI_LOBES_AUTO_H

#include "job.h"
#include "json_write.h"
#include "term.h"

/*
 * As brdffit_cli_job_run(), with 1, 2, ... lobes until one more does not lower BIC by CLI_TELLING or more (criteria.h). The
 * result, and the fitter's options, are then those of the number that is kept.
 */
void brdffit_cli_job_run_auto(struct cli_job *job, struct cli_fitter *fitter, const char *path);

/* "Lobes: 2 ..."; nothing without --lobes auto. */
void brdffit_cli_report_lobes(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                              const struct cli_fitter *fitter);

/* The member "lobes_auto"; nothing without. */
void brdffit_cli_json_trials(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter);

#endif
