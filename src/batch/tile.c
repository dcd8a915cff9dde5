/*
 * A tile of texels: into lanes, through the plan's kernels, and back to the caller's units; texels that have no
 * place there take the general path, and so does the fit of two lobes. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"
#include "fit/verdict.h"
#include "batch/batch.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* Channels whose magnitudes are further from their scale than this, or from 1, take the general path. */
#define FAR 1e30
#define FAR_SCALE 1e100

/* Divisors of one texel's channels, as reduce.c chooses them; 0 when it is none for the kernels. */
static int choose_scales(const brdffit_plan *plan, struct batch_tile *tile, size_t lane)
{
    size_t K = plan->geometry.channels, k;
    double all = 0.0, relative = 0.0;

    for (k = 0; k < K; k++) {
        all = fmax(all, tile->scan.magnitude[k * LANES + lane]);
    }
    if (!(tile->scan.not_finite[lane] == 0.0 && all > 0.0)) {
        return 0;
    }
    for (k = 0; k < K; k++) {
        double *scale = &tile->scale[k * LANES + lane], size = tile->scan.magnitude[k * LANES + lane];
        double largest = tile->scan.largest[k * LANES + lane];

        *scale = plan->options.normalise == BRDFFIT_NORMALISE_NONE ? power_of_two(all) : largest > 0.0 ? largest : 1.0;
        if (!(*scale >= 1.0 / FAR_SCALE && *scale <= FAR_SCALE && size <= FAR * *scale &&
              (size == 0.0 || size >= 1.0 / FAR_SCALE))) {
            return 0;
        }
        relative = fmax(relative, size / *scale);
    }
    return relative >= 1.0 / FAR;
}

static void clear_lane(const struct batch_fast *f, struct batch_tile *tile, size_t lane)
{
    size_t i, k;

    for (i = 0; i < f->used * f->channels; i++) {
        tile->value[i * LANES + lane] = 0.0;
    }
    for (k = 0; k < f->channels; k++) {
        tile->scale[k * LANES + lane] = 1.0;
    }
}

/* The published roughness of s: the options' own end where s is that end to rounding (domain.c), and in their range. */
static double sigma_of(const brdffit_plan *plan, double s)
{
    const brdffit_options *o = &plan->options;
    int by_exponent = plan->fast.kind->by_exponent;
    double most = by_exponent ? 1.0 / sqrt(o->exponent_min) : o->sigma_max;
    double least = by_exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min, sigma = 1.0 / sqrt(s);

    return s <= plan->fast.s_low * (1.0 + 1e-13) || sigma > most ? most : sigma < least ? least : sigma;
}

/* What turns a lane's objective into the caller's units. */
static double unit_of(const brdffit_plan *plan, const struct batch_tile *tile, size_t lane)
{
    double value = plan->options.normalise == BRDFFIT_NORMALISE_NONE ? tile->scale[lane] : 1.0;

    return plan->fast.scale_w * (value * value);
}

/* The verdict on a lane (verdict.h): what its kernel proved is certified by its final numbers, or not at all. */
static int judge(const brdffit_plan *plan, const struct batch_outcome *out, double unit, struct batch_result *r)
{
    const struct evidence evidence = {out->e2 * unit,           out->error * unit,          out->lower_bound * unit,
                                      out->total * unit,        plan->options.relative_gap, plan->options.absolute_gap,
                                      BRDFFIT_STOP_RELATIVE_GAP};
    struct verdict verdict = brdffit_verdict(&evidence);

    r->status = BRDFFIT_TEXEL_CERTIFIED;
    r->stop = verdict.stop;
    r->e2 = evidence.e2;
    r->lower_bound = verdict.lower_bound;
    r->sum_of_squares = evidence.total;
    r->sigma_floor = plan->fast.sigma_floor;
    return verdict.certified;
}

/* Column j's coefficient of channel k in the data's units, as far as a double holds it. */
static double coefficient(const struct batch_fast *f, const struct batch_tile *tile, size_t lane, size_t k, int j,
                          struct wide factor)
{
    double y = tile->y[(k * (size_t)f->each + (size_t)j) * LANES + lane] * tile->scale[k * LANES + lane];

    return wide_value(wide_over(wide_of(y / f->column[j].scale_b), factor));
}

/* y and F0 of a channel; 0 where they are no ordinary numbers. */
static int keep_lobe(const struct batch_fast *f, const struct batch_tile *tile, size_t lane, size_t k,
                     const struct wide factor[EACH_MOST], struct batch_result *r)
{
    double z[EACH_MOST] = {0.0};
    int j, ordinary = 1;

    for (j = 0; j < f->each; j++) {
        z[j] = coefficient(f, tile, lane, k, j, factor[j]);
        ordinary = ordinary && (isnormal(z[j]) || tile->y[(k * (size_t)f->each + (size_t)j) * LANES + lane] == 0.0);
    }
    r->y[k] = z[0] + z[1];
    if (r->f0) {
        r->f0[k] = r->y[k] > 0.0 ? fmin(1.0, z[0] / r->y[k]) : 0.0;
    }
    return ordinary && isfinite(r->y[k]);
}

/*
 * A certified lane to a result; 0 where a fit's own rules (domain.c, published.c) decide which coefficients there are: near
 * the end of finite ones, and where one is no ordinary number.
 */
static int keep(const brdffit_plan *plan, const struct batch_tile *tile, size_t lane, struct batch_result *r)
{
    const struct batch_fast *f = &plan->fast;
    const struct batch_outcome *out = &tile->outcome[lane];
    int none = plan->options.normalise == BRDFFIT_NORMALISE_NONE;
    struct wide factor[EACH_MOST];
    double unit = unit_of(plan, tile, lane);
    size_t k;
    int j, last = f->each - 1;
    int finite = f->kind->exponent(f->column[last].sight.c_min, out->s) <= LIMIT_PLAIN_EXPONENT &&
                 judge(plan, out, unit, r);

    r->where = BRDFFIT_NONE;
    r->boxes = out->boxes;
    r->nodes = out->nodes;
    r->general = r->one_lobe_enough = 0;
    r->sigma[0] = sigma_of(plan, out->s);
    for (j = 0; j < f->each; j++) {
        factor[j] = brdffit_lobe_divisor(f->kind, twofold_inverse_square(r->sigma[0]), &f->column[j].sight);
    }
    for (k = 0; k < f->channels && finite; k++) {
        double scale = tile->scale[k * LANES + lane];

        r->x[k] = f->root_a > 0.0 ? tile->x[k * LANES + lane] / f->root_a * scale / f->scale_a : 0.0;
        r->channel_scale[k] = none ? 1.0 : scale;
        finite = (isnormal(r->x[k]) || r->x[k] == 0.0) && keep_lobe(f, tile, lane, k, factor, r);
    }
    return finite;
}

/* Every used value is zero. */
static void keep_nothing(const brdffit_plan *plan, struct batch_result *r)
{
    size_t k;

    r->status = BRDFFIT_TEXEL_NO_SIGNAL;
    r->stop = BRDFFIT_STOP_RELATIVE_GAP;
    r->where = BRDFFIT_NONE;
    r->boxes = r->nodes = 0;
    r->general = r->one_lobe_enough = 0;
    r->e2 = r->lower_bound = r->sum_of_squares = 0.0;
    r->sigma_floor = plan->fast.sigma_floor;
    r->sigma[0] = sigma_of(plan, plan->fast.s_low);
    for (k = 0; k < plan->fast.channels; k++) {
        r->x[k] = r->y[k] = 0.0;
        r->channel_scale[k] = 1.0;
        if (r->f0) {
            r->f0[k] = 0.0;
        }
    }
}

static int no_signal(const struct batch_tile *tile, size_t channels, size_t lane)
{
    double all = tile->scan.not_finite[lane];
    size_t k;

    for (k = 0; k < channels; k++) {
        all += tile->scan.magnitude[k * LANES + lane];
    }
    return all == 0.0;
}

static void fit_lanes(struct batch *batch)
{
    const brdffit_plan *plan = batch->plan;
    struct batch_tile *tile = &batch->tile;
    struct batch_rules rules = {plan->options.relative_gap, plan->options.absolute_gap};
    const double *row[BATCH_TILE];
    unsigned char live[BATCH_TILE];
    size_t l;
    int any = 0;

    for (l = 0; l < BATCH_TILE; l++) {
        row[l] = batch->row[l < batch->filled ? l : 0];
    }
    plan->kernels->load(&plan->fast, row, tile, &tile->scan);
    for (l = 0; l < BATCH_TILE; l++) {
        live[l] = (unsigned char)(l < batch->filled && choose_scales(plan, tile, l));
        tile->outcome[l].certified = 0;
        any = any || live[l];
        if (!live[l]) {
            clear_lane(&plan->fast, tile, l);
        }
    }
    if (any) {
        plan->kernels->tile(&plan->fast, &rules, tile, live);
    }
}

/* Two lobes: the ordinary fit, and whether its bound leaves room for a second lobe to be of use. */
static void fit_two(struct batch *batch, size_t l)
{
    const brdffit_plan *plan = batch->plan;
    struct batch_result *r = &batch->result[l];

    brdffit_batch_general(plan, batch, batch->row[l], r);
    if (plan->kernels && batch->tile.outcome[l].certified && r->status <= BRDFFIT_TEXEL_OPEN) {
        double one = (batch->tile.outcome[l].e2 + batch->tile.outcome[l].error) * unit_of(plan, &batch->tile, l);

        r->one_lobe_enough = one <= (1.0 + plan->options.relative_gap) * r->lower_bound ||
                             one - r->lower_bound <= plan->options.absolute_gap * r->sum_of_squares;
    }
}

void brdffit_batch_tile(struct batch *batch)
{
    const brdffit_plan *plan = batch->plan;
    size_t l;

    if (plan->kernels) {
        fit_lanes(batch);
    }
    for (l = 0; l < batch->filled; l++) {
        struct batch_result *r = &batch->result[l];

        if (plan->options.lobes > 1) {
            fit_two(batch, l);
        } else if (plan->kernels && batch->tile.outcome[l].certified && keep(plan, &batch->tile, l, r)) {
            continue;
        } else if (plan->kernels && no_signal(&batch->tile, plan->fast.channels, l)) {
            keep_nothing(plan, r);
        } else {
            brdffit_batch_general(plan, batch, batch->row[l], r);
        }
    }
}
