/*
 * What the moment engine knows about one interval of the axis (theory 4.2), whichever box it is a side of.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_INTERVAL_H
#define BRDFFIT_INTERVAL_H

#include "base/arena.h"
#include "data/moments.h"

struct interval {
    const struct node *low, *high;
    uint32_t low_index, high_index;
    double eighth;       /* (u_high - u_low)^2 / 8 */
    double kappa_shift;  /* signed: kappa may fall below its chord by this much at most */
    double kappa_inf;    /* >= 0 */
    double curvature;    /* inf of the term that a lobe's own norm contributes to second derivatives:
                            2 m2 for exponential families, mean slope + 2 variance in general */
    double root_m4;      /* sup sqrt(m4); infinity for general families */
    double *tau_shift;   /* K, signed: tau may exceed its chord by this much at most */
    double *tau_sup;     /* K */
    int refined;         /* how often brdffit_interval_refine() has halved it */
};

struct intervals {
    struct moments *moments;
    struct interval *interval;
    unsigned char *ready;
    double *pool;
    size_t capacity;
};

void brdffit_intervals_layout(struct intervals *intervals, struct arena *arena, size_t capacity, size_t channels);
void brdffit_intervals_start(struct intervals *intervals, struct moments *moments);

/* Interval `index` between two nodes of the axis, computed on first use. */
struct interval *brdffit_interval(struct intervals *intervals, uint32_t index, uint32_t low, uint32_t high,
                                  double theta_low, double theta_high);

/* Tighten kappa_shift and every tau_shift by the two halves of the interval, which share the node in between. */
void brdffit_interval_refine(struct intervals *intervals, struct interval *whole, const struct interval *left,
                             const struct interval *right);

/*
 * sup over the box first x second of the second derivative of mu by the variable of `first` (which = 0) or of
 * `second` (which = 1), times that side's `eighth`: how far mu may fall below its chord.
 */
double brdffit_pair_shift(struct intervals *intervals, const struct interval *first, const struct interval *second,
                          int which);

#endif
