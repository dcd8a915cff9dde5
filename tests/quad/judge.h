/*
 * What a fit says against what quad precision finds. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_JUDGE_H
#define BRDFFIT_TESTS_JUDGE_H

#include <stddef.h>

#include "fit_view.h"

enum judge_fault {
    JUDGE_BOUND = 0, /* lower_bound above E^2 of a point of the domain */
    JUDGE_E2,        /* e2 is not E^2 at the reported parameters: 1e-9 of itself, 1e-13 of the zero model, e2_error */
    JUDGE_GAP,       /* certified by a gap that e2 and lower_bound do not have */
    JUDGE_GAP_ROUND, /* the same by no more than 1e-12 of e2 and 1e-27 (L1, LINF: 1e-14) of the zero model:
                        e2 is taken again after the stop */
    JUDGE_ORDER,     /* not 0 <= lower_bound <= e2 < infinity, a coefficient that is negative or infinite */
    JUDGE_RANGE,     /* a sigma outside of the options' range */
    JUDGE_NAN,       /* NaN anywhere in the result */
    JUDGE_SCALE,     /* channel_scale or sum_of_squares off by more than 1e-12 */
    JUDGE_USED,      /* samples_used, though no sample is near a limit */
    JUDGE_BOX,       /* the lower_bound of a box above E^2 of a point of the box (campaign --boxes) */
    JUDGE_PROOF,   /* brdffit_verify() proved a level above E^2 of a point */
    JUDGE_COUNT
};

/* Constant name: "bound", "e2", ... */
const char *judge_fault_string(enum judge_fault fault);

struct judgement {
    int fault[JUDGE_COUNT];
    double worst[JUDGE_COUNT]; /* how far: relative, for what has a size */
    double excess_total;       /* bound: (lower_bound - E^2) / E^2 of the zero model */
    double best, s[QUAD_LOBES]; /* of the least E^2 found */
    double e2;                 /* E^2 at the reported parameters */
    int refused;               /* the fit failed: nothing was judged */
    struct fit_box box;        /* the worst box, and E^2 inside of it (attack.h) */
    double box_best;
};

/* `effort`: evaluations of E^2 to spend, about. Returns how many kinds of faults there are. */
int judge(const struct fit_view *view, const struct fit_question *q, size_t effort, struct judgement *out);

/* One line, to `text`; always terminated. */
void judge_describe(const struct judgement *j, const struct fit_view *view, char *text, size_t size);

#endif
