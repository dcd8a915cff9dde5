/*
 * The fit as a peer sees it: residuals and Jacobian in one of three charts. Shares nothing with the library but
 * the reader of files. SPDX-License-Identifier: MIT
 */
#ifndef PEERS_PROBLEM_H
#define PEERS_PROBLEM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PEERS_MOST_LOBES 2
#define PEERS_MOST_CHANNELS 64
#define PEERS_MOST_PARAMETERS (PEERS_MOST_LOBES + PEERS_MOST_CHANNELS * (1 + PEERS_MOST_LOBES))
#define PEERS_SIGMA_MIN 1e-12
#define PEERS_SIGMA_MAX 6.0

/*
 * What the solver varies, for P lobes and K channels: P roughnesses, K diffuse coefficients, then K x P specular ones.
 *
 *   plain     sigma, x, y as the paper writes them; in a box
 *   log       ln sigma, x, z = y s exp(-c_0 s), s = 1/sigma^2, c_0 the smallest c: the lobe's height no longer
 *             changes with its width; in a box
 *   squares   ln sigma, sqrt x, sqrt z: coefficients cannot become negative and nothing is constrained
 */
enum peers_chart { PEERS_PLAIN, PEERS_LOG, PEERS_SQUARES, PEERS_CHARTS };

struct peers_problem {
    size_t samples, channels; /* N, K */
    int lobes;                /* P */
    enum peers_chart chart;
    double *a, *b, *c; /* N each; a owns the memory of all arrays here */
    double *value;     /* N x K, each channel divided by its maximum */
    double *column, *slope, *model; /* scratch: N, N, N x K */
    double c_min, a_max, b_max;
    double total; /* sum of squares of value */
    uint64_t digest; /* of a, b, c and value: tells whether a cached row is about these data */
};

const char *peers_chart_name(enum peers_chart chart);

/* 0 when the file cannot be used; `message` then says why. Lobes and chart are left for the caller to set. */
int peers_problem_read(const char *path, struct peers_problem *problem, const char **message);
void peers_problem_free(struct peers_problem *problem);

/* M = P + K (1 + P) and N K. */
size_t peers_parameters(const struct peers_problem *problem);
size_t peers_residuals(const struct peers_problem *problem);

/* Box of the chart (infinite where there is none): M values each. */
void peers_bounds(const struct peers_problem *problem, double *lower, double *upper);

/* Roughness of lobe p. */
double peers_sigma(const struct peers_problem *problem, const double *parameter, int lobe);
double peers_sigma_to_chart(const struct peers_problem *problem, double sigma);

/* Column of a lobe without its coefficient, and its derivative by the roughness parameter (may be NULL): N each. */
void peers_column(const struct peers_problem *problem, double roughness, double *column, double *derivative);

/* Model at M parameters: N x K. */
void peers_model(const struct peers_problem *problem, const double *parameter, double *model);
/* Its derivatives: (N K) x M, row-major. */
void peers_jacobian(const struct peers_problem *problem, const double *parameter, double *jacobian);
double peers_e2(const struct peers_problem *problem, const double *parameter);

/* The paper's supervision: an answer that is not finite or whose roughness left the range does not count. */
int peers_reasonable(const struct peers_problem *problem, const double *parameter);

#ifdef __cplusplus
}
#endif
#endif
