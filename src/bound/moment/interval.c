/*
 * Deviations from the chord over an interval: see interval.h. SPDX-License-Identifier: MIT
 *
 * Let g^ be the normalised lobe, x = -ell (c' for exponential families), means under p = bb phi^2 / H. For a
 * functional W~(u) = sum W phi / sqrt(H) with W >= 0 (theory 4.2 and 4.4)
 *
 *     W~'' = sum W [(x - mean)^2 + slope] g^  -  [E slope + 2 Var x] W~
 *
 * On [l, u] every phi, H, x and slope is decreasing, so with ends only (theory 4.2, "enclosures"):
 *
 *     W~'' <= max_{c0 in {mean(l), mean(u)}} sum W (x - c0)^2 phi(l) / sqrt(H(u))  -  inf[..] inf W~
 *     W~'' >= min_{c0 in [mean(u), mean(l)]} sum W (x - c0)^2 phi(u) / sqrt(H(l))  -  sup[..] sup W~
 *
 * kappa'' is that of W = ab over |a|; tau'' that of max(I,0) b minus that of max(-I,0) b. A chord errs by at
 * most (u - l)^2 / 8 times the second derivative. TOL_CURVATURE covers the rounding of all this.
 *
 * Refinement. Let the whole be split at fraction m, D(x) the excess of a function over the whole's chord at fraction x,
 * and d_L the left half's shift: D is at most the line from 0 to D(m) plus d_L times the half's own 4 y (1 - y), y = x/m,
 * so that over the whole's w = 4 x (1 - x)
 *
 *     D / w <= [D(m) / m + 4 d_L (m - x) / m^2] / (4 (1 - x)),      0 < x <= m,
 *
 * a Moebius function of x, largest at an end: D(m) / (4 m) + d_L / m at 0, D(m) / w(m) at m. The right half mirrors
 * it. The largest of the three numbers is a shift of the whole, and for a parabola the exact one. D(m) is a difference
 * of node values that carry their allowance on one side, so it gets that of both.
 *
 * Exponential lobes have x = c' and slope = 0, so that node sums suffice; the others sum over all
 * c, with each (x - c0)^2 enclosed on its own: interval_family.c.
 */
#include "bound/moment/interval.h"

#include <math.h>

#include "bound/moment/interval_family.h"
#include "base/tolerance.h"
#include "base/vector.h"

#define UP (1.0 + TOL_CURVATURE)
#define DOWN (1.0 - TOL_CURVATURE)

void brdffit_intervals_layout(struct intervals *t, struct arena *arena, size_t capacity, size_t channels, size_t fixed,
                              int second)
{
    t->interval = brdffit_arena_take(arena, capacity, sizeof *t->interval);
    marks_layout(&t->ready, arena, capacity);
    t->pool = brdffit_arena_take(arena, capacity, 2 * (channels + fixed) * sizeof(double));
    t->beside = second ? brdffit_arena_take(arena, capacity, sizeof *t->beside) : NULL;
}

void brdffit_intervals_start(struct intervals *t, struct moments *moments, int kind, struct intervals *first)
{
    t->first = first;
    t->moments = moments;
    t->kind = kind;
    t->exponential = moments->kind[kind].kind->exponential;
    marks_start(&t->ready);
}

/* sum W (x - mean - d)^2 phi from moments about the mean, with an allowance for its cancellation. */
static double shifted_square(const struct functional *f, double d, double allowance)
{
    double first = 2.0 * d * f->f1, second = d * d * f->f0;

    return (f->f2 - first + second) + allowance * (f->f2 + fabs(first) + second);
}

static double clip(double d, double low, double high)
{
    return d < low ? low : d > high ? high : d;
}

struct enclosure {
    double low, high;
};

/* W~'' of functional f for an exponential family. curvature: [inf, sup] of 2 m2. */
static struct enclosure exponential_functional(const struct interval *v, size_t f, struct enclosure curvature)
{
    const struct functional *low = &v->low->functional[f], *high = &v->high->functional[f];
    double reach = v->low->mean - v->high->mean; /* >= 0: the mean falls with s */
    double best = high->f0 > 0.0 ? clip(high->f1 / high->f0, 0.0, reach) : 0.0;
    double upper = larger(shifted_square(low, 0.0, TOL_CURVATURE), shifted_square(low, -reach, TOL_CURVATURE));
    double lower = larger(0.0, shifted_square(high, best, -TOL_CURVATURE));
    struct enclosure e;

    e.high = UP * upper / v->high->root - DOWN * curvature.low * (high->f0 / v->low->root);
    e.low = DOWN * lower / v->low->root - UP * curvature.high * (low->f0 / v->high->root);
    return e;
}

static struct enclosure exponential_curvature(struct interval *v)
{
    const struct node *l = v->low, *u = v->high;
    double d = l->mean - u->mean, ratio = l->h / u->h;
    double shifted = l->m4 + 4.0 * l->m3 * d + 6.0 * l->m2 * d * d + d * d * d * d;
    struct enclosure e;

    e.low = DOWN * (2.0 * u->m2 / ratio);
    e.high = UP * (2.0 * l->m2 * ratio);
    v->root_m4 = UP * sqrt(larger(l->m4, shifted) * ratio);
    return e;
}

static struct enclosure own_curvature(const struct intervals *t, struct interval *v)
{
    struct enclosure e;

    if (t->exponential) {
        return exponential_curvature(v);
    }
    v->root_m4 = INFINITY;
    brdffit_family_curvature(t->moments, t->kind, v, &e.low, &e.high);
    return e;
}

static struct enclosure functional_curvature(const struct intervals *t, const struct interval *v, size_t f,
                                             struct enclosure curvature)
{
    struct enclosure e;

    if (t->exponential) {
        return exponential_functional(v, f, curvature);
    }
    brdffit_family_functional(t->moments, t->kind, v, f, curvature.low, curvature.high, &e.low, &e.high);
    return e;
}

/* Whether the shifts are of use (LIMIT_SHIFT). */
static int usable(const struct intervals *t, const struct interval *v)
{
    int fine = !t->first || fabs(v->beside->shift) <= LIMIT_SHIFT, f;
    size_t k;

    for (f = 0; f < t->moments->data->fixed; f++) {
        fine = fine && fabs(v->kappa_shift[f]) <= LIMIT_SHIFT;
    }

    for (k = 0; k < t->moments->data->bounded && fine; k++) {
        fine = fabs(v->tau_shift[k]) <= LIMIT_SHIFT * t->moments->norm[k];
    }
    return fine;
}

/* Plain ranges by monotonicity, and the deviations of kappa and every tau. */
static void fill(struct intervals *t, struct interval *v)
{
    const struct reduced *data = t->moments->data;
    double epsilon = larger(v->low->epsilon, v->high->epsilon);
    double width = v->high->u - v->low->u;
    struct enclosure curvature = own_curvature(t, v), e;
    size_t k, f, K = data->bounded, F = (size_t)data->fixed;
    int negative = data->functionals > F + K;

    v->eighth = UP * (width * width / 8.0);
    v->curvature = curvature.low;
    for (f = 0; f < F; f++) {
        v->kappa_inf[f] = v->kappa_shift[f] = 0.0;
        if (data->aa[f][f] > 0.0) {
            double a_norm = sqrt(data->aa[f][f]), kappa_inf = v->high->functional[f].f0 / v->low->root / a_norm;

            e = functional_curvature(t, v, f, curvature);
            v->kappa_inf[f] = larger(0.0, kappa_inf - epsilon);
            v->kappa_shift[f] = v->eighth * smaller(e.high / a_norm, v->root_m4 - DOWN * (curvature.low * kappa_inf));
        }
    }
    for (k = 0; k < K; k++) {
        double sup = v->low->functional[F + k].f0 / v->high->root, curved;

        e = functional_curvature(t, v, F + k, curvature);
        curved = -e.low;
        if (negative) {
            sup -= v->high->functional[F + K + k].f0 / v->low->root;
            e = functional_curvature(t, v, F + K + k, curvature);
            curved += e.high;
        }
        v->tau_sup[k] = sup + epsilon * t->moments->norm[k];
        v->tau_shift[k] = v->eighth * curved;
    }
    v->usable = usable(t, v);
}

/* All lobes vanish, or the node at u is the node at l: the interval is one point. */
static void fill_point(const struct intervals *t, struct interval *v)
{
    size_t k;
    int f;

    v->eighth = 0.0;
    for (f = 0; f < t->moments->data->fixed; f++) {
        v->kappa_shift[f] = 0.0;
        v->kappa_inf[f] = larger(0.0, v->low->kappa[f]);
    }
    v->curvature = 0.0;
    v->root_m4 = 0.0;
    v->usable = 1;
    for (k = 0; k < t->moments->data->bounded; k++) {
        v->tau_shift[k] = 0.0;
        v->tau_sup[k] = v->low->tau[k];
    }
}

/*
 * The cosine m of the two columns of one lobe, which share phi: with x about the same origin, means X1 and X2 of it, and
 * W = b1 b2 summed, (ln g1^ g2^)' = -(2 x - X1 - X2), so that
 *
 *     m'' = sum W phi^2 / (sqrt(H1) sqrt(H2)) [(2 x - X1 - X2)^2 + 2 slope]  -  m sum over both of [E slope + 2 Var x]
 *
 * where the bracket is 4 (x - X)^2 + 2 slope about the mean X of the two. Upper ends as above.
 */
static void fill_beside(const struct intervals *t, struct interval *v, const struct interval *first)
{
    const struct couple low = {{t->first->kind, t->kind}, {v->low_index, v->low_index}};
    const struct couple high = {{t->first->kind, t->kind}, {v->high_index, v->high_index}};
    const struct pair *pair = brdffit_moments_pair(t->moments, &low);
    double least, curved, norms = v->high->root * first->high->root, wide = v->low->root * first->low->root, mu, value;

    v->beside->end[0] = pair->mu;
    value = pair->value;
    curved = norms > 0.0 ? brdffit_family_beside(t->moments, t->kind, v, first, pair) / norms : 0.0;
    pair = brdffit_moments_pair(t->moments, &high);
    mu = pair->mu;
    v->beside->end[1] = mu;
    v->beside->shift = 0.0;
    v->beside->least = larger(0.0, smaller(v->beside->end[0], mu));
    if (!(v->eighth > 0.0) || !(value > 0.0)) {
        return;
    }
    /* mu has the allowance for its sum; the nodes have that of their norms. */
    least = wide > 0.0 ? mu * (norms / wide) * DOWN : 0.0;
    least -= 2.0 * larger(larger(v->low->epsilon, v->high->epsilon), larger(first->low->epsilon, first->high->epsilon));
    v->beside->least = larger(0.0, least);
    v->beside->shift = v->eighth * (UP * curved - DOWN * ((v->curvature + first->curvature) * v->beside->least));
}

void brdffit_interval_fill(struct intervals *t, uint32_t index, const struct axis *axis)
{
    const struct axis_interval *i = &axis->interval[index];
    struct interval *v = &t->interval[index];
    size_t K = t->moments->data->bounded, F = (size_t)t->moments->data->fixed;

    v->low = brdffit_moments_node(t->moments, t->kind, i->low, axis->coordinate[i->low]);
    v->high = brdffit_moments_node(t->moments, t->kind, i->high, axis->coordinate[i->high]);
    v->low_index = i->low;
    v->high_index = i->high;
    v->refined = 0;
    v->tau_shift = t->pool + 2 * (K + F) * index;
    v->tau_sup = v->tau_shift + K;
    v->kappa_shift = v->tau_sup + K;
    v->kappa_inf = v->kappa_shift + F;
    v->beside = t->first ? &t->beside[index] : NULL;
    if (v->beside) {
        v->beside->shift = 0.0; /* usable() reads it before fill_beside() knows */
    }
    if (v->low->h > 0.0 && v->low->u < v->high->u) {
        fill(t, v);
    } else {
        fill_point(t, v);
    }
    if (t->first) {
        fill_beside(t, v, brdffit_interval(t->first, index, axis));
        v->usable = v->usable && usable(t, v);
    }
}

/* The shift of the whole from its halves; `middle`: D(m), with its rounding. */
static double joined(double m, double middle, double left, double right)
{
    double rest = 1.0 - m, within = larger(middle / (4.0 * m) + left / m, middle / (4.0 * rest) + right / rest);

    return larger(within, middle / (4.0 * m * rest));
}

void brdffit_interval_refine(struct intervals *t, struct interval *v, const struct interval *left,
                             const struct interval *right)
{
    double m = (left->high->u - v->low->u) / (v->high->u - v->low->u), rest = 1.0 - m, shift;
    double rounding = 4.0 * larger(v->low->epsilon, larger(v->high->epsilon, left->high->epsilon));
    const struct node *low = v->low, *high = v->high, *middle = left->high;
    size_t k;
    int f;

    /* m itself is rounded: its error times the rise along the chord is far below the rounding of the values. */
    if (!(m >= 0.01 && m <= 0.99)) {
        return;
    }
    for (f = 0; f < t->moments->data->fixed; f++) {
        shift = joined(m, rest * low->kappa[f] + m * high->kappa[f] - middle->kappa[f] + rounding, left->kappa_shift[f],
                       right->kappa_shift[f]);
        v->kappa_shift[f] = smaller(v->kappa_shift[f], shift);
    }
    if (t->first) {
        shift = joined(m, rest * v->beside->end[0] + m * v->beside->end[1] - left->beside->end[1] + 2.0 * rounding,
                       left->beside->shift, right->beside->shift);
        v->beside->shift = smaller(v->beside->shift, shift);
    }
    for (k = 0; k < t->moments->data->bounded; k++) {
        double above = middle->tau[k] - (rest * low->tau[k] + m * high->tau[k]) + rounding * t->moments->norm[k];

        v->tau_shift[k] = smaller(v->tau_shift[k], joined(m, above, left->tau_shift[k], right->tau_shift[k]));
    }
    v->usable = usable(t, v);
}

/* ---- pairs ---- */

static uint32_t end_of(const struct interval *v, int high)
{
    return high ? v->high_index : v->low_index;
}

const struct pair *brdffit_pair_corner(const struct sides *b, int corner)
{
    const struct couple at = {{b->kind[0], b->kind[1]},
                              {end_of(b->side[0], corner & 1), end_of(b->side[1], corner >> 1 & 1)}};

    return brdffit_moments_pair(b->moments, &at);
}

/*
 * Lobes of one kind: mu falls with their distance (the sum of phi phi' being log-convex), so the corner that is furthest
 * from the diagonal has the least. Of two kinds, and with Smith's masking, where that does not hold (smith.h): the sum of products falls with both variables, and so do the norms.
 */
double brdffit_pair_least(const struct sides *b)
{
    const struct node *low0 = b->side[0]->low, *low1 = b->side[1]->low;
    const struct node *high0 = b->side[0]->high, *high1 = b->side[1]->high;
    const struct pair *far;
    double norms, epsilon;

    if (b->kind[0] == b->kind[1] && !b->moments->kind[b->kind[0]].kind->smith) {
        return larger(0.0, brdffit_pair_corner(b, 2)->mu);
    }
    far = brdffit_pair_corner(b, 3);
    norms = low0->root * low1->root;
    if (!(norms > 0.0)) {
        return 0.0;
    }
    /* far->mu has the allowance for its sum; the nodes have that of their norms. */
    epsilon = 2.0 * larger(larger(low0->epsilon, low1->epsilon), larger(high0->epsilon, high1->epsilon));
    return larger(0.0, far->mu * (high0->root * high1->root / norms) * (1.0 - TOL_CURVATURE) - epsilon);
}

double brdffit_pair_shift(const struct sides *b, int which, double least)
{
    const struct interval *side = b->side[which];
    const struct pair *corner;
    double square, square_low, square_high;

    if (!(side->eighth > 0.0)) {
        return 0.0;
    }
    if (!moments_one_family(b->moments, b->kind[0], b->kind[1])) {
        return side->eighth * brdffit_family_pair(b, which, least);
    }
    corner = brdffit_pair_corner(b, 0);
    square_low = corner->mean - side->low->mean;
    square_high = corner->mean - side->high->mean;
    square = corner->value * (corner->variance + larger(square_low * square_low, square_high * square_high));
    square = UP * smaller(square / (b->side[0]->high->root * b->side[1]->high->root), side->root_m4);
    return side->eighth * (square - DOWN * (side->curvature * least));
}
