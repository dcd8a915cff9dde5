/*
 * Engine `socp`: the paper's feasibility problem, solved by ECOS and proven by our own certificate (theory section 3).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_SOCP_H
#define BRDFFIT_BOUND_SOCP_H

#include "search/engine.h"
#include "solve/conic/socp.h"
#include "solve/varpro.h"

struct bound_socp {
    const struct axis *axis;    /* one a kind */
    struct varpro *varpro;
    struct socp *solver;        /* one for the shape; made by start, freed by finish */
    int cheap;                  /* decide by the closed form where it can */
    struct conic_shape program;
    size_t *column, *row, cone; /* pattern of G */
    double *g, *c, *h;          /* its numbers */
    double *x, *z, *lower, *upper;
    double *shape[3];           /* stride each: lobe shapes at the ends and the centre of a box */
    double *ell, *slope;        /* stride each: -ell and slope at the low end of lobes that are not exponential */
    size_t evaluated;           /* restricted problems solved, one a box */
    size_t solved, refused, decided; /* programs solved; without certificate; boxes that needed none */
};

void brdffit_bound_socp_layout(struct bound_socp *engine, struct arena *arena, size_t count, size_t channels,
                               const struct model *model);

/* Allocates (ECOS does). */
brdffit_status brdffit_bound_socp_start(struct bound_socp *engine, struct varpro *varpro, const struct axis *axis,
                                        int cheap);
void brdffit_bound_socp_finish(struct bound_socp *engine);

/* bound() of struct engine; self is a struct bound_socp. */
double brdffit_bound_socp(struct bound_socp *engine, struct box *box, struct point *met);

#endif
