/*
 * Options of the readers: defaults, checks, names. SPDX-License-Identifier: MIT
 */
#include "io/options.h"

#include <math.h>

#include "base/intake.h"
#include "io/fail.h"
#include "io/limits.h"

void brdffit_io_options_init_sized(brdffit_io_options *options, size_t struct_size)
{
    static const brdffit_io_options defaults = {
        .format = BRDFFIT_IO_FORMAT_AUTO,
        .quantity = BRDFFIT_QUANTITY_BRDF,
        .merl_bins = BRDFFIT_IO_MERL_EDGE,
        .merl_sampling = BRDFFIT_IO_MERL_TABLE,
    };

    intake_init(options, struct_size, &defaults, sizeof defaults);
}

size_t brdffit_io_file_limit(const brdffit_io_options *options)
{
    return options->max_bytes > 0 && options->max_bytes < IO_LIMIT_BYTES ? options->max_bytes : IO_LIMIT_BYTES;
}

size_t brdffit_io_unpacked_limit(const brdffit_io_options *options)
{
    return options->max_bytes > 0 ? brdffit_io_file_limit(options) : IO_LIMIT_UNPACKED;
}

const char *brdffit_io_drop_string(brdffit_io_drop reason)
{
    switch (reason) {
    case BRDFFIT_IO_DROP_MASKED: return "masked";
    case BRDFFIT_IO_DROP_ABSENT: return "absent";
    case BRDFFIT_IO_DROP_BELOW_HORIZON: return "cell_below_horizon";
    case BRDFFIT_IO_DROP_SATURATED: return "saturated";
    default: break;
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

int brdffit_io_directions(const brdffit_io_options *options, brdffit_samples *own)
{
    brdffit_samples_init(own);
    return intake(own, sizeof *own, INTAKE_LEAST(brdffit_samples, weights), options->directions);
}

static brdffit_status directions_check(const brdffit_io_options *options, brdffit_error *error)
{
    brdffit_samples known;
    const brdffit_samples *at = &known;
    size_t i;

    if (!options->directions) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT, "MERL sampling by directions without directions");
    }
    if (!brdffit_io_directions(options, &known)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_ARGUMENT,
                               "directions: without their struct_size, or asking for what this version does not know");
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

/* What concerns text. */
static brdffit_status text_check(const brdffit_io_options *o, brdffit_error *error)
{
    if ((unsigned)o->missing > BRDFFIT_IO_MISSING_NONE || !isfinite(o->missing_value)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "missing must be one of its constants, its value finite");
    }
    if ((unsigned)o->values > BRDFFIT_IO_VALUES_REFLECTANCE_FACTOR ||
        (o->values != BRDFFIT_IO_VALUES_PLAIN && o->quantity_set && o->quantity != BRDFFIT_QUANTITY_BRDF)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "values must be one of its constants, and not with radiance");
    }
    if (o->directions_as > 127u ||
        ((o->directions_as & BRDFFIT_IO_DEGREES) && (o->directions_as & BRDFFIT_IO_RADIANS))) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPTION, "directions cannot be that, or not both");
    }
    if (!(o->saturated >= 0.0)) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_OPTION, "saturated must be a value above 0", o->saturated);
    }
    return BRDFFIT_OK;
}

int brdffit_io_wants_text(const brdffit_io_options *o)
{
    return o->values != BRDFFIT_IO_VALUES_PLAIN || o->channels || o->columns ||
           o->missing != BRDFFIT_IO_MISSING_MARKED || o->directions_as || o->saturated > 0.0;
}

brdffit_status brdffit_io_options_check(const brdffit_io_options *given, brdffit_io_options *out, brdffit_error *error)
{
    brdffit_io_options_init(out);
    if (!given) {
        return BRDFFIT_OK;
    }
    if (!intake(out, sizeof *out, INTAKE_LEAST(brdffit_io_options, directions), given)) {
        return brdffit_io_fail(
            error, BRDFFIT_ERR_ARGUMENT,
            "reader options: without their struct_size, or asking for what this version does not know");
    }
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
    if (text_check(out, error) != BRDFFIT_OK) {
        return BRDFFIT_ERR_OPTION;
    }
    if (out->fault && out->fault_size > 0) {
        out->fault[0] = '\0';
    }
    return out->merl_sampling == BRDFFIT_IO_MERL_DIRECTIONS ? directions_check(out, error) : BRDFFIT_OK;
}
