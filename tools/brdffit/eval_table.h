/* eval_table.h: a fit beside the measurements, as CSV and as figures.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_EVAL_TABLE_H
#define BRDFFIT_CLI_EVAL_TABLE_H

#include "json_read.h"
#include "output.h"

struct cli_comparison {
    const struct cli_fit *fit;
    const brdffit_table *table;
    const double *fitted; /* samples x channels of the fit, in the file's quantity */
    size_t *measured;     /* per channel of the fit, its column in the table, or BRDFFIT_NONE */
    int complete;         /* every channel of the fit was measured */
};

/* Fill `measured` (K entries of the caller): by name, or by position when
 * the line has no names and the counts agree. */
void brdffit_cli_match_channels(struct cli_comparison *comparison);

/* The table as CSV. 0 when all of it was written. */
int brdffit_cli_eval_rows(const struct cli_comparison *comparison, struct cli_output *output);

struct cli_figures {
    double e2;    /* in the norm of the fit and the units that were minimised */
    double data;  /* the same of the zero model: what the data themselves weigh */
    size_t used;  /* samples that they rest on */
    double *rms;  /* K entries of the caller: radiance, the data's units */
};

/* The objective and RMS over the samples that the fit would use; complete only. */
void brdffit_cli_eval_figures(const struct cli_comparison *comparison, struct cli_figures *figures);

#endif
