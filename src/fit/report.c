/*
 * From the outcome of a search to the caller's result: coefficients in the data's units, what each lobe rests on,
 * and whether the data can tell its roughness (theory 4.5). SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"
#include "fit/published.h"
#include "fit/verdict.h"
#include "base/exp.h"
#include "base/intake.h"
#include "base/tolerance.h"
#include "data/slack.h"

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/* What is claimed ends at `flat`, and the search a little beyond (domain.c). */
static double claimed(const struct domain *d, double theta)
{
    return d->flat >= d->low && theta > d->flat ? d->flat : theta;
}

/* Whether theta is an end of the options' range to rounding: those ends were moved outwards by that (domain.c). */
static int at_low_end(const struct domain *d, double theta)
{
    return theta <= brdffit_fit_outwards(d->low, 2.0);
}

static int at_high_end(const struct domain *d, double theta)
{
    return theta >= brdffit_fit_outwards(d->tail, -2.0);
}

/* The parameter of theta, sigma or the exponent: the range's own number at an end of it, and never outside of it. */
static double parameter_of(const struct fit *f, int kind, double theta)
{
    const struct domain *d = &f->domain[kind];
    double low = fmin(d->parameter_low, d->parameter_tail), high = fmax(d->parameter_low, d->parameter_tail), value;

    theta = claimed(d, theta);
    value = f->model.kind[kind]->by_exponent ? kernel_exp(theta) : kernel_exp(-0.5 * theta);
    return at_low_end(d, theta)    ? d->parameter_low
           : at_high_end(d, theta) ? d->parameter_tail
                                   : clamp(value, low, high);
}

double brdffit_fit_sigma(const struct fit *f, int kind, double theta)
{
    double parameter = parameter_of(f, kind, theta);

    return f->model.kind[kind]->by_exponent ? 1.0 / sqrt(parameter) : parameter;
}

static double objective_at(struct fit *f, struct point at, int p, double theta)
{
    struct varpro_value value;

    at.theta[p] = theta;
    brdffit_fit_evaluate(f, &at, 0, &value);
    return value.objective;
}

/* An objective and how far another may be from it and still be the same to rounding. */
struct level {
    double objective, tolerance;
};

static int same_level(struct fit *f, const struct point *at, int p, double theta, const struct level *level)
{
    return fabs(objective_at(f, *at, p, theta) - level->objective) <= level->tolerance;
}

/* Whether the objective one FLAT_STEP towards `end` (or at the end, if nearer) stays level. */
static int flat_towards(struct fit *f, const struct point *at, int p, double end, const struct level *level)
{
    double here = at->theta[p];
    double there = end > here ? fmin(end, here + FLAT_STEP) : fmax(end, here - FLAT_STEP);

    return there == here || same_level(f, at, p, there, level);
}

/* Furthest theta towards `end` where the objective stays level: growing steps, then bisection. */
static double flat_end(struct fit *f, const struct point *at, int p, double end, const struct level *level)
{
    double inside = at->theta[p], outside = inside, step = end > inside ? FLAT_STEP : -FLAT_STEP;
    int i;

    while (inside == outside && inside != end) {
        outside = end > inside ? fmin(end, inside + step) : fmax(end, inside + step);
        step = fabs(step) < FLAT_STRIDE ? 2.0 * step : step;
        if (same_level(f, at, p, outside, level)) {
            inside = outside;
        }
    }
    for (i = 0; i < 40 && fabs(outside - inside) > FLAT_END; i++) {
        double middle = 0.5 * (inside + outside);

        if (same_level(f, at, p, middle, level)) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    return inside;
}

/* The roughness at theta, and the interval from there up to theta `high`, in the parameter's terms too. */
static void publish_roughness(const struct fit *f, int kind, double theta, double high, brdffit_lobe *lobe)
{
    lobe->sigma = lobe->sigma_high = brdffit_fit_sigma(f, kind, theta);
    lobe->sigma_low = brdffit_fit_sigma(f, kind, high);
    if (f->model.kind[kind]->by_exponent) {
        lobe->exponent = lobe->exponent_low = parameter_of(f, kind, theta);
        lobe->exponent_high = parameter_of(f, kind, high);
    }
}

static struct level level_of(const struct fit *f, double objective)
{
    double absolute = f->norm == BRDFFIT_NORM_L2 ? TOL_FLAT_ABSOLUTE : TOL_FLAT_LINEAR;
    struct level level = {objective, objective * TOL_FLAT_RELATIVE + absolute * f->data.total};

    return level;
}

/*
 * Where the objective is flat to rounding on both sides of the optimum, or up to the end of the domain, sigma is
 * not identified: move to the largest, one lobe after the other. Returns the lobes that are flat, as bits; those of
 * `curved` are known not to be.
 */
static unsigned move_to_largest(struct fit *f, struct point *at, const struct level *level, unsigned curved)
{
    unsigned flat = 0;
    int p;

    for (p = 0; p < f->model.lobes; p++) {
        const struct domain *d = fit_domain(f, p);

        if (!(curved >> p & 1) && flat_towards(f, at, p, d->low, level) && flat_towards(f, at, p, d->high, level)) {
            at->theta[p] = flat_end(f, at, p, d->low, level);
            flat |= 1u << p;
        }
    }
    return flat;
}

/* Roughness and its interval, with the other lobes where they ended up. */
static void describe_lobe(struct fit *f, const struct point *at, int p, int flat, const struct level *level,
                          brdffit_lobe *lobe)
{
    const struct domain *d = fit_domain(f, p);
    double high = at->theta[p];

    lobe->warnings = 0;
    if (flat) {
        high = flat_end(f, at, p, d->high, level);
        high = high < d->high ? high : d->flat;
    }
    if (high > at->theta[p]) {
        lobe->warnings |= BRDFFIT_WARN_FLAT;
    } else if (at_low_end(d, at->theta[p]) || at_high_end(d, at->theta[p])) {
        lobe->warnings |= BRDFFIT_WARN_AT_LIMIT;
    }
    publish_roughness(f, f->model.lobe[p].kind, at->theta[p], high, lobe);
}

static void lobe_shares(const struct fit *f, brdffit_lobe *lobe)
{
    double sum[BRDFFIT_MAX_LOBES] = {0.0}, all = 0.0, largest = 0.0;
    size_t k, lobes = (size_t)f->model.lobes, p;

    for (k = 0; k < f->data.channels * lobes; k++) {
        largest = fmax(largest, f->y[k]);
    }
    for (k = 0; k < f->data.channels && largest > 0.0; k++) {
        for (p = 0; p < lobes; p++) {
            sum[p] += f->y[k * lobes + p] / largest;
        }
    }
    for (p = 0; p < lobes; p++) {
        all += sum[p];
    }
    for (p = 0; p < lobes; p++) {
        lobe[p].weight = all > 0.0 ? sum[p] / all : 0.0;
        if (!(sum[p] > 0.0)) {
            lobe[p].warnings |= BRDFFIT_WARN_UNUSED;
        }
        if (lobe[p].effective_samples < LIMIT_EFFECTIVE_SAMPLES) {
            lobe[p].warnings |= BRDFFIT_WARN_UNRESOLVED;
        }
    }
}

static void count_work(const struct fit *f, const struct search_result *found, const brdffit_options *o,
                       brdffit_result *result)
{
    result->boxes = found->boxes;
    if (o->norm != BRDFFIT_NORM_L2) {
        result->nodes = f->restricted.evaluated;
        result->programs_solved = f->restricted.lp.solved + f->linear.lp.solved;
        result->programs_refused = f->restricted.lp.refused + f->linear.lp.refused;
        result->programs_decided = f->linear.decided;
    } else if (o->engine == BRDFFIT_ENGINE_SOCP) {
        result->nodes = f->socp.evaluated;
        result->programs_solved = f->socp.solved;
        result->programs_refused = f->socp.refused;
        result->programs_decided = f->socp.decided;
    } else {
        result->nodes = f->moment.moments.evaluated;
    }
}

void brdffit_fit_judge(const brdffit_options *o, brdffit_result *result)
{
    const struct evidence evidence = {result->e2,      result->e2_error, result->lower_bound, result->sum_of_squares,
                                      o->relative_gap, o->absolute_gap,  result->stop};
    struct verdict verdict = brdffit_verdict(&evidence);

    result->stop = verdict.stop;
    result->certified = verdict.certified;
    result->lower_bound = verdict.lower_bound;
    result->gap = verdict.gap;
}

/* The numbers of the proof, in the caller's units, and what follows from them. Bounds of other engines than moment, whose slack
 * knows of it, are sums over channels too. */
static void certificate(const struct fit *f, const struct search_result *found, const struct published *published,
                        double scale, const brdffit_options *o, brdffit_result *result)
{
    result->e2 = published->objective * scale;
    result->e2_error = published->error * scale;
    result->e2_free = result->e2;
    result->lower_bound = found->lower_bound * (1.0 - slack_of_channels(f->data.channels)) * scale;
    result->sum_of_squares = f->data.total * scale;
    result->stop = found->stop;
    result->rms_total = sqrt(published->squares / ((double)f->data.channels * f->data.weight_sum)) *
                        (o->normalise == BRDFFIT_NORMALISE_NONE ? f->data.channel_scale[0] : 1.0) * f->data.value_scale;
    brdffit_fit_judge(o, result);
}

/* Like lobes in ascending sigma, that is, descending theta; returns whether they were not. */
static int order_lobes(const struct model *model, struct point *at, brdffit_lobe *lobe)
{
    int p, q, swapped = 0;

    for (p = 1; p < model->lobes; p++) {
        for (q = p; q > model->lobe[p].first && at->theta[q - 1] < at->theta[q]; q--) {
            double theta = at->theta[q - 1];
            brdffit_lobe other = lobe[q - 1];

            at->theta[q - 1] = at->theta[q];
            at->theta[q] = theta;
            lobe[q - 1] = lobe[q];
            lobe[q] = other;
            swapped = 1;
        }
    }
    return swapped;
}

/* Lobes, as bits, whose curvature at the point leaves no doubt that FLAT_STEP changes the objective. */
static unsigned curved_lobes(const struct fit *f, const struct varpro_value *value, const struct level *level)
{
    unsigned curved = 0;
    int p;

    for (p = 0; p < f->model.lobes; p++) {
        if (0.5 * value->hessian[p][p] * (FLAT_STEP * FLAT_STEP) > FLAT_DOUBT * level->tolerance) {
            curved |= 1u << p;
        }
    }
    return curved;
}

/* What is proven of a lobe is proven down to this roughness; infinity where no lobe of its kind is left. */
static double sigma_floor(const struct fit *f, int p)
{
    const struct domain *d = fit_domain(f, p);

    return d->flat < d->low ? (double)INFINITY : brdffit_fit_sigma(f, f->model.lobe[p].kind, d->flat);
}

/* The same of an anisotropic lobe whose ratio is given: of both roughnesses, and so of the smaller one. */
static double smaller_floor(const struct fit *f, const brdffit_options *o)
{
    double ratio = fmax(f->model.stretch.ratio, 1.0 / f->model.stretch.ratio), floor = sigma_floor(f, 0);
    const struct domain *d = &f->domain[0];

    if (d->flat >= d->tail) { /* all of the range */
        return f->model.kind[0]->by_exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min;
    }
    return floor / sqrt(ratio);
}

/* Below this roughness the data see no change of any lobe. */
static double sigma_tail(const struct fit *f)
{
    double least = INFINITY;
    int kind;

    for (kind = 0; kind < f->model.axes; kind++) {
        least = fmin(least, brdffit_fit_sigma(f, kind, f->domain[kind].high));
    }
    return least;
}

/* sigma along and across the tangent of lobe p: the same, but of an anisotropic one. */
static void publish_roughnesses(struct fit *f, const brdffit_options *o, int p)
{
    struct handout *h = f->handout;
    int turned = f->model.turned && p == 0;
    double root = turned ? sqrt(o->anisotropy) : 1.0;

    h->anisotropy[p] = turned ? o->anisotropy : 1.0;
    h->tangent_angle[p] = h->lobe[p].tangent_angle = turned ? o->tangent_angle : 0.0;
    h->lobe[p].sigma_x = h->lobe[p].sigma * root;
    h->lobe[p].sigma_y = h->lobe[p].sigma / root;
}

/* The model, which points to what the handout and the fit hold. */
static void publish_model(struct fit *f, const brdffit_options *o)
{
    struct handout *h = f->handout;
    int p;

    h->model.struct_size = brdffit_options_special(o) ? sizeof(brdffit_model)
                                                      : INTAKE_LEAST(brdffit_model, distributions);
    h->model.distribution = f->model.distribution[0];
    h->model.lobes = o->lobes;
    h->model.channels = f->data.channels;
    h->model.sigma = h->sigma;
    h->model.x = f->x;
    h->model.y = f->y;
    h->model.distributions = h->distributions;
    h->model.fresnel = o->fresnel;
    h->model.diffuse = o->diffuse;
    h->model.masking = o->masking;
    h->model.anisotropy = f->model.turned ? h->anisotropy : NULL;
    h->model.tangent_angle = f->model.turned ? h->tangent_angle : NULL;
    h->model.f0 = f->f0;
    h->model.x_more = f->x_more;
    for (p = 0; p < o->lobes; p++) {
        h->sigma[p] = h->lobe[p].sigma;
        h->distributions[p] = f->model.distribution[p];
        publish_roughnesses(f, o, p);
        h->lobes[p] = &h->lobe[p];
    }
    h->result.model = &h->model;
    h->result.lobe = h->lobes;
}

/* The arrays of the result, in the caller's units. */
static void publish(struct fit *f, const brdffit_options *o)
{
    brdffit_result *result = &f->handout->result;
    size_t k;
    int p;

    if (o->normalise == BRDFFIT_NORMALISE_NONE) {
        for (k = 0; k < f->data.channels; k++) {
            f->data.channel_scale[k] = 1.0;
        }
    }
    result->channel_scale = f->data.channel_scale;
    result->rms = f->rms;
    result->at_limit = f->at_limit;
    for (k = 0; k < f->data.channels && f->at_limit; k++) {
        f->at_limit[k] = f->physical && f->varpro.answer[k].multiplier > 0.0;
        result->channels_at_limit += (size_t)f->at_limit[k];
    }
    for (p = 0; p < f->model.lobes; p++) {
        f->handout->lobe[p].sigma_floor = f->model.turned && p == 0 ? smaller_floor(f, o) : sigma_floor(f, p);
        result->sigma_floor = fmax(result->sigma_floor, f->handout->lobe[p].sigma_floor);
    }
    result->sigma_tail = sigma_tail(f);
    result->distinct_c = f->data.distinct;
    result->channels_zero = f->data.channels_zero;
    result->channels_identical = f->data.channels_identical;
    result->samples_used = f->data.counted;
    for (k = 0; k < BRDFFIT_SKIP_COUNT; k++) {
        f->handout->skipped[k] = f->data.skipped[k];
    }
    result->samples_skipped = f->handout->skipped;
}

void brdffit_report(struct fit *f, const brdffit_options *o, double objective_scale, const struct search_result *found)
{
    static const struct handout zero;
    struct handout *h = f->handout;
    struct point at = found->point;
    const struct level level = level_of(f, f->least);
    struct published published;
    struct varpro_value value;
    double sigma[BRDFFIT_MAX_LOBES];
    unsigned all = (1u << o->lobes) - 1, curved = 0, flat;
    int p, swapped;

    *h = zero;
    (void)order_lobes(&f->model, &at, h->lobe);
    if (f->norm == BRDFFIT_NORM_L2) {
        brdffit_varpro_evaluate(&f->varpro, &at, 1, &value);
        curved = f->physical ? 0u : curved_lobes(f, &value, &level);
    }
    flat = move_to_largest(f, &at, &level, curved);
    for (p = 0; p < o->lobes; p++) {
        describe_lobe(f, &at, p, (flat >> p) & 1, &level, &h->lobe[p]);
    }
    swapped = order_lobes(&f->model, &at, h->lobe);
    if (curved != all || swapped) {
        brdffit_fit_evaluate(f, &at, 1, &value);
    }
    for (p = 0; p < o->lobes; p++) {
        sigma[p] = h->lobe[p].sigma;
    }
    published = brdffit_fit_publish(f, sigma);
    for (p = 0; p < o->lobes; p++) {
        h->lobe[p].effective_samples = published.effective[p];
    }
    lobe_shares(f, h->lobe);
    count_work(f, found, o, &h->result);
    certificate(f, found, &published, objective_scale, o, &h->result);
    h->result.kkt_residual = value.kkt;
    publish_model(f, o);
    publish(f, o);
}
