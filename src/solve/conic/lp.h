/*
 * Linear programs that bound how well columns known to lie between two others can fit data, in L1 or L-infinity:
 *
 *     minimise |t|  subject to  t >= data - U z,  t >= L z - data,  t >= 0,  z >= 0      (|t|: sum, or largest entry)
 *
 * For any columns A with L z <= A z <= U z this is at most the norm of data - A z. With L = U = A it is the restricted
 * problem. ECOS suggests a dual point and brdffit_socp_certified_bound() makes a proof of it. Knows columns, not BRDFs.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_LP_H
#define BRDFFIT_LP_H

#include <stddef.h>

#include "base/arena.h"
#include "brdffit.h"
#include "model/model.h"
#include "solve/conic/certificate.h"
#include "solve/conic/socp.h"

#define LP_COLUMNS (FIXED_MOST + 2 * MOVING_MOST)

struct lp {
    brdffit_norm norm;
    size_t rows, columns;
    struct socp *solver; /* one for the shape; made by start, freed by finish */
    struct conic_shape shape;
    size_t *column, *row; /* pattern of G */
    double *g, *c, *h, *x, *dual, *low, *high;
    size_t solved, refused; /* since start; refused: no better than the bound that needs no program */
};

/* One program: rows entries each, all finite. limit[j] is what z_j is known not to exceed. */
struct lp_data {
    const double *data;
    const double *upper[LP_COLUMNS], *lower[LP_COLUMNS];
    double limit[LP_COLUMNS];
};

/* For at most `count` rows. */
void brdffit_lp_layout(struct lp *lp, struct arena *arena, size_t count, size_t columns, brdffit_norm norm);

/* Allocates (ECOS does). After a layout with this norm and columns. */
brdffit_status brdffit_lp_start(struct lp *lp, size_t rows);
void brdffit_lp_finish(struct lp *lp);

/* Proven lower bound, >= 0; z (a column each, >= 0, within the limits) is the solver's, or zeros. */
double brdffit_lp_bound(struct lp *lp, const struct lp_data *data, double *z);

#endif
