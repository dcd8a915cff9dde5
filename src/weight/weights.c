/*
 * Weights of samples: see brdffit.h. SPDX-License-Identifier: MIT
 *
 * A fit minimises sum_ik w_i (I_ik - model_ik)^2 / scale_k^2 over radiance I = f_r (n.l). With w the solid angle that a
 * sample stands for, the sum over samples is a quadrature of the integral over all pairs of directions: wherever the
 * samples lie, what is minimised is the same. With w = 1 / max(m, floor)^2, m_i^2 the mean over channels of
 * (I_ik / max_i |I_ik|)^2, it is the sum of squared relative errors of the samples that are not too dark.
 */
#include "weight/weights.h"

#include <math.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/error.h"
#include "base/vector.h"
#include "model/geometry.h"
#include "weight/cells.h"

/* What the choices have in common. */
struct weighing {
    const brdffit_samples *samples;
    struct cells cells;
    double *scale; /* a channel each */
    double *out;
    brdffit_error *error;
};

size_t brdffit_weights_bytes(size_t count, size_t channels, brdffit_weighting weighting)
{
    struct arena arena;
    struct cells cells;

    brdffit_arena_init(&arena, NULL, 0);
    if (weighting == BRDFFIT_WEIGHTING_SOLID_ANGLE && count <= UINT32_MAX) {
        brdffit_cells_take(&cells, count, &arena);
    } else if (weighting == BRDFFIT_WEIGHTING_RELATIVE) {
        (void)ARENA_DOUBLES(&arena, channels);
    } else {
        return 0;
    }
    return arena.failed ? 0 : arena.used;
}

/* ---- What a sample is ---------------------------------------------------- */

/* 1: it is above the horizon, with a weight that is not 0, and *geometry is filled in; *status may be a failure. */
static int is_used(const struct weighing *w, size_t i, struct geometry *geometry, brdffit_status *status)
{
    brdffit_skip skip = brdffit_geometry_sample(w->samples, BRDFFIT_BECKMANN, 0.0, i, geometry, status, w->error);

    return *status == BRDFFIT_OK && skip == BRDFFIT_SKIP_COUNT;
}

/* The same, and else its weight is there already. */
static int in_domain(const struct weighing *w, size_t i, struct geometry *geometry, brdffit_status *status)
{
    w->out[i] = w->samples->weights && w->samples->weights[i] == 0.0 ? 0.0 : 1.0;
    return is_used(w, i, geometry, status);
}

static double radiance(const struct weighing *w, size_t i, size_t k, const struct geometry *geometry)
{
    double value = w->samples->values[i * w->samples->channels + k];

    return w->samples->quantity == BRDFFIT_QUANTITY_RADIANCE ? value : value * geometry->cos_light;
}

/* ---- The choices --------------------------------------------------------- */

static brdffit_status weigh_as_given(struct weighing *w, int keep)
{
    size_t i;

    for (i = 0; i < w->samples->count; i++) {
        double given = w->samples->weights ? w->samples->weights[i] : 1.0;

        if (!(given >= 0.0 && isfinite(given))) {
            return brdffit_fail_at(w->error, "weight is not finite and >= 0", i, BRDFFIT_NONE, given);
        }
        w->out[i] = keep ? given : given > 0.0;
    }
    return BRDFFIT_OK;
}

static brdffit_status weigh_by_cosine(struct weighing *w)
{
    brdffit_status status = BRDFFIT_OK;
    struct geometry geometry;
    size_t i;

    for (i = 0; i < w->samples->count && status == BRDFFIT_OK; i++) {
        if (in_domain(w, i, &geometry, &status)) {
            w->out[i] = geometry.angles.cos_light;
        }
    }
    return status;
}

static brdffit_status place_samples(struct weighing *w)
{
    brdffit_status status = BRDFFIT_OK;
    struct geometry geometry;
    size_t i;

    for (i = 0; i < w->samples->count && status == BRDFFIT_OK; i++) {
        if (in_domain(w, i, &geometry, &status)) {
            brdffit_cells_place(&w->cells, i, geometry.angles.cos_light, geometry.angles.cos_view,
                                geometry.angles.cos_difference);
        }
    }
    return status;
}

static brdffit_status weigh_by_solid_angle(struct weighing *w, void *workspace, size_t size)
{
    const size_t count = w->samples->count;
    struct arena arena;
    brdffit_status status;
    size_t i;

    if (count > UINT32_MAX) {
        return brdffit_fail(w->error, BRDFFIT_ERR_UNSUPPORTED, "more samples than 32 bits count");
    }
    brdffit_arena_init(&arena, workspace, size);
    brdffit_cells_take(&w->cells, count, &arena);
    if (!workspace || arena.failed) {
        return brdffit_fail(w->error, BRDFFIT_ERR_WORKSPACE, "the workspace is too small: see brdffit_weights_size()");
    }
    status = place_samples(w);
    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_cells_share(&w->cells, w->out);
    for (i = 0; i < w->cells.placed; i++) {
        w->out[w->cells.order[0][i]] *= (double)w->cells.placed;
    }
    return BRDFFIT_OK;
}

/* The largest magnitude of each channel. */
static brdffit_status find_scales(struct weighing *w)
{
    const size_t channels = w->samples->channels;
    brdffit_status status = BRDFFIT_OK;
    struct geometry geometry;
    size_t i, k;

    for (k = 0; k < channels; k++) {
        w->scale[k] = 0.0;
    }
    for (i = 0; i < w->samples->count && status == BRDFFIT_OK; i++) {
        for (k = 0; is_used(w, i, &geometry, &status) && k < channels; k++) {
            double value = radiance(w, i, k, &geometry);

            if (!isfinite(value)) {
                return brdffit_fail_at(w->error, "value is not finite", i, k, value);
            }
            w->scale[k] = larger(w->scale[k], fabs(value));
        }
    }
    return status;
}

/* Root mean square of the channels, each in [-1, 1]. */
static double magnitude(const struct weighing *w, size_t i, const struct geometry *geometry)
{
    const size_t channels = w->samples->channels;
    double sum = 0.0;
    size_t k;

    for (k = 0; k < channels; k++) {
        double part = w->scale[k] > 0.0 ? radiance(w, i, k, geometry) / w->scale[k] : 0.0;

        sum += part * part;
    }
    return sqrt(sum / (double)channels);
}

static brdffit_status weigh_by_value(struct weighing *w, double floor, void *workspace, size_t size)
{
    struct arena arena;
    struct geometry geometry;
    brdffit_status status;
    size_t i;

    if (!(floor >= BRDFFIT_WEIGHT_FLOOR_MIN && floor <= 1.0)) {
        return brdffit_fail_at(w->error, "the floor of relative weights is not in [1e-6, 1]", BRDFFIT_NONE,
                               BRDFFIT_NONE, floor);
    }
    brdffit_arena_init(&arena, workspace, size);
    w->scale = ARENA_DOUBLES(&arena, w->samples->channels);
    if (!workspace || arena.failed) {
        return brdffit_fail(w->error, BRDFFIT_ERR_WORKSPACE, "the workspace is too small: see brdffit_weights_size()");
    }
    status = find_scales(w);
    for (i = 0; i < w->samples->count && status == BRDFFIT_OK; i++) {
        if (in_domain(w, i, &geometry, &status)) {
            double m = larger(magnitude(w, i, &geometry), floor);

            w->out[i] = 1.0 / (m * m);
        }
    }
    return status;
}

/* ---- Whether weights are needed ------------------------------------------ */

#define CROWDED_EFFECTIVE 0.25
#define CROWDED_BRIGHT 3.0

/* Mean magnitude of the samples over that with weights; 0: none is bright. */
static double brightness(struct weighing *w, const double *solid_angles)
{
    double sum = 0.0, weighted = 0.0, count = 0.0, weights = 0.0;
    struct geometry geometry;
    brdffit_status status = BRDFFIT_OK;
    size_t i;

    for (i = 0; i < w->samples->count && status == BRDFFIT_OK; i++) {
        if (is_used(w, i, &geometry, &status)) {
            double m = magnitude(w, i, &geometry);

            sum += m;
            count += 1.0;
            weighted += solid_angles[i] * m;
            weights += solid_angles[i];
        }
    }
    return weighted > 0.0 && status == BRDFFIT_OK ? sum / count / (weighted / weights) : 0.0;
}

int brdffit_weights_crowd(const brdffit_samples *samples, const double *solid_angles, void *workspace, size_t size)
{
    struct weighing w = {.samples = samples};
    struct arena arena;

    if (!solid_angles || !workspace || brdffit_geometry_check(samples, 1, NULL) != BRDFFIT_OK ||
        !(brdffit_weights_share(solid_angles, samples->count) < CROWDED_EFFECTIVE)) {
        return 0;
    }
    brdffit_arena_init(&arena, workspace, size);
    w.scale = ARENA_DOUBLES(&arena, samples->channels);
    return !arena.failed && find_scales(&w) == BRDFFIT_OK && brightness(&w, solid_angles) > CROWDED_BRIGHT;
}

/* ---- The call ------------------------------------------------------------ */

static brdffit_status check(const struct weighing *w, brdffit_weighting weighting)
{
    int by_value = weighting == BRDFFIT_WEIGHTING_RELATIVE;
    brdffit_status status;

    if (!w->out || !((unsigned)weighting < BRDFFIT_WEIGHTING_COUNT)) {
        return brdffit_fail(w->error, BRDFFIT_ERR_ARGUMENT, w->out ? "there is no such weighting" : "out is NULL");
    }
    status = brdffit_geometry_check(w->samples, by_value, w->error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (weighting == BRDFFIT_WEIGHTING_COLUMN && !w->samples->weights) {
        return brdffit_fail(w->error, BRDFFIT_ERR_ARGUMENT, "the samples have no weights of their own");
    }
    if ((weighting == BRDFFIT_WEIGHTING_COSINE || weighting == BRDFFIT_WEIGHTING_SOLID_ANGLE) &&
        w->samples->form == BRDFFIT_FORM_COEFFICIENTS) {
        return brdffit_fail(w->error, BRDFFIT_ERR_UNSUPPORTED, "samples of a, b, c have no directions to weigh by");
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_weights_run(const brdffit_samples *samples, brdffit_weighting weighting, double floor,
                                   void *workspace, size_t size, double *out, brdffit_error *error)
{
    struct weighing w = {.samples = samples, .out = out, .error = error};
    brdffit_status status = check(&w, weighting);

    if (status != BRDFFIT_OK) {
        return status;
    }
    switch (weighting) {
    case BRDFFIT_WEIGHTING_COSINE: return weigh_by_cosine(&w);
    case BRDFFIT_WEIGHTING_SOLID_ANGLE: return weigh_by_solid_angle(&w, workspace, size);
    case BRDFFIT_WEIGHTING_RELATIVE: return weigh_by_value(&w, floor, workspace, size);
    case BRDFFIT_WEIGHTING_NONE:
    case BRDFFIT_WEIGHTING_COLUMN:
    case BRDFFIT_WEIGHTING_COUNT: break;
    }
    return weigh_as_given(&w, weighting == BRDFFIT_WEIGHTING_COLUMN);
}
