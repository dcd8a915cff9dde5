/*
 * One texel of a batch by the ordinary fit: what has no faster way. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"
#include "batch/batch.h"

static void copy(double *to, const double *from, size_t count)
{
    size_t i;

    for (i = 0; i < count; i++) {
        to[i] = from[i];
    }
}

static void keep(const brdffit_plan *plan, const brdffit_result *from, struct batch_result *to)
{
    size_t K = plan->geometry.channels, P = (size_t)plan->options.lobes;

    to->status = from->certified ? BRDFFIT_TEXEL_CERTIFIED : BRDFFIT_TEXEL_OPEN;
    to->stop = from->stop;
    to->boxes = from->boxes;
    to->nodes = from->nodes;
    to->e2 = from->e2;
    to->lower_bound = from->lower_bound;
    to->sum_of_squares = from->sum_of_squares;
    to->sigma_floor = from->sigma_floor;
    copy(to->sigma, from->model->sigma, P);
    copy(to->x, from->model->x, K);
    copy(to->channel_scale, from->channel_scale, K);
    copy(to->y, from->model->y, K * P);
    if (to->f0) {
        copy(to->f0, from->model->f0, K * P);
    }
    if (to->x_more) {
        copy(to->x_more, from->model->x_more, K * ((size_t)brdffit_diffuse_columns(plan->options.diffuse) - 1));
    }
    if (!(to->sum_of_squares > 0.0)) {
        to->status = BRDFFIT_TEXEL_NO_SIGNAL;
    }
}

void brdffit_batch_general(const brdffit_plan *plan, struct batch *batch, const double *values,
                           struct batch_result *result)
{
    brdffit_samples samples = plan->geometry;
    const brdffit_result *fitted;
    brdffit_error error;

    result->where = BRDFFIT_NONE;
    result->boxes = result->nodes = 0;
    result->general = 1;
    result->one_lobe_enough = 0;
    samples.values = values;
    if (brdffit_fit_run(&samples, &plan->options, batch->fit, batch->fit_size, &fitted, &error) == BRDFFIT_OK) {
        keep(plan, fitted, result);
        return;
    }
    result->status = BRDFFIT_TEXEL_REFUSED;
    result->stop = BRDFFIT_STOP_COUNT;
    if (error.status == BRDFFIT_ERR_VALUE && error.sample != BRDFFIT_NONE && error.channel != BRDFFIT_NONE &&
        !isfinite(error.value)) {
        result->status = BRDFFIT_TEXEL_BAD_VALUE;
        result->where = error.sample * samples.channels + error.channel;
    }
}
