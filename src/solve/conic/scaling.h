/*
 * Scaling of conic programs (certificate.h) by powers of two, which is exact: each linear row and each cone
 * as a whole (a group of rows), and each column of G, so that magnitudes in G gather around 1 and below;
 * then h and c as wholes, to a largest entry in [1, 2). With e for exponents, row i of group p, column j:
 *
 *     G'_ij = G_ij 2^-(e_p + e_j)    h'_i = h_i 2^-(e_p + e_h)    c'_j = c_j 2^-(e_j + e_c)
 *     x_j = x'_j 2^(e_h - e_j)       z_i = z'_i 2^(e_c - e_p)
 *
 * Solvers have absolute tolerances somewhere; after this they are relative ones. Knows no solver.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SCALING_H
#define BRDFFIT_SCALING_H

#include <stddef.h>

#include "base/arena.h"
#include "solve/conic/certificate.h"

struct scaling_range {
    int low, high;
};

struct scaling {
    size_t variables, rows, entries, groups;
    size_t *column, *row; /* pattern of G, also when it is dense */
    size_t *group;        /* of each row */
    int *exponent, *h_exponent, *c_exponent;
    int *group_scale, *column_scale;
    struct scaling_range *range;
    int h_scale, c_scale;
    int trusted; /* the caller's rows and columns are of like size already: scale h and c only */
};

/* Take memory for a valid shape; the arena may only be counting. */
void brdffit_scaling_layout(struct scaling *scaling, struct arena *arena, const struct conic_shape *shape);

/* Copy the pattern; once, after a layout with memory. Not trusted. */
void brdffit_scaling_start(struct scaling *scaling, const struct conic_shape *shape);

/* Find the scales of finite data and write the scaled program to g, c and h. */
void brdffit_scaling_apply(struct scaling *scaling, const struct conic_data *data, double *g, double *c, double *h);

/* x and z of the scaled program -> of the caller's. In place is fine. */
void brdffit_scaling_undo(const struct scaling *scaling, const double *scaled_x, const double *scaled_z, double *x,
                          double *z);

#endif
