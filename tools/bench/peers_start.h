/*
 * Random starts. Start i of a material depends on the seed, the data, the lobes and i alone: blocks of starts can be
 * run in any order, and every peer gets the same roughnesses. SPDX-License-Identifier: MIT
 */
#ifndef PEERS_START_H
#define PEERS_START_H

#include "peers_problem.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Log-uniform starts reach down to here: at 10 degrees between samples a sharper lobe is a single sample. */
#define PEERS_LOG_UNIFORM_MIN 1e-3

struct peers_start {
    int log_uniform; /* in sigma over [1e-3, 6]; 0: uniform over [1e-12, 6] */
    int nnls;        /* coefficients solve the restricted problem at sigma; 0: uniform, up to the height at which the
                        term alone explains the largest value */
    uint64_t seed;
};

void peers_start_draw(const struct peers_problem *problem, const struct peers_start *start, uint64_t index,
                      double *parameter);
/* The roughnesses of the same start alone: P values. */
void peers_start_roughness(const struct peers_problem *problem, const struct peers_start *start, uint64_t index,
                           double *parameter);
/* At given roughnesses, with non-negative least squares for the rest. */
void peers_start_at(const struct peers_problem *problem, const double *sigma, double *parameter);

#ifdef __cplusplus
}
#endif
#endif
