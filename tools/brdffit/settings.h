/* settings.h: what the command line asked for. One table describes every
 * option of every subcommand; parsing, help and suggestions read it.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_SETTINGS_H
#define BRDFFIT_CLI_SETTINGS_H

#include <stddef.h>

#include "brdffit.h"
#include "brdffit_io.h"
#include "text.h"

/* Subcommands, as bits. */
#define CLI_FIT 1u
#define CLI_EVAL 2u
#define CLI_INFO 4u
#define CLI_MAP 8u
#define CLI_MERGE 16u
#define CLI_COMPARE 32u

/* An option that can be left out and was. */
#define CLI_UNSET (-1)

struct cli_settings {
    const char *lobes_given; /* --lobes: a number or names; NULL: not given */
    int distribution;        /* --distribution: CLI_UNSET, or a brdffit_distribution */
    int lobes;               /* what the two say (lobes.h), in the order of a result */
    brdffit_distribution distributions[BRDFFIT_MAX_LOBES];
    int fresnel, diffuse, masking; /* of the library's enumerations */
    int norm;
    int engine;
    int socp_every_box;
    int physical;
    int anisotropic;      /* --anisotropic */
    double anisotropy;    /* --anisotropy; 0: searched */
    double tangent_angle; /* --tangent-angle */
    const char *verify;   /* as given: socp or socp=MARGIN; NULL: do not */
    double confidence;    /* --confidence, in percent; 0: none */
    double verify_margin; /* what --verify leaves of the bound */
    int normalise;
    double sigma_min;
    double sigma_max;
    double exponent_min;
    double exponent_max;
    double gap;
    double absolute_gap;
    double resolution;
    double max_incidence; /* CLI_UNSET until all options are read */
    size_t box_budget;
    int values; /* CLI_UNSET, a brdffit_quantity, or one of reading.h */
    const char *channels, *missing, *directions; /* as given; NULL: not */
    char *columns;    /* all --column, commas between them; owned */
    double saturated; /* 0: not given */
    int weight; /* CLI_UNSET, or a brdffit_weighting */
    int format;
    int merl_bins;
    const char *merl_samples; /* "table", "84" or a file of directions */
    int json;
    int quiet;
    const char *output; /* NULL: standard output */
    size_t max_bytes;   /* of a file, and of what a gzip stream unpacks to; 0: the library's limits */
    size_t select;      /* line of the fits, from 1; 0: by the file's name */
    const char *shard;  /* as given: I/N; NULL: all */
    size_t shard_index, shard_count; /* I - 1, N */
    /* map */
    const char *geometry, *lights, *views, *normals, *mask; /* files, or NULL */
    int map_format;     /* cli_map_format */
    int srgb;
    int fresh;
    int stats;
    size_t tile;    /* rows; 0: by the size of a row */
    size_t threads; /* 0: as many as there are processors */
    /* models by name */
    const char *model;  /* fit --model: a preset or a form; NULL: not given */
    int model_distribution; /* what it says that --distribution may replace, */
    char model_lobes[80];   /* and --lobes */
    int lobes_auto;     /* fit --lobes auto */
    const char *models; /* compare --models; NULL: the default list */
    int criterion;      /* cli_criterion */
    double threshold;   /* of its differences */
    int count_all;      /* --observations all */
    const char **files; /* in the order given; the array is owned */
    size_t file_count;
};

enum cli_map_format { CLI_MAP_NPY, CLI_MAP_PFM };

enum cli_option_kind {
    CLI_FLAG,
    CLI_CHOICE,
    CLI_DISTRIBUTION,
    CLI_FRESNEL,
    CLI_DIFFUSE,
    CLI_MASKING,
    CLI_NUMBER,
    CLI_COUNT,
    CLI_DEGREES, /* a number, or "off" for 90 */
    CLI_STRING,
    CLI_LIST, /* a string; given again, more of it after a comma */
    CLI_HELP
};

struct cli_choice {
    const char *name; /* NULL ends the list */
    int value;
    int hidden; /* another spelling of the one before */
};

struct cli_option {
    const char *name; /* without the dashes; NULL ends the table */
    char letter;      /* 0: none */
    enum cli_option_kind kind;
    unsigned commands; /* CLI_FIT | ... */
    int hidden;        /* another spelling of the option before */
    size_t offset;     /* of the member of cli_settings */
    double low, high;  /* CLI_NUMBER, CLI_DEGREES, CLI_COUNT */
    int low_open;      /* `low` itself is not allowed */
    const struct cli_choice *choices; /* CLI_DISTRIBUTION to CLI_MASKING: of the library */
    const char *value; /* shown in the help */
    const char *help;  /* lines separated by \n; CLI_DISTRIBUTION: made of the library's names */
};

extern const struct cli_option brdffit_cli_options[];

enum cli_parse { CLI_PARSED, CLI_PARSED_HELP, CLI_PARSE_FAILED, CLI_PARSE_NO_MEMORY };

/* Read argv[1..] of `command`. On failure the reason is on stderr. Release
 * with brdffit_cli_settings_free() whatever the answer. */
enum cli_parse brdffit_cli_parse(unsigned command, const char *command_name, int argc, char **argv,
                                 struct cli_settings *settings);

void brdffit_cli_settings_free(struct cli_settings *settings);

/* The whole of `text` as a finite decimal number, whatever the locale says:
 * the process never leaves the "C" LC_NUMERIC. 0 when it is not one. */
int brdffit_cli_number(const char *text, double *value);

/* What the settings mean to the libraries. Progress callbacks and MERL
 * directions are the caller's to add. */
void brdffit_cli_fit_options(const struct cli_settings *settings, brdffit_options *options);
void brdffit_cli_io_options(const struct cli_settings *settings, brdffit_io_options *options);

/* What is fitted and how closely, an option a line: two runs that agree in
 * this do the same to the same data. */
void brdffit_cli_record_options(struct cli_text *text, const brdffit_options *options);

/* Name of a value in a list of choices. */
const char *brdffit_cli_choice_name(const struct cli_choice *choices, int value);

extern const struct cli_choice brdffit_cli_norm_choices[];
extern const struct cli_choice brdffit_cli_normalise_choices[];
extern const struct cli_choice brdffit_cli_quantity_choices[];
extern const struct cli_choice brdffit_cli_bins_choices[];
extern const struct cli_choice brdffit_cli_format_choices[];

/* Those of the library, under the library's names. Not for threads. */
const struct cli_choice *brdffit_cli_distribution_choices(void);
const struct cli_choice *
brdffit_cli_term_choices(enum cli_option_kind kind); /* CLI_FRESNEL, CLI_DIFFUSE, CLI_MASKING */

/* What an option with a list of values takes; NULL: it has none. */
const struct cli_choice *brdffit_cli_choices_of(const struct cli_option *option);

/* The options of `command`, as its help shows them. */
void brdffit_cli_option_help(struct cli_text *text, unsigned command);

#endif
