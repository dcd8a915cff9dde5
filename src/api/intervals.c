/*
 * The public functions of intervals, as those of entry.c. SPDX-License-Identifier: MIT
 */
#include "base/environment.h"
#include "fit/intake.h"
#include "fit/intervals.h"

struct given {
    brdffit_samples samples;
    brdffit_options options;
    brdffit_model model;
    brdffit_interval_options asked;
};

size_t brdffit_intervals_workspace_size(size_t count, size_t channels, const brdffit_options *options)
{
    struct environment callers;
    brdffit_options known;
    size_t size = 0;

    brdffit_environment_enter(&callers);
    if (brdffit_intake_options(options, &known, NULL) == BRDFFIT_OK) {
        size = brdffit_intervals_bytes(count, channels, &known);
    }
    brdffit_environment_leave(&callers);
    return size;
}

brdffit_status brdffit_intervals(const brdffit_samples *samples, const brdffit_options *options,
                                 const brdffit_model *model, double e2,
                                 const brdffit_interval_options *interval_options, void *workspace,
                                 size_t workspace_size, const brdffit_interval_result **result, brdffit_error *error)
{
    struct environment callers;
    struct given given;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_options(options, &given.options, error);
    status = status == BRDFFIT_OK ? brdffit_intake_samples(samples, &given.samples, error) : status;
    status = status == BRDFFIT_OK ? brdffit_intake_model(model, &given.model, error) : status;
    status = status == BRDFFIT_OK ? brdffit_intake_interval_options(interval_options, &given.asked, error) : status;
    if (status == BRDFFIT_OK) {
        status = brdffit_intervals_run(&given.samples, &given.options, &given.model, e2, &given.asked, workspace,
                                       workspace_size, result, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}
