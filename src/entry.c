/*
 * The public functions that compute, each in the default floating-point environment (environment.h) and nothing more:
 * the work is done by the function of the same call in fit.h. Layer 5. SPDX-License-Identifier: MIT
 */
#include "environment.h"
#include "fit.h"

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
    status = brdffit_reprove_run(samples, options, level, workspace, workspace_size, reproof, error);
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
