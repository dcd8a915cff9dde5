/*
 * Moments of the reduced data (theory 4.1): at a node (one value of theta) and at a pair of nodes, each computed
 * once. SPDX-License-Identifier: MIT
 *
 * Sums over distinct c run in LANES lanes with a fixed order, so that their bits do not depend on the
 * instruction set. Every sum of positive terms is within node.epsilon (relative) of the exact one: moments.epsilon
 * for additions and products, and exponent_epsilon times the mean exponent c' u, because exp(-x) turns a relative
 * error of x (4 u, and that of merged c) into one of x times that.
 */
#ifndef BRDFFIT_MOMENTS_H
#define BRDFFIT_MOMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "model/lobe.h"
#include "kernels/kernels.h"
#include "data/reduce.h"

struct node {
    double u;
    double h;     /* H = sum bb phi^2 */
    double root;  /* sqrt(H) */
    double mean;  /* of x = -ell under p = bb phi^2 / H */
    double m2, m3, m4; /* its central moments (m3 and m4 for exponential families only) */
    double epsilon; /* rounding allowance of this node's sums */
    double kappa; /* cosine of a and g, lowered by epsilon */
    double *tau;  /* B: data along the normalised lobe, raised by epsilon |I_k| */
    struct functional *functional; /* as reduced.linear */
    double *phi;  /* stride, or NULL: see brdffit_moments_shape */
};

/* sum bb phi(s1) phi(s2), with mean and variance of x = c' under these weights (exponential families only). */
struct pair {
    uint32_t first, second; /* nodes; first == UINT32_MAX: empty */
    double value, mean, variance;
    double mu; /* cosine of the two lobes, lowered by epsilon */
};

struct moments {
    const struct reduced *data;
    const struct lobe_kind *kind;
    const struct kernels *kernels;
    double epsilon;     /* rounding allowance of a sum, but for its exponents */
    double exponent_epsilon; /* relative error of an exponent */
    double *omega;      /* B (reduced.bounded): data along the normalised a, raised by epsilon |I_k| */
    double *norm;       /* B: |I_k| */
    double slack;       /* rounding allowance of an objective, absolute */
    struct node *node;
    unsigned char *ready;
    uint32_t capacity;
    size_t evaluated;   /* nodes computed */
    struct pair *cache; /* direct-mapped: a hit saves a sum, a miss costs nothing else */
    double *tau_pool, *phi_pool;
    size_t phi_doubles; /* of phi_pool */
    struct functional *functional_pool;
    double *scratch;    /* 4 x stride */
};

#define PAIR_CACHE 1024u

void brdffit_moments_layout(struct moments *moments, struct arena *arena, size_t count, size_t channels,
                            uint32_t node_capacity, int lobes);

void brdffit_moments_start(struct moments *moments, const struct reduced *data, const struct lobe_kind *kind,
                           const struct kernels *kernels, int lobes);

/* Node `index` at coordinate theta, computed on first use. */
const struct node *brdffit_moments_node(struct moments *moments, uint32_t index, double theta);

/* A node at any theta, kept until the next call with the same `slot` (0 or 1). */
const struct node *brdffit_moments_scratch(struct moments *moments, uint32_t slot, double theta);

/* The pair of the two scratch nodes. */
struct pair brdffit_moments_scratch_pair(struct moments *moments);

/* Pair of two computed nodes. */
const struct pair *brdffit_moments_pair(struct moments *moments, uint32_t first, uint32_t second);

/* phi of a computed node: stored, or computed into scratch (stride doubles). */
const double *brdffit_moments_shape(const struct moments *moments, const struct node *node, double *scratch);

#endif
