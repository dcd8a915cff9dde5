/* json_fit.h: the line that a fit writes with --json, schema "brdffit.fit/1".
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JSON_FIT_H
#define BRDFFIT_CLI_JSON_FIT_H

#include "job.h"
#include "json_write.h"

/* One line, newline included. */
void brdffit_cli_json_fit(struct cli_text *text, const struct cli_job *job, const struct cli_fitter *fitter);

/* Its members, without what --shard adds. */
void brdffit_cli_json_fit_members(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter);

/* What its lobes are: "distribution", null when they are of several, and
 * "distributions" of each: also of maps. */
void brdffit_cli_json_lobes(struct cli_json *json, const brdffit_options *o);

/* What the fit was asked for, and where its proof holds: also of maps. */
void brdffit_cli_json_options(struct cli_json *json, const brdffit_options *o);

/* Members that fit and info lines share. */
void brdffit_cli_json_error(struct cli_json *json, const struct cli_job *job);
void brdffit_cli_json_source(struct cli_json *json, const struct cli_job *job, const struct cli_settings *settings);
void brdffit_cli_json_skipped(struct cli_json *json, const size_t *skipped, const brdffit_table *table);
void brdffit_cli_json_channels(struct cli_json *json, const brdffit_table *table);

#endif
