/*
 * A lower bound proven a second time, by engine socp alone. SPDX-License-Identifier: MIT
 *
 * The driver of every fit does it unchanged, around an engine whose points all have the objective `level` and no gap:
 * then nothing beats the incumbent, a box is closed when its bound reaches the level, and boxes that do not are split.
 * Every box passes through bound() once, so leaves are counted there.
 *
 * The measure of the domain is by theta = ln s; with two lobes of the pairs theta_0 <= theta_1, where a box on the
 * diagonal counts half. Both halves of a domain without extent (one theta) count as 1.
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

static double length(const struct reproof *r, uint32_t interval)
{
    const struct axis *axis = &r->fit->axis;
    const struct axis_interval *i = &axis->interval[interval];

    return r->whole > 0.0 ? axis->coordinate[i->high] - axis->coordinate[i->low] : 1.0;
}

static double measure(const struct reproof *r, const struct box *box)
{
    double first = length(r, box->interval[0]);

    if (r->engine.lobes == 1) {
        return first;
    }
    return (box->interval[0] == box->interval[1] ? 0.5 : 1.0) * first * length(r, box->interval[1]);
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

static double width(void *self, uint32_t interval)
{
    const struct reproof *r = self;

    return r->engine.width(r->engine.self, interval);
}

static double measure_of_domain(const struct fit *f, int lobes)
{
    double extent = f->theta_high - f->theta_low;

    return lobes == 1 ? extent : 0.5 * extent * extent;
}

static void reprove(struct fit *f, const brdffit_options *o, struct search_rules *rules, struct reproof *r,
                    brdffit_reproof *reproof)
{
    double scale = brdffit_fit_scale(&f->data, o), whole;
    struct engine engine;
    struct search_result found;

    r->fit = f;
    r->leaves = 0;
    r->proven = 0.0;
    r->whole = measure_of_domain(f, o->lobes);
    r->level = reproof->level / scale;
    whole = r->whole > 0.0 ? r->whole : o->lobes == 1 ? 1.0 : 0.5;
    engine.self = r;
    engine.lobes = o->lobes;
    engine.bound = bound;
    engine.start = NULL;
    engine.try_point = try_point;
    engine.width = width;
    engine.noise = 0.0;
    rules->relative_gap = rules->absolute_gap = 0.0;
    brdffit_search(&f->axis, &f->heap, &engine, rules, &found);
    reproof->proven = found.lower_bound >= r->level;
    reproof->stop = found.stop;
    reproof->boxes = found.boxes;
    reproof->leaves = r->leaves;
    reproof->solved = f->socp.solved;
    reproof->refused = f->socp.refused;
    reproof->decided = f->socp.decided;
    reproof->unproven = reproof->proven ? 0.0 : fmax(0.0, 1.0 - r->proven / whole);
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
