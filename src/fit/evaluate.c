/*
 * Evaluation of a model at directions, and what a fit would use of samples. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "model/lobe.h"
#include "fit/fit.h"
#include "base/error.h"
#include "model/diffuse.h"
#include "model/geometry.h"

/* The distribution of lobe p. */
static brdffit_distribution distribution_of(const brdffit_model *m, int p)
{
    return m->distributions ? m->distributions[p] : m->distribution;
}

/* sigma_x / sigma_y of lobe p. */
static double anisotropy_of(const brdffit_model *m, int p)
{
    return m->anisotropy ? m->anisotropy[p] : 1.0;
}

static int any_anisotropic(const brdffit_model *m)
{
    int p, any = 0;

    for (p = 0; p < m->lobes; p++) {
        any = any || anisotropy_of(m, p) != 1.0;
    }
    return any;
}

static brdffit_status check_model(const brdffit_model *m, brdffit_error *error)
{
    int p;

    if (!m->sigma || !m->x || !m->y || m->channels == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: without roughness or coefficients");
    }
    if (!(m->lobes >= 1 && m->lobes <= BRDFFIT_MAX_LOBES)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: unknown number of lobes");
    }
    for (p = 0; p < m->lobes; p++) {
        if (!((unsigned)distribution_of(m, p) < BRDFFIT_DISTRIBUTION_COUNT)) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: unknown distribution");
        }
    }
    if (!((unsigned)m->fresnel < BRDFFIT_FRESNEL_COUNT && (unsigned)m->diffuse < BRDFFIT_DIFFUSE_COUNT &&
          brdffit_diffuse_columns(m->diffuse) <= FIXED_MOST)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: unknown Fresnel or diffuse term");
    }
    for (p = 0; p < m->lobes; p++) {
        if (!brdffit_lobe_kind_masked(distribution_of(m, p), m->masking)) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: a masking that its distribution has not");
        }
    }
    if ((m->fresnel != BRDFFIT_FRESNEL_NONE && !m->f0) || (brdffit_diffuse_columns(m->diffuse) > 1 && !m->x_more)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: without F0, or coefficients of the diffuse term");
    }
    for (p = 0; p < m->lobes; p++) {
        double r = anisotropy_of(m, p);

        if (r != 1.0 &&
            !(r >= 1.0 / ANISOTROPY_MOST && r <= ANISOTROPY_MOST && brdffit_turn_known(distribution_of(m, p)))) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT,
                                "model: an anisotropy that its distribution has not, or out of [1e-6, 1e6]");
        }
    }
    for (p = 0; p < m->lobes; p++) {
        double s = 1.0 / (m->sigma[p] * m->sigma[p]);

        if (!(m->sigma[p] > 0.0 && s > 0.0 && isfinite(s))) {
            return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "model: sigma must be positive, and 1/sigma^2 finite");
        }
    }
    return BRDFFIT_OK;
}

/*
 * b lambda(s) phi(s, c) of lobe p at a direction, whose geometry for the model's first lobe is given; `turn` of its half
 * vector, where a lobe needs that. s is that of the
 * model's sigma to twice the digits, as in published.c, so that values are within some 30 u of the model as it is written.
 */
static struct wide lobe_at(const brdffit_model *m, int p, struct twofold s, const struct geometry *first,
                           int coefficients, const double turn[2])
{
    const struct lobe_kind *kind = brdffit_lobe_kind_masked(distribution_of(m, p), m->masking);
    struct wide lambda = wide_of(1.0);
    struct geometry g = *first;

    if (!coefficients && kind->row != brdffit_lobe_kind_of(distribution_of(m, 0))->row) {
        kind->row(&first->angles, &g);
    }
    if (anisotropy_of(m, p) != 1.0) {
        const struct stretch stretch = brdffit_stretch_of(anisotropy_of(m, p),
                                                          m->tangent_angle ? m->tangent_angle[p] : 0.0);

        brdffit_turn_stretch(&stretch, turn, &g);
        lambda = wide_of(brdffit_turn_lambda(kind, stretch.ratio, s.high));
    }
    return wide_times(wide_times(wide_of(g.b), lambda), brdffit_lobe_at(kind, s, &g));
}

/* y may be as large as a double gets where phi is as small: neither may vanish or overflow on the way. */
static void eval_one(const brdffit_model *m, const struct twofold *s, const struct geometry *g, int coefficients,
                     const double turn[2], double divisor, double *out)
{
    struct wide lobe[BRDFFIT_MAX_LOBES];
    size_t k, lobes = (size_t)m->lobes, p, f, columns = (size_t)brdffit_diffuse_columns(m->diffuse);
    double fixed[FIXED_MOST], error[FIXED_MOST], w = 1.0;

    for (p = 0; p < lobes; p++) {
        lobe[p] = lobe_at(m, (int)p, s[p], g, coefficients, turn);
    }
    brdffit_diffuse_row(m->diffuse, g, fixed, error);
    w = m->fresnel == BRDFFIT_FRESNEL_SCHLICK ? schlick_weight(&g->angles) : 1.0;
    for (k = 0; k < m->channels; k++) {
        double value = fixed[0] * m->x[k];

        for (f = 1; f < columns; f++) {
            value += fixed[f] * m->x_more[k * (columns - 1) + f - 1];
        }
        for (p = 0; p < lobes; p++) {
            double f0 = m->fresnel == BRDFFIT_FRESNEL_SCHLICK ? m->f0[k * lobes + p] : 1.0;

            value += wide_value(
                wide_times(wide_times(wide_of(m->y[k * lobes + p]), wide_of(f0 + (1.0 - f0) * w)), lobe[p]));
        }
        out[k] = value / divisor;
    }
}

brdffit_status brdffit_eval_run(const brdffit_model *model, const brdffit_samples *at, double *out,
                                brdffit_error *error)
{
    brdffit_status status = check_model(model, error);
    struct twofold s[BRDFFIT_MAX_LOBES];
    int p, turned = status == BRDFFIT_OK && any_anisotropic(model);
    double turn[2] = {1.0, 0.0};
    brdffit_samples places;
    size_t i, k;

    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(at, 0, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (at->form == BRDFFIT_FORM_COEFFICIENTS && (model->fresnel || model->diffuse || model->masking)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "samples given as a, b, c have no angles for Fresnel, masking and diffuse terms");
    }
    if (!out && at->count) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "out is NULL");
    }
    for (p = 0; p < model->lobes; p++) {
        s[p] = twofold_inverse_square(model->sigma[p]);
    }
    places = *at;
    places.weights = NULL; /* not read: every direction is evaluated */
    for (i = 0; i < at->count; i++) {
        struct geometry g = {.cos_light = 1.0};
        brdffit_skip skip = brdffit_geometry_sample(&places, distribution_of(model, 0), 0.0, i, &g, &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            for (k = 0; k < model->channels; k++) {
                out[i * model->channels + k] = 0.0;
            }
            continue;
        }
        if (turned && !brdffit_turn_of(at, i, turn)) {
            return brdffit_fail_at(error, "an anisotropic lobe needs directions, and a tangent where there are normals",
                                   i, BRDFFIT_NONE, NAN);
        }
        eval_one(model, s, &g, at->form == BRDFFIT_FORM_COEFFICIENTS, turn,
                 at->quantity == BRDFFIT_QUANTITY_BRDF ? g.cos_light : 1.0, out + i * model->channels);
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_inspect_run(const brdffit_samples *samples, const brdffit_options *options, size_t *used,
                                   size_t *skipped, size_t known, brdffit_error *error)
{
    brdffit_status status = brdffit_options_check(options, error);
    size_t counted = 0, reasons[BRDFFIT_SKIP_COUNT] = {0}, i, k;
    double min_cosine;

    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(samples, 1, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    for (i = 0; i < samples->count; i++) {
        struct geometry g;
        brdffit_skip skip = brdffit_geometry_sample(samples, brdffit_model_asked(options, 0), min_cosine, i, &g,
                                                    &status, error);

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
    for (k = 0; skipped && k < known; k++) {
        skipped[k] = k < BRDFFIT_SKIP_COUNT ? reasons[k] : 0;
    }
    if (used) {
        *used = counted;
    }
    return counted ? BRDFFIT_OK : brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
}
