/*
 * The only allocating functions of the core. SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "brdffit.h"
#include "base/error.h"
#include "model/geometry.h"

/* The workspace follows the result in one block. */
struct owned {
    brdffit_result result;
    unsigned char workspace[];
};

brdffit_status brdffit_fit_new(const brdffit_samples *samples, const brdffit_options *options, brdffit_result **result,
                               brdffit_error *error)
{
    struct owned *owned;
    brdffit_status status;
    size_t size;

    if (!result || !samples || samples->struct_size != sizeof *samples) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples or result: NULL or of another version's size");
    }
    *result = NULL;
    size = brdffit_workspace_size(samples->count, samples->channels ? samples->channels : 1, options);
    owned = size <= (size_t)-1 - sizeof *owned ? malloc(sizeof *owned + size) : NULL;
    if (!owned) {
        return brdffit_fail(error, BRDFFIT_ERR_MEMORY, "no memory for the workspace");
    }
    status = brdffit_fit(samples, options, owned->workspace, size, &owned->result, error);
    if (status != BRDFFIT_OK) {
        free(owned);
        return status;
    }
    *result = &owned->result;
    return BRDFFIT_OK;
}

void brdffit_fit_free(brdffit_result *result)
{
    free(result); /* first member of struct owned */
}
