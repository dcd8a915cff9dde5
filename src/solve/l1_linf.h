/*
 * The restricted problem of norms l1 and linf: the objective at a point of roughness, exact because it is evaluated
 * from the residuals of coefficients >= 0; and a descent of it. Answers are left where those of norm l2 are
 * (varpro->answer), so that a report need not know the norm. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_L1_LINF_H
#define BRDFFIT_L1_LINF_H

#include "solve/conic/lp.h"
#include "solve/varpro.h"
#include "solve/simplex.h"

struct l1_linf {
    struct varpro *varpro;
    brdffit_norm norm;
    struct simplex simplex;
    struct lp lp;
    double *column[COLUMNS_MOST]; /* rows each, at unit norm */
    double *data;                 /* rows: a channel at about unit size */
    double *channel;              /* K: its part of the objective */
    size_t evaluated;
};

void brdffit_l1_linf_layout(struct l1_linf *r, struct arena *arena, size_t count, size_t channels,
                            const struct model *model, brdffit_norm norm);

/* Allocates (ECOS does). */
brdffit_status brdffit_l1_linf_start(struct l1_linf *r, struct varpro *varpro);
void brdffit_l1_linf_finish(struct l1_linf *r);

/*
 * Objective at a point. With `prove`, ECOS solves each channel too: the better answer counts, and value->kkt is how
 * far the objective of a channel can be from its optimum, relative to that of no lobes at all; else it is 0.
 */
void brdffit_l1_linf_evaluate(struct l1_linf *r, const struct point *at, int prove, struct varpro_value *value);

/* Local descent inside the domain; returns the objective of what *point becomes, never worse than its start. */
double brdffit_l1_linf_descend(struct l1_linf *r, struct point *point);

#endif
