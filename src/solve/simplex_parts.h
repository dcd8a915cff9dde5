/*
 * What both norms need of a vertex; only simplex_l1.c and simplex_linf.c call it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SIMPLEX_PARTS_H
#define BRDFFIT_SIMPLEX_PARTS_H

#include "solve/simplex.h"

/* Pivots of one problem; ten or so are usual. */
#define SIMPLEX_PIVOTS 1000
/* A slope counts as downhill when it is this part of what rounding could make of it. */
#define SIMPLEX_DOWNHILL 1e-12

/* Square system of the constraints that hold at a vertex; inverse[j][q]: unknown j by right side q. */
struct simplex_system {
    int size;
    double matrix[SIMPLEX_UNKNOWNS][SIMPLEX_UNKNOWNS];
    double inverse[SIMPLEX_UNKNOWNS][SIMPLEX_UNKNOWNS];
};

/* 0 when singular. */
int brdffit_simplex_invert(struct simplex_system *system);

/* Fill v->moved; 0 when the data are all zero. */
int brdffit_simplex_move_apart(struct simplex *v);

static inline double simplex_model(const struct simplex *v, const double *z, size_t i)
{
    double sum = 0.0;
    int j;

    for (j = 0; j < v->columns; j++) {
        sum += v->column[j][i] * z[j];
    }
    return sum;
}

#endif
