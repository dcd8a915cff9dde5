/*
 * Second-order cone programs, solved by ECOS: the only module that includes ecos.h. The program, its shape
 * and its data are those of certificate.h. The shape is fixed when the solver is made (that allocates);
 * each solve takes new numbers, copies them, and allocates nothing.
 *
 * What a solver says is floating point and proves nothing: hand z to brdffit_socp_certified_bound().
 * Same shape and numbers, same bits, whatever the solver solved before. Two threads must not share a
 * solver. Without ECOS in the build (make ECOS=0) making one answers BRDFFIT_ERR_UNSUPPORTED.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SOCP_H
#define BRDFFIT_SOCP_H

#include <stddef.h>

#include "brdffit.h"
#include "solve/conic/certificate.h"

struct socp;

enum socp_outcome {
    SOCP_OPTIMAL = 0,       /* to the solver's tolerance (1e-8, relative) */
    SOCP_INACCURATE,        /* an optimum, to 1e-4 only */
    SOCP_PRIMAL_INFEASIBLE, /* z is a ray: G'z = 0, h'z = -1, z in K */
    SOCP_DUAL_INFEASIBLE,   /* unbounded; x is a ray: c'x = -1, -G x in K */
    SOCP_FAILED             /* x and z are the last iterate, or zeros when there is none */
};

struct socp_result {
    enum socp_outcome outcome;
    double primal; /* c'x;  +infinity when primal infeasible, -infinity when dual infeasible */
    double dual;   /* -h'z; likewise */
    size_t iterations;
    int code; /* ECOS's own, for reports */
};

/* BRDFFIT_ERR_ARGUMENT for an invalid shape or one without entries in G; BRDFFIT_ERR_MEMORY. */
brdffit_status brdffit_socp_new(const struct conic_shape *shape, struct socp **socp);

/* x (variables) and z (rows) are written unless the call itself fails: BRDFFIT_ERR_VALUE when a number is
 * not finite. A program without solution is an outcome, not a failure. */
brdffit_status brdffit_socp_solve(struct socp *socp, const struct conic_data *data, double *x, double *z,
                                  struct socp_result *result);

/* The caller's rows and columns are of like size already: from now on leave them alone. Numbers that are next to
 * nothing, such as those of a sample far from a lobe or a deviation of 1e-7, would otherwise decide how a column is
 * scaled. */
void brdffit_socp_trust_scale(struct socp *socp);

void brdffit_socp_free(struct socp *socp); /* NULL is fine */

#endif
