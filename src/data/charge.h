/*
 * What the rounding of geometry costs a proof: see charge.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_CHARGE_H
#define BRDFFIT_CHARGE_H

#include <stddef.h>

#include "base/arena.h"
#include "base/tolerance.h"
#include "brdffit.h"
#include "model/geometry.h"
#include "model/model.h"

struct reduced;

/*
 * Directions that mirror each other within TOL_ANGLE are mirror images (brdffit.h): what the doubles say of c is charged,
 * and its rounding, 1e-28 times alpha and more (rounding.h), but not that alpha is known to TOL_ANGLE only. Else nothing
 * could be said of lobes below 1e-10, for all data with two samples in the mirror direction.
 */
#define MIRROR_C_MIN (8.0 * TOL_ANGLE * TOL_ANGLE)
#define MIRROR_ROUNDING 1e-40

/* Cells of theta, where one number is not enough. */
#define CHARGE_CELLS 48

/* Of the samples, as one geometry sees them. */
struct charge {
    double *light, *b,
        *c; /* used samples: their errors (struct geometry). Of one with b = 0: b and c are what it hides. Gone with
                    the scratch of the reduction, once brdffit_charge_domain() was there */
    double *gamma; /* distinct c: largest error of c */
    double *off, *weight; /* norms of errors of b, and of b; where the table needs them */
    double grazing; /* largest relative error of n.l */
    double diffuse; /* of a and of the data, relative to their norms */
    double relative; /* largest relative error of b */
    double reference; /* error of c of c_min's first sample, which y takes up */
    double spread; /* error of c of the others of c_min against it */
    double joined; /* largest change of c by joining c_min (reduce.c) */
    double hidden, hidden_c; /* norm of what samples with b = 0 may hide, and their least c - c_min */
    double hidden_data; /* norm of their data */
    double most_hidden; /* largest b_hidden of a sample */
    double any_hidden,
        any_c; /* as hidden and hidden_c, of samples with any data: what a published model may be off by */
    double root; /* norm of all data, twice that where the norm is not l2 */
    brdffit_norm norm; /* not l2: objectives are norms, and not their squares */
    double least, all, mean; /* norms of b over c_min and over all samples; mean c - c_min under it */
};

/* Of the lobes of one kind. */
struct kind_charge {
    double body, tail; /* relative error of a lobe: in the domain; from its end on */
    double low, step; /* of the table: theta of its first cell, 1 / width. step = 0: there is none */
    double cell[CHARGE_CELLS];
    double high; /* end of the domain: the tail begins */
};

/* A box's charge: see brdffit_charge_pay(). */
struct doubt {
    double error; /* of the model, relative to the data */
    double hidden; /* the same of what is hidden */
    double hidden_data; /* norm of the data that may hide it */
};

/*
 * Ordinary data (l2): one number d does for all boxes, and a bound b pays (sqrt(b) - d)^2 >= b - 2 d sqrt(b)
 * >= (1 - d / q) b - d q for any q > 0. Nearly nothing is lost with q the root of what closes boxes now, so q follows that.
 */
struct payment {
    double doubt; /* d, absolute; below 0 where boxes differ: then they pay one by one */
    double total; /* of the data: what no bound exceeds */
    double target, share, offset; /* what a bound pays while `target` closes boxes: a share of it, and an offset */
};

/* What is by sample. Arrays by group are laid out with the others (reduce.c). */
void brdffit_charge_layout_scratch(struct reduced *reduced, struct arena *arena, size_t count);

/* No errors: what reduce.c starts from. */
void brdffit_charge_none(struct reduced *reduced);

/* Errors of used sample j. */
static inline void brdffit_charge_sample(struct charge *charge, size_t j, const struct geometry *g)
{
    int lobe = g->b > 0.0;

    charge->light[j] = g->light_error;
    charge->b[j] = lobe ? g->b_error : g->b_hidden;
    charge->c[j] = lobe ? g->c_error : g->c_hidden;
    charge->grazing = g->light_error > charge->grazing ? g->light_error : charge->grazing;
    charge->most_hidden = !lobe && g->b_hidden > charge->most_hidden ? g->b_hidden : charge->most_hidden;
    charge->relative = lobe && g->b_error > charge->relative ? g->b_error : charge->relative;
}

/* After the sums and the rows: errors of the groups, of a and of the data, and what is hidden. */
void brdffit_charge_samples(struct reduced *reduced, const brdffit_samples *samples, brdffit_norm norm);

/* The same where the "samples" are groups of sums: only the groups' errors, from sample_b, b and c. */
void brdffit_charge_groups(struct reduced *reduced);

/*
 * Once the domain of a kind is known: lobes of theta in [low, high], which change no more up to `flat`. One number for all
 * of it does where that is at most `fine`. `scratch`: a stride.
 */
void brdffit_charge_domain(struct reduced *reduced, const struct model *model, int kind, const struct kernels *kernels,
                           const double theta[3], double fine, double *scratch);

/* Of a box with the sides [low, high] of theta of each lobe. */
struct doubt brdffit_charge_box(const struct reduced *reduced, const struct model *model, const double *low,
                                const double *high);

/* How far sharp and hidden lobes may take the objective's root (l1, linf: the objective) of a model with its lobes at theta. */
double brdffit_charge_point(const struct reduced *reduced, const struct model *model, const double *theta);

/* A bound of at least this pays to one of at least `target`, but for rounding. */
double brdffit_charge_raise(const struct reduced *reduced, const struct doubt *doubt, double target);

/* Lower bound of the objective with true coefficients from one with those that are there. */
double brdffit_charge_pay(const struct reduced *reduced, const struct doubt *doubt, double bound);

void brdffit_payment_start(struct payment *payment, const struct reduced *reduced, const struct model *model);

/* The same two as brdffit_charge_raise() and brdffit_charge_pay(), which is to be called with the same target last raised. */
double brdffit_payment_raise(struct payment *payment, double target);
double brdffit_payment_pay(const struct payment *payment, double bound);

#endif
