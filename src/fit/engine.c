/*
 * The engines of a fit behind the driver's interface (engine.h). SPDX-License-Identifier: MIT
 */
#include "fit/fit.h"
#include "base/exp.h"
#include "bound/moment/descend.h"

void brdffit_fit_evaluate(struct fit *f, const struct point *at, int prove, struct varpro_value *value)
{
    if (f->norm != BRDFFIT_NORM_L2) {
        brdffit_l1_linf_evaluate(&f->restricted, at, prove, value);
    } else {
        brdffit_varpro_evaluate(&f->varpro, at, 0, value);
    }
}

static double try_point(void *self, struct point *point)
{
    struct fit *f = self;

    return brdffit_varpro_descend(&f->varpro, point);
}

/* Cheap steps in moment space first, where the residual is far above its rounding. */
static double try_moments(void *self, struct point *point)
{
    struct fit *f = self;

    brdffit_moment_descend(&f->moment.moments, &f->model, f->varpro.theta_low, f->varpro.theta_high, point);
    return brdffit_varpro_descend(&f->varpro, point);
}

/* With physical bounds a descent costs many evaluations: points that are no better than what there is are left alone. */
static double try_physical(void *self, struct point *point)
{
    struct fit *f = self;
    struct varpro_value value;

    brdffit_varpro_evaluate(&f->varpro, point, 0, &value);
    return value.objective < f->least ? brdffit_varpro_feel(&f->varpro, point) : value.objective;
}

static double try_point_lp(void *self, struct point *point)
{
    struct fit *f = self;

    return brdffit_l1_linf_descend(&f->restricted, point);
}

static double width(void *self, int kind, uint32_t interval)
{
    const struct axis *axis = &((const struct fit *)self)->axis[kind];
    const struct axis_interval *i = &axis->interval[interval];

    return kernel_exp(-0.5 * axis->coordinate[i->low]) - kernel_exp(-0.5 * axis->coordinate[i->high]);
}

static double bound_moment(void *self, struct box *box, struct point *met)
{
    return brdffit_bound_moment(&((struct fit *)self)->moment, box, met);
}

static double start_moment(void *self, struct point *met)
{
    return brdffit_bound_moment_first(&((struct fit *)self)->moment, met);
}

static void forget_moment(void *self, int kind, uint32_t node, uint32_t interval)
{
    struct fit *f = self;
    struct bound_moment *moment = &f->moment;

    for (; kind < f->model.kinds; kind += f->model.axes) {
        brdffit_moments_forget(&moment->moments, kind, node);
        brdffit_interval_forget(&moment->intervals[kind], interval);
        brdffit_interval_forget(&moment->intervals[kind], interval + 1);
    }
}

static double bound_socp(void *self, struct box *box, struct point *met)
{
    return brdffit_bound_socp(&((struct fit *)self)->socp, box, met);
}

static double bound_lp(void *self, struct box *box, struct point *met)
{
    return brdffit_bound_lp(&((struct fit *)self)->linear, box, met);
}

static brdffit_status start_lp(struct fit *f, const brdffit_options *o, struct engine *engine)
{
    brdffit_status status = brdffit_l1_linf_start(&f->restricted, &f->varpro);

    engine->bound = bound_lp;
    engine->try_point = try_point_lp;
    engine->noise = 0.0;
    if (status == BRDFFIT_OK) {
        status = brdffit_bound_lp_start(&f->linear, &f->restricted, f->axis, !o->socp_every_box);
        if (status != BRDFFIT_OK) {
            brdffit_l1_linf_finish(&f->restricted);
        }
    }
    return status;
}

static struct box_sides sides_of(const struct model *model)
{
    struct box_sides sides = {.count = model->sides};
    int p;

    for (p = 0; p < model->lobes; p++) {
        sides.axis[p] = model->lobe[p].kind;
        sides.first[p] = model->lobe[p].first;
    }
    return sides;
}

brdffit_status brdffit_fit_engine_start(struct fit *f, const brdffit_options *o, struct engine *engine)
{
    engine->self = f;
    engine->sides = sides_of(&f->model);
    engine->try_point = try_point;
    engine->width = width;
    engine->start = NULL;
    engine->forget = NULL;
    if (o->norm != BRDFFIT_NORM_L2) {
        return start_lp(f, o, engine);
    }
    if (o->engine == BRDFFIT_ENGINE_SOCP) {
        engine->bound = bound_socp;
        engine->noise = 0.0;
        return brdffit_bound_socp_start(&f->socp, &f->varpro, f->axis, !o->socp_every_box);
    }
    f->data.apart = f->physical;
    brdffit_reduce_channels(&f->data);
    brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    f->moment.limits.on = f->physical;
    engine->bound = bound_moment;
    engine->start = start_moment;
    engine->forget = forget_moment;
    engine->try_point = f->physical ? try_physical : model_exponential(&f->model) ? try_moments : try_point;
    engine->noise = 2.0 * f->moment.moments.slack;
    return BRDFFIT_OK;
}

void brdffit_fit_engine_finish(struct fit *f, const brdffit_options *o)
{
    if (o->norm != BRDFFIT_NORM_L2) {
        brdffit_bound_lp_finish(&f->linear);
        brdffit_l1_linf_finish(&f->restricted);
    } else if (o->engine == BRDFFIT_ENGINE_SOCP) {
        brdffit_bound_socp_finish(&f->socp);
    }
}
