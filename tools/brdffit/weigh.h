/* weigh.h: what samples count for, as --weight says.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_WEIGH_H
#define BRDFFIT_CLI_WEIGH_H

#include "brdffit_io.h"
#include "settings.h"
#include "term.h"

extern const struct cli_choice brdffit_cli_weight_choices[];

/* What `asked` (CLI_UNSET, or a brdffit_weighting) means for a table as it was read: its own weights if it has any. */
brdffit_weighting brdffit_cli_weighting(const brdffit_table *table, int asked);

/* Give the table's samples the weights that were asked for. *owned holds them (or NULL), for free() after the table.
 * Where samples keep what they have nothing happens. */
brdffit_status brdffit_cli_weigh(brdffit_table *table, int asked, double **owned, brdffit_error *error);

/* 1: the file's directions, which count alike, crowd where it is bright (brdffit_weights_crowded). 0 for tables in half
 * and difference angles, whose grid is what it is, for a, b, c, and for too few samples to tell. *share: Kish's effective
 * sample size of their solid angles, by their number. */
int brdffit_cli_crowded(const brdffit_table *table, double *share);

/* The lines of a report: which weights were used, and whether there should have been some. */
void brdffit_cli_report_weights(struct cli_text *text, struct cli_style style, const brdffit_table *table,
                                brdffit_weighting weighting);

#endif
