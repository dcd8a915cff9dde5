/* json_fit.h: the line that a fit writes with --json, schema "brdffit.fit/1".
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JSON_FIT_H
#define BRDFFIT_CLI_JSON_FIT_H

#include "job.h"
#include "json_write.h"

/* One line, newline included. */
void brdffit_cli_json_fit(cli_text *text, const cli_job *job, const cli_fitter *fitter);

/* What the fit was asked for, and where its proof holds: also of maps. */
void brdffit_cli_json_options(cli_json *json, const brdffit_options *o);

/* Members that fit and info lines share. */
void brdffit_cli_json_error(cli_json *json, const cli_job *job);
void brdffit_cli_json_source(cli_json *json, const cli_job *job, const cli_settings *settings);
void brdffit_cli_json_skipped(cli_json *json, const size_t *skipped, const brdffit_table *table);
void brdffit_cli_json_channels(cli_json *json, const brdffit_table *table);

#endif
