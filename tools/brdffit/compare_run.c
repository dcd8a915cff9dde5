/* compare_run.c: the fits of a comparison. A file is read once, but for a MERL
 * table that is fitted from sums, which are those of one distribution and
 * know no further terms.
 * SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>
#include <string.h>

#include "failure.h"
#include "interrupt.h"
#include "lobes.h"
#include "terms.h"

/* Whether another model could have more luck with this file. */
static int is_of_model(brdffit_status status)
{
    return status == BRDFFIT_ERR_UNSUPPORTED || status == BRDFFIT_ERR_OPTION || status == BRDFFIT_ERR_WORKSPACE ||
           status == BRDFFIT_ERR_MEMORY;
}

/* What every model finds the same: how much there is to fit. */
static void take_data(struct cli_comparison *c, const brdffit_result *result)
{
    if (c->samples_used > 0) {
        return;
    }
    c->samples_used = result->samples_used;
    c->channels = brdffit_cli_distinct_channels(result);
    c->observations = brdffit_cli_observations(result);
    memcpy(c->skipped, result->samples_skipped, sizeof c->skipped);
}

static void take_result(struct cli_comparison *c, struct cli_entry *entry, const brdffit_result *result,
                        const brdffit_options *options)
{
    const double floor = brdffit_cli_e2_floor(result, options);
    take_data(c, result);
    entry->certified = result->certified;
    entry->stop = result->stop;
    entry->e2 = result->e2;
    entry->e2_error = result->e2_error;
    entry->lower_bound = result->lower_bound;
    entry->sum_of_squares = result->sum_of_squares;
    entry->rms_total = result->rms_total;
    entry->e2_ranked = fmax(result->e2, floor);
    entry->bound_ranked = fmax(result->lower_bound, floor);
    entry->r2 = result->sum_of_squares > 0 ? 1 - result->e2 / result->sum_of_squares : NAN;
    for (int p = 0; p < result->model->lobes; p++) {
        const int by_exponent = brdffit_cli_by_exponent(result->model->distributions[p]);
        entry->shape[p] = by_exponent ? result->lobe[p]->exponent : result->lobe[p]->sigma;
        entry->warnings[p] = result->lobe[p]->warnings;
    }
    entry->parameters = brdffit_cli_parameters(options, options->lobes, c->channels);
}

/* The form that a file is read for: one that needs samples, when the list has one, so that all are fitted to those. */
static void use_most(const struct cli_comparison *c, const struct cli_model *model, struct cli_fitter *fitter)
{
    for (size_t i = 0; i < c->count; i++) {
        brdffit_cli_use_model(c->entries[i].model, &fitter->options);
        if (brdffit_cli_special(&fitter->options)) {
            return;
        }
    }
    brdffit_cli_use_model(model, &fitter->options);
}

/* Sums are of the model that the file was opened for: of another distribution, it is opened again. */
static void open_for(const struct cli_comparison *c, const struct cli_model *model, struct cli_job *job,
                     struct cli_fitter *fitter, const struct cli_model *before)
{
    brdffit_cli_use_model(model, &fitter->options);
    const int same = before != NULL && before->distributions[0] == fitter->options.distribution &&
                     !brdffit_cli_lobes_differ(&fitter->options);
    if (before != NULL && (job->table->sums == NULL || same)) {
        return;
    }
    const char *const path = job->path;
    brdffit_cli_job_free(job);
    use_most(c, model, fitter);
    brdffit_cli_job_open(job, fitter, path);
    brdffit_cli_use_model(model, &fitter->options);
    if (strcmp(path, "-") == 0 && job->status == BRDFFIT_OK) { /* which is read only once */
        brdffit_cli_job_samples(job);
    }
}

void brdffit_cli_compare_models(struct cli_comparison *c, struct cli_fitter *fitter, struct cli_job *job,
                                const char *path, struct cli_text *json)
{
    const struct cli_model *before = NULL;
    memset(job, 0, sizeof *job);
    job->azimuth = -1;
    job->path = path;
    for (size_t i = 0; i < c->count && !brdffit_cli_interrupted(); i++) {
        struct cli_entry *const entry = &c->entries[i];
        const double start = brdffit_cli_clock();
        open_for(c, entry->model, job, fitter, before);
        if (job->table == NULL) {
            return;
        }
        before = entry->model;
        if (job->status == BRDFFIT_OK || is_of_model(job->status)) {
            brdffit_cli_job_fit(job, fitter);
        }
        const double effective = job->status == BRDFFIT_OK ? brdffit_cli_effective_observations(job, &fitter->options)
                                                           : 0;
        entry->not_begun = 0;
        entry->status = job->status;
        entry->message = job->status == BRDFFIT_OK ? NULL : brdffit_cli_message(&job->error);
        if (job->status != BRDFFIT_OK && !is_of_model(job->status)) {
            return;
        }
        if (job->status == BRDFFIT_OK) {
            take_result(c, entry, job->result, &fitter->options);
            entry->effective = effective;
        } else if (job->status == BRDFFIT_ERR_MEMORY) {
            (void)brdffit_cli_no_memory(); /* which is no word about the model */
        }
        entry->seconds = brdffit_cli_clock() - start;
        if (json != NULL) {
            brdffit_cli_job_check(job, fitter);
            brdffit_cli_compare_json(json, entry, c, job, fitter);
        }
    }
    if (before != NULL && is_of_model(job->status)) { /* said in its entry: the file is fine */
        job->status = BRDFFIT_OK;
    }
    job->not_begun = before == NULL;
    brdffit_cli_rank(c);
}
