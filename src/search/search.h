/*
 * Best-first branch and bound over boxes (theory section 5). Knows engines, not BRDFs.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SEARCH_H
#define BRDFFIT_SEARCH_H

#include "search/engine.h"
#include "brdffit.h"

struct search_rules {
    double relative_gap;
    double absolute_gap;     /* in units of the objective */
    double sigma_resolution; /* 0: off */
    size_t box_budget;
    int cancelled;           /* stop as soon as the first partition is bounded */
    brdffit_progress_fn progress;
    void *progress_user;
    double progress_scale;   /* objective to what the caller sees */
    void (*observe)(void *self, const struct box *box); /* or NULL: each box once, with its final bound */
    void *observe_self;
};

struct search_result {
    struct point point;  /* incumbent */
    double objective;    /* exact, at the incumbent */
    double lower_bound;  /* of the whole domain, as the boxes have it: not lowered to the objective */
    brdffit_stop stop;
    size_t boxes;
};

/* Every axis of the engine's sides must be started. The heap is emptied first. */
void brdffit_search(struct axis *axis, struct heap *heap, const struct engine *engine, const struct search_rules *rules,
                    struct search_result *result);

/* Objective below which a lower bound counts as proof for an incumbent of this objective. */
double brdffit_search_cutoff(const struct search_rules *rules, double objective);

#endif
