/*
 * One fit, step by step: validate, reduce, search, report. SPDX-License-Identifier: MIT
 */
#include "fit/fit.h"

#include <float.h>
#include <math.h>

#include "fit/published.h"

#include "base/error.h"
#include "model/geometry.h"
#include "base/tolerance.h"

/* Boxes of a first partition of so many intervals a kind: multisets of them for like lobes. */
static double first_boxes(const struct model *model, uint32_t first)
{
    double boxes = 1.0;
    int p;

    for (p = 0; p < model->lobes; p++) {
        int place = p - model->lobe[p].first;

        boxes *= ((double)first + place) / (1.0 + place);
    }
    return boxes;
}

/* First partition: as fine as the budget allows, so that even a budget of one box gives a bound of the whole; and of half of
 * the nodes at most. */
static uint32_t first_intervals(const struct model *model, const struct axis *axis, const brdffit_options *o)
{
    uint32_t first = FIRST_INTERVALS;

    while (first > 1 && (first_boxes(model, first) > (double)o->box_budget || 2 * first > axis->node_capacity)) {
        first /= 2;
    }
    return first;
}

int brdffit_fit_report_reduced(const struct fit *f, const brdffit_options *o)
{
    brdffit_progress p;

    if (!o->progress) {
        return 0;
    }
    p.phase = BRDFFIT_PHASE_REDUCED;
    p.boxes = 0;
    p.e2 = f->data.total * brdffit_fit_scale(&f->data, o);
    p.lower_bound = 0.0;
    return o->progress(o->progress_user, &p) != 0;
}

/* The engine's point with an objective that its published model will not exceed: what is closed against it stays so. */
static double try_published(void *self, struct point *point)
{
    struct fit *f = self;
    double objective = f->try_point(f, point), allowed = objective + brdffit_fit_allowance(f, point, objective);

    f->least = fmin(f->least, objective);
    return allowed < DBL_MAX ? allowed : objective; /* where nothing can be known there is an incumbent all the same */
}

/*
 * What the geometry's rounding costs. A charge d takes 2 d |I| E of E^2, and E^2 is proven to gap E^2 or to
 * absolute_gap |I|^2: the two meet where a charge of this size takes a hundredth of either.
 */
static void charge_domain(struct fit *f, const brdffit_options *o)
{
    double fine = fmin(1e-10, fmax(1e-14, 0.005 * sqrt(o->relative_gap * o->absolute_gap)));
    int kind;

    for (kind = 0; kind < f->model.kinds; kind++) {
        const struct domain *d = &f->domain[model_axis(&f->model, kind)];
        const double theta[3] = {d->low, d->high, d->flat};

        brdffit_charge_domain(&f->data, &f->model, kind, f->varpro.kernels, theta, fine, f->varpro.phi);
    }
}

void brdffit_fit_rules(const struct fit *f, const brdffit_options *o, struct search_rules *rules)
{
    rules->relative_gap = o->relative_gap;
    rules->absolute_gap = o->absolute_gap * f->data.total;
    rules->sigma_resolution = o->sigma_resolution;
    rules->box_budget = o->box_budget;
    rules->progress = o->progress;
    rules->progress_user = o->progress_user;
    rules->progress_scale = brdffit_fit_scale(&f->data, o);
}

/* Everything up to the first box: domain, partition, engine, rules. The engine is to be finished after success. */
brdffit_status brdffit_fit_start(struct fit *f, const brdffit_options *o, struct engine *engine,
                                 struct search_rules *rules, brdffit_error *error)
{
    brdffit_status status;
    int kind;

    rules->cancelled = brdffit_fit_report_reduced(f, o);
    brdffit_fit_prepare(f, o);
    charge_domain(f, o);
    for (kind = 0; kind < f->model.axes; kind++) {
        const struct domain *d = &f->domain[kind];
        int point = d->high <= brdffit_fit_outwards(d->low, 4.0); /* one roughness, and what rounding may make of it */

        brdffit_axis_start(&f->axis[kind], d->low, d->high, point ? 1 : first_intervals(&f->model, &f->axis[kind], o));
    }
    status = brdffit_fit_engine_start(f, o, engine);
    if (status != BRDFFIT_OK) {
        return brdffit_fail(error, status,
                            status == BRDFFIT_ERR_UNSUPPORTED
                                ? "norms l1 and linf and engine socp need ECOS, which this build is without"
                                : "ECOS could not set up its solver");
    }
    f->try_point = engine->try_point;
    f->least = INFINITY;
    engine->try_point = try_published;
    brdffit_fit_rules(f, o, rules);
    brdffit_fit_observe(f, o, rules);
    return BRDFFIT_OK;
}

static brdffit_status check_call(const brdffit_samples *samples, const brdffit_options *options, const void *workspace,
                                 size_t size, const void *result, brdffit_error *error)
{
    brdffit_status status = brdffit_options_check(options, error);
    size_t needed;

    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(samples, 1, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (samples->form == BRDFFIT_FORM_COEFFICIENTS && brdffit_options_special(options)) {
        return brdffit_fail(
            error, BRDFFIT_ERR_UNSUPPORTED,
            "samples given as a, b, c have no angles for Fresnel, masking, diffuse terms and anisotropy");
    }
    if (options->anisotropic && samples->form != BRDFFIT_FORM_DIRECTIONS) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "an anisotropic lobe needs samples with directions");
    }
    if (!workspace || !result) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "workspace or result is NULL");
    }
    needed = brdffit_fit_workspace(samples->count, samples->channels, options);
    if (needed == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "more samples or channels than can be addressed");
    }
    if (size < needed) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE, "the workspace is smaller than brdffit_workspace_size()");
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_fit_check_total(const struct fit *f, const brdffit_options *options, brdffit_error *error)
{
    double total = f->data.total * brdffit_fit_scale(&f->data, options);

    if (f->data.total > 0.0 && !isnormal(total)) {
        return brdffit_fail_at(error, "the weighted sum of squares is beyond a double: scale values or weights",
                               BRDFFIT_NONE, BRDFFIT_NONE, total);
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_fit_open(struct fit *f, const brdffit_samples *samples, const brdffit_options *options,
                                void *workspace, size_t size, const void *result, brdffit_error *error)
{
    brdffit_status status = check_call(samples, options, workspace, size, result, error);
    struct arena arena;

    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(f, &arena, samples->count, samples->channels, options);
    status = brdffit_reduce(&f->data, samples, &f->model, options, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    return brdffit_fit_check_total(f, options, error);
}

brdffit_status brdffit_fit_finish(struct fit *f, const brdffit_options *options, brdffit_error *error)
{
    struct search_result found;
    struct search_rules rules;
    struct engine engine;
    brdffit_status status = brdffit_fit_start(f, options, &engine, &rules, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_search(f->axis, &f->heap, &engine, &rules, &found);
    brdffit_report(f, options, brdffit_fit_scale(&f->data, options), &found);
    brdffit_fit_engine_finish(f, options);
    return BRDFFIT_OK;
}
