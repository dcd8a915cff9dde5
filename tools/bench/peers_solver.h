/*
 * What a peer is: a local least-squares solver, called at one start. SPDX-License-Identifier: MIT
 */
#ifndef PEERS_SOLVER_H
#define PEERS_SOLVER_H

#include "peers_problem.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Both peers stop on these: the default tolerances (1e-6 and so) often stop short of 1e-6 in E^2. */
#define PEERS_MOST_ITERATIONS 500
#define PEERS_GRADIENT 1e-12
#define PEERS_STEP 1e-10
#define PEERS_DECREASE 1e-13

/*
 * Minimise from `parameter` (M values, inside the chart's box) and leave the answer there. Returns the number of
 * iterations, or -1 when the solver gave up without an answer. `create` prepares for a problem whose lobes and chart
 * are set; NULL when memory runs out.
 */
struct peers_solver {
    const char *name, *version;
    void *(*create)(const struct peers_problem *problem);
    int (*run)(void *solver, double *parameter);
    void (*destroy)(void *solver);
};

extern const struct peers_solver peers_levmar;
extern const struct peers_solver peers_ceres; /* absent with PEERS_NO_CERES */

#ifdef __cplusplus
}
#endif
#endif
