/*
 * One end of one interval: the driver of every fit, around an engine whose objective is the parameter (for an upper end, its
 * negative) over the models with E^2 <= threshold. SPDX-License-Identifier: MIT
 *
 * A box without such a model has the bound INFINITY; of the others the bound is what its roughness and extreme.h allow. So the
 * search proves an end as it proves an optimum: to a gap, here a share of the end's distance from the fitted value, which grows
 * while better ends are found. (A box closed earlier was closed with a smaller gap: its bound counts all the same.)
 *
 * Points are tried in vector form, with room for rounding: what is reached is a model's, but for 1e-12 of the data.
 */
#include <math.h>

#include "fit/intervals.h"
#include "base/tolerance.h"
#include "bound/moment/extreme.h"
#include "solve/level.h"

struct ender {
    struct intervals_work *work;
    const struct interval_end *end;
    struct engine own;
    struct search_rules rules;
    struct interval_found *found;
    double reached; /* objective */
};

static double objective_of(const struct interval_end *end, double value)
{
    return end->upper ? -value : value;
}

/* ---- bounds ---- */

/* Columns of the model that an end asks for. */
static void columns_of(const struct fit *f, const struct interval_end *end, int column[2])
{
    column[0] = end->parameter == PARAMETER_X ? end->fixed : f->model.lobe[end->side].column;
    column[1] = end->parameter != PARAMETER_X && f->model.each > 1 ? column[0] + 1 : -1;
}

/* Of a share, the high end of F0 is its supremum, and the low one 1 less that of 1 - F0. */
static void ask(struct ender *e, const struct box *box, struct extreme *x)
{
    struct fit *f = e->work->fit;
    const struct interval_end *end = e->end;
    double ratio[2] = {0.0, 0.0};

    columns_of(f, end, x->column);
    x->channel = e->work->group[end->channel];
    x->share = end->parameter == PARAMETER_F0;
    x->sense = end->upper || x->share ? 1 : -1;
    if (x->column[1] >= 0) {
        brdffit_intervals_ratio(e->work, end->side, box->interval[end->side], ratio);
    }
    x->second = end->upper ? ratio[1] : ratio[0];
    if (x->share) {
        x->second = end->upper ? ratio[0] : 1.0 / ratio[1];
        if (!end->upper) {
            x->column[0] = x->column[1];
            x->column[1] = x->column[0] - 1;
        }
    }
    x->total_gain = brdffit_moment_least_gain(&f->moment, box, e->work->threshold);
}

/* A reach as the objective of the end, given the norm of its first column (not of a share). */
static double objective_from(const struct ender *e, double reach, struct wide norm)
{
    const struct interval_end *end = e->end;

    if (reach == -INFINITY) {
        return INFINITY;
    }
    if (end->parameter == PARAMETER_F0) {
        return end->upper ? -reach : 1.0 - reach;
    }
    return end->upper ? -brdffit_intervals_value(e->work->fit, end->channel, reach, norm, 1)
                      : brdffit_intervals_value(e->work->fit, end->channel, -reach, norm, 0);
}

static struct wide_range norms(struct ender *e, const struct box *box)
{
    struct fit *f = e->work->fit;
    struct wide_range range;

    if (e->end->parameter == PARAMETER_X) {
        range.low = range.high = brdffit_intervals_fixed_norm(f, e->end->fixed);
        return range;
    }
    return brdffit_intervals_norm(e->work, f->model.lobe[e->end->side].column - f->model.fixed,
                                  box->interval[e->end->side]);
}

static struct wide corner_norm(struct ender *e, const struct box *box, unsigned corner)
{
    int side = e->end->side, column[2];

    if (e->end->parameter == PARAMETER_X) {
        return brdffit_intervals_fixed_norm(e->work->fit, e->end->fixed);
    }
    columns_of(e->work->fit, e->end, column);
    return brdffit_intervals_end_norm(e->work, column[0] - e->work->fit->model.fixed, box->interval[side],
                                      (int)(corner >> side & 1u));
}

static double coordinate(const struct fit *f, const struct box *box, int side, int high)
{
    double ends[2];

    brdffit_axis_ends(&f->axis[f->model.lobe[side].kind], box->interval[side], &ends[0], &ends[1]);
    return ends[high];
}

/* The best corner into *met, from objectives. */
static double best_corner(const struct fit *f, const struct box *box, const double *objective, struct point *met)
{
    double best = INFINITY;
    unsigned corner;
    int p;

    for (corner = 0; corner < 1u << f->model.sides; corner++) {
        if (!(objective[corner] < best)) {
            continue;
        }
        best = objective[corner];
        for (p = 0; p < f->model.sides; p++) {
            met->theta[p] = coordinate(f, box, p, (int)(corner >> p & 1u));
        }
    }
    return best;
}

static double bound_theta(struct ender *e, struct box *box, struct point *met)
{
    struct fit *f = e->work->fit;
    double value[1u << SIDES_MOST], needed = f->data.total - e->work->threshold;
    int p = e->end->side;
    unsigned corner;

    box->bound = objective_of(e->end, coordinate(f, box, p, e->end->upper));
    brdffit_moment_corners(&f->moment, box, value);
    for (corner = 0; corner < 1u << f->model.sides; corner++) {
        value[corner] = value[corner] >= needed ? objective_of(e->end, coordinate(f, box, p, (int)(corner >> p & 1u)))
                                                : (double)INFINITY;
    }
    return best_corner(f, box, value, met);
}

static double bound_coefficient(struct ender *e, struct box *box, struct point *met)
{
    struct fit *f = e->work->fit;
    struct extreme x;
    double value[1u << SIDES_MOST], reach;
    struct wide_range range = norms(e, box);
    unsigned corner;

    ask(e, box, &x);
    if (x.second > 1e100) { /* nothing is known of the second column */
        reach = INFINITY;
        for (corner = 0; corner < 1u << f->model.sides; corner++) {
            value[corner] = -INFINITY;
        }
    } else {
        reach = brdffit_moment_extreme(&f->moment, box, &x, value);
    }
    for (corner = 0; corner < 1u << f->model.sides; corner++) {
        value[corner] = objective_from(e, value[corner], corner_norm(e, box, corner));
    }
    box->bound = objective_from(e, reach, e->end->upper ? range.low : range.high);
    return best_corner(f, box, value, met);
}

/* The side that the parameter depends on most, where it is not much narrower than the one that E^2 does. */
static uint32_t side_to_split(const struct ender *e, const struct box *box)
{
    const struct fit *f = e->work->fit;
    int advised = (int)box->split, own = e->end->side;

    if (e->end->parameter == PARAMETER_X || own == advised) {
        return box->split;
    }
    return coordinate(f, box, own, 1) - coordinate(f, box, own, 0) >=
                   coordinate(f, box, advised, 1) - coordinate(f, box, advised, 0)
               ? (uint32_t)own
               : box->split;
}

static double bound(void *self, struct box *box, struct point *met)
{
    struct ender *e = self;
    double cutoff = fmax(e->work->threshold * (1.0 + 8.0 * TOL_UNIT), 1e-300), best;

    box->bound = cutoff;
    (void)e->work->engine.bound(e->work->engine.self, box, met);
    if (box->bound >= cutoff) {
        box->bound = INFINITY;
        return INFINITY;
    }
    best = e->end->parameter == PARAMETER_THETA ? bound_theta(e, box, met) : bound_coefficient(e, box, met);
    box->split = side_to_split(e, box);
    return best;
}

/* ---- points ---- */

/* Cosines and projections of channel k from the vector form as it was evaluated last. */
static void gram_of(const struct fit *f, size_t k, double *cosine, double *t)
{
    const struct nnls *a = &f->varpro.nnls;
    double q[NNLS_COLUMNS];
    int i, j, m;

    for (j = 0; j < a->columns; j++) {
        q[j] = a->kernels->dot(a->q[j], f->data.row_value + k * f->data.used, a->rows);
    }
    for (j = 0; j < a->columns; j++) {
        t[j] = 0.0;
        for (i = 0; i <= j; i++) {
            t[j] += a->r[i][j] * q[i];
        }
        for (i = 0; i < j; i++) {
            double sum = 0.0;

            for (m = 0; m <= i; m++) {
                sum += a->r[m][i] * a->r[m][j];
            }
            cosine[COSINE(a->columns, i, j)] = fmin(1.0, fmax(0.0, sum));
        }
    }
}

/* What channel k has to gain, those others at their best; from the last evaluation. */
static double to_gain(const struct fit *f, size_t k, double threshold)
{
    double others = 0.0;
    size_t i;

    for (i = 0; i < f->data.channels; i++) {
        double scale = f->varpro.answer[i].data_scale;

        others += i == k ? 0.0 : f->varpro.answer[i].rss * (scale * scale);
    }
    return f->data.ii[k] - (threshold - others) + TOL_REACHED * f->moment.moments.slack;
}

static struct wide column_norm(const struct fit *f, int column, double theta)
{
    const struct nnls *a = &f->varpro.nnls;
    struct wide norm = wide_times(wide_of(a->norm[column]), wide_of(a->scale[column]));

    if (column < f->model.fixed) {
        return wide_times(norm, wide_of(f->data.scale_a[column]));
    }
    return wide_times(norm, brdffit_intervals_factor(f, column - f->model.fixed, theta));
}

static double reached_share(const struct ender *e, struct level *level, double ratio)
{
    double reach;

    if (!e->end->upper) {
        int first = level->asked[0];

        level->asked[0] = level->asked[1];
        level->asked[1] = first;
        ratio = ratio > 0.0 ? 1.0 / ratio : 1e100;
    }
    reach = brdffit_level_share(level, fmin(ratio, 1e100), -INFINITY);
    return reach == -INFINITY ? (double)INFINITY : e->end->upper ? -reach : 1.0 - reach;
}

/* The best coefficient at the point that was evaluated, for lobes as narrow as theta. */
static double reached_coefficient(struct ender *e, const struct level *asked, double theta)
{
    struct level level = *asked;
    double z[NNLS_COLUMNS], ratio = 0.0, sum;
    struct wide norm = column_norm(e->work->fit, level.asked[0], theta), second;
    int sense = e->end->upper ? 1 : -1;

    if (level.asked[1] >= 0) {
        second = column_norm(e->work->fit, level.asked[1], theta);
        ratio = second.value > 0.0 ? wide_value(wide_over(norm, second)) : 0.0;
    }
    if (e->end->parameter == PARAMETER_F0) {
        return reached_share(e, &level, ratio);
    }
    level.second = ratio;
    if (!brdffit_level_attain(&level, sense, z)) {
        return INFINITY;
    }
    sum = z[level.asked[0]] + (level.asked[1] >= 0 ? ratio * z[level.asked[1]] : 0.0);
    return objective_of(e->end,
                        norm.value > 0.0 ? brdffit_intervals_value(e->work->fit, e->end->channel, sum, norm, 0) : 0.0);
}

static double try_coefficient(struct ender *e, const struct point *at)
{
    const struct fit *f = e->work->fit;
    const struct domain *d = fit_domain(f, e->end->side);
    double cosine[COSINES(NNLS_COLUMNS)], t[NNLS_COLUMNS], theta = at->theta[e->end->side], best;
    struct level level = {.columns = f->model.columns, .cosine = cosine, .t = t};
    int i;

    gram_of(f, e->end->channel, cosine, t);
    columns_of(f, e->end, level.asked);
    level.gain = to_gain(f, e->end->channel, e->work->threshold);
    best = reached_coefficient(e, &level, theta);
    for (i = 1; i <= TAIL_POINTS && e->end->parameter == PARAMETER_Y && theta >= d->high && d->flat > d->high; i++) {
        best = fmin(best, reached_coefficient(e, &level, d->high + (d->flat - d->high) * ((double)i / TAIL_POINTS)));
    }
    return best;
}

/* How near the proof has to come, now that this is reached. */
static void set_tolerance(struct ender *e)
{
    double fitted = e->end->fitted, reached = objective_of(e->end, e->reached);
    double least = INTERVAL_LEAST * fmax(fabs(fitted), fabs(reached));

    e->rules.absolute_gap = e->work->tolerance *
                            fmax(fabs(reached - fitted), e->end->parameter == PARAMETER_THETA ? INTERVAL_LEAST : least);
    e->rules.absolute_gap = isfinite(e->rules.absolute_gap) ? e->rules.absolute_gap : 0.0;
    e->own.noise = 0.25 * e->rules.absolute_gap;
}

static double try_point(void *self, struct point *point)
{
    struct ender *e = self;
    struct varpro_value value;
    double objective = INFINITY;

    brdffit_varpro_evaluate(&e->work->fit->varpro, point, 0, &value);
    if (value.objective <= e->work->threshold) {
        objective = e->end->parameter == PARAMETER_THETA ? objective_of(e->end, point->theta[e->end->side])
                                                         : try_coefficient(e, point);
    }
    objective = fmin(objective, objective_of(e->end, e->end->fitted)); /* which the model itself has */
    if (objective < e->reached) {
        e->reached = objective;
        set_tolerance(e);
    }
    return objective;
}

static double start(void *self, struct point *met)
{
    struct ender *e = self;

    *met = e->work->start;
    return INFINITY;
}

static double width(void *self, int kind, uint32_t interval)
{
    const struct ender *e = self;
    double low, high;

    brdffit_axis_ends(&e->work->fit->axis[kind], interval, &low, &high);
    return high - low;
}

static void forget(void *self, int axis, uint32_t node, uint32_t interval)
{
    const struct ender *e = self;

    e->work->engine.forget(e->work->engine.self, axis, node, interval);
}

/* Axes that are half full are begun anew, and what was known of them with them. */
static void make_room(struct fit *f)
{
    int kind, full = 0;

    for (kind = 0; kind < f->model.axes; kind++) {
        full = full || f->axis[kind].nodes > f->axis[kind].node_capacity / 2;
    }
    for (kind = 0; kind < f->model.axes && full; kind++) {
        brdffit_axis_start(&f->axis[kind], f->domain[kind].low, f->domain[kind].high, f->axis[kind].first);
    }
    if (full) {
        brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    }
}

void brdffit_intervals_search(struct intervals_work *w, const struct interval_end *end, struct interval_found *found)
{
    struct ender e = {.work = w, .end = end, .found = found, .rules = w->rules, .reached = INFINITY};
    struct search_result result;

    make_room(w->fit);
    e.own.self = &e;
    e.own.sides = w->engine.sides;
    e.own.bound = bound;
    e.own.start = start;
    e.own.try_point = try_point;
    e.own.width = width;
    e.own.forget = forget;
    e.own.noise = 0.0;
    e.rules.relative_gap = 0.0;
    e.rules.absolute_gap = 0.0;
    e.rules.sigma_resolution = INTERVAL_RESOLUTION;
    brdffit_search(w->fit->axis, &w->fit->heap, &e.own, &e.rules, &result);
    found->bound = objective_of(end, fmin(result.lower_bound, result.objective));
    found->reached = objective_of(end, result.objective);
    found->settled = result.lower_bound >= result.objective - e.rules.absolute_gap ||
                     result.stop == BRDFFIT_STOP_RESOLUTION || result.stop == BRDFFIT_STOP_ROUNDING;
    found->cancelled = result.stop == BRDFFIT_STOP_CANCELLED;
    found->boxes = result.boxes;
}
