/*
 * The only allocating functions of the core. SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "fit/fit.h"
#include "fit/intake.h"
#include "base/error.h"

static struct handout *handout_of(const brdffit_result *result)
{
    return (struct handout *)((unsigned char *)result - offsetof(struct handout, result));
}

brdffit_status brdffit_fit_new(const brdffit_samples *samples, const brdffit_options *options,
                               const brdffit_result **result, brdffit_error *error)
{
    brdffit_samples known;
    brdffit_status status = brdffit_intake_samples(samples, &known, error);
    void *block;
    size_t size;

    if (!result) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "result is NULL");
    }
    *result = NULL;
    if (status != BRDFFIT_OK) {
        return status;
    }
    /* 0 for what brdffit_fit() explains better. */
    size = brdffit_workspace_size(known.count, known.channels ? known.channels : 1, options);
    block = malloc(size ? size : 1);
    if (!block) {
        return brdffit_fail(error, BRDFFIT_ERR_MEMORY, "no memory for the workspace");
    }
    status = brdffit_fit(samples, options, block, size, result, error);
    if (status != BRDFFIT_OK) {
        free(block);
        return status;
    }
    handout_of(*result)->block = block;
    return BRDFFIT_OK;
}

void brdffit_result_free(const brdffit_result *result)
{
    if (result) {
        free(handout_of(result)->block);
    }
}
