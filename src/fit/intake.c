/*
 * The last fields of each structure's first version, and defaults: see intake.h. SPDX-License-Identifier: MIT
 */
#include "fit/intake.h"

#include "base/error.h"
#include "base/intake.h"

void brdffit_samples_init_sized(brdffit_samples *samples, size_t struct_size)
{
    static const brdffit_samples zero;

    intake_init(samples, struct_size, &zero, sizeof zero);
}

void brdffit_model_init_sized(brdffit_model *model, size_t struct_size)
{
    static const brdffit_model start = {.lobes = 1};

    intake_init(model, struct_size, &start, sizeof start);
}

void brdffit_row_init_sized(brdffit_row *row, size_t struct_size)
{
    static const brdffit_row zero;

    intake_init(row, struct_size, &zero, sizeof zero);
}

void brdffit_texel_results_init_sized(brdffit_texel_results *results, size_t struct_size)
{
    static const brdffit_texel_results zero;

    intake_init(results, struct_size, &zero, sizeof zero);
}

void brdffit_many_stats_init_sized(brdffit_many_stats *stats, size_t struct_size)
{
    static const brdffit_many_stats zero;

    intake_init(stats, struct_size, &zero, sizeof zero);
}

brdffit_status brdffit_intake_samples(const brdffit_samples *callers, brdffit_samples *own, brdffit_error *error)
{
    brdffit_samples_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_samples, weights), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_model(const brdffit_model *callers, brdffit_model *own, brdffit_error *error)
{
    brdffit_model_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_model, distributions), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_row(const brdffit_row *callers, brdffit_row *own, brdffit_error *error)
{
    brdffit_row_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_row, scale), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "row: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_texels(const brdffit_texels *callers, brdffit_texels *own, brdffit_error *error)
{
    *own = (brdffit_texels){.scale = 1.0};
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_texels, mask), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "texels: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_texel_results(const brdffit_texel_results *callers, brdffit_texel_results *own,
                                            brdffit_error *error)
{
    brdffit_texel_results_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_texel_results, boxes), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "results: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_many_stats(const brdffit_many_stats *callers, brdffit_many_stats *own,
                                         brdffit_error *error)
{
    brdffit_many_stats_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_many_stats, one_lobe_enough), callers)
               ? BRDFFIT_OK
               : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "stats: " INTAKE_REFUSED);
}

brdffit_status brdffit_intake_options(const brdffit_options *callers, brdffit_options *own, brdffit_error *error)
{
    brdffit_options_init(own);
    if (callers && !intake(own, sizeof *own, INTAKE_LEAST(brdffit_options, box_user), callers)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "options: " INTAKE_REFUSED);
    }
    if (own->distributions && own->lobes >= 1) {
        own->distribution = own->distributions[0];
    }
    return BRDFFIT_OK;
}
