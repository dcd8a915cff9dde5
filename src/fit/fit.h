/*
 * Everything that one fit keeps in the caller's workspace, and the steps that share it.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FIT_H
#define BRDFFIT_FIT_H

#include "base/arena.h"
#include "search/axis.h"
#include "bound/lp/bound_lp.h"
#include "bound/cell/cell.h"
#include "bound/moment/bound.h"
#include "bound/socp/bound_socp.h"
#include "brdffit.h"
#include "base/environment.h"
#include "search/heap.h"
#include "data/reduce.h"
#include "search/search.h"
#include "solve/varpro.h"

/* What shows boxes to the caller: observe.c. */
struct observer {
    const struct fit *fit;
    const brdffit_options *options;
    double scale; /* objective to the caller's units */
};

/* Where the lobes of one kind are searched: theta = ln s. */
struct domain {
    double low, high; /* of the search; the tail counts as its end */
    double flat; /* beyond `high` nothing changes up to here: the end of the range, or of finite y; below `low`: no
                         lobe has a finite y */
    double tail; /* end of the options' range */
    double parameter_low, parameter_tail; /* what the ends of the range are of the parameter, sigma or the exponent */
};

/* What a fit hands out by pointer, in the workspace: `result` and what it points to, but for arrays of K. */
struct handout {
    void *block; /* what brdffit_result_free() frees: set by brdffit_fit_new() */
    brdffit_result result;
    brdffit_model model;
    brdffit_lobe lobe[BRDFFIT_MAX_LOBES];
    const brdffit_lobe *lobes[BRDFFIT_MAX_LOBES];
    double sigma[BRDFFIT_MAX_LOBES], anisotropy[BRDFFIT_MAX_LOBES], tangent_angle[BRDFFIT_MAX_LOBES];
    brdffit_distribution distributions[BRDFFIT_MAX_LOBES];
    size_t skipped[BRDFFIT_SKIP_COUNT];
    brdffit_verification verification;
};

struct fit {
    struct model model;
    struct reduced data;
    struct axis axis[BRDFFIT_MAX_LOBES]; /* one a kind of first columns; with an anisotropic lobe one a side */
    struct heap heap;
    struct bound_moment moment; /* only the engine in use is laid out */
    struct bound_socp socp;
    struct bound_lp linear;
    struct bound_cell cells; /* of models whose anisotropic lobe is searched (anisotropic.c) */
    struct l1_linf restricted; /* norms l1 and linf only */
    struct varpro varpro;
    brdffit_norm norm;
    int physical; /* whether this search keeps to physical bounds: the second one of such a fit */
    struct domain domain[BRDFFIT_MAX_LOBES]; /* one an axis */
    struct handout *handout;
    struct lobe_kind vanished[KINDS_MOST]; /* in the model's place of kinds of which no lobe has a finite y */
    double *x, *y, *rms; /* K, K x P, K: the result's arrays */
    double *f0, *x_more; /* K x P, K x (F - 1): likewise, where the model has them */
    int *at_limit;       /* K, or NULL without physical bounds */
    double *z;           /* K x columns: published coefficients, one a column */
    double rows_error; /* how far E^2 of the rows may be from that of the samples, relative to the total: 0, but of
                              sums */
    double triangle_error; /* brdffit_fit_triangle_error() */
    double least; /* smallest objective met, exact */
    double (*try_point)(void *fit, struct point *point); /* the engine's */
    void *block; /* scratch of the reduction, then the search (layout.c) */
    size_t block_bytes;
    int limited; /* whether that is less than a search may want */
    struct observer observer;
};

/* The domain of a lobe. */
static inline const struct domain *fit_domain(const struct fit *f, int lobe)
{
    return &f->domain[f->model.lobe[lobe].kind];
}

/* Every field in its range. The options are whole, as brdffit_intake_options() makes them; so are all that follow. */
brdffit_status brdffit_options_check(const brdffit_options *options, brdffit_error *error);

/* Whether the model needs more of a sample than a, b and c: Fresnel, masking, or a diffuse term that are not the defaults, an
 * anisotropic lobe. */
static inline int brdffit_options_special(const brdffit_options *o)
{
    return o->fresnel != BRDFFIT_FRESNEL_NONE || o->diffuse != BRDFFIT_DIFFUSE_LAMBERT ||
           o->masking != BRDFFIT_MASKING_V_CAVITY || o->anisotropic;
}

/* Lay a fit out in an arena (counting or real). */
void brdffit_fit_layout(struct fit *fit, struct arena *arena, size_t count, size_t channels,
                        const brdffit_options *options);

/* Whether the two roughnesses of an anisotropic lobe are searched. */
static inline int brdffit_options_two_shapes(const brdffit_options *o)
{
    return o->anisotropic && !(o->anisotropy > 0.0);
}

/* Tell the progress callback that the samples are reduced; whether it wants no more. */
int brdffit_fit_report_reduced(const struct fit *fit, const brdffit_options *options);

/* What a search is told by the options, once the domain is known. */
void brdffit_fit_rules(const struct fit *fit, const brdffit_options *options, struct search_rules *rules);

/* The whole fit of such a model: see anisotropic.c. */
brdffit_status brdffit_fit_anisotropic(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                       size_t size, struct fit *fit, brdffit_error *error);

/* Its domain, axes and engine, of a fit that is open. */
void brdffit_fit_anisotropic_engine(struct fit *fit, const brdffit_options *options, struct engine *engine);

/* After the reduction, lay out what the search keeps where that had its scratch: written to once the search begins. */
void brdffit_fit_layout_search(struct fit *fit, const brdffit_options *options);

/* Check the call, lay out and reduce. `result` is only looked at for NULL. */
brdffit_status brdffit_fit_open(struct fit *fit, const brdffit_samples *samples, const brdffit_options *options,
                                void *workspace, size_t size, const void *result, brdffit_error *error);

/* After a reduction: whether its sum of squares is a normal double in the caller's units. */
brdffit_status brdffit_fit_check_total(const struct fit *fit, const brdffit_options *options, brdffit_error *error);

/* Domain, first partition, engine and rules of a fit that is open. After success the engine is to be finished. */
brdffit_status brdffit_fit_start(struct fit *fit, const brdffit_options *options, struct engine *engine,
                                 struct search_rules *rules, brdffit_error *error);

/* Whether the published coefficients obey physical bounds, in exact arithmetic. */
int brdffit_fit_is_physical(const struct fit *fit);

/* All that follows the reduction, of a fit that is open; the result is fit->handout->result. */
brdffit_status brdffit_fit_finish(struct fit *fit, const brdffit_options *options, brdffit_error *error);

/* What turns an internal objective into the caller's units. */
double brdffit_fit_scale(const struct reduced *data, const brdffit_options *options);
double brdffit_fit_level(double level, double scale);

/*
 * After the reduction: the lobe kind, and the domain of theta = ln s, which is the options' range cut where the
 * lobe no longer changes (theory 4.1).
 */
void brdffit_fit_prepare(struct fit *fit, const brdffit_options *options);

/* A coordinate that is an end of what is claimed, moved up by `steps` times what rounding may have done to it. */
double brdffit_fit_outwards(double theta, double steps);

/* Make the engine that the options name, after brdffit_fit_prepare(); finish releases what engine socp allocated. */
brdffit_status brdffit_fit_engine_start(struct fit *fit, const brdffit_options *options, struct engine *engine);
void brdffit_fit_engine_finish(struct fit *fit, const brdffit_options *options);

/* Have the rules show each box to the options' callback. *options and *fit must live as long as the search. */
void brdffit_fit_observe(struct fit *fit, const brdffit_options *options, struct search_rules *rules);

/* The roughness of theta, s^(-1/2) whatever the kind's parameter is, never outside of the options' range. */
double brdffit_fit_sigma(const struct fit *fit, int kind, double theta);

/* Exact objective at a point in the fit's norm, while its engine is there. With `prove`, value->kkt is meant too. */
void brdffit_fit_evaluate(struct fit *fit, const struct point *at, int prove, struct varpro_value *value);

/* Fill fit->handout from the outcome of a search; objective_scale turns its objective into the caller's units. */
void brdffit_report(struct fit *fit, const brdffit_options *options, double objective_scale,
                    const struct search_result *found);

/* Stop, certified, lower_bound and gap of a result, from its e2, e2_error, sum_of_squares and what was in stop and
 * lower_bound so far: to be called last, and again when a number has changed. */
void brdffit_fit_judge(const brdffit_options *options, brdffit_result *result);

/* Sample i alone, to be evaluated as radiance. */
brdffit_samples brdffit_fit_one_sample(const brdffit_samples *samples, size_t i);

/* What turns values of sample i into radiance; 0 when it is not used. Bad samples were found by brdffit_inspect_run(). */
double brdffit_fit_to_radiance(const brdffit_samples *samples, const brdffit_model *model, double min_cosine, size_t i);

/* The public functions of whole structures, in the floating-point environment as it is (entry.c calls them). */
ENVIRONMENT_APART size_t brdffit_fit_workspace(size_t count, size_t channels, const brdffit_options *options);
ENVIRONMENT_APART brdffit_status brdffit_fit_run(const brdffit_samples *samples, const brdffit_options *options,
                                                 void *workspace, size_t workspace_size, const brdffit_result **result,
                                                 brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_fit_sums_run(const brdffit_sums *sums, const brdffit_options *options,
                                                      void *workspace, size_t workspace_size,
                                                      const brdffit_result **result, brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_sums_init_run(void *memory, size_t size, size_t channels, size_t groups,
                                                       const brdffit_options *options, brdffit_sums **sums,
                                                       brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_verify_run(const brdffit_samples *samples, const brdffit_options *options,
                                                    double level, void *workspace, size_t workspace_size,
                                                    const brdffit_verification **verification, brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_inspect_run(const brdffit_samples *samples, const brdffit_options *options,
                                                     size_t *used, size_t *skipped, size_t reasons,
                                                     brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_quality_run(const brdffit_samples *samples, const brdffit_options *options,
                                                     const double *fitted, double *r2, double total[3],
                                                     unsigned *misfit, brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_f0_interval_run(const brdffit_samples *samples, const brdffit_options *options,
                                                         const brdffit_model *model, double *low, double *high,
                                                         brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_azimuth_share_run(const brdffit_samples *samples,
                                                           const brdffit_options *options, const brdffit_model *model,
                                                           const double *channel_scale, double *share,
                                                           brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_eval_run(const brdffit_model *model, const brdffit_samples *at, double *out,
                                                  brdffit_error *error);

#endif
