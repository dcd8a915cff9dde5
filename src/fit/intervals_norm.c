/*
 * Norms of columns over intervals of roughness: see intervals.h. SPDX-License-Identifier: MIT
 *
 * y = z / |g| with |g(s)| = lambda(s) phi(s, c_min) conversion(s) sqrt(H): the first and third do not fall with s, the others
 * do not rise, so that their ends give a range. It is of first order; the search splits boxes where that matters.
 *
 * The interval at the end of the domain also stands for all narrower lobes, which differ in the scalar alone (theory 4.1): that
 * stretch is cut into pieces, each with such a range. Not so the second column of a lobe that does not see the sharpest
 * samples: there its norm may go to 0.
 */
#include "fit/intervals.h"

#include <float.h>
#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"

static int less(struct wide a, struct wide b)
{
    double unit;

    if (!(a.value > 0.0) || !(b.value > 0.0)) {
        return a.value < b.value;
    }
    unit = ldexp(1.0, (int)fmax(-1000.0, fmin(1000.0, (double)(a.exponent - b.exponent))));
    return a.value * unit < b.value;
}

static struct twofold plain(double s)
{
    const struct twofold t = {s, 0.0};

    return t;
}

/* The scalar, but for scale_b, with lambda and conversion at `rising` and phi at `falling`. */
static struct wide scalar(const struct lobe_kind *kind, const struct lobe_sight *sight, double rising, double falling)
{
    double rise = kind->lambda(rising) * (kind->conversion ? kind->conversion(sight, rising) : 1.0);

    return wide_times(wide_of(rise), kind->phi(plain(falling), sight->c_min));
}

struct wide brdffit_intervals_factor(const struct fit *f, int c, double theta)
{
    const struct table *t = varpro_table(&f->varpro, c);
    const struct lobe_kind *kind = model_column_kind(&f->model, c);
    double s = kernel_exp(theta);

    return wide_times(scalar(kind, &t->sight, s, s), wide_of(t->scale_b));
}

/* Whether an interval is the one that stands for narrower lobes, too. */
static int at_tail(const struct fit *f, int side, uint32_t interval)
{
    const struct domain *d = fit_domain(f, side);
    const struct axis *axis = &f->axis[f->model.lobe[side].kind];
    double low, high;

    brdffit_axis_ends(axis, interval, &low, &high);
    return high >= d->high && d->flat > d->high;
}

/* Widen a range by that of [low, high] of theta. */
static void join(const struct fit *f, int c, double low, double high, struct wide roots[2], struct wide_range *range)
{
    const struct table *t = varpro_table(&f->varpro, c);
    const struct lobe_kind *kind = model_column_kind(&f->model, c);
    double first = kernel_exp(low), last = kernel_exp(high);
    struct wide least = wide_times(scalar(kind, &t->sight, first, last), roots[1]);
    struct wide most = wide_times(scalar(kind, &t->sight, last, first), roots[0]);

    range->low = less(least, range->low) ? least : range->low;
    range->high = less(range->high, most) ? most : range->high;
}

struct wide_range brdffit_intervals_norm(struct intervals_work *w, int c, uint32_t interval)
{
    struct fit *f = w->fit;
    int side = model_lobe_of(&f->model, c), kind = model_kind_of(&f->model, c), i;
    const struct interval *v = brdffit_bound_moment_side(&f->moment, kind, interval, 0);
    const struct table *t = varpro_table(&f->varpro, c);
    struct wide roots[2] = {wide_of(v->low->root), wide_of(v->high->root)};
    struct wide_range range = {{0.5, 100000}, {0.0, 0}};
    double low, high, step;

    brdffit_axis_ends(&f->axis[f->model.lobe[side].kind], interval, &low, &high);
    join(f, c, low, high, roots, &range);
    if (at_tail(f, side, interval)) {
        step = (fit_domain(f, side)->flat - high) / TAIL_PIECES;
        roots[0] = roots[1];
        roots[1] = t->c_low > 0.0 ? wide_of(0.0) : roots[1];
        for (i = 0; i < TAIL_PIECES; i++) {
            join(f, c, high + i * step, brdffit_fit_outwards(high + (i + 1) * step, 1.0), roots, &range);
        }
    }
    range.low = wide_times(range.low, wide_of(t->scale_b * (1.0 - TOL_NORM)));
    range.high = wide_times(range.high, wide_of(t->scale_b * (1.0 + TOL_NORM)));
    return range;
}

struct wide brdffit_intervals_end_norm(struct intervals_work *w, int c, uint32_t interval, int high)
{
    struct fit *f = w->fit;
    int kind = model_kind_of(&f->model, c);
    const struct interval *v = brdffit_bound_moment_side(&f->moment, kind, interval, 0);
    double ends[2];

    brdffit_axis_ends(&f->axis[model_axis(&f->model, kind)], interval, &ends[0], &ends[1]);
    return wide_times(wide_of(high ? v->high->root : v->low->root), brdffit_intervals_factor(f, c, ends[high]));
}

struct wide brdffit_intervals_fixed_norm(const struct fit *f, int column)
{
    return wide_times(wide_of(sqrt(f->data.aa[column][column])), wide_of(f->data.scale_a[column]));
}

void brdffit_intervals_ratio(struct intervals_work *w, int side, uint32_t interval, double ratio[2])
{
    struct fit *f = w->fit;
    int c = side * f->model.each;
    const struct interval *g = brdffit_bound_moment_side(&f->moment, model_kind_of(&f->model, c), interval, 0);
    const struct interval *e = brdffit_bound_moment_side(&f->moment, model_kind_of(&f->model, c + 1), interval, 0);
    const struct table *one = varpro_table(&f->varpro, c), *two = varpro_table(&f->varpro, c + 1);
    double scale = one->scale_b / two->scale_b;

    ratio[0] = e->low->root > 0.0 ? g->high->root / e->low->root * scale * (1.0 - TOL_NORM) : 0.0;
    ratio[1] = e->high->root > 0.0 ? g->low->root / e->high->root * scale * (1.0 + TOL_NORM) : (double)INFINITY;
    if (at_tail(f, side, interval) && two->c_low > 0.0) {
        ratio[1] = INFINITY;
    }
}

double brdffit_intervals_value(const struct fit *f, size_t k, double z, struct wide norm, int up)
{
    struct wide unit = wide_times(wide_of(f->data.channel_scale[k]), wide_of(f->data.value_scale));

    if (!(z > 0.0)) {
        return 0.0;
    }
    if (!(norm.value > 0.0) || !isfinite(z)) {
        return up ? (double)INFINITY : 0.0;
    }
    z = wide_value(wide_over(wide_times(wide_of(z), unit), norm));
    return up ? z * (1.0 + 16.0 * TOL_UNIT) + DBL_MIN : fmin(fmax(z * (1.0 - 16.0 * TOL_UNIT) - DBL_MIN, 0.0), DBL_MAX);
}
