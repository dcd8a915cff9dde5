/* job.c: one file, from reading to the proven result.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "job.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "confidence.h"
#include "failure.h"
#include "guard.h"
#include "interrupt.h"
#include "tell.h"
#include "terms.h"
#include "weigh.h"

double brdffit_cli_clock(void)
{
    struct timespec now;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0) {
        return 0;
    }
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int on_progress(void *user, const brdffit_progress *progress)
{
    struct cli_fitter *const fitter = user;
    if (progress->phase == BRDFFIT_PHASE_REDUCED) {
        fitter->reduced_at = brdffit_cli_clock();
    } else if (fitter->progress != NULL) {
        brdffit_cli_progress_search(fitter->progress, progress);
    }
    return brdffit_cli_interrupted();
}

/* ---- Directions of --merl-samples FILE --------------------------------- */

static int load_directions(struct cli_fitter *fitter, const char *path)
{
    brdffit_io_options options;
    brdffit_io_options_init(&options);
    options.format = BRDFFIT_IO_FORMAT_CSV;
    options.directions_only = 1;
    brdffit_error error = {0};
    errno = 0;
    const brdffit_status status = brdffit_io_read(path, &options, &fitter->directions, &error);
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(path, &error, NULL, errno);
        brdffit_cli_tell("brdffit: --merl-samples takes table, 84 or a file like those of fit, with "
                         "directions\n");
        return brdffit_cli_status_exit(status);
    }
    const brdffit_samples *const samples = fitter->directions->samples;
    if (samples->form != BRDFFIT_FORM_DIRECTIONS || samples->normal != NULL || samples->count == 0) {
        brdffit_cli_tell("brdffit: %s: --merl-samples needs directions of light and view, without normals\n", path);
        return CLI_EXIT_DATA;
    }
    fitter->io.directions = samples;
    return 0;
}

int brdffit_cli_fitter_init(struct cli_fitter *fitter, const struct cli_settings *settings)
{
    memset(fitter, 0, sizeof *fitter);
    fitter->settings = settings;
    brdffit_cli_fit_options(settings, &fitter->options);
    fitter->options.progress = on_progress;
    fitter->options.progress_user = fitter;
    brdffit_cli_io_options(settings, &fitter->io);
    if (fitter->io.merl_sampling != BRDFFIT_IO_MERL_DIRECTIONS) {
        return 0;
    }
    return load_directions(fitter, settings->merl_samples);
}

void brdffit_cli_fitter_free(struct cli_fitter *fitter)
{
    brdffit_io_free(fitter->directions);
    free(fitter->workspace);
    free(fitter->verify_workspace);
    free(fitter->interval_workspace);
    memset(fitter, 0, sizeof *fitter);
}

/* ---- Files ------------------------------------------------------------- */

void brdffit_cli_job_fail(struct cli_job *job, brdffit_status status)
{
    job->status = status;
    job->error.status = status;
    job->error.message = brdffit_status_string(status);
    job->error.sample = job->error.channel = BRDFFIT_NONE;
    job->error.line = job->error.column = BRDFFIT_NONE;
    job->error.value = 0;
}

/* Of a file that was mapped: what is gone of it was read as zeros. */
static void end_guard(struct cli_job *job)
{
    if (brdffit_cli_guard_end()) {
        brdffit_io_free(job->table);
        job->table = NULL;
        brdffit_cli_job_fail(job, BRDFFIT_ERR_READ);
        job->error.message = "the file became shorter, or failed, while it was read";
        errno = 0;
    }
}

void brdffit_cli_job_samples(struct cli_job *job)
{
    brdffit_cli_guard_begin();
    job->status = brdffit_io_samples(job->table, &job->error);
    end_guard(job);
}

/* `options`: of the fit, when the table will be fitted and nothing else, so that sums will do; or NULL. */
static void read_table(struct cli_job *job, struct cli_fitter *fitter, const char *path, const brdffit_options *options)
{
    memset(job, 0, sizeof *job);
    job->azimuth = -1;
    job->path = path;
    const double start = brdffit_cli_clock();
    errno = 0;
    brdffit_cli_guard_begin();
    job->status = options != NULL ? brdffit_io_read_sums(path, &fitter->io, options, &job->table, &job->error)
                                  : brdffit_io_read(path, &fitter->io, &job->table, &job->error);
    end_guard(job);
    if (job->status != BRDFFIT_OK) {
        job->system_error = errno;
    }
    job->read_seconds = brdffit_cli_clock() - start;
}

void brdffit_cli_job_read(struct cli_job *job, struct cli_fitter *fitter, const char *path)
{
    read_table(job, fitter, path, NULL);
}

/* 1 when the workspace holds `size` bytes. The old content is of no use, so
 * it is released first rather than copied. */
static int grow(void **workspace, size_t *capacity, size_t size)
{
    if (size <= *capacity) {
        return 1;
    }
    free(*workspace);
    *workspace = malloc(size);
    *capacity = *workspace == NULL ? 0 : size;
    return *workspace != NULL;
}

/* Of E^2: where sums know it less well than this, only the samples tell how good the fit is. */
#define SUMS_ACCURACY 1e-8

static void fit(struct cli_job *job, struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    const brdffit_sums *const sums = job->table->sums;
    /* 0 for options or sizes that brdffit_fit() explains better. */
    const size_t size = sums != NULL ? brdffit_sums_workspace_size(sums, &fitter->options)
                                     : brdffit_workspace_size(samples->count, samples->channels, &fitter->options);
    if (!grow(&fitter->workspace, &fitter->capacity, size > 0 ? size : 1)) {
        brdffit_cli_job_fail(job, BRDFFIT_ERR_MEMORY);
        return;
    }
    fitter->reduced_at = 0;
    const double start = brdffit_cli_clock();
    job->status = sums != NULL ? brdffit_fit_sums(sums, &fitter->options, fitter->workspace, fitter->capacity,
                                                  &job->result, &job->error)
                               : brdffit_fit(samples, &fitter->options, fitter->workspace, fitter->capacity,
                                             &job->result, &job->error);
    const double end = brdffit_cli_clock();
    const double reduced = fitter->reduced_at > 0 ? fitter->reduced_at : end;
    job->reduce_seconds = reduced - start;
    job->search_seconds = end - reduced;
}

static int sums_suffice(const struct cli_job *job)
{
    if (job->status != BRDFFIT_OK) { /* a limit of sums, or one that the samples share and explain */
        return job->status == BRDFFIT_ERR_NO_SAMPLES || job->status == BRDFFIT_ERR_MEMORY;
    }
    return job->result->e2_error <= SUMS_ACCURACY * job->result->e2;
}

/* A bound of 0 needs no proof. */
static void verify(struct cli_job *job, struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    brdffit_options options = fitter->options;
    options.engine = BRDFFIT_ENGINE_SOCP;
    const double level = job->result->lower_bound * (1 - fitter->settings->verify_margin);
    if (!(level > 0)) {
        memset(&job->verification, 0, sizeof job->verification);
        job->verification.proven = job->verified = 1;
        return;
    }
    const size_t size = brdffit_workspace_size(samples->count, samples->channels, &options);
    if (!grow(&fitter->verify_workspace, &fitter->verify_capacity, size > 0 ? size : 1)) {
        brdffit_cli_job_fail(job, BRDFFIT_ERR_MEMORY);
        return;
    }
    const brdffit_verification *made;
    const double start = brdffit_cli_clock();
    job->status = brdffit_verify(samples, &options, level, fitter->verify_workspace, fitter->verify_capacity, &made,
                                 &job->error);
    job->verify_seconds = brdffit_cli_clock() - start;
    job->verified = job->status == BRDFFIT_OK;
    if (job->verified) {
        job->verification = *made;
    }
}

/* One lobe for two, so that --stats can say whether the second is of use. The result still points into the fitter's
 * workspace, so this takes that of --verify; a failure here only leaves the statement out. */
static void fit_one_lobe(struct cli_job *job, struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    const brdffit_sums *const sums = job->table->sums;
    brdffit_options options = fitter->options;
    const brdffit_result *result;
    options.lobes = 1;
    options.progress = NULL;
    const size_t size = sums != NULL ? brdffit_sums_workspace_size(sums, &options)
                                     : brdffit_workspace_size(samples->count, samples->channels, &options);
    if (size > 0 && !grow(&fitter->verify_workspace, &fitter->verify_capacity, size)) {
        brdffit_cli_job_fail(job, BRDFFIT_ERR_MEMORY);
    }
    if (size == 0 || job->status != BRDFFIT_OK) {
        return;
    }
    const brdffit_status status = sums != NULL ? brdffit_fit_sums(sums, &options, fitter->verify_workspace,
                                                                  fitter->verify_capacity, &result, NULL)
                                               : brdffit_fit(samples, &options, fitter->verify_workspace,
                                                             fitter->verify_capacity, &result, NULL);
    job->one_lobe_fitted = status == BRDFFIT_OK;
    job->one_lobe_e2 = job->one_lobe_fitted ? result->e2 : 0;
}

/* Where there is an F0, which no physical bound has a part in. Data that do not tell it only leave the statement out. */
static void tell_f0(struct cli_job *job, const struct cli_fitter *fitter)
{
    const brdffit_model *const model = job->result->model;
    const size_t count = model->channels * (size_t)model->lobes;
    free(job->f0_low); /* of an earlier fit of this file */
    job->f0_low = job->f0_high = NULL;
    if (model->fresnel == BRDFFIT_FRESNEL_NONE || fitter->options.physical || fitter->options.norm != BRDFFIT_NORM_L2) {
        return;
    }
    job->f0_low = calloc(count, 2 * sizeof *job->f0_low);
    if (job->f0_low == NULL) {
        brdffit_cli_job_fail(job, BRDFFIT_ERR_MEMORY);
        return;
    }
    job->f0_high = job->f0_low + count;
    if (brdffit_f0_interval(job->table->samples, &fitter->options, model, job->f0_low, job->f0_high, NULL) !=
        BRDFFIT_OK) {
        free(job->f0_low);
        job->f0_low = job->f0_high = NULL;
    }
}

/* R^2 and whether the model describes the data: only where there are samples. A failure leaves the statement out. */
static void judge(struct cli_job *job, const struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    free(job->r2); /* of an earlier fit of this file */
    job->r2 = NULL;
    if (job->table->sums != NULL) {
        return;
    }
    double *const fitted = calloc(samples->count, samples->channels * sizeof *fitted);
    job->r2 = calloc(samples->channels, sizeof *job->r2);
    if (fitted == NULL || job->r2 == NULL || brdffit_eval(job->result->model, samples, fitted, NULL) != BRDFFIT_OK ||
        brdffit_quality(samples, &fitter->options, fitted, job->r2, job->quality, &job->misfit, NULL) != BRDFFIT_OK) {
        free(job->r2);
        job->r2 = NULL;
        job->misfit = 0;
    }
    free(fitted);
}

/* More samples than this are not looked at: it would take longer than the fit. */
#define AZIMUTH_SAMPLES 20000u

/* Whether an isotropic fit misses what the data do with the azimuth of the half vector. */
static void tell_azimuth(struct cli_job *job, const struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    job->azimuth = -1;
    if (samples->form != BRDFFIT_FORM_DIRECTIONS || samples->count > AZIMUTH_SAMPLES ||
        fitter->options.norm != BRDFFIT_NORM_L2 || fitter->options.anisotropic) {
        return;
    }
    if (brdffit_azimuth_share(samples, &fitter->options, job->result->model, job->result->channel_scale, &job->azimuth,
                              NULL) != BRDFFIT_OK) {
        job->azimuth = -1;
    }
}

/* Sums have weight 1 throughout, and know the plain model alone, without physical bounds. */
static int fits_sums(const struct cli_fitter *fitter)
{
    const struct cli_settings *const settings = fitter->settings;
    return settings->verify == NULL && settings->confidence == 0 && !brdffit_cli_special(&fitter->options) &&
           !settings->physical && (settings->weight == CLI_UNSET || settings->weight == BRDFFIT_WEIGHTING_NONE);
}

static void weigh(struct cli_job *job, const struct cli_settings *settings)
{
    job->weighting = brdffit_cli_weighting(job->table, settings->weight);
    job->status = brdffit_cli_weigh(job->table, settings->weight, &job->weights, &job->error);
}

void brdffit_cli_job_open(struct cli_job *job, struct cli_fitter *fitter, const char *path)
{
    read_table(job, fitter, path, fits_sums(fitter) ? &fitter->options : NULL);
    if (job->status == BRDFFIT_OK) {
        weigh(job, fitter->settings);
    }
}

void brdffit_cli_job_fit(struct cli_job *job, struct cli_fitter *fitter)
{
    fit(job, fitter);
    if (job->table->sums != NULL && !sums_suffice(job)) {
        brdffit_cli_job_samples(job);
        if (job->status == BRDFFIT_OK) {
            fit(job, fitter);
        }
    }
}

void brdffit_cli_job_check(struct cli_job *job, struct cli_fitter *fitter)
{
    if (job->status == BRDFFIT_OK) {
        tell_f0(job, fitter);
        judge(job, fitter);
        tell_azimuth(job, fitter);
    }
    if (job->status == BRDFFIT_OK && fitter->settings->verify != NULL) {
        verify(job, fitter);
    }
    if (job->status == BRDFFIT_OK && fitter->settings->confidence > 0) {
        brdffit_cli_confidence_run(job, fitter);
    }
    if (job->status == BRDFFIT_OK && fitter->settings->stats && fitter->options.lobes > 1) {
        fit_one_lobe(job, fitter);
    }
}

void brdffit_cli_job_run(struct cli_job *job, struct cli_fitter *fitter, const char *path)
{
    brdffit_cli_job_open(job, fitter, path);
    if (job->status == BRDFFIT_OK) {
        brdffit_cli_job_fit(job, fitter);
    }
    brdffit_cli_job_check(job, fitter);
}

void brdffit_cli_job_free(struct cli_job *job)
{
    free(job->f0_low);
    free(job->r2);
    job->f0_low = job->f0_high = job->r2 = NULL;
    brdffit_io_free(job->table);
    free(job->weights);
    job->table = NULL;
    job->weights = NULL;
}

int brdffit_cli_job_exit(const struct cli_job *job)
{
    if (job->not_begun) {
        return CLI_EXIT_OPEN;
    }
    if (job->status != BRDFFIT_OK) {
        return brdffit_cli_status_exit(job->status);
    }
    if (job->result->stop == BRDFFIT_STOP_CONTRADICTION) {
        return CLI_EXIT_FAILURE;
    }
    const int proven = job->result->certified && (!job->verified || job->verification.proven);
    return proven ? CLI_EXIT_CERTIFIED : CLI_EXIT_OPEN;
}

size_t brdffit_cli_entries(const brdffit_table *table)
{
    size_t entries = table->samples->count;
    for (int i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        entries += table->dropped[i];
    }
    return entries;
}
