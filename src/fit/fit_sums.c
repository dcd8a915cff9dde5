/*
 * Fits of sums: brdffit_fit() from the reduction on. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"
#include "base/error.h"
#include "model/geometry.h"
#include "data/sums.h"
#include "base/tolerance.h"

brdffit_status brdffit_sums_init_run(void *memory, size_t size, size_t channels, size_t groups,
                                     const brdffit_options *options, brdffit_sums **sums, brdffit_error *error)
{
    size_t needed = brdffit_sums_size(channels, groups);
    brdffit_status status;
    struct model model;

    if (!memory || !sums || needed == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "sums: NULL, no channels, no groups or too many of them");
    }
    status = brdffit_options_check(options, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (options->norm != BRDFFIT_NORM_L2) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "sums are those of norm l2: the others need the samples");
    }
    if (brdffit_options_special(options)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "sums know nothing of Fresnel, masking and diffuse terms");
    }
    brdffit_model_make(&model, options);
    if (model.geometries > 1) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "sums are of one geometry: lobes of these distributions have several");
    }
    if (size < needed) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE, "the memory is smaller than brdffit_sums_size()");
    }
    *sums = brdffit_sums_start(memory, size, channels, groups, options);
    return BRDFFIT_OK;
}

/* Whether the lobes asked for see the geometry that the samples were summed for: bins have a remainder for their kind. */
static int same_geometry(const brdffit_sums *sums, const brdffit_options *o)
{
    const struct lobe_kind *kind = brdffit_lobe_kind_of(sums->distribution);
    int p, same = 1;

    for (p = 0; p < o->lobes; p++) {
        const struct lobe_kind *asked = brdffit_lobe_kind_of(brdffit_model_asked(o, p));

        same = same && asked->row == kind->row && (asked == kind || !sums->bits);
    }
    return same;
}

static brdffit_status check_call(const brdffit_sums *sums, const brdffit_options *o, const void *workspace, size_t size,
                                 const void *result, brdffit_error *error)
{
    brdffit_status status = brdffit_options_check(o, error);
    size_t needed;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!sums || !workspace || !result) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "sums, workspace or result is NULL");
    }
    if (o->physical) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "fits of sums have no physical bounds: fit the samples");
    }
    if (o->norm != BRDFFIT_NORM_L2 || o->engine != BRDFFIT_ENGINE_MOMENT) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "sums are fitted in norm l2 by engine moment only");
    }
    if (!same_geometry(sums, o) || o->max_incidence != sums->max_incidence) {
        return brdffit_fail(error, BRDFFIT_ERR_OPTION, "the sums were made for another distribution or max_incidence");
    }
    if (sums->bits && o->box) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "boxes of binned sums would be shown without the remainder");
    }
    needed = brdffit_fit_workspace(brdffit_sums_rows(sums), sums->channels, o);
    if (needed == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "more groups or channels than can be addressed");
    }
    return size >= needed ? BRDFFIT_OK
                          : brdffit_fail(error, BRDFFIT_ERR_WORKSPACE,
                                         "the workspace is smaller than brdffit_sums_workspace_size()");
}

static brdffit_status open_sums(struct fit *f, const brdffit_sums *sums, const brdffit_options *o, void *workspace,
                                size_t size, brdffit_error *error)
{
    brdffit_status status;
    struct arena arena;

    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(f, &arena, brdffit_sums_rows(sums), sums->channels, o);
    status = brdffit_sums_reduce(sums, o, &f->data, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    return brdffit_fit_check_total(f, o, error);
}

brdffit_status brdffit_fit_sums_run(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                    size_t workspace_size, const brdffit_result **result, brdffit_error *error)
{
    brdffit_options inner;
    brdffit_status status;
    struct fit fit;

    status = check_call(sums, options, workspace, workspace_size, result, error);
    if (status == BRDFFIT_OK) {
        status = open_sums(&fit, sums, options, workspace, workspace_size, error);
    }
    if (status == BRDFFIT_OK) {
        inner = *options;
        fit.rows_error = 9.0 * TOL_GRAM * TOL_UNIT;
        inner.relative_gap *= sums->bits ? 0.5 : 1.0; /* the other half is for the bins */
        status = brdffit_fit_finish(&fit, &inner, error);
    }
    if (status == BRDFFIT_OK && sums->bits) {
        brdffit_sums_remainder(sums, options, &fit.handout->result);
        brdffit_fit_judge(options, &fit.handout->result);
    }
    if (status == BRDFFIT_OK) {
        *result = &fit.handout->result;
    }
    return status;
}
