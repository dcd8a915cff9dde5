/*
 * The vector form (theory 4.3): the exact objective at a point, from the rows themselves, with derivatives by
 * theta after the coefficients are eliminated (variable projection); and its descent.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VARPRO_H
#define BRDFFIT_VARPRO_H

#include "solve/newton.h"
#include "solve/nnls.h"
#include "data/reduce.h"

/*
 * What is differentiated: a column by a side of its lobe, and by two of them. Lobes have one side, and so each column has one
 * slope and one bend, but for the anisotropic one: two slopes, three bends.
 */
#define SLOPES_MOST (MOVING_MOST + EACH_MOST)
#define BENDS_MOST (MOVING_MOST + 2 * EACH_MOST)
struct slope {
    int column, side;
};
struct bend {
    int column, side[2];
};

struct varpro {
    const struct reduced *data;
    const struct model *model;
    const struct kernels *kernels;
    int physical; /* whether coefficients have to obey physical bounds (data/physical.h); derivatives then are those of what
                     does not bind */
    double theta_low[SIDES_MOST], theta_high[SIDES_MOST]; /* domain of a descent, of each side */

    double *phi; /* stride: the shape in use */
    double *x, *slope; /* stride: -ell and slope of lobes that are not exponential */
    double *column[MOVING_MOST]; /* R each: the columns of the lobes */
    double *first[SLOPES_MOST]; /* R each: d column / d theta of each slope (struct slope) */
    double *second[BENDS_MOST]; /* R each: of each bend */
    struct slope slope_of[SLOPES_MOST];
    struct bend bend_of[BENDS_MOST];
    int slopes, bends; /* of them */
    double *exponent; /* stride: of a lobe with two shape coordinates */
    double *q; /* columns x R */
    double *residual; /* R */
    struct nnls nnls;
    struct nnls_answer *answer; /* K, of the last evaluation */
};

/* The table of the geometry that column c of the lobes sees. */
static inline const struct table *varpro_table(const struct varpro *v, int c)
{
    return &v->data->table[v->model->geometry[model_kind_of(v->model, c)]];
}

/* Columns of the lobes. */
static inline int varpro_moving(const struct varpro *v)
{
    return v->model->columns - v->model->fixed;
}

/* Sets v->model, too. */
void brdffit_varpro_layout(struct varpro *v, struct arena *arena, size_t count, size_t channels,
                           const struct model *model);

/* The columns of the first lobe, which is anisotropic, at its two coordinates (varpro_turned.c). */
void brdffit_varpro_turned(struct varpro *v, const double theta[2], int derivatives);

void brdffit_varpro_evaluate(struct varpro *v, const struct point *at, int derivatives, struct varpro_value *value);

/* Newton descent from *point inside [theta_low, theta_high]; returns the objective of what *point becomes. */
double brdffit_varpro_descend(struct varpro *v, struct point *point);

/* The same without derivatives, which do not hold where physical bounds bind. */
double brdffit_varpro_feel(struct varpro *v, struct point *point);

#endif
