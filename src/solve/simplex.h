/*
 * The restricted problem in norms that are not smooth: min |data - A z| over z >= 0 in L1 (the sum) or L-infinity
 * (the largest), with as many columns as a model has, their entries >= 0. A simplex method written for so few unknowns: it walks from
 * vertex to vertex, each given by as many constraints as unknowns, so that the optimum is exact to rounding.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SIMPLEX_H
#define BRDFFIT_SIMPLEX_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "model/model.h"

#define SIMPLEX_COLUMNS COLUMNS_MOST
#define SIMPLEX_UNKNOWNS (SIMPLEX_COLUMNS + 1)

struct simplex {
    size_t rows;
    int columns;
    const double *column[SIMPLEX_COLUMNS]; /* rows each, of about unit size; zero columns are left alone */
    const double *data;                   /* rows, of about unit size */

    /* scratch, rows each */
    double *moved;    /* data moved apart by a few roundings, so that no two constraints meet by accident */
    double *residual; /* moved - A z */
    double *along;    /* A times the direction of a step */
    double *place;    /* breakpoints of a step, a heap */
    uint32_t *owner;  /* row of each */
};

void brdffit_simplex_layout(struct simplex *v, struct arena *arena, size_t count);

/* Return the norm of data - A z, and the z (one a column, >= 0) that has it. */
double brdffit_simplex_l1(struct simplex *v, double *z);
double brdffit_simplex_linf(struct simplex *v, double *z);

/* Norms of data - A z at any z. */
double brdffit_simplex_norm_l1(const struct simplex *v, const double *z);
double brdffit_simplex_norm_linf(const struct simplex *v, const double *z);

#endif
