/*
 * Evaluation of a model at directions, and what a fit would use of samples. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "model/lobe.h"
#include "fit/fit.h"
#include "base/error.h"
#include "model/geometry.h"

static brdffit_status check_model(const brdffit_model *m, brdffit_error *error)
{
    int p;

    if (!m || !m->x || !m->y || m->channels == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: NULL, or without coefficients");
    }
    if (!(m->lobes >= 1 && m->lobes <= BRDFFIT_MAX_LOBES) ||
        !((unsigned)m->distribution < BRDFFIT_DISTRIBUTION_COUNT)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: unknown distribution or number of lobes");
    }
    for (p = 0; p < m->lobes; p++) {
        double s = 1.0 / (m->sigma[p] * m->sigma[p]);

        if (!(m->sigma[p] > 0.0 && s > 0.0 && isfinite(s))) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: sigma must be positive, and 1/sigma^2 finite");
        }
    }
    return BRDFFIT_OK;
}

static void eval_one(const brdffit_model *m, const struct lobe_kind *kind, const struct geometry *g, double divisor,
                     double *out)
{
    double lobe[BRDFFIT_MAX_LOBES];
    size_t k, lobes = (size_t)m->lobes, p;

    for (p = 0; p < lobes; p++) {
        lobe[p] = g->b * kind->evaluate(1.0 / (m->sigma[p] * m->sigma[p]), g->c);
    }
    for (k = 0; k < m->channels; k++) {
        double value = g->a * m->x[k];

        for (p = 0; p < lobes; p++) {
            value += m->y[k * lobes + p] * lobe[p];
        }
        out[k] = value / divisor;
    }
}

brdffit_status brdffit_eval_run(const brdffit_model *model, const brdffit_samples *at, double *out,
                                brdffit_error *error)
{
    brdffit_status status = check_model(model, error);
    const struct lobe_kind *kind;
    brdffit_samples places;
    size_t i, k;

    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(at, 0, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!out && at->count) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "out is NULL");
    }
    kind = brdffit_lobe_kind_of(model->distribution);
    places = *at;
    places.weights = NULL; /* not read: every direction is evaluated */
    for (i = 0; i < at->count; i++) {
        struct geometry g = {.cos_light = 1.0};
        brdffit_skip skip = brdffit_geometry_sample(&places, model->distribution, 0.0, i, &g, &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            for (k = 0; k < model->channels; k++) {
                out[i * model->channels + k] = 0.0;
            }
            continue;
        }
        eval_one(model, kind, &g, at->quantity == BRDFFIT_QUANTITY_BRDF ? g.cos_light : 1.0, out + i * model->channels);
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_inspect_run(const brdffit_samples *samples, const brdffit_options *options, size_t *used,
                                   size_t skipped[BRDFFIT_SKIP_COUNT], brdffit_error *error)
{
    brdffit_options defaults;
    brdffit_status status;
    size_t counted = 0, reasons[BRDFFIT_SKIP_COUNT] = {0}, i, k;
    double min_cosine;

    if (!options) {
        brdffit_options_init(&defaults);
        options = &defaults;
    }
    status = brdffit_options_check(options, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(samples, 1, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    for (i = 0; i < samples->count; i++) {
        struct geometry g;
        brdffit_skip skip = brdffit_geometry_sample(samples, options->distribution, min_cosine, i, &g, &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        counted += skip == BRDFFIT_SKIP_COUNT;
        for (k = 0; k < samples->channels && skip == BRDFFIT_SKIP_COUNT; k++) {
            double value = samples->values[i * samples->channels + k];

            if (!isfinite(value)) {
                return brdffit_fail_at(error, "value is not finite", i, k, value);
            }
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            reasons[skip]++;
        }
    }
    for (k = 0; k < BRDFFIT_SKIP_COUNT && skipped; k++) {
        skipped[k] = reasons[k];
    }
    if (used) {
        *used = counted;
    }
    return counted ? BRDFFIT_OK : brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
}
