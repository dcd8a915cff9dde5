/*
 * The engine of norms l1 and linf: second-order bounds by linear programs, solved by ECOS and proven by our own
 * certificate. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_LP_H
#define BRDFFIT_BOUND_LP_H

#include "search/engine.h"
#include "solve/conic/lp.h"
#include "solve/l1_linf.h"

/* A lobe over an interval of roughness: its columns lie between two that are linear in one parameter. */
struct bound_lp_lobe {
    double *upper[2], *lower[2]; /* rows each, at the two ends of the interval */
    double scale[2];             /* power of two that upper and lower were divided by */
    double least;                /* no column of the interval has a smaller norm; 0 when the lobe is absent */
    double change;               /* norm of what the ends differ by, relative: which lobe had better be split */
    double place, tilt;          /* of the centre: its column is tilt^-1 times one that lies `place` between the
                                    ends */
};

struct bound_lp {
    const struct axis *axis; /* one a kind */
    struct l1_linf *restricted;
    struct lp lp;
    int cheap;         /* decide by what is known of the centre where it can */
    double *phi[3];    /* stride each: shapes at the ends and the middle of an interval */
    double *x, *slope; /* stride each: -ell and slope at the middle of lobes that are not exponential */
    double *data;      /* rows: a channel at about unit size */
    double *relaxed;   /* K: the program's objective at the centre's coefficients */
    double *no_lobe;   /* K: norm of the data */
    struct bound_lp_lobe lobe[MOVING_MOST]; /* of each column of the lobes */
    size_t decided;    /* boxes that needed no program */
};

void brdffit_bound_lp_layout(struct bound_lp *engine, struct arena *arena, size_t count, size_t channels,
                             const struct model *model, brdffit_norm norm);

/* Allocates (ECOS does). `restricted` must be started. */
brdffit_status brdffit_bound_lp_start(struct bound_lp *engine, struct l1_linf *restricted, const struct axis *axis,
                                      int cheap);
void brdffit_bound_lp_finish(struct bound_lp *engine);

/* bound() of struct engine; self is a struct bound_lp. */
double brdffit_bound_lp(struct bound_lp *engine, struct box *box, struct point *met);

#endif
