/*
 * What both norms need of a vertex; only vertex_*.c call it. Layer 1. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VERTEX_PARTS_H
#define BRDFFIT_VERTEX_PARTS_H

#include "vertex.h"

/* Pivots of one problem; ten or so are usual. */
#define VERTEX_PIVOTS 1000
/* A slope counts as downhill when it is this part of what rounding could make of it. */
#define VERTEX_DOWNHILL 1e-12

/* Square system of the constraints that hold at a vertex; inverse[j][q]: unknown j by right side q. */
struct vertex_system {
    int size;
    double matrix[VERTEX_UNKNOWNS][VERTEX_UNKNOWNS];
    double inverse[VERTEX_UNKNOWNS][VERTEX_UNKNOWNS];
};

/* 0 when singular. */
int brdffit_vertex_invert(struct vertex_system *system);

/* Fill v->moved; 0 when the data are all zero. */
int brdffit_vertex_move_apart(struct vertex *v);

static inline double vertex_model(const struct vertex *v, const double *z, size_t i)
{
    double sum = 0.0;
    int j;

    for (j = 0; j < v->columns; j++) {
        sum += v->column[j][i] * z[j];
    }
    return sum;
}

#endif
