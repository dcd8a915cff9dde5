/* confidence.h: --confidence, an interval for every parameter of a fit. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_CONFIDENCE_H
#define BRDFFIT_CLI_CONFIDENCE_H

#include "job.h"
#include "json_write.h"
#include "term.h"

/* Into job->intervals, or the job's failure. */
void brdffit_cli_confidence_run(struct cli_job *job, struct cli_fitter *fitter);

/* A table; nothing without intervals. */
void brdffit_cli_confidence_report(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                                   const struct cli_fitter *fitter);

/* "intervals": an object; nothing without. */
void brdffit_cli_confidence_json(struct cli_json *json, const struct cli_job *job);

#endif
