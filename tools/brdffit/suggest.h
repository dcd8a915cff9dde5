/* suggest.h: the near match for a misspelt word. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_SUGGEST_H
#define BRDFFIT_CLI_SUGGEST_H

#include <stddef.h>

struct cli_suggestion {
    const char *word; /* best so far, or NULL */
    size_t distance;
};

/* Offer `candidate` for `given`; start from a zeroed suggestion. A candidate
 * is near when it begins with `given`, or when few edits (insert, delete,
 * replace, swap of neighbours) lead from one to the other. */
void brdffit_cli_suggest(struct cli_suggestion *best, const char *given, const char *candidate);

#endif
