/*
 * The restricted problem in norms that are not smooth: min |data - A z| over z >= 0 in L1 (the sum) or L-infinity
 * (the largest), with at most 3 columns of entries >= 0. A simplex method written for so few unknowns: it walks from
 * vertex to vertex, each given by as many constraints as unknowns, so that the optimum is exact to rounding.
 * Layer 1. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_VERTEX_H
#define BRDFFIT_VERTEX_H

#include <stddef.h>
#include <stdint.h>

#include "arena.h"

#define VERTEX_COLUMNS 3
#define VERTEX_UNKNOWNS (VERTEX_COLUMNS + 1)

struct vertex {
    size_t rows;
    int columns;
    const double *column[VERTEX_COLUMNS]; /* rows each, of about unit size; zero columns are left alone */
    const double *data;                   /* rows, of about unit size */

    /* scratch, rows each */
    double *moved;    /* data moved apart by a few roundings, so that no two constraints meet by accident */
    double *residual; /* moved - A z */
    double *along;    /* A times the direction of a step */
    double *place;    /* breakpoints of a step, a heap */
    uint32_t *owner;  /* row of each */
};

void brdffit_vertex_layout(struct vertex *v, struct arena *arena, size_t count);

/* Return the norm of data - A z, and the z (one a column, >= 0) that has it. */
double brdffit_vertex_l1(struct vertex *v, double *z);
double brdffit_vertex_linf(struct vertex *v, double *z);

/* Norms of data - A z at any z. */
double brdffit_vertex_norm_l1(const struct vertex *v, const double *z);
double brdffit_vertex_norm_linf(const struct vertex *v, const double *z);

#endif
