/*
 * What the moment engine knows about one interval of an axis (theory 4.2), whichever box it is a side of.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_INTERVAL_H
#define BRDFFIT_INTERVAL_H

#include "base/arena.h"
#include "base/marks.h"
#include "data/moments.h"
#include "search/axis.h"

/* The cosine of a second column with the first one: its values at both ends, shift and infimum as of a kappa. */
struct beside {
    double end[2], shift, least;
};

struct interval {
    const struct node *low, *high;
    uint32_t low_index, high_index;
    double eighth;      /* (u_high - u_low)^2 / 8 */
    double *kappa_shift; /* F, signed: kappa may fall below its chord by this much at most */
    double *kappa_inf;   /* F, >= 0 */
    struct beside *beside; /* of second columns, else NULL */
    double curvature; /* inf of the term that a lobe's own norm contributes to second derivatives:
                           2 m2 for exponential lobes, mean slope + 2 variance in general */
    double root_m4; /* sup sqrt(m4); infinity for lobes that are not exponential */
    double *tau_shift; /* K, signed: tau may exceed its chord by this much at most */
    double *tau_sup; /* K */
    int usable; /* whether the shifts are finite and within LIMIT_SHIFT */
    int refined; /* how often brdffit_interval_refine() has halved it */
};

/* Those of one kind of lobe. */
struct intervals {
    struct moments *moments;
    int kind, exponential;
    struct intervals *first; /* of the first columns, where these are of the second ones; or NULL */
    struct interval *interval;
    struct marks ready;
    double *pool;
    struct beside *beside; /* as many as intervals, of second columns */
};

/* `second`: they are of second columns. */
void brdffit_intervals_layout(struct intervals *intervals, struct arena *arena, size_t capacity, size_t channels,
                              size_t fixed, int second);
void brdffit_intervals_start(struct intervals *intervals, struct moments *moments, int kind, struct intervals *first);

/* Interval `index` between two nodes of the axis: see brdffit_interval(). */
void brdffit_interval_fill(struct intervals *intervals, uint32_t index, const struct axis *axis);

/* What is known of interval `index` of the axis, computed on first use. */
static inline struct interval *brdffit_interval(struct intervals *t, uint32_t index, const struct axis *axis)
{
    if (!marks_set(&t->ready, index)) {
        brdffit_interval_fill(t, index, axis);
    }
    return &t->interval[index];
}

/* Have interval `index` computed anew: its ends are others now. */
static inline void brdffit_interval_forget(struct intervals *t, uint32_t index)
{
    marks_clear(&t->ready, index);
}

/* Tighten every shift by the two halves of the interval, which share the node in between. */
void brdffit_interval_refine(struct intervals *intervals, struct interval *whole, const struct interval *left,
                             const struct interval *right);

/* Two sides of a box: intervals of lobes of two kinds, or of one. */
struct sides {
    struct moments *moments;
    int kind[2];
    const struct interval *side[2];
};

/* The pair of nodes at a corner: bit i of `corner` is the high end of side i. */
const struct pair *brdffit_pair_corner(const struct sides *sides, int corner);

/* A cosine mu is never below this in the box; of one kind, the first side is not above the second. */
double brdffit_pair_least(const struct sides *sides);

/* sup over the box of the second derivative of mu by the variable of one side (0 or 1), times that side's `eighth`: how
 * far mu may fall below its chord. */
double brdffit_pair_shift(const struct sides *sides, int which, double least);

#endif
