/*
 * Options of the readers: defaults, checks, names. SPDX-License-Identifier: MIT
 */
#include "io/options.h"

#include <math.h>
#include <string.h>

#include "io/fail.h"

void brdffit_io_options_init(brdffit_io_options *options)
{
    memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
    options->format = BRDFFIT_IO_FORMAT_AUTO;
    options->quantity = BRDFFIT_QUANTITY_BRDF;
    options->merl_bins = BRDFFIT_IO_MERL_EDGE;
    options->merl_sampling = BRDFFIT_IO_MERL_TABLE;
}

const char *brdffit_io_drop_string(brdffit_io_drop reason)
{
    switch (reason) {
    case BRDFFIT_IO_DROP_MASKED: return "masked";
    case BRDFFIT_IO_DROP_ABSENT: return "absent";
    case BRDFFIT_IO_DROP_BELOW_HORIZON: return "cell_below_horizon";
    case BRDFFIT_IO_DROP_COUNT: break;
    }
    return "unknown";
}

static brdffit_status vector_check(const double *v, size_t sample, const char *message, brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;

    if (isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0)) {
        return BRDFFIT_OK;
    }
    place.sample = sample;
    return brdffit_io_fail_at(error, BRDFFIT_ERR_VALUE, message, &place,
                              !isfinite(v[0])   ? v[0]
                              : !isfinite(v[1]) ? v[1]
                                                : v[2]);
}

static brdffit_status direction_check(const brdffit_samples *at, size_t i, brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;
    brdffit_status status = vector_check(at->light + 3 * i, i,
                                         "a requested light direction is not finite or has no length", error);

    if (status == BRDFFIT_OK) {
        status = vector_check(at->view + 3 * i, i, "a requested view direction is not finite or has no length", error);
    }
    if (status == BRDFFIT_OK && at->normal) {
        status = vector_check(at->normal + 3 * i, i, "a requested normal is not finite or has no length", error);
    }
    if (status == BRDFFIT_OK && at->weights && !(at->weights[i] >= 0.0 && isfinite(at->weights[i]))) {
        place.sample = i;
        status = brdffit_io_fail_at(error, BRDFFIT_ERR_VALUE, "a requested weight is not finite and >= 0", &place,
                                    at->weights[i]);
    }
    return status;
}

static brdffit_status directions_check(const brdffit_samples *at, brdffit_error *error)
{
    size_t i;

    if (!at) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "MERL sampling by directions without directions");
    }
    if (at->struct_size != sizeof *at) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "directions: a struct of another version's size");
    }
    if (at->form != BRDFFIT_FORM_DIRECTIONS || !at->light || !at->view) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "directions: must be given as light and view vectors");
    }
    if (at->count == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_NO_SAMPLES, "directions: there are none");
    }
    for (i = 0; i < at->count; i++) {
        brdffit_status status = direction_check(at, i, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_options_check(const brdffit_io_options *given, brdffit_io_options *out, brdffit_error *error)
{
    brdffit_io_options_init(out);
    if (!given) {
        return BRDFFIT_OK;
    }
    if (given->struct_size != sizeof *given) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "reader options: a struct of another version's size");
    }
    *out = *given;
    if ((unsigned)out->format > BRDFFIT_IO_FORMAT_MERL) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "unknown file format");
    }
    if (out->quantity_set && (unsigned)out->quantity > BRDFFIT_QUANTITY_RADIANCE) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "unknown quantity");
    }
    if ((unsigned)out->merl_bins > BRDFFIT_IO_MERL_CENTRE) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "unknown convention of MERL bins");
    }
    if ((unsigned)out->merl_sampling > BRDFFIT_IO_MERL_DIRECTIONS) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "unknown sampling of MERL tables");
    }
    return out->merl_sampling == BRDFFIT_IO_MERL_DIRECTIONS ? directions_check(out->directions, error) : BRDFFIT_OK;
}
