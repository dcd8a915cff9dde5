/*
 * The public functions of weights, as entry.c has the others. SPDX-License-Identifier: MIT
 */
#include "base/environment.h"
#include "base/vector.h"
#include "fit/intake.h"
#include "weight/weights.h"

size_t brdffit_weights_size(size_t count, size_t channels, brdffit_weighting weighting)
{
    return brdffit_weights_bytes(count, channels, weighting);
}

brdffit_status brdffit_weights(const brdffit_samples *samples, brdffit_weighting weighting, double floor,
                               void *workspace, size_t workspace_size, double *out, brdffit_error *error)
{
    struct environment callers;
    brdffit_samples known;
    brdffit_status status;

    brdffit_environment_enter(&callers);
    status = brdffit_intake_samples(samples, &known, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_weights_run(&known, weighting, floor, workspace, workspace_size, out, error);
    }
    brdffit_environment_leave(&callers);
    return status;
}

int brdffit_weights_crowded(const brdffit_samples *samples, const double *solid_angles, void *workspace,
                            size_t workspace_size)
{
    struct environment callers;
    brdffit_samples known;
    int crowded;

    brdffit_environment_enter(&callers);
    crowded = brdffit_intake_samples(samples, &known, NULL) == BRDFFIT_OK &&
              brdffit_weights_crowd(&known, solid_angles, workspace, workspace_size);
    brdffit_environment_leave(&callers);
    return crowded;
}

double brdffit_weights_effective(const double *weights, size_t count)
{
    struct environment callers;
    double share;

    brdffit_environment_enter(&callers);
    share = brdffit_weights_share(weights, count);
    brdffit_environment_leave(&callers);
    return share;
}
