/*
 * The public functions that compute, each with the caller's structures taken in as this version knows them (intake.h),
 * in the default floating-point environment (environment.h), and nothing more: the work is done by the function of the
 * same call in fit.h, sums.h or batch.h. SPDX-License-Identifier: MIT
 */
#include "base/environment.h"
#include "base/intake.h"
#include "fit/fit.h"
#include "fit/intake.h"
#include "batch/batch.h"
#include "data/sums.h"

/* What most calls are given. */
struct given {
    brdffit_samples samples;
    brdffit_options options;
};

static brdffit_status take(struct given *given, const brdffit_samples *samples, const brdffit_options *options,
                           brdffit_error *error)
{
    brdffit_status status = brdffit_intake_options(options, &given->options, error);

    return status == BRDFFIT_OK ? brdffit_intake_samples(samples, &given->samples, error) : status;
}

size_t brdffit_workspace_size(size_t count, size_t channels, const brdffit_options *options)
{
    struct environment callers;
    brdffit_options known;
    size_t size = 0;

    brdffit_environment_enter(&callers);
    if (brdffit_intake_options(options, &known, NULL) == BRDFFIT_OK) {
        size = brdffit_fit_workspace(count, channels, &known);
    }
    brdffit_environment_leave(&callers);
    return size;
}

brdffit_status brdffit_fit(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                           size_t workspace_size, const brdffit_result **result, brdffit_error *error)
{
    struct given given;
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take(&given, samples, options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_fit_run(&given.samples, &given.options, workspace, workspace_size, result, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_verify(const brdffit_samples *samples, const brdffit_options *options, double level,
                              void *workspace, size_t workspace_size, const brdffit_verification **verification,
                              brdffit_error *error)
{
    struct given given;
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take(&given, samples, options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_verify_run(&given.samples, &given.options, level, workspace, workspace_size, verification,
                                    error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_inspect(const brdffit_samples *samples, const brdffit_options *options, size_t *used,
                               size_t *skipped, size_t reasons, brdffit_error *error)
{
    struct given given;
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take(&given, samples, options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_inspect_run(&given.samples, &given.options, used, skipped, reasons, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_eval(const brdffit_model *model, const brdffit_samples *at, double *out, brdffit_error *error)
{
    struct environment callers;
    brdffit_samples places;
    brdffit_model known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_model(model, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_intake_samples(at, &places, error);
    }
    if (status == BRDFFIT_OK) {
        status = brdffit_eval_run(&known, &places, out, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

/* The same, and the model of their fit. */
static brdffit_status take_fit(struct given *given, brdffit_model *known, const brdffit_samples *samples,
                               const brdffit_options *options, const brdffit_model *model, brdffit_error *error)
{
    brdffit_status status = take(given, samples, options, error);

    return status == BRDFFIT_OK ? brdffit_intake_model(model, known, error) : status;
}

brdffit_status brdffit_f0_interval(const brdffit_samples *samples, const brdffit_options *options,
                                   const brdffit_model *model, double *low, double *high, brdffit_error *error)
{
    struct environment callers;
    struct given given;
    brdffit_model known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take_fit(&given, &known, samples, options, model, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_f0_interval_run(&given.samples, &given.options, &known, low, high, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_quality(const brdffit_samples *samples, const brdffit_options *options, const double *fitted,
                               double *r2, double total[3], unsigned *misfit, brdffit_error *error)
{
    struct environment callers;
    struct given given;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take(&given, samples, options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_quality_run(&given.samples, &given.options, fitted, r2, total, misfit, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_azimuth_share(const brdffit_samples *samples, const brdffit_options *options,
                                     const brdffit_model *model, const double *channel_scale, double *share,
                                     brdffit_error *error)
{
    struct environment callers;
    struct given given;
    brdffit_model known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take_fit(&given, &known, samples, options, model, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_azimuth_share_run(&given.samples, &given.options, &known, channel_scale, share, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_init(void *memory, size_t size, size_t channels, size_t groups,
                                 const brdffit_options *options, brdffit_sums **sums, brdffit_error *error)
{
    struct environment callers;
    brdffit_options known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_options(options, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_sums_init_run(memory, size, channels, groups, &known, sums, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add(brdffit_sums *sums, const brdffit_samples *samples, brdffit_error *error)
{
    struct environment callers;
    brdffit_samples known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_samples(samples, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_sums_add_run(sums, &known, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add_row(brdffit_sums *sums, const brdffit_row *row, size_t cells[BRDFFIT_CELL_COUNT],
                                    brdffit_error *error)
{
    struct environment callers;
    brdffit_row known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_row(row, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_sums_add_row_run(sums, &known, cells, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

size_t brdffit_sums_workspace_size(const brdffit_sums *sums, const brdffit_options *options)
{
    return sums ? brdffit_workspace_size(brdffit_sums_rows(sums), sums->channels, options) : 0;
}

brdffit_status brdffit_fit_sums(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                size_t workspace_size, const brdffit_result **result, brdffit_error *error)
{
    struct environment callers;
    brdffit_options known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_options(options, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_fit_sums_run(sums, &known, workspace, workspace_size, result, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

size_t brdffit_plan_size(const brdffit_samples *geometry, const brdffit_options *options)
{
    struct given given;
    struct environment callers;
    size_t size = 0;

    brdffit_environment_enter(&callers);
    if (take(&given, geometry, options, NULL) == BRDFFIT_OK) {
        size = brdffit_plan_bytes(&given.samples, &given.options);
    }
    brdffit_environment_leave(&callers);
    return size;
}

brdffit_status brdffit_plan_init(const brdffit_samples *geometry, const brdffit_options *options, void *memory,
                                 size_t size, const brdffit_plan **plan, brdffit_error *error)
{
    struct given given;
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take(&given, geometry, options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_plan_make(&given.samples, &given.options, memory, size, plan, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

/* What a batch is given. */
struct given_batch {
    brdffit_texels texels;
    brdffit_texel_results results;
    brdffit_many_stats stats;
};

static brdffit_status take_batch(struct given_batch *given, const brdffit_texels *texels,
                                 const brdffit_texel_results *results, const brdffit_many_stats *stats,
                                 brdffit_error *error)
{
    brdffit_status status = brdffit_intake_texels(texels, &given->texels, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_intake_texel_results(results, &given->results, error);
    }
    return status == BRDFFIT_OK && stats ? brdffit_intake_many_stats(stats, &given->stats, error) : status;
}

brdffit_status brdffit_fit_many(const brdffit_plan *plan, const brdffit_texels *texels,
                                const brdffit_texel_results *results, void *workspace, size_t workspace_size,
                                brdffit_many_stats *stats, brdffit_error *error)
{
    struct environment callers;
    struct given_batch given;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = take_batch(&given, texels, results, stats, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_batch_run(plan, &given.texels, &given.results, workspace, workspace_size,
                                   stats ? &given.stats : NULL, error);
    }
    if (status == BRDFFIT_OK && stats) {
        intake_return(stats, &given.stats, sizeof given.stats);
    }
    brdffit_environment_leave(&callers);
    return status;
}
