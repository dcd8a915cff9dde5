/*
 * The fit of a model with an anisotropic lobe (theory 7.4): both roughnesses are searched and proven with engine `cell`; then
 * the model is fitted once more at the ratio that was found, as one of a stretched geometry (model/turn.h), which makes its
 * other numbers, and its E^2, those of every other fit. The bound is the search's. SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>

#include "base/exp.h"
#include "base/log.h"
#include "data/slack.h"
#include "fit/fit.h"
#include "fit/published.h"

/*
 * The largest exponent of the sample that is nearest to the mirror direction and not in it (tan^2 alpha up to MIRROR), of exp(-E)
 * and of (1 + E)^-2. Narrower lobes, of whose peak no sample beside the mirror's sees 1e-7, are fits to single samples, and the
 * search would spend its time on which one; and no sum over the lobe underflows.
 */
#define MIRROR 1e-9
#define EXPONENT_MOST 16.0
#define TAIL_MOST 3162.0

/* Boxes of the first partition. */
#define FIRST_BOXES 512.0

/* Intervals of an axis to begin with, by how many axes there are. */
static uint32_t first_of(const struct fit *f, const brdffit_options *o)
{
    double most = fmin(FIRST_BOXES, (double)o->box_budget), boxes;
    uint32_t first = 2 * FIRST_INTERVALS;
    int side;

    do {
        first /= 2;
        for (boxes = 1.0, side = 0; side < f->model.sides; side++) {
            boxes *= first;
        }
    } while (first > 1 && boxes > most);
    return first;
}

/* The least c of the lobe's samples that are not in the mirror direction; 0 when all are. */
static double least_off_mirror(const struct table *t, size_t groups)
{
    double least = INFINITY;
    size_t j;

    for (j = 0; j < groups; j++) {
        double c = t->c[j] + t->c_min;

        least = t->bb[j] > 0.0 && c > MIRROR && c < least ? c : least;
    }
    return isfinite(least) ? least : 0.0;
}

/* The domain of the two roughnesses: what the options ask, cut where no sample sees the lobe. */
static void domain_of_shapes(struct fit *f)
{
    struct domain d = f->domain[0];
    double least = 0.0;
    int c;

    for (c = 0; c < f->model.each; c++) {
        least = fmax(
            least, least_off_mirror(&f->data.table[f->model.geometry[model_kind_of(&f->model, c)]], f->data.distinct));
    }
    d.high = d.flat = d.tail;
    if (least > 0.0) {
        double most = f->model.kind[0]->exponential ? EXPONENT_MOST : TAIL_MOST;

        d.high = d.flat = fmax(d.low, fmin(d.tail, kernel_log(most / least)));
    }
    f->domain[2] = f->domain[1]; /* of the other lobe, if there is one */
    f->domain[0] = f->domain[1] = d;
}

static void prepare(struct fit *f, const brdffit_options *o)
{
    int side;

    brdffit_fit_prepare(f, o);
    domain_of_shapes(f);
    for (side = 0; side < f->model.sides; side++) {
        const struct domain *d = &f->domain[side];
        int point = d->high <= brdffit_fit_outwards(d->low, 4.0);

        brdffit_axis_start(&f->axis[side], d->low, d->high, point ? 1 : first_of(f, o));
        f->varpro.theta_low[side] = d->low;
        f->varpro.theta_high[side] = d->high;
    }
}

static double bound(void *self, struct box *box, struct point *met)
{
    return brdffit_bound_cell(&((struct fit *)self)->cells, box, met);
}

/* What is closed against this point's objective stays closed when its model is published. */
static double try_point(void *self, struct point *point)
{
    struct fit *f = self;
    double objective = brdffit_varpro_descend(&f->varpro, point);
    double allowed = objective + brdffit_fit_allowance(f, point, objective);

    return allowed < DBL_MAX ? allowed : objective;
}

static double width(void *self, int side, uint32_t interval)
{
    const struct axis *axis = &((const struct fit *)self)->axis[side];
    double low, high;

    brdffit_axis_ends(axis, interval, &low, &high);
    return kernel_exp(-0.5 * low) - kernel_exp(-0.5 * high);
}

static void forget(void *self, int side, uint32_t node, uint32_t interval)
{
    (void)side;
    (void)node;
    (void)interval;
    brdffit_bound_cell_forget(&((struct fit *)self)->cells);
}

static void make_engine(struct fit *f, struct engine *engine)
{
    int side;

    brdffit_reduce_channels(&f->data);
    brdffit_bound_cell_start(&f->cells, &f->data, &f->model, f->varpro.kernels, f->axis);
    *engine = (struct engine){.self = f, .bound = bound, .try_point = try_point, .width = width, .forget = forget};
    engine->sides.count = f->model.sides;
    engine->noise = 2.0 * f->cells.moments.slack;
    for (side = 0; side < f->model.sides; side++) {
        engine->sides.axis[side] = engine->sides.first[side] = side;
    }
}

void brdffit_fit_anisotropic_engine(struct fit *f, const brdffit_options *o, struct engine *engine)
{
    prepare(f, o);
    make_engine(f, engine);
}

/* What a search leaves for the result. */
struct outcome {
    double lower_bound, anisotropy, floor;
    brdffit_stop stop;
    size_t boxes, nodes;
};

static struct outcome search(struct fit *f, const brdffit_options *o)
{
    struct search_rules rules = {.cancelled = brdffit_fit_report_reduced(f, o)};
    struct search_result found;
    struct outcome out;
    struct engine engine;

    brdffit_fit_anisotropic_engine(f, o, &engine);
    brdffit_fit_rules(f, o, &rules);
    brdffit_search(f->axis, &f->heap, &engine, &rules, &found);
    out.lower_bound = found.lower_bound * (1.0 - slack_of_channels(f->data.channels)) * brdffit_fit_scale(&f->data, o);
    out.anisotropy = kernel_exp(0.5 * (found.point.theta[1] - found.point.theta[0]));
    out.anisotropy = fmin(ANISOTROPY_MOST, fmax(1.0 / ANISOTROPY_MOST, out.anisotropy));
    out.floor = brdffit_fit_sigma(f, 0, f->domain[0].flat);
    out.stop = found.stop;
    out.boxes = found.boxes;
    out.nodes = f->cells.evaluated;
    return out;
}

static void complete(struct fit *f, const brdffit_options *o, const struct outcome *out)
{
    brdffit_result *result = &f->handout->result;

    result->lower_bound = out->lower_bound;
    result->stop = out->stop;
    result->boxes += out->boxes;
    result->nodes += out->nodes;
    f->handout->lobe[0].sigma_floor = out->floor;
    result->sigma_floor = fmax(result->sigma_floor, out->floor);
    brdffit_fit_judge(o, result);
}

brdffit_status brdffit_fit_anisotropic(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                       size_t size, struct fit *f, brdffit_error *error)
{
    const struct outcome out = search(f, options);
    brdffit_options given = *options;
    brdffit_status status;

    given.anisotropy = out.anisotropy;
    given.box = NULL; /* boxes of the second fit are not those of the proof, nor is its progress */
    given.progress = NULL;
    status = brdffit_fit_open(f, samples, &given, workspace, size, f, error);
    if (status == BRDFFIT_OK) {
        status = brdffit_fit_finish(f, &given, error);
    }
    if (status == BRDFFIT_OK) {
        complete(f, &given, &out);
    }
    return status;
}
