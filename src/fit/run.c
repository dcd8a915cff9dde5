/*
 * The public fit: one search, or what needs two (physical bounds, an anisotropic lobe). SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"

/* What the free fit leaves for the one with physical bounds. */
struct before {
    double e2, lower_bound;
    size_t boxes, nodes;
};

static struct before before_of(const struct fit *f)
{
    const brdffit_result *r = &f->handout->result;
    const struct before before = {r->e2, r->lower_bound, r->boxes, r->nodes};

    return before;
}

/*
 * The free fit bounds that with physical bounds from below. Where its model obeys them it is the answer; where not, search
 * again with the bounds in every restricted problem, in the same workspace, from the samples on.
 */
static brdffit_status make_physical(struct fit *f, const brdffit_samples *samples, const brdffit_options *options,
                                    void *workspace, size_t size, brdffit_error *error)
{
    const struct before before = before_of(f);
    brdffit_status status = brdffit_fit_open(f, samples, options, workspace, size, f, error);
    brdffit_result *result;

    if (status == BRDFFIT_OK) {
        f->physical = 1;
        status = brdffit_fit_finish(f, options, error);
    }
    if (status == BRDFFIT_OK) {
        result = &f->handout->result;
        result->e2_free = before.e2;
        result->boxes += before.boxes;
        result->nodes += before.nodes;
        result->lower_bound = fmax(result->lower_bound, before.lower_bound);
        brdffit_fit_judge(options, result);
    }
    return status;
}

brdffit_status brdffit_fit_run(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                               size_t workspace_size, const brdffit_result **result, brdffit_error *error)
{
    brdffit_status status;
    struct fit fit;

    status = brdffit_fit_open(&fit, samples, options, workspace, workspace_size, result, error);
    if (status == BRDFFIT_OK && brdffit_options_two_shapes(options)) {
        status = brdffit_fit_anisotropic(samples, options, workspace, workspace_size, &fit, error);
    } else if (status == BRDFFIT_OK) {
        status = brdffit_fit_finish(&fit, options, error);
    }
    if (status == BRDFFIT_OK && options->physical && !brdffit_fit_is_physical(&fit)) {
        status = make_physical(&fit, samples, options, workspace, workspace_size, error);
    }
    if (status == BRDFFIT_OK) {
        *result = &fit.handout->result;
    }
    return status;
}
