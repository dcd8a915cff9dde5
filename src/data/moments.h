/*
 * Moments of the reduced data (theory 4.1): at a node (one value of theta) and at a pair of nodes, each computed
 * once. SPDX-License-Identifier: MIT
 *
 * Sums over distinct c run in LANES lanes with a fixed order, so that their bits do not depend on the
 * instruction set. Every sum of positive terms is within node.epsilon (relative) of the exact one: moments.epsilon
 * for additions and products, and table.snapped and a few u times the mean exponent c' u, because exp(-x) turns a relative
 * error of x (4 u, and that of merged c) into one of x times that.
 */
#ifndef BRDFFIT_MOMENTS_H
#define BRDFFIT_MOMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/marks.h"
#include "kernels/kernels.h"
#include "data/reduce.h"
#include "model/model.h"

struct node {
    double u;
    double h;          /* H = sum bb phi^2 */
    double root;       /* sqrt(H) */
    double mean;       /* of x = -ell under p = bb phi^2 / H */
    double m2, m3, m4; /* its central moments (m3 and m4 for exponential lobes only) */
    double epsilon;    /* rounding allowance of this node's sums */
    double *kappa;     /* F: cosines of the fixed columns and g, lowered by epsilon */
    double *tau;       /* B: data along the normalised lobe, raised by epsilon |I_k| */
    struct functional *functional; /* as table.linear */
    double *phi;       /* stride, or NULL: see brdffit_moments_shape() */
    double *x;         /* stride: -ell, and behind it slope; NULL for exponential lobes and where phi is */
};

/* sum w b b' phi(s1) phi'(s2), with mean and variance of x = c' under these weights (of one exponential kind only). */
struct pair {
    uint32_t kinds, first,
        second; /* kind of the first + KINDS_MOST kind of the second; nodes; kinds == UINT32_MAX: empty */
    double value, mean, variance;
    double mu; /* cosine of the two lobes, lowered by epsilon */
};

/* What is known of the lobes of one kind, whichever lobe of the model it is. */
struct kind_moments {
    const struct lobe_kind *kind;
    const struct table *table;
    int geometry;
    struct node *node;
    struct marks ready;
    double *tau_pool, *phi_pool;
    size_t phi_doubles; /* of phi_pool */
    struct functional *functional_pool;
};

struct moments {
    const struct reduced *data;
    const struct kernels *kernels;
    int kinds;
    struct kind_moments kind[KINDS_MOST];
    double epsilon;     /* rounding allowance of a sum, but for its exponents */
    double *omega[FIXED_MOST]; /* B (reduced.bounded) each: data along the normalised a, raised by epsilon |I_k| */
    double inverse_a[FIXED_MOST]; /* 1 / |a|; 0 of a column that vanishes */
    double fixed[FIXED_MOST][FIXED_MOST]; /* cosines of fixed columns, lowered by epsilon; not below 0 */
    double *norm;       /* B: |I_k| */
    double slack;       /* rounding allowance of an objective, absolute */
    uint32_t capacity;  /* nodes of each kind */
    size_t evaluated;   /* nodes computed */
    struct pair *cache; /* direct-mapped: a hit saves a sum, a miss costs nothing else */
    uint32_t cached;    /* places in it */
    double *scratch;    /* brdffit_moments_scratches() x stride */
};

/* What a search may keep; numbers, so that the same memory holds the same on every processor. */
struct moments_room {
    uint32_t nodes;  /* of each kind */
    uint32_t shaped; /* the first so many of them keep their shapes */
    uint32_t pairs;  /* places for pairs, 0 where there are none */
    size_t stride, channels, functionals;
};

/* Whether the columns of two kinds have one exponential phi, so that one sum says how x is spread under both. */
static inline int moments_one_family(const struct moments *m, int first, int second)
{
    const struct kind_moments *one = &m->kind[first], *two = &m->kind[second];

    return one->kind == two->kind && one->geometry % m->data->bases == two->geometry % m->data->bases &&
           one->kind->exponential;
}

void brdffit_moments_layout(struct moments *moments, struct arena *arena, const struct moments_room *room,
                            const struct model *model);

/* Doubles of a shape that a node keeps for each group, and vectors of scratch: fewer where every kind is exponential. */
static inline size_t moments_kept(const struct lobe_kind *kind)
{
    return kind->exponential ? 1 : 3;
}
size_t brdffit_moments_scratches(const struct model *model);

void brdffit_moments_start(struct moments *moments, const struct reduced *data, const struct model *model,
                           const struct kernels *kernels);

/* Node `index` of a kind at coordinate theta, computed on first use. */
const struct node *brdffit_moments_node(struct moments *moments, int kind, uint32_t index, double theta);

/* Have node `index` of a kind, and every pair with it, computed anew: its coordinate is another now. */
void brdffit_moments_forget(struct moments *moments, int kind, uint32_t index);

/* A node at any theta, kept until the next call with the same `slot` (below the number of lobes). */
const struct node *brdffit_moments_scratch(struct moments *moments, int kind, uint32_t slot, double theta);

/* The pair of two scratch nodes of a kind. */
struct pair brdffit_moments_scratch_pair(struct moments *moments, int kind, uint32_t first, uint32_t second);

/* Two computed nodes, each of its kind. */
struct couple {
    int kind[2];
    uint32_t node[2];
};
void brdffit_moments_fill_pair(struct moments *moments, const struct couple *couple, struct pair *pair);

static inline const struct pair *brdffit_moments_pair(struct moments *m, const struct couple *at)
{
    uint32_t kinds = (uint32_t)(at->kind[0] + KINDS_MOST * at->kind[1]), first = at->node[0], second = at->node[1];
    struct pair *pair = &m->cache[(first * 2654435761u ^ second * 40503u ^ kinds * 97u) % m->cached];

    if (pair->first != first || pair->second != second || pair->kinds != kinds) {
        brdffit_moments_fill_pair(m, at, pair);
    }
    return pair;
}

/* phi of a computed node: stored, or computed into scratch (stride doubles). */
const double *brdffit_moments_shape(const struct moments *moments, int kind, const struct node *node, double *scratch);

/* x = -ell and slope of a computed node, likewise (2 x stride doubles); of exponential lobes *slope is NULL. */
const double *brdffit_moments_slopes(const struct moments *moments, int kind, const struct node *node, double *scratch,
                                     const double **slope);

#endif
