/*
 * What the rounding of geometry costs the lobes of a domain: the second half of charge.c's argument, "summed up in two steps".
 * SPDX-License-Identifier: MIT
 */
#include "data/charge.h"

#include <math.h>

#include "base/exp.h"
#include "base/log.h"
#include "base/vector.h"
#include "data/charge_parts.h"
#include "data/reduce_parts.h"

/* Relative error of a lobe for any s up to `most`, from maxima: never below the truth, and enough for ordinary data. */
static double from_maxima(const struct reduced *r, const struct table *t, const struct lobe_kind *kind, double most)
{
    const struct charge *c = &t->charge;
    double largest = 0.0, sharpest = 0.0, reach;
    double sum = c->spread * kind->sensitivity(most, larger(0.0, t->c_min + t->c_low - c->spread));
    size_t j;

    for (j = 0; j < r->distinct; j++) {
        if (t->c[j] > t->c_low) {
            largest = larger(largest, t->bb[j]);
        } else {
            sharpest = larger(sharpest, t->bb[j]);
        }
    }
    reach = largest > sharpest ? 0.5 * kernel_log(largest / sharpest) : 0.0;
    reach += TAIL_EXPONENT + kernel_log((double)r->used);
    /* What masking adds to a shape at most, s being at least 1e-6 (smith.h). */
    reach += t->masked ? kernel_log(1.0 + 1e6 * 4.0 * t->sight.tan2_most) : 0.0;
    for (j = 0; j < r->distinct; j++) {
        double error = c->gamma[j] + c->reference;

        double beyond = t->c[j] - t->c_low;

        if (!(beyond > 0.0) || !(t->bb[j] > 0.0)) {
            continue;
        }
        if (kind->steep) {
            sum = larger(sum, error * most * beyond > error * reach ? error * reach / beyond : error * most);
        } else {
            sum = larger(sum,
                         error * kind->sensitivity(most, larger(0.0, t->c[j] + t->c_min - error)) +
                             c->reference * kind->sensitivity(most, larger(0.0, t->c_min + t->c_low - c->reference)));
        }
    }
    return SAFE * (c->relative + (1.0 + c->relative) * sum * kernel_exp(smaller(sum, 1.0)) + 1e-17);
}

/* What only the table needs: norms of b and of its errors, group by group, and over all. */
static void fill_norms(struct reduced *r, struct table *t)
{
    struct charge *c = &t->charge;
    double all = 0.0, mean = 0.0, sum = 0.0;
    size_t place, j;

    for (j = 0; j < r->distinct; j++) {
        double off = 0.0, weight = 0.0;

        for (place = r->begin[j]; place < r->begin[j + 1]; place++) {
            uint32_t i = r->order[place];
            double b = t->sample_b[i], share = c->norm == BRDFFIT_NORM_L2 ? b * b : b;

            off = join(off, c->b[i] * b, c->norm);
            weight = join(weight, b, c->norm);
            all = join(all, b, c->norm);
            mean += share * t->c[j];
            sum += share;
        }
        c->off[j] = root_of(off, c->norm);
        c->weight[j] = root_of(weight, c->norm);
        c->least = t->c[j] > t->c_low ? c->least : larger(c->least, c->weight[j]);
    }
    c->all = c->norm == BRDFFIT_NORM_LINF ? 0.0 : root_of(all, c->norm);
    c->mean = sum > 0.0 ? SAFE * mean / sum : 0.0;
}

/* Error of group j of a lobe of s in [low, high] over b phi(s_low): x exp(x) of the s where it is largest. */
static double group_error(const struct table *t, const struct lobe_kind *kind, size_t j, double low, double high)
{
    const struct charge *c = &t->charge;
    int sharp = !(t->c[j] > t->c_low);
    double error = sharp ? c->spread : c->gamma[j] + c->reference, total = t->c_min + t->c[j], x;
    double s = kind->steep && (t->c[j] - t->c_low - error) * low >= 1.0 ? low : high;

    x = error * kind->sensitivity(s, larger(0.0, total - error));
    if (!kind->steep && !sharp) {
        x += c->reference * kind->sensitivity(s, larger(0.0, t->c_min + t->c_low - c->reference));
    }
    return x < 600.0 ? x * kernel_exp(x) : INFINITY;
}

/* |g* - g| / |g| of lobes in [low, high] of theta. */
static double cell_error(const struct reduced *r, const struct table *t, const struct lobe_kind *kind,
                         const struct kernels *kernels, double low, double high, double *phi)
{
    const struct charge *c = &t->charge;
    double s_low = kernel_exp(low), s_high = kernel_exp(high), u[3], size = 0.0, error = 0.0;
    size_t j;

    kind->variable(&t->sight, high, u);
    kind->shape(kernels, &t->sight, r->stride, u[0], phi);
    for (j = 0; j < r->distinct; j++) {
        size = join(size, c->weight[j] * phi[j], c->norm);
    }
    kind->variable(&t->sight, low, u);
    kind->shape(kernels, &t->sight, r->stride, u[0], phi);
    for (j = 0; j < r->distinct; j++) {
        double x = group_error(t, kind, j, s_low, s_high), lobe = c->weight[j] * phi[j];

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

static void fill_cells(const struct reduced *r, const struct table *t, struct kind_charge *out,
                       const struct lobe_kind *kind, const struct kernels *kernels, const double theta[3], double *phi)
{
    double low = theta[0], width = (theta[1] - low) / CHARGE_CELLS;
    size_t i;

    for (i = 0; i < CHARGE_CELLS; i++) {
        double error = cell_error(r, t, kind, kernels, low + (double)i * width, low + ((double)i + 1.0) * width, phi);

        out->cell[i] = over_true(error, error);
    }
    out->low = low;
    out->step = width > 0.0 ? 1.0 / width : 0.0;
    out->body = width > 0.0 ? 0.0 : out->cell[0];
}

static int any_lobe(const struct reduced *r, const struct table *t)
{
    size_t j = 0;

    while (j < r->distinct && !(t->bb[j] > 0.0)) {
        j++;
    }
    return j < r->distinct;
}

void brdffit_charge_domain(struct reduced *r, const struct model *model, int kind, const struct kernels *kernels,
                           const double theta[3], double fine, double *scratch)
{
    struct table *t = &r->table[model->geometry[kind]];
    struct kind_charge *out = &r->kind_charge[kind];
    struct charge *all = &r->table[0].charge, *c = &t->charge;
    double high = theta[1], flat = larger(theta[2], theta[1]);

    out->step = 0.0;
    out->high = high;
    out->body = out->tail = c->least = c->all = c->mean = 0.0;
    if (kind == 0) {
        all->diffuse = over_true(all->diffuse, all->diffuse);
        all->root = (all->norm == BRDFFIT_NORM_L2 ? sqrt(r->total) : 2.0 * r->total) * SAFE * (1.0 + all->diffuse);
    }
    if (!any_lobe(r, t)) {
        return;
    }
    out->body = from_maxima(r, t, model->kind[kind], kernel_exp(high));
    out->tail = larger(out->body, from_maxima(r, t, model->kind[kind], kernel_exp(flat)));
    if (c->hidden > 0.0 || !(out->tail <= fine)) {
        fill_norms(r, t);
    }
    if (!(out->tail <= fine)) {
        out->tail = cell_error(r, t, model->kind[kind], kernels, high, flat, scratch);
        out->tail = over_true(out->tail, out->tail);
    }
    if (!(out->body <= fine)) {
        fill_cells(r, t, out, model->kind[kind], kernels, theta, scratch);
    }
}
