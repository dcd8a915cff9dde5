/* lobes.h: which lobes a fit has: their names, from the command line and back
 * into words. What a distribution is called, and by which parameter, only the
 * library knows. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_LOBES_H
#define BRDFFIT_CLI_LOBES_H

#include "brdffit.h"
#include "settings.h"
#include "term.h"

/* The distribution of lobe p. */
brdffit_distribution brdffit_cli_lobe(const brdffit_options *options, int p);

/* Whether the distribution is known by its exponent n, and not by sigma. */
int brdffit_cli_by_exponent(brdffit_distribution distribution);

/* Whether a lobe (every lobe; exponent = 0: not) is known by its exponent. */
int brdffit_cli_any_lobe_by(const brdffit_options *options, int exponent);

/* Whether lobes are of more than one distribution. */
int brdffit_cli_lobes_differ(const brdffit_options *options);

/* The letter of the parameter: "n" or sigma. */
const char *brdffit_cli_parameter(struct cli_style style, brdffit_distribution distribution);

/* "σ", "n", or "σ and n". */
void brdffit_cli_add_parameters(struct cli_text *text, struct cli_style style, const brdffit_options *options);

/* "Beckmann fit with 2 lobes", "fit of one Beckmann and one GGX lobe". */
void brdffit_cli_add_family(struct cli_text *text, const brdffit_options *options);

/* "ggx,ggx,ward": as --lobes takes it. */
void brdffit_cli_add_names(struct cli_text *text, const brdffit_options *options);

/* Lobes of one distribution together, in the order of their first mention:
 * the order of a result. */
void brdffit_cli_group_lobes(brdffit_distribution *list, int count);

/* Names, with commas, into `list`. How many; 0 when there are none or too
 * many; or -1, and *bad is the one that is no distribution. */
int brdffit_cli_read_names(const char *names, brdffit_distribution list[BRDFFIT_MAX_LOBES], char bad[32]);

/* What --lobes and --distribution say together; 0, or the reason on stderr
 * (not when command_name is NULL). */
int brdffit_cli_settle_lobes(struct cli_settings *settings, const char *command_name);

#endif
