/* words.h: what a result means, in words. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_WORDS_H
#define BRDFFIT_CLI_WORDS_H

#include "brdffit.h"
#include "brdffit_io.h"
#include "term.h"

/* snake_case name of one BRDFFIT_WARN_* bit. */
const char *brdffit_cli_warning_name(unsigned bit);

/* The range that the bound is proven for, of the lobes known by sigma (exponent = 0) or by n. 1 when that is less than was
 * asked for. */
int brdffit_cli_proven(const brdffit_result *result, const brdffit_options *options, int exponent, double range[2]);

/* "Beckmann fit with 2 lobes and σ in [1e-12, 6]", "fit of one GGX and one Blinn-Phong lobe with σ in [1e-12, 6] and n in
 * [0.1, 1e+07]": those ranges, rounded inwards. */
void brdffit_cli_family(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                        const brdffit_options *options);

/* A sentence on why a range is not the one that was asked for; nothing when they are. */
void brdffit_cli_cut(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                     const brdffit_options *options);

/* "Proven: no Beckmann fit with 2 lobes ..." or "NOT proven: ...". */
void brdffit_cli_certificate(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                             const brdffit_options *options);

/* A paragraph for each warning of each lobe; of an unused lobe only that. */
void brdffit_cli_warnings(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                          const brdffit_options *options);

/* "60 light beyond 60° incidence, 8 view below the horizon"; nothing when
 * nothing was skipped. Returns how many were. */
size_t brdffit_cli_skipped(struct cli_text *text, struct cli_style style, const size_t *skipped,
                           const brdffit_table *table, double max_incidence);

/* "1,234,567". */
void brdffit_cli_grouped(struct cli_text *text, size_t number);

/* "0.31 ms", "2.4 s", for a paragraph. */
void brdffit_cli_duration(struct cli_text *text, double seconds);

/* `value` with `digits` significant digits, rounded so that the text is not
 * above it (up = 0) or not below it (up = 1): what is claimed stays true. */
void brdffit_cli_directed(struct cli_text *text, double value, int digits, int up);

/* What a norm minimises, as a noun: "E²", "sum of absolute residuals", "maximum absolute residual". */
const char *brdffit_cli_objective(struct cli_style style, brdffit_norm norm);

#endif
