/*
 * The public functions of sums that compute, in the default floating-point environment: see entry.c. Layer 5.
 * SPDX-License-Identifier: MIT
 */
#include "environment.h"
#include "fit.h"
#include "sums.h"

brdffit_status brdffit_sums_init(void *memory, size_t size, size_t channels, size_t groups,
                                 const brdffit_options *options, brdffit_sums **sums, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_fit_sums_init(memory, size, channels, groups, options, sums, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add(brdffit_sums *sums, const brdffit_samples *samples, brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_sums_take(sums, samples, error);
    brdffit_environment_leave(&callers);
    return status;
}

brdffit_status brdffit_sums_add_row(brdffit_sums *sums, const brdffit_row *row, size_t cells[BRDFFIT_CELL_COUNT],
                                    brdffit_error *error)
{
    struct environment callers;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_sums_take_row(sums, row, cells, error);
    brdffit_environment_leave(&callers);
    return status;
}

size_t brdffit_sums_workspace_size(const brdffit_sums *sums, const brdffit_options *options)
{
    struct environment callers;
    size_t size;

    brdffit_environment_enter(&callers);
    size = brdffit_fit_sums_workspace(sums, options);
    brdffit_environment_leave(&callers);
    return size;
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
