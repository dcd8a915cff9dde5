/* json_read.h: fits read back from their JSON lines.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JSON_READ_H
#define BRDFFIT_CLI_JSON_READ_H

#include <cjson/cJSON.h>

#include "settings.h"

/* A fit as its line records it. All pointers belong to the struct. */
struct cli_fit {
    brdffit_model model; /* sigma and distributions point to those below, x and y into `numbers` */
    double sigma[BRDFFIT_MAX_LOBES], anisotropy[BRDFFIT_MAX_LOBES], tangent_angle[BRDFFIT_MAX_LOBES];
    brdffit_distribution distributions[BRDFFIT_MAX_LOBES];
    const double *channel_scale;
    const double *rms;
    brdffit_norm norm;
    double e2;          /* what was minimised, in that norm */
    double max_incidence;
    char **names;       /* K names of channels, or NULL when the line has none */
    int quantity;       /* CLI_UNSET, or what --values says of it */
    char *channels, *columns, *missing, *directions; /* "reading": as given to the fit, or NULL */
    double saturated;   /* likewise, or 0 */
    int weighting;      /* CLI_UNSET, or a brdffit_weighting */
    int merl_bins;
    int merl_sampling;
    brdffit_samples merl_directions; /* for BRDFFIT_IO_MERL_DIRECTIONS */
    size_t line;        /* which fit of its file, from 1 */
    double *numbers;    /* storage */
    double *vectors;    /* storage of directions */
};

/* Find the fit of `file` in the JSON of `path` ("-": standard input): number
 * `select` if that is not 0; else the one whose "file" is `file`, or has its
 * last component when only one does; else the only one. Returns 0, or an
 * exit code when the reason is on stderr. */
int brdffit_cli_fit_read(struct cli_fit *fit, const char *path, const char *file, size_t select);

/* The same in a text that was read from `path`. */
int brdffit_cli_fit_find(struct cli_fit *fit, const struct cli_text *text, const char *path, const char *file,
                         size_t select);

/* Read fit number fit->line from its JSON object; the same answers. */
int brdffit_cli_fit_parse(struct cli_fit *fit, const cJSON *object, const char *path);

void brdffit_cli_fit_free(struct cli_fit *fit);

#endif
