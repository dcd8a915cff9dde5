/*
 * What a fit of binned sums proves about the samples themselves. SPDX-License-Identifier: MIT
 *
 * Binned sums (sums_bins.c) are those of a legitimate data set: a sample (a, b, c, I) of weight w in a cell [l, u] of
 * width h counts as two, at l with w (u - c) / h and at u with w (c - l) / h. The search proves E_b^2 >= B for it.
 * Let f(c) = sum_p Y_p exp(-s_p c) with Y, s >= 0 be the lobes of one channel, r the residual of a sample, and
 * e_l = b (f(l) - f(c)) >= 0 >= e_u = b (f(u) - f(c)), so that its residuals at the nodes are r + e. Then
 *
 *     E_b^2 - E^2 = sum w [2 r b eps + q],    b eps = ((u - c) e_l + (c - l) e_u) / h,
 *                                             q = ((u - c) e_l^2 + (c - l) e_u^2) / h.
 *
 * eps is the error of linear interpolation of a convex f: 0 <= eps <= h^2/8 f''(l). |f'| falls, so that
 * |e_l| <= b (c - l) |f'(l)|, |e_u| <= b (u - c) |f'(l)| and 0 <= q <= b^2 f'(l)^2 (u - c)(c - l) <= b^2 f'(l)^2 h^2/4.
 * With Cauchy-Schwarz over samples and channels
 *
 *     -2 E d <= E_b^2 - E^2 <= 2 E d + D,    D = sum w b^2 h^2/4 f'(l)^2,   d^2 = sum w b^2 h^4/64 f''(l)^2.     (1)
 *
 * At a given model the sums D and d are evaluated as they stand, and (1) bounds E there: E <= d + sqrt(d^2 + E_b^2),
 * |E_b^2 - E^2| <= 2 E d + D.
 *
 * Lower bound: whatever the lobes' s, let x and Y be the samples' best. Then Y_p H <= V, where H = sum w b^2 phi^2 and
 * V = sum w b max(I, 0) phi over samples (the optimality condition of Y_p > 0; the inner products of a, b phi_p and
 * b phi_q are not negative), and Y_p^2 H <= sum w I^2 = T of the channel. By Minkowski over P lobes (1) holds with
 *
 *     D <= P^2 sup_s A_1(s) Q(s),   d^2 <= P^2 sup_s A_2(s) Q(s),   Q = sum_k min(V_k^2 / H, T_k) / H,
 *     A_1 = sum w b^2 (h s)^2/4 exp(-2 s l),   A_2 = sum w b^2 (h s)^4/64 exp(-2 s l),
 *
 * and from E^2 + 2 E d + D >= E_b^2 >= B follows E >= sqrt(d^2 + B - D) - d. Nothing changes when a constant c0 is taken
 * from every c (Y takes it up).
 *
 * The sup over s is taken interval by interval, [s, t] with t = STEP s: powers of s at t, exponentials of A at s (at t
 * where a node is below c0), H at t with cells at u and exact groups as they are, and V of the binned sums at s, which
 * is not below that of the samples (exp is convex). Once every cell has s (l - c0) >= FAR, (h s)^q exp(-2 s (l - c0))
 * falls with s, and one last interval reaches to infinity: its H is that of the smallest c, c0, which is an exact group.
 * SLACK covers rounding.
 */
#include <math.h>

#include "model/lobe.h"
#include "base/exp.h"
#include "data/sums.h"

#define STEP 1.04427378242741384 /* 2^(1/16) */
#define FAR 40.0
#define SLACK (1.0 + 1e-9)

struct remainder {
    double first, second; /* D and d^2 */
};

/* What does not depend on s. */
struct cells {
    const struct brdffit_sums *sums;
    const double *scale; /* K: channel scales */
    double smallest;     /* c0 */
    double nearest;      /* smallest l - c0 of the cells; INFINITY when there is none */
};

static struct cells open_cells(const struct brdffit_sums *s, const double *scale)
{
    struct cells v = {s, scale, INFINITY, INFINITY};
    size_t g;

    if (s->exact_used > 0) {
        v.smallest = s->c[s->ascending[0]];
    }
    for (g = s->exact; g < s->groups; g++) {
        if (sums_value(&s->cell[g]) > 0.0) {
            v.nearest = fmin(v.nearest, s->c[g] - v.smallest);
        }
    }
    return v;
}

static double product(const struct cells *v, size_t g, size_t which)
{
    return sums_value(sums_group(v->sums, g) + which);
}

/* exp(-s (c - c0)) and no less than that. */
static double falls(const struct cells *v, double s, double c)
{
    double x = s * (c - v->smallest);

    return x < -700.0 ? (double)INFINITY : kernel_exp(-fmin(700.0, x)); /* beyond 700, a bound from above */
}

/* The largest on [s, t]: nodes may be below c0, where it rises. */
static double falls_most(const struct cells *v, double s, double t, double c)
{
    return falls(v, c < v->smallest ? t : s, c);
}

/* H of the samples at least, at t; of c0 alone when t is infinite. */
static double norm_below(const struct cells *v, double t)
{
    const struct brdffit_sums *s = v->sums;
    double h = product(v, s->ascending[0], SUMS_BB);
    size_t g;

    for (g = 1; g < s->exact_used && isfinite(t); g++) {
        h += product(v, s->ascending[g], SUMS_BB) * kernel_exp(-2.0 * t * (s->c[s->ascending[g]] - v->smallest));
    }
    for (g = s->exact; g < s->groups && isfinite(t); g++) {
        double bb = sums_value(&s->cell[g]), upper = s->c[g] + brdffit_sums_width(s, s->c[g]) - v->smallest;

        if (bb > 0.0 && 2.0 * t * upper < 700.0) {
            h += bb * kernel_exp(-2.0 * t * upper);
        }
    }
    return h / SLACK;
}

/* A_1 and A_2 with powers of t and exponentials of s. */
static struct remainder moments_above(const struct cells *v, double s, double t)
{
    struct remainder a = {0.0, 0.0};
    size_t g;

    for (g = v->sums->exact; g < v->sums->groups; g++) {
        double bb = sums_value(&v->sums->cell[g]), c = v->sums->c[g];
        double x = brdffit_sums_width(v->sums, c) * t, term;

        if (bb > 0.0) {
            term = bb * x * x * falls_most(v, 2.0 * s, 2.0 * t, c);
            a.first += term / 4.0;
            a.second += term * (x * x / 64.0);
        }
    }
    return a;
}

/* Q, with V on [s, t] and H given. */
static double data_above(const struct cells *v, double s, double t, double h)
{
    size_t g, k, K = v->sums->channels;
    double sum = 0.0;

    for (k = 0; k < K; k++) {
        size_t positive = SUMS_CHANNEL + SUMS_PER_CHANNEL * k + SUMS_POSITIVE;
        size_t square = SUMS_CHANNEL + SUMS_PER_CHANNEL * k + SUMS_II;
        double along = 0.0, total = 0.0;

        for (g = 0; g < v->sums->groups; g++) {
            double lobe = product(v, g, positive);

            total += product(v, g, square);
            if (lobe > 0.0) {
                along += lobe * falls_most(v, s, t, v->sums->c[g]);
            }
        }
        along = along / v->scale[k] / sqrt(h);
        sum += fmin(along * along, total / v->scale[k] / v->scale[k]);
    }
    return SLACK * sum / h;
}

/* The suprema over s >= first of A_1 Q and A_2 Q. */
static struct remainder largest(const struct cells *v, double first, double last)
{
    struct remainder most = {0.0, 0.0}, a;
    double s = first, t, reach;

    for (; s <= last && isfinite(v->nearest); s = t) {
        int end = v->nearest > 0.0 && s * v->nearest >= FAR;
        double h, q;

        t = s * STEP;
        reach = end ? s : t; /* the powers of s, which the exponential outdoes at the end */
        h = norm_below(v, end ? INFINITY : t);
        a = moments_above(v, s, reach);
        q = data_above(v, s, reach, h);
        if (!isfinite(a.first * q) || !isfinite(a.second * q)) {
            most.first = most.second = INFINITY;
            return most;
        }
        most.first = fmax(most.first, SLACK * a.first * q);
        most.second = fmax(most.second, SLACK * a.second * q);
        if (end) {
            break;
        }
    }
    return most;
}

/* D and d^2 of channel k at the model found; the lobes' Y for c - c0. */
static struct remainder at_model(const struct cells *v, const struct brdffit_result *result, size_t k)
{
    const struct lobe_kind *kind = brdffit_lobe_kind_of(v->sums->distribution);
    double s[BRDFFIT_MAX_LOBES], y[BRDFFIT_MAX_LOBES];
    struct remainder sum = {0.0, 0.0};
    size_t g;
    int p;

    for (p = 0; p < result->model->lobes; p++) {
        struct twofold exact = twofold_inverse_square(result->model->sigma[p]);
        struct wide all = wide_of(result->model->y[k * (size_t)result->model->lobes + (size_t)p]);

        s[p] = exact.high;
        y[p] = wide_value(wide_times(all, brdffit_lobe_factor(kind, exact, v->smallest))) / v->scale[k];
    }
    for (g = v->sums->exact; g < v->sums->groups; g++) {
        double bb = sums_value(&v->sums->cell[g]), first = 0.0, second = 0.0;
        double width = brdffit_sums_width(v->sums, v->sums->c[g]);

        for (p = 0; p < result->model->lobes && bb > 0.0; p++) {
            double x = width * s[p];
            double lobe = y[p] * falls(v, s[p], v->sums->c[g]);

            first += x * lobe;
            second += x * x * lobe;
        }
        sum.first += bb * first * first / 4.0;
        sum.second += bb * second * second / 64.0;
    }
    return sum;
}

static double model_error(const struct cells *v, const brdffit_result *result)
{
    struct remainder sum = {0.0, 0.0}, one;
    double above;
    size_t k;

    for (k = 0; k < v->sums->channels; k++) {
        one = at_model(v, result, k);
        sum.first += SLACK * one.first;
        sum.second += SLACK * one.second;
    }
    above = sqrt(sum.second) + sqrt(sum.second + result->e2 + result->e2_error);
    above = SLACK * (2.0 * above * sqrt(sum.second) + sum.first);
    return isfinite(above) ? above : INFINITY;
}

static double lower_bound(const struct cells *v, const brdffit_options *o, const brdffit_result *result)
{
    int by_exponent = brdffit_lobe_kind_of(o->distribution)->by_exponent;
    double first = by_exponent ? o->exponent_min : 1.0 / (o->sigma_max * o->sigma_max);
    double last = by_exponent ? o->exponent_max : 1.0 / (o->sigma_min * o->sigma_min);
    struct remainder most = largest(v, first / SLACK, last * SLACK);
    double lobes = (double)o->lobes, rest, root;

    rest = result->lower_bound - SLACK * lobes * lobes * most.first;
    root = lobes * sqrt(most.second);
    if (!(rest > 0.0) || !isfinite(root)) {
        return 0.0;
    }
    root = rest / (sqrt(root * root + rest) + root); /* sqrt(d^2 + B - D) - d */
    return root * root / SLACK;
}

void brdffit_sums_remainder(const struct brdffit_sums *s, const brdffit_options *o, brdffit_result *result)
{
    struct cells v = open_cells(s, result->channel_scale);

    if (!isfinite(v.nearest)) {
        return; /* every c is exact */
    }
    result->e2_error += model_error(&v, result);
    result->lower_bound = fmin(result->lower_bound, lower_bound(&v, o, result));
}
