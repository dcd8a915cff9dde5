/* compare.h: many forms of model on one file, and which of them its data
 * support (docs/compare.md). SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_COMPARE_H
#define BRDFFIT_CLI_COMPARE_H

#include "criteria.h"
#include "job.h"
#include "models.h"
#include "observations.h"
#include "term.h"

/* What the criterion says of a form, beside the best fit of all. */
enum cli_rank {
    CLI_RANK_BEST,
    CLI_RANK_TIED,      /* less than the threshold behind */
    CLI_RANK_BEHIND,    /* as its fit is, but not proven: its search stopped before */
    CLI_RANK_PROVEN,    /* behind by the threshold or more whatever its parameters are */
    CLI_RANK_UNRANKED   /* fitted, but with as many parameters as observations, or to data without signal */
};

/* One form of model, fitted to one file. */
struct cli_entry {
    const struct cli_model *model;
    brdffit_status status; /* with the next three: why there is no fit */
    const char *message;
    int not_begun;         /* interrupted before its turn */
    int certified;
    brdffit_stop stop;
    double shape[BRDFFIT_MAX_LOBES]; /* sigma, or n where the distribution has one */
    unsigned warnings[BRDFFIT_MAX_LOBES];
    double e2, e2_error, lower_bound, sum_of_squares, rms_total;
    double e2_ranked, bound_ranked; /* e2 and lower_bound, no less than the floor */
    double r2;                      /* 1 - e2 / sum_of_squares; NaN without signal */
    size_t parameters;
    double effective;               /* observations, to go by its residuals */
    struct cli_criteria fit, bound; /* of the two; filled in by brdffit_cli_rank() */
    double seconds;
    enum cli_rank rank;
    double delta;        /* of the criterion, from that of the best */
    double delta_proven; /* the least that any parameters of this form could have */
};

struct cli_comparison {
    enum cli_criterion criterion;
    double threshold;
    size_t count;
    struct cli_entry *entries; /* in the order of the list */
    const struct cli_entry **order; /* those with a criterion, best first; then the others */
    size_t ranked;             /* how many have one */
    size_t tied;               /* with the best, not counting it */
    size_t samples_used, channels, observations;
    int count_all;             /* --observations all */
    double effective;          /* observations of the criteria: of the fit with the least E^2, or all */
    size_t skipped[BRDFFIT_SKIP_COUNT];
};

/* Room for so many models; 0 on success. */
int brdffit_cli_comparison_init(struct cli_comparison *comparison, const struct cli_model *models, size_t count,
                                const struct cli_settings *settings);
void brdffit_cli_comparison_free(struct cli_comparison *comparison);

/* Read the file and fit every model. What is wrong with the file is left in the job; what is wrong with a model alone, in its
 * entry. `json` gets a line a model, or is NULL. The job is released by the caller. */
void brdffit_cli_compare_models(struct cli_comparison *comparison, struct cli_fitter *fitter, struct cli_job *job,
                                const char *path, struct cli_text *json);

/* Once every entry is there: order, rank and differences. */
void brdffit_cli_rank(struct cli_comparison *comparison);

/* The one of fewest parameters, of the best and those tied with it; the better where they are as many. Some are ranked. */
const struct cli_entry *brdffit_cli_simplest(const struct cli_comparison *comparison);

/* The exit code that this file alone would give, when its job is fine. */
int brdffit_cli_comparison_exit(const struct cli_comparison *comparison);

/* Table and words. */
void brdffit_cli_compare_report(struct cli_text *text, struct cli_style style, const struct cli_comparison *comparison,
                                const struct cli_job *job, const brdffit_options *options);

/* What the data say, in words: the end of the report. */
void brdffit_cli_compare_words(struct cli_text *text, struct cli_style style, const struct cli_comparison *comparison);

/* The line of one model, and that of the verdict (or of what is wrong with the file). */
void brdffit_cli_compare_json(struct cli_text *text, const struct cli_entry *entry,
                              const struct cli_comparison *comparison, const struct cli_job *job,
                              const struct cli_fitter *fitter);
void brdffit_cli_verdict_json(struct cli_text *text, const struct cli_comparison *comparison,
                              const struct cli_job *job);

#endif
