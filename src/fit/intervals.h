/*
 * Intervals of parameters: what their parts share (theory 7.10). SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_INTERVALS_H
#define BRDFFIT_INTERVALS_H

#include "fit/fit.h"

/* What an interval is of. Roughness is known by theta. */
enum parameter { PARAMETER_THETA, PARAMETER_X, PARAMETER_Y, PARAMETER_F0 };

/* One end of one interval. */
struct interval_end {
    enum parameter parameter;
    int upper;
    int side;       /* of THETA, Y and F0: which side of a box has the lobe */
    int fixed;      /* of X: which column */
    size_t channel; /* of X, Y and F0 */
    double fitted;  /* value of the model that was fitted */
};

/* What was found: `bound` is proven, `reached` attained; both in [the end's limits]. */
struct interval_found {
    double bound, reached;
    int settled; /* as near each other as was asked for, or as can be told */
    int cancelled;
    size_t boxes;
};

/* The state of all searches of one call. */
struct intervals_work {
    struct fit *fit;
    struct engine engine; /* of a fit */
    struct search_rules rules;
    size_t *group;    /* K: of which channel that bounds look at each is; as many as those: of none */
    double threshold; /* of E^2, internal units */
    struct point start; /* the model's, sides in the order of the search */
    double tolerance;
};

void brdffit_intervals_search(struct intervals_work *work, const struct interval_end *end,
                              struct interval_found *found);

/* The side of a box that has lobe p of a result, where like lobes stand in the other order. */
static inline int intervals_side(const struct model *model, int p)
{
    int first = model->lobe[p].first, last = p;

    while (last + 1 < model->lobes && model->lobe[last + 1].first == first) {
        last++;
    }
    return first + last - p;
}

/* ---- what coefficients of unit columns are divided by ---- */

struct wide_range {
    struct wide low, high;
};

/* |g| in the caller's units of column c of the lobes, over an interval of its axis, and at an end of it; and of a fixed column. */
struct wide_range brdffit_intervals_norm(struct intervals_work *work, int c, uint32_t interval);
struct wide brdffit_intervals_end_norm(struct intervals_work *work, int c, uint32_t interval, int high);
struct wide brdffit_intervals_fixed_norm(const struct fit *fit, int f);

/* The ratio of the norms of the two columns of a lobe, low[0] to high[1]; high may be INFINITY. */
void brdffit_intervals_ratio(struct intervals_work *work, int side, uint32_t interval, double ratio[2]);

/* |g| / (norm of the unscaled column) at theta. */
struct wide brdffit_intervals_factor(const struct fit *fit, int c, double theta);

/* z / norm in the data's units, towards `up`. */
double brdffit_intervals_value(const struct fit *fit, size_t channel, double z, struct wide norm, int up);

ENVIRONMENT_APART size_t brdffit_intervals_bytes(size_t count, size_t channels, const brdffit_options *options);
ENVIRONMENT_APART brdffit_status brdffit_intervals_run(const brdffit_samples *samples, const brdffit_options *options,
                                                       const brdffit_model *model, double e2,
                                                       const brdffit_interval_options *interval_options,
                                                       void *workspace, size_t workspace_size,
                                                       const brdffit_interval_result **result, brdffit_error *error);
brdffit_status brdffit_intake_interval_options(const brdffit_interval_options *callers, brdffit_interval_options *own,
                                               brdffit_error *error);

#endif
