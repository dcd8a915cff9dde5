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

struct reproof {
    struct fit *fit;
    struct engine engine; /* socp */
    double level;
    double whole, proven; /* measure of the domain and of its leaves */
    size_t leaves;
};

static double length(const struct reproof *r, int kind, uint32_t interval)
{
    const struct axis *axis = &r->fit->axis[kind];
    const struct axis_interval *i = &axis->interval[interval];
    double extent = r->fit->domain[kind].high - r->fit->domain[kind].low;

    return extent > 0.0 ? axis->coordinate[i->high] - axis->coordinate[i->low] : 1.0;
}

static double measure(const struct reproof *r, const struct box *box)
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
    struct reproof *r = self;

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
    const struct reproof *r = self;

    (void)point;
    return r->level;
}

static double width(void *self, int kind, uint32_t interval)
{
    const struct reproof *r = self;

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

static void reprove(struct fit *f, const brdffit_options *o, struct search_rules *rules, struct reproof *r,
                    brdffit_reproof *reproof)
{
    double scale = brdffit_fit_scale(&f->data, o);
    struct engine engine;
    struct search_result found;

    r->fit = f;
    r->leaves = 0;
    r->proven = 0.0;
    r->whole = measure_of_domain(f);
    r->level = reproof->level / scale;
    engine.self = r;
    engine.sides = r->engine.sides;
    engine.bound = bound;
    engine.start = NULL;
    engine.try_point = try_point;
    engine.width = width;
    engine.noise = 0.0;
    rules->relative_gap = rules->absolute_gap = 0.0;
    brdffit_search(f->axis, &f->heap, &engine, rules, &found);
    reproof->proven = found.lower_bound >= r->level;
    reproof->stop = found.stop;
    reproof->boxes = found.boxes;
    reproof->leaves = r->leaves;
    reproof->solved = f->socp.solved;
    reproof->refused = f->socp.refused;
    reproof->decided = f->socp.decided;
    reproof->unproven = reproof->proven ? 0.0 : fmax(0.0, 1.0 - r->proven / r->whole);
}

brdffit_status brdffit_verify_run(const brdffit_samples *samples, const brdffit_options *options, double level,
                                  void *workspace, size_t workspace_size, brdffit_reproof *reproof,
                                  brdffit_error *error)
{
    static const brdffit_reproof zero;
    struct search_rules rules;
    struct reproof state;
    brdffit_options o;
    brdffit_status status;
    struct fit fit;

    brdffit_options_init(&o);
    status = options ? brdffit_options_check(options, error) : BRDFFIT_OK;
    if (status != BRDFFIT_OK) {
        return status;
    }
    o = options ? *options : o;
    if (!(level > 0.0 && isfinite(level))) {
        return brdffit_fail_at(error, "the level to prove must be positive and finite", BRDFFIT_NONE, BRDFFIT_NONE,
                               level);
    }
    if (o.norm != BRDFFIT_NORM_L2) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "only norm l2 can be verified by engine socp");
    }
    o.engine = BRDFFIT_ENGINE_SOCP;
    status = brdffit_fit_open(&fit, samples, &o, workspace, workspace_size, reproof, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_fit_start(&fit, &o, &state.engine, &rules, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    *reproof = zero;
    reproof->level = level;
    reprove(&fit, &o, &rules, &state, reproof);
    brdffit_fit_engine_finish(&fit, &o);
    return BRDFFIT_OK;
}
