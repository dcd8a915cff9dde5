/*
 * Intervals of every parameter: threshold, the list of ends, and what is handed out (theory 7.10).
 * SPDX-License-Identifier: MIT
 */
#include "fit/intervals.h"

#include <float.h>
#include <math.h>

#include "base/chi2.h"
#include "base/error.h"
#include "base/exp.h"
#include "base/intake.h"
#include "base/log.h"
#include "base/tolerance.h"
#include "fit/intake.h"

#define DEFAULT_LEVEL 0.95
#define DEFAULT_TOLERANCE 0.02
#define DEFAULT_BUDGET 20000

/* In the workspace behind a fit's. */
struct arrays {
    brdffit_interval_result *result;
    brdffit_range *sigma, *exponent, *x, *y, *f0;
    size_t *group;
};

/* One call. */
struct call {
    struct fit fit;
    struct intervals_work work;
    struct arrays out;
    const brdffit_options *options;
    const brdffit_model *model;
    brdffit_interval_options asked;
};

void brdffit_interval_options_init_sized(brdffit_interval_options *options, size_t struct_size)
{
    static const brdffit_interval_options zero;

    intake_init(options, struct_size, &zero, sizeof zero);
}

brdffit_status brdffit_intake_interval_options(const brdffit_interval_options *callers, brdffit_interval_options *own,
                                               brdffit_error *error)
{
    brdffit_interval_options_init(own);
    if (callers && !intake(own, sizeof *own, INTAKE_LEAST(brdffit_interval_options, box_budget), callers)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "interval options: " INTAKE_REFUSED);
    }
    own->level = own->level == 0.0 ? DEFAULT_LEVEL : own->level;
    own->tolerance = own->tolerance == 0.0 ? DEFAULT_TOLERANCE : own->tolerance;
    own->box_budget = own->box_budget == 0 ? DEFAULT_BUDGET : own->box_budget;
    return BRDFFIT_OK;
}

/* ---- arguments ---- */

static brdffit_status bad(brdffit_error *error, const char *message, double value)
{
    brdffit_status status = brdffit_fail(error, BRDFFIT_ERR_OPTION, message);

    if (error) {
        error->value = value;
    }
    return status;
}

static brdffit_status check_asked(const brdffit_interval_options *a, brdffit_error *error)
{
    if (!(a->level > 0.0 && a->level <= 1.0 - 1e-9)) {
        return bad(error, "the level of an interval must be in (0, 1 - 1e-9]", a->level);
    }
    if (!(a->noise >= 0.0 && a->noise <= 1e150)) {
        return bad(error, "noise must be finite and not negative", a->noise);
    }
    if (!(a->eta >= 0.0 && a->eta <= 1e100)) {
        return bad(error, "eta must be finite and not negative", a->eta);
    }
    if (!(a->tolerance > 0.0 && a->tolerance <= 1.0)) {
        return bad(error, "the tolerance of an interval must be in (0, 1]", a->tolerance);
    }
    return BRDFFIT_OK;
}

/* Whether the model is one of these options, with all arrays there and every sigma positive. */
static int model_fits(const brdffit_model *m, const brdffit_samples *s, const brdffit_options *o)
{
    int p, fine = m->lobes == o->lobes && m->channels == s->channels && m->sigma && m->x && m->y;

    fine = fine && m->fresnel == o->fresnel && m->diffuse == o->diffuse && m->masking == o->masking;
    fine = fine && (m->f0 || o->fresnel == BRDFFIT_FRESNEL_NONE);
    fine = fine && (m->x_more || brdffit_diffuse_columns(o->diffuse) < 2);
    for (p = 0; fine && p < m->lobes; p++) {
        fine = m->sigma[p] >= 1e-150 && m->sigma[p] <= 1e150;
    }
    return fine;
}

static brdffit_status check_call(const brdffit_samples *samples, const brdffit_options *o, const brdffit_model *model,
                                 double e2, brdffit_error *error)
{
    if (o->norm != BRDFFIT_NORM_L2 || o->engine != BRDFFIT_ENGINE_MOMENT) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "intervals are of norm l2 and engine moment only");
    }
    if (!model_fits(model, samples, o)) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "the model is not one of these options and samples");
    }
    if (!(e2 >= 0.0 && e2 <= DBL_MAX)) {
        return brdffit_fail_at(error, "e2 must be finite and not negative", BRDFFIT_NONE, BRDFFIT_NONE, e2);
    }
    return BRDFFIT_OK;
}

/* ---- memory ---- */

static brdffit_range *take_intervals(struct arena *arena, size_t count, size_t each)
{
    return brdffit_arena_take(arena, count, each * sizeof(brdffit_range));
}

/* Behind what a fit lays out. */
static void layout(struct arrays *out, struct arena *arena, size_t count, size_t channels, const brdffit_options *o)
{
    size_t lobes = (size_t)o->lobes;
    struct fit fit;

    brdffit_fit_layout(&fit, arena, count, channels, o);
    out->result = brdffit_arena_take(arena, 1, sizeof *out->result);
    out->sigma = take_intervals(arena, 1, lobes);
    out->exponent = take_intervals(arena, 1, lobes);
    out->x = take_intervals(arena, channels, (size_t)fit.model.fixed);
    out->y = take_intervals(arena, channels, lobes);
    out->f0 = fit.model.each > 1 ? take_intervals(arena, channels, lobes) : NULL;
    out->group = brdffit_arena_take(arena, channels, sizeof *out->group);
}

size_t brdffit_intervals_bytes(size_t count, size_t channels, const brdffit_options *o)
{
    struct arena arena;
    struct arrays arrays;

    if (channels == 0 || brdffit_options_check(o, NULL) != BRDFFIT_OK) {
        return 0;
    }
    brdffit_arena_init(&arena, NULL, 0);
    layout(&arrays, &arena, count, channels, o);
    return arena.failed ? 0 : arena.used;
}

/* ---- the threshold ---- */

/* (sum w)^2 / sum w^2 of the used samples. */
static double effective_samples(const struct reduced *r, const brdffit_samples *samples)
{
    double sum = 0.0, square = 0.0;
    size_t j;

    for (j = 0; j < r->used; j++) {
        double w = samples->weights ? samples->weights[r->sample[j]] / r->scale_w : 1.0;

        sum += w;
        square += w * w;
    }
    return square > 0.0 ? sum * sum / square : 0.0;
}

static brdffit_status set_threshold(struct call *c, const brdffit_samples *samples, double e2, brdffit_error *error)
{
    brdffit_interval_result *r = c->out.result;
    const struct model *m = &c->fit.model;
    int columns = c->options->diffuse == BRDFFIT_DIFFUSE_NONE ? m->columns - 1 : m->columns;

    r->e2 = e2;
    if (c->asked.eta > 0.0) {
        r->threshold = e2 + c->asked.eta * e2;
        return BRDFFIT_OK;
    }
    r->level = c->asked.level;
    r->noise = c->asked.noise;
    if (!(r->noise > 0.0)) {
        r->degrees = effective_samples(&c->fit.data, samples) * (double)c->fit.data.channels -
                     (double)(c->fit.data.channels * (size_t)columns + (size_t)m->lobes);
        if (!(r->degrees > 0.0)) {
            return brdffit_fail_at(error, "no more data than parameters: give the noise, or eta", BRDFFIT_NONE,
                                   BRDFFIT_NONE, r->degrees);
        }
        r->noise = sqrt(e2 / r->degrees);
    }
    r->threshold = e2 + chi2_quantile(r->level) * (r->noise * r->noise);
    return BRDFFIT_OK;
}

/* Of which channel that bounds look at each is, as the number of its first twin; before these are compressed. */
static void find_twins(struct call *c)
{
    size_t k, l;

    for (k = 0; k < c->fit.data.channels; k++) {
        for (l = 0; l < k && !(brdffit_reduce_same_channels(&c->fit.data, l, k)); l++) {
        }
        c->out.group[k] = l;
    }
}

static void find_groups(struct call *c)
{
    const struct reduced *r = &c->fit.data;
    size_t k, i;

    for (k = 0; k < r->channels; k++) {
        for (i = 0; i < r->bounded && r->bound_channel[i] != c->out.group[k]; i++) {
        }
        c->out.group[k] = i;
    }
}

/* Theta of the model's lobes, sides in the order of the search. */
static void set_start(struct call *c)
{
    const struct model *m = &c->fit.model;
    int p;

    for (p = 0; p < m->lobes; p++) {
        const struct domain *d = fit_domain(&c->fit, p);
        double theta = -2.0 * kernel_log(c->model->sigma[p]);

        c->work.start.theta[intervals_side(m, p)] = fmin(fmax(theta, d->low), d->high);
    }
}

/* ---- ends to intervals ---- */

/* Both ends of a parameter that cannot be below `low` nor above `high`. */
static void find(struct call *c, struct interval_end end, double low, double high, brdffit_range *out)
{
    struct interval_found found[2] = {{low, end.fitted, 0, 0, 0}, {high, end.fitted, 0, 0, 0}};
    brdffit_interval_result *r = c->out.result;
    int upper, open = 0;

    for (upper = 0; upper < 2; upper++) {
        end.upper = upper;
        if (!r->stopped) {
            brdffit_intervals_search(&c->work, &end, &found[upper]);
            r->stopped = found[upper].cancelled;
            r->boxes += found[upper].boxes;
        }
        open = open || !found[upper].settled;
    }
    out->low = fmin(fmax(found[0].bound, low), high);
    out->high = fmax(fmin(found[1].bound, high), low);
    out->inner_low = fmax(found[0].reached, out->low);
    out->inner_high = fmin(found[1].reached, out->high);
    out->flags = (out->low <= low ? BRDFFIT_INTERVAL_LOW_END : 0u) |
                 (out->high >= high ? BRDFFIT_INTERVAL_HIGH_END : 0u) | (open ? BRDFFIT_INTERVAL_OPEN : 0u);
    r->complete = r->complete && !open;
}

static double sigma_at(const struct call *c, int kind, double theta)
{
    return brdffit_fit_sigma(&c->fit, kind, theta);
}

/* The sigma interval from that of theta: ends of the domain are those of what is claimed, others moved outwards. */
static void sigma_interval(const struct call *c, int kind, const brdffit_range *theta, brdffit_range *out)
{
    const struct domain *d = &c->fit.domain[kind];
    double floor = sigma_at(c, kind, fmax(d->high, fmax(d->flat, d->low))), top = sigma_at(c, kind, d->low);

    out->low = theta->high >= d->high ? floor : fmax(floor, sigma_at(c, kind, theta->high) * (1.0 - TOL_SIGMA));
    out->high = theta->low <= d->low ? top : fmin(top, sigma_at(c, kind, theta->low) * (1.0 + TOL_SIGMA));
    out->inner_low = theta->inner_high >= d->high ? out->low : fmax(out->low, sigma_at(c, kind, theta->inner_high));
    out->inner_high = fmin(out->high, sigma_at(c, kind, theta->inner_low));
    out->inner_low = fmin(out->inner_low, out->inner_high);
    out->flags = (theta->high >= d->high ? BRDFFIT_INTERVAL_LOW_END : 0u) |
                 (theta->low <= d->low ? BRDFFIT_INTERVAL_HIGH_END : 0u) | (theta->flags & BRDFFIT_INTERVAL_OPEN);
}

/* n = 1 / sigma^2, rounded outwards. */
static void exponent_interval(const struct call *c, const brdffit_range *sigma, brdffit_range *out)
{
    double low = c->options->exponent_min, high = c->options->exponent_max;

    out->low = fmax(low, (1.0 - TOL_SIGMA) / (sigma->high * sigma->high));
    out->high = fmin(high, (1.0 + TOL_SIGMA) / (sigma->low * sigma->low));
    out->inner_low = fmax(out->low, 1.0 / (sigma->inner_high * sigma->inner_high));
    out->inner_high = fmin(out->high, 1.0 / (sigma->inner_low * sigma->inner_low));
    out->flags = (sigma->flags & BRDFFIT_INTERVAL_LOW_END ? BRDFFIT_INTERVAL_HIGH_END : 0u) |
                 (sigma->flags & BRDFFIT_INTERVAL_HIGH_END ? BRDFFIT_INTERVAL_LOW_END : 0u) |
                 (sigma->flags & BRDFFIT_INTERVAL_OPEN);
}

static void find_roughness(struct call *c, int p)
{
    const struct model *m = &c->fit.model;
    struct interval_end end = {.parameter = PARAMETER_THETA, .side = intervals_side(m, p)};
    const struct domain *d = fit_domain(&c->fit, p);
    static const brdffit_range none;
    brdffit_range theta;
    int kind = m->lobe[p].kind;

    end.fitted = c->work.start.theta[end.side];
    find(c, end, d->low, d->high, &theta);
    sigma_interval(c, kind, &theta, &c->out.sigma[p]);
    c->out.exponent[p] = none;
    if (m->kind[kind]->by_exponent) {
        exponent_interval(c, &c->out.sigma[p], &c->out.exponent[p]);
    }
}

static void find_diffuse(struct call *c, size_t k)
{
    size_t F = (size_t)c->fit.model.fixed, f;
    struct interval_end end = {.parameter = PARAMETER_X, .channel = k};
    static const brdffit_range zero = {.flags = BRDFFIT_INTERVAL_LOW_END | BRDFFIT_INTERVAL_HIGH_END};

    for (f = 0; f < F; f++) {
        end.fixed = (int)f;
        end.fitted = f == 0 ? c->model->x[k] : c->model->x_more[k * (F - 1) + f - 1];
        if (c->options->diffuse == BRDFFIT_DIFFUSE_NONE) {
            c->out.x[k] = zero;
        } else {
            find(c, end, 0.0, INFINITY, &c->out.x[k * F + f]);
        }
    }
}

static void find_specular(struct call *c, size_t k, int p)
{
    size_t at = k * (size_t)c->fit.model.lobes + (size_t)p;
    struct interval_end end = {
        .parameter = PARAMETER_Y, .channel = k, .side = intervals_side(&c->fit.model, p), .fitted = c->model->y[at]};

    find(c, end, 0.0, INFINITY, &c->out.y[at]);
    if (c->out.f0) {
        end.parameter = PARAMETER_F0;
        end.fitted = c->model->f0[at];
        find(c, end, 0.0, 1.0, &c->out.f0[at]);
    }
}

static void publish(struct call *c)
{
    brdffit_interval_result *r = c->out.result;

    r->sigma = c->out.sigma;
    r->exponent = c->out.exponent;
    r->x = c->out.x;
    r->y = c->out.y;
    r->f0 = c->out.f0;
    r->lobes = c->fit.model.lobes;
    r->diffuse_columns = c->fit.model.fixed;
    r->channels = c->fit.data.channels;
}

static void find_all(struct call *c)
{
    size_t k;
    int p;

    c->out.result->complete = 1;
    for (p = 0; p < c->fit.model.lobes; p++) {
        find_roughness(c, p);
    }
    for (k = 0; k < c->fit.data.channels; k++) {
        find_diffuse(c, k);
        for (p = 0; p < c->fit.model.lobes; p++) {
            find_specular(c, k, p);
        }
    }
    publish(c);
}

/* Lay out, reduce, and decide what is near enough. */
static brdffit_status open_call(struct call *c, const brdffit_samples *samples, double e2, void *workspace, size_t size,
                                brdffit_error *error)
{
    static const brdffit_interval_result zero;
    struct arena arena;
    brdffit_status status;

    status = brdffit_fit_open(&c->fit, samples, c->options, workspace, size, workspace, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_arena_init(&arena, workspace, size);
    layout(&c->out, &arena, samples->count, samples->channels, c->options);
    if (arena.failed) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE,
                            "the workspace is smaller than brdffit_intervals_workspace_size()");
    }
    *c->out.result = zero;
    return set_threshold(c, samples, e2, error);
}

brdffit_status brdffit_intervals_run(const brdffit_samples *samples, const brdffit_options *options,
                                     const brdffit_model *model, double e2, const brdffit_interval_options *asked,
                                     void *workspace, size_t size, const brdffit_interval_result **result,
                                     brdffit_error *error)
{
    struct call c = {.options = options, .model = model, .asked = *asked};
    brdffit_status status = brdffit_options_check(options, error);

    status = status == BRDFFIT_OK ? check_asked(asked, error) : status;
    if (status == BRDFFIT_OK && options->anisotropic) {
        status = brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "there are no certified intervals of anisotropic lobes");
    }
    status = status == BRDFFIT_OK ? check_call(samples, options, model, e2, error) : status;
    if (status == BRDFFIT_OK && !result) {
        status = brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "result is NULL");
    }
    status = status == BRDFFIT_OK ? open_call(&c, samples, e2, workspace, size, error) : status;
    if (status != BRDFFIT_OK) {
        return status;
    }
    find_twins(&c);
    status = brdffit_fit_start(&c.fit, options, &c.work.engine, &c.work.rules, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    find_groups(&c);
    c.work.fit = &c.fit;
    c.work.group = c.out.group;
    c.work.threshold = brdffit_fit_level(c.out.result->threshold, brdffit_fit_scale(&c.fit.data, options));
    c.work.threshold *= 1.0 + 4.0 * TOL_UNIT;
    c.work.tolerance = asked->tolerance;
    c.work.rules.box_budget = asked->box_budget;
    c.work.rules.observe = NULL;
    set_start(&c);
    find_all(&c);
    brdffit_fit_engine_finish(&c.fit, options);
    *result = c.out.result;
    return BRDFFIT_OK;
}
