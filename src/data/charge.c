/*
 * What the rounding of geometry costs a proof. SPDX-License-Identifier: MIT
 *
 * Bounds are proven for the columns a, g that are there. Let a*, g*, I* be the true ones (rounding.h) and z* >= 0 the best
 * coefficients for them at some roughness. In the norm of the fit, over all samples and channels, with the columns >= 0
 *
 *     x |a*| and y_p |g_p*| <= |I*|  (l2: of the projection)      <= 2 |I*|  (l1, linf: the model is within 2 |I*|)
 *     root of E*^2 = |I* - A* z*| >= |I - A z*| - |I* - I| - |(A* - A) z*| >= root of the bound - doubt |I|
 *
 *     doubt = |I* - I| / |I| + |a* - a| / |a*| + sum_p |g_p* - g_p| / |g_p*|.
 *
 * So the charge is made where a box's bound is known, whatever engine found it, and it is small where E is.
 *
 * A lobe may be multiplied by any positive function of s, and c_min's first sample decides which: every error e of c counts
 * with that sample's as e + reference, and none of its own. With x = e sensitivity(s, c - e) the true b phi is within
 * b phi (beta + (1 + beta) x exp(x)), beta the relative error of b. For exponential lobes x = e s, and b phi x exp(x) falls
 * with s once (c' - e) s > 1.
 *
 * That is summed up in two steps. First from maxima, in one pass: relative errors of single samples are one of the norm,
 * and beyond c' s = X a sample is exp(-TAIL_EXPONENT) of c_min's, so that e s counts up to e X / c'. For ordinary data this is
 * below 1e-10 for every s, and one number does. Else the domain of theta is cut into cells, in which norms are taken
 * group by group, numerators at the low end and |g| at the high end.
 *
 * Hidden lobes (Lafortune, r.v about 0). A true model may exceed ours at these samples by t >= 0, |t| <= y b_hidden
 * phi(s, c_hidden), where the residual r is at most the data: (r - t)^2 >= r^2 where r <= 0, so only samples with positive
 * data count, and E^2 falls by 2 |r+| |t| at most, |r+| being at most E and at most the norm of those data.
 */
#include "data/charge.h"

#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "data/reduce_parts.h"

/* Rounding of all this. */
#define SAFE (1.0 + 1e-6)

void brdffit_charge_layout(struct charge *c, struct arena *arena, size_t count)
{
    c->light = ARENA_DOUBLES(arena, count);
    c->b = ARENA_DOUBLES(arena, count);
    c->c = ARENA_DOUBLES(arena, count);
    c->gamma = ARENA_DOUBLES(arena, count);
    c->off = ARENA_DOUBLES(arena, count);
    c->weight = ARENA_DOUBLES(arena, count);
}

void brdffit_charge_none(struct charge *c)
{
    c->diffuse = c->grazing = c->relative = c->reference = c->spread = c->joined = 0.0;
    c->hidden = c->hidden_c = c->hidden_data = 0.0;
    c->body = c->tail = c->root = c->step = 0.0;
    c->norm = BRDFFIT_NORM_L2;
    c->lobes = 0;
}

/* A sum in the norm, term by term, and its end. */
static double join(double sum, double term, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_L2 ? sum + term * term : norm == BRDFFIT_NORM_L1 ? sum + term : larger(sum, term);
}

static double root_of(double sum, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_L2 ? sqrt(sum) : sum;
}

/* ---- Groups ------------------------------------------------------------------------------------------------- */

void brdffit_charge_groups(struct reduced *r)
{
    struct charge *c = &r->charge;
    size_t place = 0, begin = 0, j = 0;
    double others = 0.0;

    while (place < r->used && isfinite(r->sample_c[r->order[place]])) {
        double gamma = c->c[r->order[place]], first = r->sample_c[r->order[place]];

        for (begin = place++; place < r->used && r->sample_c[r->order[place]] == first; place++) {
            double error = c->c[r->order[place]];

            gamma = larger(gamma, error);
            others = begin == 0 ? larger(others, error) : others;
        }
        c->gamma[j++] = gamma;
        if (begin == 0) {
            c->reference = c->c[r->order[0]];
            c->spread = place < 2                  ? 0.0
                        : r->c_min <= MIRROR_C_MIN ? c->joined + MIRROR_ROUNDING
                                                   : others + c->reference;
        }
    }
    c->lobes = place;
}

/* What only the table needs: norms of b and of its errors, group by group, and over all. */
static void fill_norms(struct reduced *r)
{
    struct charge *c = &r->charge;
    double all = 0.0, mean = 0.0, sum = 0.0;
    size_t place = 0, j;

    for (j = 0; place < c->lobes; j++) {
        double off = 0.0, weight = 0.0, here = r->sample_c[r->order[place]];

        for (; place < c->lobes && r->sample_c[r->order[place]] == here; place++) {
            uint32_t i = r->order[place];
            double b = r->sample_b[i], share = c->norm == BRDFFIT_NORM_L2 ? b * b : b;

            off = join(off, c->b[i] * b, c->norm);
            weight = join(weight, b, c->norm);
            all = join(all, b, c->norm);
            mean += share * r->c[j];
            sum += share;
        }
        c->off[j] = root_of(off, c->norm);
        c->weight[j] = root_of(weight, c->norm);
    }
    c->least = c->weight[0];
    c->all = c->norm == BRDFFIT_NORM_LINF ? 0.0 : root_of(all, c->norm);
    c->mean = sum > 0.0 ? SAFE * mean / sum : 0.0;
}

/* Samples without a lobe, which may hide one: those with positive data. */
static void charge_hidden(struct reduced *r, const brdffit_samples *samples, brdffit_norm norm)
{
    struct charge *c = &r->charge;
    double hidden = 0.0, data = 0.0, least = INFINITY;
    size_t place, k;

    for (place = c->lobes; place < r->used; place++) {
        uint32_t i = r->order[place];
        int positive = 0;

        for (k = 0; k < r->channels && c->b[i] > 0.0; k++) {
            double value = brdffit_reduce_value(r, samples, i, k);

            positive = positive || value > 0.0;
            data = join(data, larger(value, 0.0), norm);
        }
        if (positive) {
            hidden = join(hidden, c->b[i], norm);
            least = larger(0.0, smaller(least, c->c[i] - r->c_min));
        }
    }
    c->hidden = root_of(hidden, norm);
    c->hidden_data = root_of(data, norm);
    c->hidden_c = least;
}

/* Of a and of radiance made from f_r, which share the error of n.l: the largest, or, where that is a grazing light's, norms. */
static void charge_diffuse(struct reduced *r, const brdffit_samples *samples, brdffit_norm norm)
{
    struct charge *c = &r->charge;
    double a = 0.0, error = 0.0, data = 0.0, data_error = 0.0;
    size_t i, k;

    c->diffuse = 2.0 * SAFE * c->grazing;
    for (i = 0; i < r->used && c->grazing > 1e-12; i++) {
        a = join(a, r->sample_a[i], norm);
        error = join(error, r->sample_a[i] * c->light[i], norm);
        for (k = 0; k < r->channels; k++) {
            double value = fabs(brdffit_reduce_value(r, samples, (uint32_t)i, k));

            data = join(data, value, norm);
            data_error = join(data_error, value * c->light[i], norm);
        }
    }
    if (c->grazing > 1e-12) {
        a = a > 0.0 ? root_of(error, norm) / root_of(a, norm) : 0.0;
        data = data > 0.0 ? root_of(data_error, norm) / root_of(data, norm) : 0.0;
        c->diffuse = SAFE * (a + data);
    }
}

void brdffit_charge_samples(struct reduced *r, const brdffit_samples *samples, brdffit_norm norm)
{
    struct charge *c = &r->charge;

    brdffit_charge_groups(r);
    c->norm = norm;
    charge_diffuse(r, samples, norm);
    charge_hidden(r, samples, norm);
}

/* ---- The domain --------------------------------------------------------------------------------------------- */

/* Relative error of a lobe for any s up to `most`, from maxima: never below the truth, and enough for ordinary data. */
static double from_maxima(const struct reduced *r, const struct lobe_kind *kind, double most)
{
    const struct charge *c = &r->charge;
    double largest = 0.0, reach, sum = c->spread * kind->sensitivity(most, larger(0.0, r->c_min - c->spread));
    size_t j;

    for (j = 1; j < r->distinct; j++) {
        largest = larger(largest, r->bb[j]);
    }
    reach = largest > r->bb[0] ? 0.5 * kernel_log(largest / r->bb[0]) : 0.0;
    reach += TAIL_EXPONENT + kernel_log((double)c->lobes);
    for (j = 1; j < r->distinct; j++) {
        double error = c->gamma[j] + c->reference;

        if (kind->exponential) {
            sum = larger(sum, error * most * r->c[j] > error * reach ? error * reach / r->c[j] : error * most);
        } else {
            sum = larger(sum, error * kind->sensitivity(most, larger(0.0, r->c[j] + r->c_min - error)) +
                                  c->reference * kind->sensitivity(most, larger(0.0, r->c_min - c->reference)));
        }
    }
    return SAFE * (c->relative + (1.0 + c->relative) * sum * kernel_exp(smaller(sum, 1.0)) + 1e-17);
}

/* Error of group j of a lobe of s in [low, high] over b phi(s_low): x exp(x) of the s where it is largest. */
static double group_error(const struct reduced *r, const struct lobe_kind *kind, size_t j, double low, double high)
{
    const struct charge *c = &r->charge;
    double error = j ? c->gamma[j] + c->reference : c->spread, total = r->c_min + r->c[j], x;
    double s = kind->exponential && (r->c[j] - error) * low >= 1.0 ? low : high;

    x = error * kind->sensitivity(s, larger(0.0, total - error));
    if (!kind->exponential && j) {
        x += c->reference * kind->sensitivity(s, larger(0.0, r->c_min - c->reference));
    }
    return x < 600.0 ? x * kernel_exp(x) : INFINITY;
}

/* |g* - g| / |g| of lobes in [low, high] of theta. */
static double cell_error(const struct reduced *r, const struct lobe_kind *kind, const struct kernels *kernels,
                         double low, double high, double *phi)
{
    const struct charge *c = &r->charge;
    double s_low = kernel_exp(low), s_high = kernel_exp(high), u[3], size = 0.0, error = 0.0;
    size_t j;

    kind->variable(r->c_min, high, u);
    kind->shape(kernels, r->c, r->stride, u[0], phi);
    for (j = 0; j < r->distinct; j++) {
        size = join(size, c->weight[j] * phi[j], c->norm);
    }
    kind->variable(r->c_min, low, u);
    kind->shape(kernels, r->c, r->stride, u[0], phi);
    for (j = 0; j < r->distinct; j++) {
        double x = group_error(r, kind, j, s_low, s_high), lobe = c->weight[j] * phi[j];

        error = join(error, c->off[j] * phi[j] + (lobe > 0.0 ? (1.0 + c->relative) * x * lobe : 0.0), c->norm);
    }
    size = root_of(size, c->norm);
    return size > 0.0 ? SAFE * root_of(error, c->norm) / size + 1e-17 : error > 0.0 ? (double)INFINITY : 0.0;
}

/* |g*| is at least (1 - ratio) |g|. */
static double over_true(double part, double ratio)
{
    return ratio < 0.5 ? part / (1.0 - ratio) : (double)INFINITY;
}

static void fill_cells(struct reduced *r, const struct lobe_kind *kind, const struct kernels *kernels, double low,
                       double high, double *phi)
{
    struct charge *c = &r->charge;
    double width = (high - low) / CHARGE_CELLS;
    size_t i;

    for (i = 0; i < CHARGE_CELLS; i++) {
        c->cell[i] = cell_error(r, kind, kernels, low + (double)i * width, low + ((double)i + 1.0) * width, phi);
        c->cell[i] = over_true(c->cell[i], c->cell[i]);
    }
    c->low = low;
    c->step = width > 0.0 ? 1.0 / width : 0.0;
    c->body = width > 0.0 ? 0.0 : c->cell[0];
}

void brdffit_charge_domain(struct reduced *r, const struct lobe_kind *kind, const struct kernels *kernels,
                           const double theta[3], double fine, double *scratch)
{
    struct charge *c = &r->charge;
    double low = theta[0], high = theta[1], flat = larger(theta[2], theta[1]);

    c->step = 0.0;
    c->high = high;
    c->body = c->tail = c->least = c->all = c->mean = 0.0;
    c->diffuse = over_true(c->diffuse, c->diffuse);
    c->root = (c->norm == BRDFFIT_NORM_L2 ? sqrt(r->total) : 2.0 * r->total) * SAFE * (1.0 + c->diffuse);
    if (!(r->bb[0] > 0.0)) {
        return;
    }
    c->body = from_maxima(r, kind, kernel_exp(high));
    c->tail = larger(c->body, from_maxima(r, kind, kernel_exp(flat)));
    if (c->hidden > 0.0 || !(c->tail <= fine)) {
        fill_norms(r);
    }
    if (!(c->tail <= fine)) {
        c->tail = cell_error(r, kind, kernels, high, flat, scratch);
        c->tail = over_true(c->tail, c->tail);
    }
    if (!(c->body <= fine)) {
        fill_cells(r, kind, kernels, low, high, scratch);
    }
}

/*
 * What is hidden against |g*| of an exponential lobe: |g| is at least that of c_min's samples, and by Jensen's inequality at
 * least exp(-mean s) that of all b; |g*| is (1 - error) of it.
 */
static double hidden_share(const struct charge *c, double low, double high, double error)
{
    double size = larger(c->least, c->all * kernel_exp(-c->mean * kernel_exp(high)));

    return size > 0.0 && error < 0.5
               ? SAFE * c->hidden * kernel_exp(-c->hidden_c * kernel_exp(low)) / (size * (1.0 - error))
               : (double)INFINITY;
}

struct doubt brdffit_charge_lobe(const struct charge *c, double low, double high)
{
    struct doubt d = {c->body, 0.0};
    double first, last;

    if (c->step > 0.0) {
        first = larger(0.0, floor((low - c->low) * c->step - 1e-6));
        last = smaller(CHARGE_CELLS - 1.0, floor((high - c->low) * c->step + 1e-6));
        for (; first <= last; first += 1.0) {
            d.error = larger(d.error, c->cell[(size_t)first]);
        }
    }
    if (high >= c->high) {
        d.error = larger(d.error, c->tail);
    }
    if (c->hidden > 0.0) {
        d.hidden = hidden_share(c, low, high, d.error);
    }
    return d;
}

struct doubt brdffit_charge_box(const struct charge *c, int lobes, const double low[2], const double high[2])
{
    struct doubt d = brdffit_charge_lobe(c, low[0], high[0]), other;

    if (lobes > 1) {
        other = brdffit_charge_lobe(c, low[1], high[1]);
        d.error += other.error;
        d.hidden += other.hidden;
    }
    d.error += c->diffuse;
    return d;
}

double brdffit_charge_pay(const struct charge *c, const struct doubt *d, double bound)
{
    double root, paid, other;

    if (!(d->error + d->hidden > 0.0) || !(bound > 0.0)) {
        return bound;
    }
    if (c->norm != BRDFFIT_NORM_L2) {
        paid = (bound - d->error * c->root) - d->hidden * c->root;
        return paid > 0.0 ? paid * (1.0 - 8.0 * TOL_UNIT) : 0.0;
    }
    root = sqrt(bound) - d->error * c->root;
    if (!(root > 0.0)) {
        return 0.0;
    }
    paid = root * root;
    if (d->hidden > 0.0) {
        other = paid - 2.0 * c->hidden_data * (d->hidden * c->root);
        root -= d->hidden * c->root;
        paid = larger(root > 0.0 ? root * root : 0.0, other);
    }
    return paid > 0.0 ? paid * (1.0 - 8.0 * TOL_UNIT) : 0.0;
}
