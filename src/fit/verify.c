/*
 * A lower bound proven a second time, by engine socp alone. SPDX-License-Identifier: MIT
 *
 * The driver of every fit does it unchanged, around an engine whose points all have the objective `level` and no gap:
 * then nothing beats the incumbent, a box is closed when its bound reaches the level, and boxes that do not are split.
 * Every box passes through bound() once, so leaves are counted there.
 *
 * The measure of the domain is by theta = ln s; of like lobes only points with ascending theta count, so that a box with
 * a run of r equal sides counts 1/r!. A domain without extent (one theta) counts as 1.
 */
#include <math.h>

#include "fit/fit.h"
#include "base/error.h"
#include "model/geometry.h"

struct verifier {
    struct fit *fit;
    struct engine engine; /* socp */
    double level;
    double whole, proven; /* measure of the domain and of its leaves */
    size_t leaves;
};

static double length(const struct verifier *r, int kind, uint32_t interval)
{
    const struct axis *axis = &r->fit->axis[kind];
    const struct axis_interval *i = &axis->interval[interval];
    double extent = r->fit->domain[kind].high - r->fit->domain[kind].low;

    return extent > 0.0 ? axis->coordinate[i->high] - axis->coordinate[i->low] : 1.0;
}

static double measure(const struct verifier *r, const struct box *box)
{
    const struct model *model = &r->fit->model;
    double product = 1.0;
    int p, run = 0;

    for (p = 0; p < model->lobes; p++) {
        int again = p > model->lobe[p].first && box->interval[p] == box->interval[p - 1];

        run = again ? run + 1 : 1;
        product *= length(r, model->lobe[p].kind, box->interval[p]) / run;
    }
    return product;
}

static double bound(void *self, struct box *box, struct point *met)
{
    struct verifier *r = self;

    box->bound = r->level;
    (void)r->engine.bound(r->engine.self, box, met);
    if (box->bound >= r->level) {
        r->leaves++;
        r->proven += measure(r, box);
    }
    return INFINITY;
}

static double try_point(void *self, struct point *point)
{
    const struct verifier *r = self;

    (void)point;
    return r->level;
}

static double width(void *self, int kind, uint32_t interval)
{
    const struct verifier *r = self;

    return r->engine.width(r->engine.self, kind, interval);
}

static double measure_of_domain(const struct fit *f)
{
    double product = 1.0;
    int p;

    for (p = 0; p < f->model.lobes; p++) {
        double extent = fit_domain(f, p)->high - fit_domain(f, p)->low;

        product *= (extent > 0.0 ? extent : 1.0) / (1.0 + p - f->model.lobe[p].first);
    }
    return product;
}

static void verify(struct fit *f, const brdffit_options *o, struct search_rules *rules, struct verifier *r,
                   double level)
{
    brdffit_verification *out = &f->handout->verification;
    double scale = brdffit_fit_scale(&f->data, o);
    struct engine engine;
    struct search_result found;

    r->fit = f;
    r->leaves = 0;
    r->proven = 0.0;
    r->whole = measure_of_domain(f);
    r->level = brdffit_fit_level(level, scale);
    engine.self = r;
    engine.sides = r->engine.sides;
    engine.bound = bound;
    engine.start = NULL;
    engine.try_point = try_point;
    engine.forget = NULL; /* as engine socp */
    engine.width = width;
    engine.noise = 0.0;
    rules->relative_gap = rules->absolute_gap = 0.0;
    brdffit_search(f->axis, &f->heap, &engine, rules, &found);
    out->level = level;
    out->proven = found.lower_bound >= r->level;
    out->stop = found.stop;
    out->boxes = found.boxes;
    out->leaves = r->leaves;
    out->solved = f->socp.solved;
    out->refused = f->socp.refused;
    out->decided = f->socp.decided;
    out->unproven = out->proven ? 0.0 : fmax(0.0, 1.0 - r->proven / r->whole);
}

brdffit_status brdffit_verify_run(const brdffit_samples *samples, const brdffit_options *options, double level,
                                  void *workspace, size_t workspace_size, const brdffit_verification **verification,
                                  brdffit_error *error)
{
    struct search_rules rules;
    struct verifier state;
    brdffit_options o = *options;
    brdffit_status status = brdffit_options_check(&o, error);
    struct fit fit;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!(level > 0.0 && isfinite(level))) {
        return brdffit_fail_at(error, "the level to prove must be positive and finite", BRDFFIT_NONE, BRDFFIT_NONE,
                               level);
    }
    if (o.norm != BRDFFIT_NORM_L2) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "only norm l2 can be verified by engine socp");
    }
    o.engine = BRDFFIT_ENGINE_SOCP;
    status = brdffit_fit_open(&fit, samples, &o, workspace, workspace_size, verification, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_fit_start(&fit, &o, &state.engine, &rules, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    verify(&fit, &o, &rules, &state, level);
    brdffit_fit_engine_finish(&fit, &o);
    *verification = &fit.handout->verification;
    return BRDFFIT_OK;
}
