/* info_report.h: the answer of brdffit info, for people and as JSON
 * (schema "brdffit.info/1"). SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_INFO_REPORT_H
#define BRDFFIT_CLI_INFO_REPORT_H

#include "info_stats.h"
#include "job.h"
#include "term.h"

void brdffit_cli_info_report(cli_text *text, cli_style style, const cli_job *job,
                             const cli_fitter *fitter, const cli_stats *stats);

/* `stats` NULL: the file failed, and the job says why. */
void brdffit_cli_info_json(cli_text *text, const cli_job *job, const cli_fitter *fitter,
                           const cli_stats *stats);

#endif
