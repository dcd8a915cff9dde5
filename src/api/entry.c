/*
 * The public functions that compute, each in the default floating-point environment (environment.h) and nothing more:
 * the work is done by the function of the same call in fit.h. SPDX-License-Identifier: MIT
 */
#include "base/environment.h"
#include "fit/fit.h"
#include "batch/batch.h"
#include "data/sums.h"

size_t brdffit_workspace_size(size_t count, size_t channels, const brdffit_options *options)
{
    struct environment callers;
    size_t size;

    brdffit_environment_enter(&callers);
    size = brdffit_fit_workspace(count, channels, options);
    brdffit_environment_leave(&callers);
    return size;
}

brdffit_status brdffit_fit(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                           size_t workspace_size, brdffit_result *result, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_fit_run(samples, options, workspace, workspace_size, result, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_verify_socp(const brdffit_samples *samples, const brdffit_options *options, double level,
                                   void *workspace, size_t workspace_size, brdffit_reproof *reproof,
                                   brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_verify_run(samples, options, level, workspace, workspace_size, reproof, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_inspect(const brdffit_samples *samples, const brdffit_options *options, size_t *used,
                               size_t skipped[BRDFFIT_SKIP_COUNT], brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_inspect_run(samples, options, used, skipped, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_eval(const brdffit_model *model, const brdffit_samples *at, double *out, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_eval_run(model, at, out, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add(brdffit_sums *sums, const brdffit_samples *samples, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_sums_add_run(sums, samples, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add_row(brdffit_sums *sums, const brdffit_row *row, size_t cells[BRDFFIT_CELL_COUNT],
                                    brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_sums_add_row_run(sums, row, cells, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_fit_sums(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                size_t workspace_size, brdffit_result *result, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_fit_sums_run(sums, options, workspace, workspace_size, result, error);
    brdffit_environment_leave(&callers);
    return status;
}

size_t brdffit_plan_size(const brdffit_samples *geometry, const brdffit_options *options)
{
    struct environment callers;
    size_t size;

    brdffit_environment_enter(&callers);
    size = brdffit_plan_bytes(geometry, options);
    brdffit_environment_leave(&callers);
    return size;
}

brdffit_status brdffit_plan_init(const brdffit_samples *geometry, const brdffit_options *options, void *memory,
                                 size_t size, const brdffit_plan **plan, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_plan_make(geometry, options, memory, size, plan, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_fit_many(const brdffit_plan *plan, const brdffit_texels *texels,
                                const brdffit_texel_results *results, void *workspace, size_t workspace_size,
                                brdffit_many_stats *stats, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_batch_run(plan, texels, results, workspace, workspace_size, stats, error);
    brdffit_environment_leave(&callers);
    return status;
}
