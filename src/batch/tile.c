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

/* Lobes of a result, which column is the first of each, and what each column's coefficient is divided by. */
struct published_lobes {
    int count, first[2];
    struct wide factor[EACH_MOST];
    double sharpest; /* largest s */
};

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

/* Column c's coefficient of channel k in the data's units, as far as a double holds it; 0 where it is no ordinary number. */
static int coefficient(const struct batch_fast *f, const struct batch_tile *tile, size_t lane, size_t k, int c,
                       struct wide factor, size_t columns, double *z)
{
    double y = tile->y[(k * columns + (size_t)c) * LANES + lane];

    *z = wide_value(wide_over(wide_of(y * tile->scale[k * LANES + lane] / f->column[c].scale_b), factor));
    return isnormal(*z) || y == 0.0;
}

/* y of every lobe of a channel, the p-th from column first[p], and F0; 0 where they are no ordinary numbers. */
static int keep_lobes(const struct batch_fast *f, const struct batch_tile *tile, size_t lane, size_t k,
                      const struct published_lobes *lobes, struct batch_result *r)
{
    size_t P = (size_t)lobes->count, columns = P * (size_t)f->each, p;
    double z[EACH_MOST] = {0.0, 0.0};
    int j, ordinary = 1;

    for (p = 0; p < P; p++) {
        for (j = 0; j < f->each; j++) {
            int c = lobes->first[p] + j;

            ordinary = coefficient(f, tile, lane, k, c, lobes->factor[c], columns, &z[j]) && ordinary;
        }
        r->y[k * P + p] = z[0] + z[1];
        if (r->f0) {
            r->f0[k * P + p] = r->y[k * P + p] > 0.0 ? fmin(1.0, z[0] / r->y[k * P + p]) : 0.0;
        }
        ordinary = ordinary && isfinite(r->y[k * P + p]);
    }
    return ordinary;
}

/* Lobes of a lane in the order of a result, sigma ascending, and what their columns' coefficients are divided by. */
static struct published_lobes lobes_of(const brdffit_plan *plan, const struct batch_outcome *out,
                                       struct batch_result *r)
{
    const struct batch_fast *f = &plan->fast;
    struct published_lobes lobes = {.count = plan->options.lobes};
    const double s[2] = {out->s, out->other};
    int p, j;

    for (p = 0; p < lobes.count; p++) {
        int column = lobes.count > 1 && s[1] > s[0] ? 1 - p : p;

        lobes.first[p] = column; /* several lobes have one column each */
        r->sigma[p] = sigma_of(plan, s[column]);
        for (j = 0; j < f->each; j++) {
            lobes.factor[column + j] = brdffit_lobe_divisor(f->kind, twofold_inverse_square(r->sigma[p]),
                                                            &f->column[column + j].sight);
        }
    }
    lobes.sharpest = lobes.count > 1 ? fmax(s[0], s[1]) : s[0];
    return lobes;
}

/*
 * A certified lane to a result; 0 where a fit's own rules (domain.c, published.c) decide which coefficients there are: near
 * the end of finite ones, and where one is no ordinary number.
 */
static int keep(const brdffit_plan *plan, const struct batch_tile *tile, const struct batch_outcome *out, size_t lane,
                struct batch_result *r)
{
    const struct batch_fast *f = &plan->fast;
    const struct published_lobes lobes = lobes_of(plan, out, r);
    int none = plan->options.normalise == BRDFFIT_NORMALISE_NONE, last = f->each - 1;
    double unit = unit_of(plan, tile, lane);
    size_t k;
    int finite = f->kind->exponent(f->column[last].sight.c_min, lobes.sharpest) <= LIMIT_PLAIN_EXPONENT &&
                 judge(plan, out, unit, r);

    r->where = BRDFFIT_NONE;
    r->boxes = out->boxes;
    r->nodes = out->nodes;
    r->general = r->one_lobe_enough = 0;
    for (k = 0; k < f->channels && finite; k++) {
        double scale = tile->scale[k * LANES + lane];

        r->x[k] = f->root_a > 0.0 ? tile->x[k * LANES + lane] / f->root_a * scale / f->scale_a : 0.0;
        r->channel_scale[k] = none ? 1.0 : scale;
        finite = (isnormal(r->x[k]) || r->x[k] == 0.0) && keep_lobes(f, tile, lane, k, &lobes, r);
    }
    return finite;
}

/* Every used value is zero. */
static void keep_nothing(const brdffit_plan *plan, struct batch_result *r)
{
    size_t k, P = (size_t)plan->options.lobes;

    r->status = BRDFFIT_TEXEL_NO_SIGNAL;
    r->stop = BRDFFIT_STOP_RELATIVE_GAP;
    r->where = BRDFFIT_NONE;
    r->boxes = r->nodes = 0;
    r->general = r->one_lobe_enough = 0;
    r->e2 = r->lower_bound = r->sum_of_squares = 0.0;
    r->sigma_floor = plan->fast.sigma_floor;
    for (k = 0; k < P; k++) {
        r->sigma[k] = sigma_of(plan, plan->fast.s_low);
    }
    for (k = 0; k < plan->fast.channels * P; k++) {
        r->y[k] = 0.0;
        if (r->f0) {
            r->f0[k] = 0.0;
        }
    }
    for (k = 0; k < plan->fast.channels; k++) {
        r->x[k] = 0.0;
        r->channel_scale[k] = 1.0;
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
    for (l = 0; l < BATCH_TILE; l++) {
        tile->two[l].certified = 0;
    }
    if (any && plan->fast.pair) {
        plan->kernels->two(&plan->fast, &rules, tile, live);
    }
}

/* Whether the bound of two lobes leaves room for a second lobe to be of use. */
static void judge_second(const struct batch *batch, size_t l, struct batch_result *r)
{
    const brdffit_plan *plan = batch->plan;

    if (plan->kernels && batch->tile.outcome[l].certified && r->status <= BRDFFIT_TEXEL_OPEN) {
        double one = (batch->tile.outcome[l].e2 + batch->tile.outcome[l].error) * unit_of(plan, &batch->tile, l);

        r->one_lobe_enough = one <= (1.0 + plan->options.relative_gap) * r->lower_bound ||
                             one - r->lower_bound <= plan->options.absolute_gap * r->sum_of_squares;
    }
}

void brdffit_batch_tile(struct batch *batch)
{
    const brdffit_plan *plan = batch->plan;
    const struct batch_outcome *outcome = plan->options.lobes > 1 ? batch->tile.two : batch->tile.outcome;
    int in_lanes = plan->kernels && (plan->options.lobes == 1 || plan->fast.pair);
    size_t l;

    if (plan->kernels) {
        fit_lanes(batch);
    }
    for (l = 0; l < batch->filled; l++) {
        struct batch_result *r = &batch->result[l];

        if (in_lanes && no_signal(&batch->tile, plan->fast.channels, l)) {
            keep_nothing(plan, r);
        } else if (!(in_lanes && outcome[l].certified && keep(plan, &batch->tile, &outcome[l], l, r))) {
            brdffit_batch_general(plan, batch, batch->row[l], r);
        }
        if (plan->options.lobes > 1) {
            judge_second(batch, l, r);
        }
    }
}
