/* job.h: one file, from reading to the proven result.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_JOB_H
#define BRDFFIT_CLI_JOB_H

#include "brdffit.h"
#include "brdffit_io.h"
#include "progress.h"
#include "settings.h"
#include "shard.h"

/* Kept from file to file: the workspace is reused and grows as needed. */
struct cli_fitter {
    const struct cli_settings *settings;
    brdffit_options options;
    brdffit_io_options io;
    brdffit_table *directions; /* of --merl-samples FILE; NULL otherwise */
    void *workspace;
    size_t capacity;
    void *verify_workspace; /* of --verify: the result still points into the other one */
    size_t verify_capacity;
    void *interval_workspace; /* of --confidence */
    size_t interval_capacity;
    struct cli_progress *progress; /* or NULL */
    const struct cli_shard *shard; /* of --shard, or NULL */
    double reduced_at;      /* clock when the reduction was done; 0: not yet */
};

struct cli_job {
    const char *path;
    size_t position;      /* of --shard: the file's place on the command line, from 1 */
    brdffit_table *table; /* NULL when reading failed */
    brdffit_weighting weighting; /* of its samples */
    double *weights;             /* the samples' own, where --weight made them */
    brdffit_status status;
    brdffit_error error;
    int system_error;   /* errno when reading failed; 0: unknown */
    int not_begun;      /* interrupted before this file's turn */
    const brdffit_result *result; /* in the fitter's workspace */
    double read_seconds;
    double reduce_seconds;
    double search_seconds;
    int verified; /* verification is filled in: --verify */
    brdffit_verification verification;
    double verify_seconds;
    const brdffit_interval_result *intervals; /* in the fitter's interval_workspace; NULL without --confidence */
    double interval_seconds;
    int one_lobe_fitted;   /* --stats, two lobes: one_lobe_e2 is filled in */
    double one_lobe_e2;    /* of the best fit with one lobe */
    int trial_count; /* --lobes auto: how many are filled in of what follows; 0 without */
    struct cli_lobe_trial {
        double e2, e2_most; /* as found; what it is at most, and no less than the floor of criteria.h */
        double lower_bound; /* no less than that either */
        double effective;   /* observations */
        size_t channels;
        double gain, gain_most; /* from the second on: by how much BIC falls, and can fall whatever the roughness */
    } trials[BRDFFIT_MAX_LOBES]; /* with 1, 2 and 3 lobes */
    double *r2; /* K, owned: brdffit_quality(); NULL: not known, as of sums */
    double quality[3];
    unsigned misfit;
    double azimuth; /* what brdffit_azimuth_share() says; -1: not looked at */
    double *f0_low, *f0_high; /* K x P each, owned: how well the samples tell F0; NULL: not known */
};

/* Load the directions that the settings name. 0, or the exit code of a
 * failure that is already on stderr. */
int brdffit_cli_fitter_init(struct cli_fitter *fitter, const struct cli_settings *settings);
void brdffit_cli_fitter_free(struct cli_fitter *fitter);

/* Read and fit. Release the job before the next one runs. */
void brdffit_cli_job_run(struct cli_job *job, struct cli_fitter *fitter, const char *path);
void brdffit_cli_job_free(struct cli_job *job);

/* The parts of that: read, sums where they will do for the fitter's options; fit what was read; --verify and --stats. */
void brdffit_cli_job_open(struct cli_job *job, struct cli_fitter *fitter, const char *path);
void brdffit_cli_job_fit(struct cli_job *job, struct cli_fitter *fitter);
void brdffit_cli_job_check(struct cli_job *job, struct cli_fitter *fitter);

/* Samples in place of sums. Without a table afterwards: the file is gone. */
void brdffit_cli_job_samples(struct cli_job *job);

/* Read only: table or error. */
void brdffit_cli_job_read(struct cli_job *job, struct cli_fitter *fitter, const char *path);

/* The job fails, in the words of the status. */
void brdffit_cli_job_fail(struct cli_job *job, brdffit_status status);

/* The exit code that this file alone would give. */
int brdffit_cli_job_exit(const struct cli_job *job);

/* Entries that the file offered: used, skipped and dropped together. */
size_t brdffit_cli_entries(const brdffit_table *table);

/* Monotonic seconds. */
double brdffit_cli_clock(void);

#endif
