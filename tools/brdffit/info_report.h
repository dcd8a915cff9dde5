/* info_report.h: the answer of brdffit info, for people and as JSON
 * (schema "brdffit.info/1"). SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_INFO_REPORT_H
#define BRDFFIT_CLI_INFO_REPORT_H

#include "info_stats.h"
#include "job.h"
#include "term.h"

void brdffit_cli_info_report(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                             const struct cli_fitter *fitter, const struct cli_stats *stats);

/* `stats` NULL: the file failed, and the job says why. */
void brdffit_cli_info_json(struct cli_text *text, const struct cli_job *job, const struct cli_fitter *fitter,
                           const struct cli_stats *stats);

#endif
