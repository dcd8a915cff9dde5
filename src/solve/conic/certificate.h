/*
 * Conic programs as plain arrays, and lower bounds of their optimum that hold whatever a solver did.
 *
 *     minimise c'x  subject to  h - G x in K,      K = R+^linear x Q(cone[0]) x Q(cone[1]) x ...
 *
 * with the second-order cones Q(d) = {(t, v) : t >= |v|, v of d - 1 entries}. For any z in K (K is its own
 * dual) and any feasible x,
 *
 *     c'x >= c'x - z'(h - G x) = -h'z + (c + G'z)'x
 *
 * so a dual point that a floating-point solver suggests gives a bound once z has been moved into K and
 * the residual c + G'z is charged at the worst x within known limits. Knows matrices, not BRDFs, not ECOS.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_CERTIFICATE_H
#define BRDFFIT_CERTIFICATE_H

#include <stddef.h>

struct conic_shape {
    size_t variables;     /* n >= 1 */
    size_t linear;        /* rows in R+; they come first */
    size_t cones;         /* second-order cones, one after the other below the linear rows */
    const size_t *cone;   /* dimension of each, >= 2 */
    const size_t *column; /* n + 1 offsets into row, from 0, or NULL: G is dense */
    const size_t *row;    /* row of each entry, ascending within a column */
};

/* Dense: g is rows x n, column-major. Sparse: g holds an entry for each of shape->row. */
struct conic_data {
    const double *g;
    const double *c; /* n */
    const double *h; /* rows */
};

/* Whether the shape is one (pointers, dimensions, pattern, sizes that do not overflow). */
int brdffit_conic_valid(const struct conic_shape *shape);

/* Rows and entries of G; of a valid shape. */
size_t brdffit_conic_rows(const struct conic_shape *shape);
size_t brdffit_conic_entries(const struct conic_shape *shape);

/*
 * A number that is at most c'x for every feasible x with lower <= x <= upper (n each; infinite limits are
 * fine), rounding of this computation included. z (one per row) is replaced by the point of K that proves
 * it: negative entries of linear rows become 0, and a cone's first entry is raised to the norm of the rest.
 * -infinity when nothing is proven: z or the data are not finite, limits are not ordered, a residual meets
 * an infinite limit, or something overflows. To prove infeasibility, pass a c of zeros: a positive bound
 * says that no x within the limits is feasible.
 */
double brdffit_socp_certified_bound(const struct conic_shape *shape, const struct conic_data *data, const double *lower,
                                    const double *upper, double *z);

#endif
