/*
 * What the rounding of geometry costs a box, and how its bound pays (charge.c). SPDX-License-Identifier: MIT
 */
#include "data/charge.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "data/charge_parts.h"
#include "data/reduce_parts.h"

/*
 * What is hidden against |g*| of an exponential lobe: |g| is at least that of c_min's samples, and by Jensen's inequality at
 * least exp(-mean s) that of all b; |g*| is (1 - error) of it.
 */
static double hidden_share(const struct charge *c, double hidden, double hidden_c, double low, double high,
                           double error)
{
    double size = larger(c->least, c->all * kernel_exp(-c->mean * kernel_exp(high)));

    return size > 0.0 && error < 0.5 ? SAFE * hidden * kernel_exp(-hidden_c * kernel_exp(low)) / (size * (1.0 - error))
                                     : (double)INFINITY;
}

/* The relative error of a lobe of any theta in [low, high], but for what is hidden. */
static double lobe_error(const struct kind_charge *k, double low, double high)
{
    double error = k->body, first, last;

    if (k->step > 0.0) {
        first = larger(0.0, floor((low - k->low) * k->step - 1e-6));
        last = smaller(CHARGE_CELLS - 1.0, floor((high - k->low) * k->step + 1e-6));
        for (; first <= last; first += 1.0) {
            error = larger(error, k->cell[(size_t)first]);
        }
    }
    return high >= k->high ? larger(error, k->tail) : error;
}

static struct doubt lobe_doubt(const struct charge *c, const struct kind_charge *k, double low, double high)
{
    struct doubt d = {lobe_error(k, low, high), 0.0, c->hidden_data};

    if (c->hidden > 0.0) {
        d.hidden = hidden_share(c, c->hidden, c->hidden_c, low, high, d.error);
    }
    return d;
}

struct doubt brdffit_charge_box(const struct reduced *r, const struct model *model, const double *low,
                                const double *high)
{
    struct doubt d = {r->table[0].charge.diffuse, 0.0, 0.0}, one;
    int c;

    for (c = 0; c < model->lobes * model->each; c++) {
        int kind = model_kind_of(model, c), p = model_lobe_of(model, c);

        one = lobe_doubt(&r->table[model->geometry[kind]].charge, &r->kind_charge[kind], low[p], high[p]);
        d.error += one.error;
        d.hidden += one.hidden;
        d.hidden_data = larger(d.hidden_data, one.hidden_data);
    }
    return d;
}

/* Ordinary data's directions make less of it than the published doubles do. */
double brdffit_charge_point(const struct reduced *r, const struct model *model, const double *theta)
{
    double error = 0.0;
    int column;

    for (column = 0; column < model->lobes * model->each; column++) {
        int kind = model_kind_of(model, column), p = model_lobe_of(model, column);
        const struct charge *c = &r->table[model->geometry[kind]].charge;
        const struct kind_charge *k = &r->kind_charge[kind];
        double own = lobe_error(k, theta[p], theta[p]);

        error += k->step > 0.0 ? own : 0.0;
        if (c->any_hidden > 0.0) {
            error += hidden_share(c, c->any_hidden, c->any_c, theta[p], theta[p], own);
        }
    }
    return error * r->table[0].charge.root;
}

/* What every box pays for, absolute, where that needs no table; else -1. */
static double charge_all(const struct reduced *r, const struct model *model)
{
    double error = r->table[0].charge.diffuse;
    int c;

    for (c = 0; c < model->lobes * model->each; c++) {
        int kind = model_kind_of(model, c);
        const struct kind_charge *k = &r->kind_charge[kind];

        /* Only boxes at its end pay for a tail that costs much more than the domain (GGX). */
        if (k->step > 0.0 || k->tail > larger(1e-14, 1.25 * k->body) ||
            r->table[model->geometry[kind]].charge.hidden > 0.0) {
            return -1.0;
        }
        error += larger(k->body, k->tail);
    }
    return error * r->table[0].charge.root;
}

double brdffit_charge_raise(const struct reduced *r, const struct doubt *d, double target)
{
    double paid = (d->error + d->hidden) * r->table[0].charge.root, root;

    if (!(paid > 0.0) || !(target > 0.0)) {
        return target;
    }
    root = sqrt(target) + paid;
    return (r->table[0].charge.norm == BRDFFIT_NORM_L2 ? root * root : target + paid) * (1.0 + 32.0 * TOL_UNIT);
}

double brdffit_charge_pay(const struct reduced *r, const struct doubt *d, double bound)
{
    const struct charge *c = &r->table[0].charge;
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
        other = paid - 2.0 * d->hidden_data * (d->hidden * c->root);
        root -= d->hidden * c->root;
        paid = larger(root > 0.0 ? root * root : 0.0, other);
    }
    return paid > 0.0 ? paid * (1.0 - 8.0 * TOL_UNIT) : 0.0;
}

static void open_payment(struct payment *p, double target)
{
    double q = sqrt(target > 0.0 && target < p->total ? target : p->total);

    q = larger(q, 4.0 * p->doubt); /* bounds that are no more than the doubt itself are worth little */
    p->target = target;
    p->share = q > 0.0 ? p->doubt / q * (1.0 + 1e-6) : 0.0;
    p->offset = p->doubt * q * (1.0 + 1e-6);
}

void brdffit_payment_start(struct payment *p, const struct reduced *r, const struct model *model)
{
    p->doubt = charge_all(r, model);
    p->total = r->total;
    p->target = -1.0;
}

double brdffit_payment_raise(struct payment *p, double target)
{
    double left;

    if (target != p->target) {
        open_payment(p, target);
    }
    left = 1.0 - p->share;
    return left > 0.5 ? (target + p->offset) / left * (1.0 + 8.0 * TOL_UNIT) : (double)INFINITY;
}

double brdffit_payment_pay(const struct payment *p, double bound)
{
    double left = 1.0 - p->share;

    return left > 0.5 ? larger(0.0, left * bound - p->offset) * (1.0 - 4.0 * TOL_UNIT) : 0.0;
}
