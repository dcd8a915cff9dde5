/*
 * The vector form (theory 4.3): the exact objective at a point, from the rows themselves, with derivatives by
 * theta after the coefficients are eliminated (variable projection); and its descent.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VARPRO_H
#define BRDFFIT_VARPRO_H

#include "solve/newton.h"
#include "model/lobe.h"
#include "solve/nnls.h"
#include "data/reduce.h"

struct varpro {
    const struct reduced *data;
    const struct lobe_kind *kind;
    const struct kernels *kernels;
    int lobes;
    double theta_low, theta_high; /* domain of a descent */

    double *phi;        /* stride: the shape in use */
    double *column[2];  /* R each: the lobes */
    double *first[2];   /* R each: d column / d theta */
    double *second[2];  /* R each */
    double *q;          /* 3 x R */
    double *residual;   /* R */
    struct nnls nnls;
    struct nnls_answer *answer; /* K, of the last evaluation */
};

void brdffit_varpro_layout(struct varpro *v, struct arena *arena, size_t count, size_t channels, int lobes);

void brdffit_varpro_evaluate(struct varpro *v, const struct point *at, int derivatives, struct varpro_value *value);

/* Newton descent from *point inside [theta_low, theta_high]; returns the objective of what *point becomes. */
double brdffit_varpro_descend(struct varpro *v, struct point *point);

#endif
