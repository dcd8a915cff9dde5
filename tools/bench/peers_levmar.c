/*
 * levmar 2.6 (GPL; this program only) as a peer: dlevmar_bc_der in a box, dlevmar_der where the chart has none, both
 * with the analytic Jacobian. Built without LAPACK, so that each step is solved by levmar's own LU: systems have at
 * most a few dozen unknowns. SPDX-License-Identifier: MIT
 */
#include <levmar.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "peers_solver.h"

struct run {
    const struct peers_problem *problem;
    double lower[PEERS_MOST_PARAMETERS], upper[PEERS_MOST_PARAMETERS];
    int parameters, residuals;
    double *work;
};

static void model(double *parameter, double *out, int m, int n, void *data)
{
    (void)m;
    (void)n;
    peers_model(data, parameter, out);
}

static void jacobian(double *parameter, double *out, int m, int n, void *data)
{
    (void)m;
    (void)n;
    peers_jacobian(data, parameter, out);
}

static void *create(const struct peers_problem *problem)
{
    struct run *run = malloc(sizeof *run);
    size_t m = peers_parameters(problem), n = peers_residuals(problem), j;

    if (!run) {
        return NULL;
    }
    run->problem = problem;
    run->parameters = (int)m;
    run->residuals = (int)n;
    peers_bounds(problem, run->lower, run->upper);
    for (j = 0; j < m; j++) { /* levmar's infinity is the largest number */
        run->lower[j] = fmax(run->lower[j], -1.7976931348623157e308);
        run->upper[j] = fmin(run->upper[j], 1.7976931348623157e308);
    }
    run->work = malloc((2 * n + 4 * m + n * m + m * m) * sizeof *run->work);
    if (!run->work) {
        free(run);
        return NULL;
    }
    return run;
}

static int run_levmar(void *solver, double *parameter)
{
    struct run *run = solver;
    const struct peers_problem *p = run->problem;
    /* The fourth value is a threshold on E^2 itself: off. */
    double opts[LM_OPTS_SZ] = {LM_INIT_MU, PEERS_GRADIENT, PEERS_STEP, 0.0, 0.0}, info[LM_INFO_SZ];
    void *data = (void *)(size_t)p; /* levmar hands it back as it is */
    int iterations;

    if (p->chart == PEERS_SQUARES) {
        iterations = dlevmar_der(model, jacobian, parameter, p->value, run->parameters, run->residuals,
                                 PEERS_MOST_ITERATIONS, opts, info, run->work, NULL, data);
    } else {
        iterations = dlevmar_bc_der(model, jacobian, parameter, p->value, run->parameters, run->residuals, run->lower,
                                    run->upper, NULL, PEERS_MOST_ITERATIONS, opts, info, run->work, NULL, data);
    }
    return iterations >= 0 && info[6] != 7.0 ? iterations : -1;
}

static void destroy(void *solver)
{
    struct run *run = solver;

    if (run) {
        free(run->work);
        free(run);
    }
}

const struct peers_solver peers_levmar = {"levmar", LM_VERSION, create, run_levmar, destroy};
