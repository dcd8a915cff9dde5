/* info_stats.h: what is in a table and what a fit would use of it.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_INFO_STATS_H
#define BRDFFIT_CLI_INFO_STATS_H

#include "brdffit.h"
#include "brdffit_io.h"

struct cli_range {
    double low, high; /* low > high: empty */
};

struct cli_channel_stats {
    double low, mean, high; /* of every sample that the reader kept */
    size_t negative;
};

struct cli_stats {
    struct cli_channel_stats *channel; /* owned */
    size_t used;
    size_t skipped[BRDFFIT_SKIP_COUNT];
    struct cli_range incidence; /* degrees, used samples; empty for a,b,c */
    struct cli_range view;
    struct cli_range half;
    size_t distinct;     /* distinct half angles of the used samples */
    double smallest[3];  /* degrees, the smallest of them, as many as there are */
};

/* Half angles closer than this count as one: rounding, not design. Radians. */
#define CLI_SAME_ANGLE 1e-9

/* Fill *stats. On failure *error says why; nothing to release then. */
brdffit_status brdffit_cli_stats(const brdffit_table *table, const brdffit_options *options, struct cli_stats *stats,
                                 brdffit_error *error);
void brdffit_cli_stats_free(struct cli_stats *stats);

/* The roughness below which fewer than three distinct half angles lie inside
 * a lobe (tan alpha <= sigma); NaN when there are fewer than three at all. */
double brdffit_cli_resolved_sigma(const struct cli_stats *stats);

#endif
