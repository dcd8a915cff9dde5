/*
 * Physical bounds in engine `moment`: see limits.h. SPDX-License-Identifier: MIT
 *
 * For any lambda >= 0 (Lagrange)
 *
 *     max {2 t.z - z'M z : z >= 0, a.z <= 1}  <=  R(t - lambda a / 2, M) + lambda,
 *
 * with equality for the right one. Each channel has its lambda, one for the whole box: the mean of those of its lowest and
 * highest corner. R rises with t, so a may be replaced by what it is not below: as a function of u along its side, a lies
 * above its chord less w(x) = 4 x (1 - x) times an allowance, which is then added to the shift of tau (bound.c). For
 *
 *     ln a = const - ln |g^| - ln D,      D(s) = lambda(s) phi(s, c_min) conversion(s):
 *
 *     -ln |g^| is concave, because phi is log-convex in u, and |g^| too;
 *     -ln D is concave, but for at most 2 (-ln u) and -ln(1 - k u), u = s / (1 + k s). Exponential lobes: k = 0,
 *     ln lambda(s) = ln(s + const), and ln phi = -c_min s is linear. GGX, k = c_min: D = u (1 - k u). Smith's conversion makes
 *     it 2 ln u at most, with smith.h's k.
 *
 * How far a convex f with f(0) = f(1) = 0 lies below 0 over [0, 1], divided by w: at most |f'(0)| / 4 where f'' falls and
 * |f'(1)| / 4 where it rises. For with h = f'' falling,
 *     -f(x) / (x (1 - x)) = (1 / x) int_0^x t h + (1 / (1 - x)) int_x^1 (1 - t) h  <=  int_0^1 (1 - t) h = |f'(0)|:
 * the difference is int_0^x [1 - t - t / x] h - x / (1 - x) int_x^1 (1 - t) h, the first at least h(x) x (1 - x) / 2, the
 * second at most that. So with r = u_high / u_low and q = (1 - k u_low) / (1 - k u_high) = (1 + k s_high) / (1 + k s_low),
 *
 *     ln a is above its chord less w d,  d = [2 (r - 1 - ln r) + (q - 1 - ln q)] / 4,
 *     a is above its chord less w [d + (ln p - 1 + 1 / p) / 4] max a,  p the ratio of its ends: exp of a chord likewise.
 *
 * Where that is of no use, a is replaced by its infimum, a constant: |g^| and phi at the low end, lambda and conversion at
 * the high one. A lambda is that of what is used instead of a.
 *
 * Rounding. a is taken lower by TOL_CURVATURE: its exponents (up to 709) make 1e-12 of it, those of the ends' theta 4e-11.
 * What is taken off t is less by rounding than it should be, never more. t below -|I| counts as -|I|: a raise, as far as
 * any column with t <= 0 is unused, and keeps gains in the range that they are made for.
 */
#include "bound/moment/limits.h"

#include "base/exp.h"
#include "base/log.h"
#include "bound/moment/view.h"
#include "data/physical.h"

#define DOWN (1.0 - TOL_CURVATURE)
#define UP (1.0 + TOL_CURVATURE)
/* Largest allowance of a chord, relative to max a. */
#define CHORD_MOST 0.25

void brdffit_limits_layout(struct limits *l, struct arena *arena, size_t channels, const struct model *model)
{
    int c;

    l->multiplier = ARENA_DOUBLES(arena, channels);
    for (c = 0; c < model->fixed; c++) {
        l->omega[c] = ARENA_DOUBLES(arena, channels);
    }
    for (c = 0; c < model->columns - model->fixed; c++) {
        l->tau[c][0] = ARENA_DOUBLES(arena, channels);
        l->tau[c][1] = ARENA_DOUBLES(arena, channels);
        l->shift[c] = ARENA_DOUBLES(arena, channels);
        l->sup[c] = ARENA_DOUBLES(arena, channels);
    }
}

/* What a unit coefficient of a column counts for, but for the channel: at both ends, its infimum, and the allowance. */
struct count {
    struct wide end[2], least;
    double norm[2];   /* of the column, at both ends */
    double allowance; /* d, of ln a */
};

static double end_of(const struct view *v, int c, int high)
{
    const struct model *model = v->engine->model;
    const struct interval *side = v->column[c];

    return v->engine->axis[model->lobe[model_lobe_of(model, c)].kind]
        .coordinate[high ? side->high_index : side->low_index];
}

/* x - 1 - ln x, rounded up. */
static double excess(double x)
{
    return larger(0.0, x - 1.0 - kernel_log(x)) + TOL_CURVATURE;
}

static void open_count(const struct view *v, int c, struct count *out)
{
    const struct kind_moments *m = &v->engine->moments.kind[model_kind_of(v->engine->model, c)];
    const struct interval *side = v->column[c];
    double low = end_of(v, c, 0), high = end_of(v, c, 1), r = side->high->u / side->low->u;
    double q = kernel_exp(high - low) / r;

    out->end[0] = brdffit_physical_lobe(m->kind, m->table, low);
    out->end[1] = brdffit_physical_lobe(m->kind, m->table, high);
    out->least = brdffit_physical_least(m->kind, m->table, low, high);
    out->norm[0] = side->low->root;
    out->norm[1] = side->high->root;
    out->allowance = 0.25 * UP * (2.0 * excess(larger(r, 1.0)) + excess(larger(q, 1.0)));
}

/* A channel's a of a column over the box: at its ends, its infimum, and how far it may be below its chord; infinite
 * where that is not used. */
struct slope {
    double end[2], least, lift;
};

static double capped(double a)
{
    return a < NNLS_LIMIT_MOST ? DOWN * a : NNLS_LIMIT_MOST; /* less is safe */
}

static double unit_of(const struct view *v, struct wide counts, double norm, size_t k)
{
    const struct reduced *data = v->engine->moments.data;

    return capped(brdffit_physical_unit(data, counts, norm, data->bound_channel[k]) / data->bound_root[k]);
}

static struct slope slope_of(const struct view *v, const struct count *count, size_t k)
{
    struct slope a = {{unit_of(v, count->end[0], count->norm[0], k), unit_of(v, count->end[1], count->norm[1], k)},
                      unit_of(v, count->least, count->norm[0], k),
                      0.0};
    double most = larger(a.end[0], a.end[1]), least = smaller(a.end[0], a.end[1]), p;

    if (!(count->norm[0] > 0.0 && count->norm[1] > 0.0 && least > 0.0)) {
        a.lift = INFINITY;
        return a;
    }
    p = least / most; /* ln(1 / p) - 1 + p */
    a.lift = UP * most * (count->allowance + 0.25 * excess(p));
    if (a.lift <= CHORD_MOST * most) {
        a.least = larger(a.least, least - a.lift);
    } else {
        a.lift = INFINITY;
    }
    return a;
}

/* What is used of it at an end. */
static double used(const struct slope *a, int high)
{
    return a->lift < INFINITY ? a->end[high] : a->least;
}

/* t less lambda a / 2, rounded up, and not below -|I|. */
static double lowered(double t, double multiplier, double a, double norm)
{
    double off = 0.5 * (multiplier * a);

    return larger((t - off) + 8.0 * TOL_UNIT * (fabs(t) + off), -norm);
}

/* Channel k at the lowest or highest corner: its multiplier, and its coefficients. */
static double multiplier_at(const struct view *v, const struct nnls *nnls, const double *a, int high, size_t k,
                            double *unit)
{
    double t[COLUMNS_MOST], norm = v->engine->moments.norm[k], out;
    int c, F = v->engine->model->fixed;

    for (c = 0; c < v->engine->model->columns; c++) {
        t[c] = c < F ? v->gains.omega[c][k] : v->gains.tau[c - F][high][k];
    }
    out = brdffit_nnls_multiplier(nnls, t, a, unit);
    return out > 0.0 ? smaller(out, norm * norm) : 0.0;
}

/* Columns at that corner. */
static void factor_corner(const struct view *v, int high, struct nnls *nnls)
{
    const struct model *model = v->engine->model;
    double cosine[NNLS_COLUMNS][NNLS_COLUMNS];
    int i, j, n = model->columns, F = model->fixed;

    for (i = 0; i < n; i++) {
        for (j = i + 1; j < n; j++) {
            int corner = !high || j < F ? 0 : of_two_sides(i, j, F, model->each) ? 3 : 1;

            cosine[i][j] = larger(0.0, v->gains.cosine[COSINE(n, i, j)][corner]);
        }
    }
    brdffit_nnls_factor_gram(nnls, n, cosine);
}

/* A lobe's column in channel k. */
static void lower_lobe(struct view *v, int c, const struct slope *a, size_t k)
{
    struct limits *l = &v->engine->limits;
    double norm = v->engine->moments.norm[k], multiplier = l->multiplier[k], lift = 0.5 * UP * (multiplier * a->lift);
    int chord = multiplier == 0.0 || lift <= norm;

    l->tau[c][0][k] = lowered(v->gains.tau[c][0][k], multiplier, chord ? a->end[0] : a->least, norm);
    l->tau[c][1][k] = lowered(v->gains.tau[c][1][k], multiplier, chord ? a->end[1] : a->least, norm);
    l->shift[c][k] = v->gains.shift[c][k] + (chord && multiplier > 0.0 ? lift : 0.0);
    l->sup[c][k] = lowered(v->column[c]->tau_sup[k], multiplier, a->least, norm);
}

/* What the limits count for in channel k: of all columns at both corners, and of those of lobes over the box. */
static void open_channel(const struct view *v, const struct count *count, size_t k, double corner[2][COLUMNS_MOST],
                         struct slope *slope)
{
    const struct moments *m = &v->engine->moments;
    int c, F = v->engine->model->fixed;

    for (c = 0; c < F; c++) {
        double norm = m->inverse_a[c] > 0.0 ? 1.0 / m->inverse_a[c] : 0.0;

        corner[0][c] = corner[1][c] = unit_of(v, brdffit_physical_fixed(m->data, c), norm, k);
    }
    for (c = 0; c < v->engine->model->columns - F; c++) {
        slope[c] = slope_of(v, &count[c], k);
        corner[0][F + c] = used(&slope[c], 0);
        corner[1][F + c] = used(&slope[c], 1);
    }
}

/* What constants in the place of slopes cost at a corner with these coefficients. */
static void add_loss(struct view *v, const struct slope *slope, int high, double multiplier, const double *unit)
{
    const struct model *model = v->engine->model;
    int c;

    for (c = 0; c < model->columns - model->fixed; c++) {
        double off = slope[c].end[high] - used(&slope[c], high);

        v->engine->limits.loss[model_lobe_of(model, c)] += multiplier * off * unit[model->fixed + c];
    }
}

static double apply_channel(struct view *v, const struct nnls *nnls, const struct count *count, size_t k)
{
    struct limits *l = &v->engine->limits;
    double a[2][COLUMNS_MOST], unit[NNLS_COLUMNS], at[2];
    struct slope slope[MOVING_MOST];
    int c, high, F = v->engine->model->fixed;

    open_channel(v, count, k, a, slope);
    for (high = 0; high < 2; high++) {
        at[high] = multiplier_at(v, &nnls[high], a[high], high, k, unit);
        add_loss(v, slope, high, at[high], unit);
    }
    l->multiplier[k] = 0.5 * (at[0] + at[1]);
    for (c = 0; c < F; c++) {
        l->omega[c][k] = lowered(v->gains.omega[c][k], l->multiplier[k], a[0][c], v->engine->moments.norm[k]);
    }
    for (c = 0; c < v->engine->model->columns - F; c++) {
        lower_lobe(v, c, &slope[c], k);
    }
    return l->multiplier[k];
}

void brdffit_limits_apply(struct view *v)
{
    struct limits *l = &v->engine->limits;
    const struct reduced *data = v->engine->moments.data;
    struct count count[MOVING_MOST];
    struct nnls corner[2];
    double sum = 0.0;
    size_t k;
    int c, F = v->engine->model->fixed, moving = v->engine->model->columns - F;

    for (c = 0; c < moving; c++) {
        l->loss[model_lobe_of(v->engine->model, c)] = 0.0;
        open_count(v, c, &count[c]);
    }
    factor_corner(v, 0, &corner[0]);
    factor_corner(v, 1, &corner[1]);
    for (k = 0; k < data->bounded; k++) {
        sum += apply_channel(v, corner, count, k);
    }
    l->raised = sum + (2.0 * (double)data->bounded + 32.0) * TOL_UNIT * (sum + data->total);
    for (c = 0; c < F; c++) {
        v->gains.omega[c] = l->omega[c];
    }
    for (c = 0; c < moving; c++) {
        v->gains.tau[c][0] = l->tau[c][0];
        v->gains.tau[c][1] = l->tau[c][1];
        v->gains.shift[c] = l->shift[c];
        v->sup[c] = l->sup[c];
    }
}
