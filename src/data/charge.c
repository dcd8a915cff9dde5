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

#include <math.h>

#include "base/vector.h"
#include "data/charge_parts.h"
#include "data/reduce_parts.h"

void brdffit_charge_layout_scratch(struct reduced *r, struct arena *arena, size_t count)
{
    double *light = ARENA_DOUBLES(arena, count);
    int g;

    for (g = 0; g < r->geometries; g++) {
        struct charge *c = &r->table[g].charge;

        c->light = light; /* the same whatever the geometry */
        c->b = ARENA_DOUBLES(arena, count);
        c->c = ARENA_DOUBLES(arena, count);
    }
}

void brdffit_charge_none(struct reduced *r)
{
    int i;

    for (i = 0; i < r->geometries; i++) {
        struct charge *c = &r->table[i].charge;

        c->diffuse = c->grazing = c->relative = c->reference = c->spread = c->joined = 0.0;
        c->hidden = c->hidden_c = c->hidden_data = c->most_hidden = c->root = 0.0;
        c->any_hidden = c->any_c = 0.0;
        c->norm = BRDFFIT_NORM_L2;
    }
    for (i = 0; i < FIXED_MOST; i++) {
        r->off_norm[i] = r->off_share[i] = 0.0;
    }
    for (i = 0; i < KINDS_MOST; i++) {
        r->kind_charge[i].body = r->kind_charge[i].tail = r->kind_charge[i].step = 0.0;
    }
}

/* ---- Groups ------------------------------------------------------------------------------------------------- */

/* Errors of c, group by group; those of c_min against its first sample. */
static void charge_groups(struct reduced *r, struct table *t)
{
    struct charge *c = &t->charge;
    double others = 0.0;
    size_t place, j, least = 0;

    for (j = 0; j < r->distinct && r->begin[j] < r->used; j++) {
        double gamma = 0.0;

        for (place = r->begin[j]; place < r->begin[j + 1]; place++) {
            uint32_t i = r->order[place];
            int lobe = isfinite(t->sample_c[i]);

            gamma = lobe ? larger(gamma, c->c[i]) : gamma;
            if (lobe && !(t->c[j] > t->c_low)) {
                others = least > 0 ? larger(others, c->c[i]) : others;
                c->reference = least == 0 ? c->c[i] : c->reference;
                least++;
            }
        }
        c->gamma[j] = gamma;
    }
    c->spread = least < 2 ? 0.0 : t->c_min <= MIRROR_C_MIN ? c->joined + MIRROR_ROUNDING : others + c->reference;
}

/* Samples without a lobe, which may hide one. A bound pays for those with positive data, a model for any. */
static void charge_hidden(struct reduced *r, struct table *t, const brdffit_samples *samples, brdffit_norm norm)
{
    struct charge *c = &t->charge;
    double hidden = 0.0, any = 0.0, data = 0.0, least = INFINITY, any_least = INFINITY;
    size_t i, k;

    for (i = 0; i < r->used && c->most_hidden > 0.0; i++) {
        int positive = 0, hides = !isfinite(t->sample_c[i]) && c->b[i] > 0.0;

        for (k = 0; k < r->channels && hides; k++) {
            double value = brdffit_reduce_value(r, samples, (uint32_t)i, k);

            positive = positive || value > 0.0;
            data = join(data, larger(value, 0.0), norm);
        }
        if (hides) {
            any = join(any, c->b[i], norm);
            any_least = larger(0.0, smaller(any_least, c->c[i] - t->c_min));
        }
        if (positive) {
            hidden = join(hidden, c->b[i], norm);
            least = larger(0.0, smaller(least, c->c[i] - t->c_min));
        }
    }
    c->hidden = root_of(hidden, norm);
    c->hidden_data = root_of(data, norm);
    c->hidden_c = least;
    c->any_hidden = root_of(any, norm);
    c->any_c = any_least;
}

/* Of a column known to `error`, relative to the true one; a column that may vanish is not known at all, and 4 leaves
 * nothing of any bound. */
static double charge_column(double size, double error)
{
    return !(error > 0.0) ? 0.0 : error < 0.5 * size ? error / (size - error) : 4.0;
}

/* Of fixed columns what is not the error of n.l: norms of it, and these over those of the columns. */
static double charge_columns(struct reduced *r, brdffit_norm norm)
{
    double sum = 0.0;
    size_t i;
    int f;

    for (f = 0; f < r->fixed; f++) {
        const double *a = r->sample_a + (size_t)f * r->room, *off = r->off_a + (size_t)f * r->room;
        double size = 0.0, error = 0.0;

        for (i = 0; i < r->used && r->diffuse_off; i++) {
            size = join(size, a[i], norm);
            error = join(error, off[i], norm);
        }
        r->off_norm[f] = SAFE * root_of(error, norm);
        r->off_share[f] = SAFE * charge_column(root_of(size, norm), root_of(error, norm));
        sum += r->off_share[f];
    }
    return sum;
}

/* Of a and of radiance made from f_r, which share the error of n.l: the largest, or, where that is a grazing light's, norms. */
static void charge_diffuse(struct reduced *r, struct charge *c, const brdffit_samples *samples, brdffit_norm norm)
{
    double a[FIXED_MOST] = {0.0}, error[FIXED_MOST] = {0.0}, data = 0.0, data_error = 0.0;
    size_t i, k, f;

    c->diffuse = (1.0 + r->fixed) * SAFE * c->grazing;
    for (i = 0; i < r->used && c->grazing > 1e-12; i++) {
        for (f = 0; f < (size_t)r->fixed; f++) {
            a[f] = join(a[f], r->sample_a[f * r->room + i], norm);
            error[f] = join(error[f], r->sample_a[f * r->room + i] * c->light[i], norm);
        }
        for (k = 0; k < r->channels; k++) {
            double value = fabs(brdffit_reduce_value(r, samples, (uint32_t)i, k));

            data = join(data, value, norm);
            data_error = join(data_error, value * c->light[i], norm);
        }
    }
    if (c->grazing > 1e-12) {
        c->diffuse = data > 0.0 ? root_of(data_error, norm) / root_of(data, norm) : 0.0;
        for (f = 0; f < (size_t)r->fixed; f++) {
            c->diffuse += a[f] > 0.0 ? root_of(error[f], norm) / root_of(a[f], norm) : 0.0;
        }
        c->diffuse *= SAFE;
    }
    c->diffuse += charge_columns(r, norm);
}

void brdffit_charge_groups(struct reduced *r)
{
    int g;

    for (g = 0; g < r->geometries; g++) {
        charge_groups(r, &r->table[g]);
    }
}

void brdffit_charge_samples(struct reduced *r, const brdffit_samples *samples, brdffit_norm norm)
{
    int g;

    for (g = 0; g < r->geometries; g++) {
        struct table *t = &r->table[g];

        charge_groups(r, t);
        t->charge.norm = norm;
        if (g == 0) {
            charge_diffuse(r, &t->charge, samples, norm);
        }
        charge_hidden(r, t, samples, norm);
    }
}
