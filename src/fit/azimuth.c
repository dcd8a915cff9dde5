/*
 * Whether data vary with the azimuth of the half vector, which an isotropic model cannot follow (theory 7.4).
 * SPDX-License-Identifier: MIT
 *
 * A lobe that is stretched by a ratio e^t at angle a is, to first order in t, itself and t (cos 2a d_1 + sin 2a d_2), d_1 and
 * d_2 its derivatives at angles 0 and 45 degrees. The share of E^2 that they explain of the residuals r, all channels with
 * the same t and a, is b'A^-1 b / |r|^2 with A the products of d_1 and d_2 and b theirs with r. It is what a small stretch
 * would take off E^2 (a large one is taken to be e), the other parameters standing still: a fit with --anisotropic takes off more. Any two numbers explain
 * something of so many residuals: what is said is 1 - (1 - share) m / (m - 2), m their number less that of the parameters.
 */
#include <math.h>

#include "base/error.h"
#include "fit/fit.h"
#include "model/turn.h"

/* Step of ln(sigma_x / sigma_y). */
#define STEP 1e-3
/* d_1 and d_2 that are parallel to this are one. */
#define PARALLEL 1e-9

/* Residuals below this part of the values are rounding. */
#define EXACT 1e-10

struct products {
    double rr, r1, r2, d11, d12, d22;
    double values; /* squares of the data */
    size_t count;  /* of residuals */
};

/* What products of one lobe say of a model with so many parameters. */
static double share_of(const struct products *s, size_t parameters)
{
    double rest = (double)s->count - (double)parameters;
    double determinant = s->d11 * s->d22 - s->d12 * s->d12, along = 0.0, turned = 0.0, gain, step;

    if (determinant > PARALLEL * s->d11 * s->d22) {
        along = (s->r1 * s->d22 - s->r2 * s->d12) / determinant;
        turned = (s->r2 * s->d11 - s->r1 * s->d12) / determinant;
    } else if (s->d11 > 0.0) {
        along = s->r1 / s->d11;
    }
    step = 1.0 / fmax(1.0, sqrt(along * along + turned * turned)); /* no further than a ratio of e */
    gain = (2.0 * step - step * step) * (along * s->r1 + turned * s->r2);
    if (!(rest > 2.0) || !(s->rr > EXACT * EXACT * s->values)) {
        return 0.0;
    }
    return fmax(0.0, 1.0 - (1.0 - fmin(1.0, gain / s->rr)) * rest / (rest - 2.0));
}

static size_t parameters_of(const brdffit_model *m)
{
    size_t lobes = (size_t)m->lobes, each = m->fresnel == BRDFFIT_FRESNEL_SCHLICK ? 2 : 1;

    return lobes + m->channels * ((size_t)brdffit_diffuse_columns(m->diffuse) + lobes * each);
}

/* The model with lobe p stretched by one step, its tangent at so many degrees; p < 0: as it is. */
struct stretched {
    brdffit_model model;
    double anisotropy[BRDFFIT_MAX_LOBES], angle[BRDFFIT_MAX_LOBES];
};

static void stretch(struct stretched *to, const brdffit_model *model, int lobe, double degrees)
{
    int p;

    to->model = *model;
    to->model.channels = 1;
    to->model.anisotropy = to->anisotropy;
    to->model.tangent_angle = to->angle;
    for (p = 0; p < model->lobes; p++) {
        to->anisotropy[p] = p == lobe ? 1.0 + STEP : 1.0;
        to->angle[p] = p == lobe ? degrees : 0.0;
    }
}

/* Channel k alone. */
static void choose_channel(struct stretched *to, const brdffit_model *model, size_t k)
{
    size_t more = (size_t)brdffit_diffuse_columns(model->diffuse) - 1, lobes = (size_t)model->lobes;

    to->model.x = model->x + k;
    to->model.y = model->y + k * lobes;
    to->model.f0 = model->f0 ? model->f0 + k * lobes : NULL;
    to->model.x_more = model->x_more ? model->x_more + k * more : NULL;
}

static brdffit_status add_sample(const brdffit_samples *one, const brdffit_model *model, const double *scale, int lobe,
                                 double weight, double factor, struct products *to, brdffit_error *error)
{
    struct stretched plain, along, turned;
    double value[3];
    brdffit_status status = BRDFFIT_OK;
    size_t k;

    stretch(&plain, model, -1, 0.0);
    stretch(&along, model, lobe, 0.0);
    stretch(&turned, model, lobe, 45.0);
    for (k = 0; k < model->channels && status == BRDFFIT_OK; k++) {
        double unit = scale ? scale[k] : 1.0, r, d1, d2;

        choose_channel(&plain, model, k);
        choose_channel(&along, model, k);
        choose_channel(&turned, model, k);
        status = brdffit_eval_run(&plain.model, one, &value[0], error);
        status = status == BRDFFIT_OK ? brdffit_eval_run(&along.model, one, &value[1], error) : status;
        status = status == BRDFFIT_OK ? brdffit_eval_run(&turned.model, one, &value[2], error) : status;
        if (status != BRDFFIT_OK) {
            return status;
        }
        r = (one->values[k] * factor - value[0]) / unit;
        d1 = (value[1] - value[0]) / (STEP * unit);
        d2 = (value[2] - value[0]) / (STEP * unit);
        to->count++;
        to->values += weight * (one->values[k] * factor / unit) * (one->values[k] * factor / unit);
        to->rr += weight * r * r;
        to->r1 += weight * r * d1;
        to->r2 += weight * r * d2;
        to->d11 += weight * d1 * d1;
        to->d12 += weight * d1 * d2;
        to->d22 += weight * d2 * d2;
    }
    return status;
}

static brdffit_status share_of_lobe(const brdffit_samples *samples, const brdffit_options *options,
                                    const brdffit_model *model, const double *scale, int lobe, double *share,
                                    brdffit_error *error)
{
    double min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    brdffit_status status = BRDFFIT_OK;
    struct products sums = {.count = 0};
    size_t i;

    for (i = 0; i < samples->count && status == BRDFFIT_OK; i++) {
        double factor = brdffit_fit_to_radiance(samples, model, min_cosine, i);
        brdffit_samples one = brdffit_fit_one_sample(samples, i);

        if (factor > 0.0) {
            status = add_sample(&one, model, scale, lobe, samples->weights ? samples->weights[i] : 1.0, factor, &sums,
                                error);
        }
    }
    *share = fmax(*share, share_of(&sums, parameters_of(model)));
    return status;
}

brdffit_status brdffit_azimuth_share_run(const brdffit_samples *samples, const brdffit_options *options,
                                         const brdffit_model *model, const double *channel_scale, double *share,
                                         brdffit_error *error)
{
    brdffit_status status = brdffit_inspect_run(samples, options, NULL, NULL, 0, error);
    int p;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!share || samples->form != BRDFFIT_FORM_DIRECTIONS || model->channels != samples->channels) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT,
                            "azimuths: NULL, samples without directions, or other channels");
    }
    *share = 0.0;
    for (p = 0; p < model->lobes && status == BRDFFIT_OK; p++) {
        brdffit_distribution distribution = model->distributions ? model->distributions[p] : model->distribution;
        int known = brdffit_turn_known(distribution) && !(model->anisotropy && model->anisotropy[p] != 1.0);

        if (known) {
            status = share_of_lobe(samples, options, model, channel_scale, p, share, error);
        }
    }
    return status;
}
