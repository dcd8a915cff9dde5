/*
 * Plans: what all texels of one geometry share. See batch.h. SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "fit/fit.h"
#include "base/error.h"
#include "model/geometry.h"
#include "batch/batch.h"

/* A copy of an array of doubles, or NULL for NULL and while counting. */
static const double *copy(struct arena *arena, const double *from, size_t count, size_t width)
{
    double *to = from ? brdffit_arena_take(arena, count, width * sizeof(double)) : NULL;

    if (to) {
        memcpy(to, from, count * width * sizeof(double));
    }
    return to;
}

/* The options that a plan keeps, with the list that they point to. */
static brdffit_options keep_options(struct arena *arena, const brdffit_options *o)
{
    brdffit_options kept = *o;
    brdffit_distribution *list = o->distributions ? brdffit_arena_take(arena, (size_t)o->lobes, sizeof *list) : NULL;

    if (list) {
        memcpy(list, o->distributions, (size_t)o->lobes * sizeof *list);
    }
    kept.distributions = list;
    kept.progress = NULL;
    return kept;
}

/* Room that making the plan needs. */
struct making {
    struct reduced reduced;
    double *values;
};

/* The plan and its copy of the geometry; only sizes are counted when the arena has no base. */
static struct brdffit_plan *lay_out(struct arena *arena, const brdffit_samples *g, const brdffit_options *o,
                                    struct making *making)
{
    struct batch_fast fast = {0};
    struct brdffit_plan *plan = brdffit_arena_take(arena, 1, sizeof *plan);
    int directions = g->form == BRDFFIT_FORM_DIRECTIONS, angles = g->form == BRDFFIT_FORM_ANGLES;
    int coefficients = g->form == BRDFFIT_FORM_COEFFICIENTS;
    brdffit_options options = keep_options(arena, o);
    brdffit_samples kept = *g;

    kept.light = copy(arena, directions ? g->light : NULL, g->count, 3);
    kept.view = copy(arena, directions ? g->view : NULL, g->count, 3);
    kept.normal = copy(arena, directions ? g->normal : NULL, g->count, 3);
    kept.cos_light = copy(arena, angles ? g->cos_light : NULL, g->count, 1);
    kept.cos_view = copy(arena, angles ? g->cos_view : NULL, g->count, 1);
    kept.tan2_half = copy(arena, angles ? g->tan2_half : NULL, g->count, 1);
    kept.cos_difference = copy(arena, angles ? g->cos_difference : NULL, g->count, 1);
    kept.a = copy(arena, coefficients ? g->a : NULL, g->count, 1);
    kept.b = copy(arena, coefficients ? g->b : NULL, g->count, 1);
    kept.c = copy(arena, coefficients ? g->c : NULL, g->count, 1);
    kept.weights = copy(arena, g->weights, g->count, 1);
    kept.values = NULL;
    if (brdffit_batch_fast_possible(o)) {
        brdffit_batch_fast_layout(&fast, arena, g->count, o);
        brdffit_batch_fast_scratch(&making->reduced, &making->values, arena, g->count, o);
    }
    if (plan) {
        plan->options = options;
        plan->geometry = kept;
        plan->fast = fast;
    }
    return plan;
}

/* Everything about the call but sizes. */
static brdffit_status check(const brdffit_samples *geometry, const brdffit_options *options, brdffit_error *error)
{
    brdffit_status status = brdffit_options_check(options, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_geometry_check(geometry, 0, error);
    }
    if (status == BRDFFIT_OK && options->anisotropic) {
        status = brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "maps have no anisotropic lobes");
    }
    if (status == BRDFFIT_OK && geometry->channels == 0) {
        status = brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "samples: no channels");
    }
    return status;
}

/* Every sample is in range, and some count. */
static brdffit_status check_samples(const brdffit_samples *geometry, const brdffit_options *options,
                                    brdffit_error *error)
{
    double min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    size_t i, used = 0;

    for (i = 0; i < geometry->count; i++) {
        struct geometry g;
        brdffit_status status;
        brdffit_skip skip = brdffit_geometry_sample(geometry, brdffit_model_asked(options, 0), min_cosine, i, &g,
                                                    &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        used += skip == BRDFFIT_SKIP_COUNT;
    }
    return used ? BRDFFIT_OK : brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
}

static size_t workspace_size(const brdffit_options *options, size_t samples, size_t channels)
{
    struct arena arena;
    struct batch batch;

    brdffit_arena_init(&arena, NULL, 0);
    brdffit_batch_layout(&batch, &arena, options, samples, channels);
    return arena.failed ? 0 : arena.used;
}

size_t brdffit_plan_bytes(const brdffit_samples *geometry, const brdffit_options *options)
{
    struct making making;
    struct arena arena;

    if (check(geometry, options, NULL) != BRDFFIT_OK) {
        return 0;
    }
    brdffit_arena_init(&arena, NULL, 0);
    (void)lay_out(&arena, geometry, options, &making);
    return arena.failed || workspace_size(options, geometry->count, geometry->channels) == 0 ? 0 : arena.used;
}

brdffit_status brdffit_plan_make(const brdffit_samples *geometry, const brdffit_options *options, void *memory,
                                 size_t size, const brdffit_plan **plan, brdffit_error *error)
{
    brdffit_status status = check(geometry, options, error);
    struct brdffit_plan *made;
    struct making making;
    struct arena arena;
    size_t needed;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!memory || !plan) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "memory or plan is NULL");
    }
    needed = brdffit_plan_bytes(geometry, options);
    if (needed == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "more samples or channels than can be addressed");
    }
    if (size < needed) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE, "the memory is smaller than brdffit_plan_size()");
    }
    status = check_samples(geometry, options, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_arena_init(&arena, memory, size);
    made = lay_out(&arena, geometry, options, &making);
    made->workspace_size = workspace_size(options, geometry->count, geometry->channels);
    made->kernels = NULL;
    if (brdffit_batch_fast_possible(options) &&
        brdffit_batch_fast_start(&made->fast, geometry, options, &making.reduced, making.values)) {
        made->kernels = brdffit_batch_kernels(options->isa);
    }
    *plan = made;
    return BRDFFIT_OK;
}

size_t brdffit_many_workspace_size(const brdffit_plan *plan)
{
    return plan ? plan->workspace_size : 0;
}
