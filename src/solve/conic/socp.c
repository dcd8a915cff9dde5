/*
 * Second-order cone programs through ECOS 2.0.14: see socp.h.
 *
 * ECOS's tolerances are relative to max(1, |h|) and max(1, |c|), and its equilibration leaves rows and
 * columns below 1e-6 alone, so numbers go through scaling.c first.
 *
 * Traps of ECOS, seen in its source, that the code below steps around:
 *  - it keeps and overwrites the caller's G and h (equilibration in place) and c (during a solve): all
 *    three are private here and written anew before every solve, so no state is carried over;
 *  - ECOS_updateData with new pointers and no equality rows dereferences NULL: the same buffers are
 *    handed in, which it recognises by their addresses;
 *  - when a solve meets NaN before its first iterate is saved, it restores the best iterate of the solve
 *    before, and may report that one's success: that iterate is spoilt before every solve;
 *  - two exits (ECOS_FATAL, ECOS_OUTCONE) leave x and z in scaled form: they count as having none;
 *  - a G whose pattern has no entry at all makes its setup read memory that it never wrote: refused;
 *  - CTRLC > 0 takes over SIGINT in each solve: the build sets it to 0, and this file checks;
 *  - it prints unless told not to;
 *  - it does not check its mallocs: ecos_memory.h, where none fails. Equilibration allocates in each solve, out of
 *    `scratch`, so that solving does not fail for want of memory.
 * SPDX-License-Identifier: MIT
 */
#include "solve/conic/socp.h"

#ifdef BRDFFIT_NO_ECOS

brdffit_status brdffit_socp_new(const struct conic_shape *shape, struct socp **socp)
{
    *socp = NULL;
    return brdffit_conic_valid(shape) ? BRDFFIT_ERR_UNSUPPORTED : BRDFFIT_ERR_ARGUMENT;
}

brdffit_status brdffit_socp_solve(struct socp *socp, const struct conic_data *data, double *x, double *z,
                                  struct socp_result *result)
{
    (void)socp;
    (void)data;
    (void)x;
    (void)z;
    (void)result;
    return BRDFFIT_ERR_UNSUPPORTED;
}

void brdffit_socp_trust_scale(struct socp *socp)
{
    (void)socp;
}

void brdffit_socp_free(struct socp *socp)
{
    (void)socp;
}

#else

#include <math.h>
#include <stdlib.h>

#include <ecos.h>

#include "base/arena.h"
#include "solve/conic/ecos_memory.h"
#include "solve/conic/scaling.h"

#if !defined(CTRLC) || CTRLC > 0
#error "build with -DCTRLC=0: ECOS must leave SIGINT to the application"
#endif

struct socp {
    pwork *work;
    double *g, *c, *h;    /* ECOS's buffers: overwritten by every solve */
    idxint *column, *row; /* of g; kept by ECOS */
    idxint *cone;         /* dimensions */
    struct scaling scaling;
    struct ecos_memory memory;
    const struct conic_shape *shape; /* while it is made */
    idxint code;                     /* of the last solve */
};

/* A vector as long as x and one as long as h (use_ruiz_equilibration of ECOS), and their alignment. */
static size_t scratch_bytes(const struct scaling *scaling)
{
    return (scaling->variables + scaling->rows) * sizeof(pfloat) + 4 * sizeof(max_align_t);
}

/* ---- Making one ------------------------------------------------------------------------------------------- */

static struct socp *layout(struct arena *arena, const struct conic_shape *shape)
{
    struct socp counting = {0};
    struct socp *memory = brdffit_arena_take(arena, 1, sizeof *memory);
    struct socp *socp = memory ? memory : &counting;

    brdffit_scaling_layout(&socp->scaling, arena, shape);
    socp->g = ARENA_DOUBLES(arena, socp->scaling.entries);
    socp->c = ARENA_DOUBLES(arena, socp->scaling.variables);
    socp->h = ARENA_DOUBLES(arena, socp->scaling.rows);
    socp->column = brdffit_arena_take(arena, socp->scaling.variables + 1, sizeof *socp->column);
    socp->row = brdffit_arena_take(arena, socp->scaling.entries, sizeof *socp->row);
    socp->cone = brdffit_arena_take(arena, shape->cones, sizeof *socp->cone);
    socp->memory.scratch = brdffit_arena_take(arena, scratch_bytes(&socp->scaling), 1);
    return memory;
}

/* All of it in one block, aligned as the arena aligns, so that the block begins with the struct. */
static struct socp *allocate(const struct conic_shape *shape)
{
    struct arena arena;
    void *block;

    brdffit_arena_init(&arena, NULL, 0);
    layout(&arena, shape);
    if (arena.failed) {
        return NULL;
    }
    block = aligned_alloc(ARENA_ALIGNMENT, (arena.used / ARENA_ALIGNMENT + 1) * ARENA_ALIGNMENT);
    if (!block) {
        return NULL;
    }
    brdffit_arena_init(&arena, block, arena.used);
    return layout(&arena, shape);
}

static void start(struct socp *socp, const struct conic_shape *shape)
{
    struct scaling *scaling = &socp->scaling;
    size_t i;

    brdffit_scaling_start(scaling, shape);
    for (i = 0; i <= scaling->variables; i++) {
        socp->column[i] = (idxint)scaling->column[i];
    }
    for (i = 0; i < scaling->entries; i++) {
        socp->row[i] = (idxint)scaling->row[i];
        socp->g[i] = 1.0; /* only the pattern matters until the first solve */
    }
    for (i = 0; i < scaling->variables; i++) {
        socp->c[i] = 0.0;
    }
    for (i = 0; i < scaling->rows; i++) {
        socp->h[i] = 0.0;
    }
    for (i = 0; i < shape->cones; i++) {
        socp->cone[i] = (idxint)shape->cone[i];
    }
    socp->memory.first = NULL;
    socp->memory.scratch_size = 0; /* of solves */
    socp->memory.scratch_used = 0;
    socp->shape = shape;
}

static void set_up(void *argument)
{
    struct socp *socp = argument;

    socp->work = ECOS_setup((idxint)socp->scaling.variables, (idxint)socp->scaling.rows, 0, (idxint)socp->shape->linear,
                            (idxint)socp->shape->cones, socp->cone, 0, socp->g, socp->column, socp->row, NULL, NULL,
                            NULL, socp->c, socp->h, NULL);
}

brdffit_status brdffit_socp_new(const struct conic_shape *shape, struct socp **result)
{
    struct socp *socp;

    *result = NULL;
    if (!(brdffit_conic_valid(shape) && brdffit_conic_entries(shape) > 0)) {
        return BRDFFIT_ERR_ARGUMENT;
    }
    socp = allocate(shape);
    if (!socp) {
        return BRDFFIT_ERR_MEMORY;
    }
    start(socp, shape);
    if (!brdffit_ecos_memory_call(&socp->memory, set_up, socp) || !socp->work) {
        brdffit_socp_free(socp);
        return BRDFFIT_ERR_MEMORY;
    }
    socp->shape = NULL; /* the caller's */
    socp->memory.scratch_size = scratch_bytes(&socp->scaling);
    socp->work->stgs->verbose = 0;
    *result = socp;
    return BRDFFIT_OK;
}

void brdffit_socp_trust_scale(struct socp *socp)
{
    socp->scaling.trusted = 1;
}

void brdffit_socp_free(struct socp *socp)
{
    if (socp) {
        brdffit_ecos_memory_release(&socp->memory);
        free(socp);
    }
}

/* ---- Numbers in ------------------------------------------------------------------------------------------- */

static int all_finite(const double *value, size_t count)
{
    size_t i;

    for (i = 0; i < count; i++) {
        if (!isfinite(value[i])) {
            return 0;
        }
    }
    return 1;
}

/* So that nothing of an earlier solve can be taken for this one's best iterate. */
static void spoil_best_iterate(pwork *work)
{
    stats *best = work->best_info;

    best->pres = best->dres = best->pinfres = best->dinfres = ECOS_NAN;
    best->gap = best->relgap = best->mu = best->kapovert = ECOS_NAN;
    best->pcost = best->dcost = ECOS_NAN;
    best->iter = 0;
    work->best_tau = work->best_kap = ECOS_NAN;
    work->best_cx = work->best_by = work->best_hz = ECOS_NAN;
}

/* ---- Answers out ------------------------------------------------------------------------------------------ */

static double dot(const double *p, const double *q, size_t count)
{
    double sum = 0.0;
    size_t i;

    for (i = 0; i < count; i++) {
        sum += p[i] * q[i];
    }
    return sum;
}

/* x and z in the caller's scaling; zeros, and 0 as the answer, when ECOS left none. */
static int unload(const struct socp *socp, idxint code, double *x, double *z)
{
    size_t n = socp->scaling.variables;
    size_t m = socp->scaling.rows;
    size_t i;

    if (code != ECOS_FATAL && code != ECOS_OUTCONE) {
        brdffit_scaling_undo(&socp->scaling, socp->work->x, socp->work->z, x, z);
        if (all_finite(x, n) && all_finite(z, m)) {
            return 1;
        }
    }
    for (i = 0; i < n; i++) {
        x[i] = 0.0;
    }
    for (i = 0; i < m; i++) {
        z[i] = 0.0;
    }
    return 0;
}

/* Make `along`'v = -1; 0 when v is no ray. */
static int normalise_ray(double *v, const double *along, size_t count)
{
    double length = -dot(v, along, count);
    size_t i;

    if (!(length > 0.0 && isfinite(length))) {
        return 0;
    }
    for (i = 0; i < count; i++) {
        v[i] /= length;
    }
    return all_finite(v, count);
}

static enum socp_outcome judge(const struct socp *socp, const struct conic_data *data, idxint code, double *x,
                               double *z, struct socp_result *result)
{
    if (!unload(socp, code, x, z)) {
        result->primal = INFINITY;
        result->dual = -INFINITY;
        return SOCP_FAILED;
    }
    result->primal = dot(data->c, x, socp->scaling.variables);
    result->dual = -dot(data->h, z, socp->scaling.rows);
    if (code == ECOS_OPTIMAL || code == ECOS_OPTIMAL + ECOS_INACC_OFFSET) {
        int finite = isfinite(result->primal) && isfinite(result->dual);

        return !finite ? SOCP_FAILED : code == ECOS_OPTIMAL ? SOCP_OPTIMAL : SOCP_INACCURATE;
    }
    if (code == ECOS_PINF && normalise_ray(z, data->h, socp->scaling.rows)) {
        result->primal = result->dual = INFINITY;
        return SOCP_PRIMAL_INFEASIBLE;
    }
    if (code == ECOS_DINF && normalise_ray(x, data->c, socp->scaling.variables)) {
        result->primal = result->dual = -INFINITY;
        return SOCP_DUAL_INFEASIBLE;
    }
    return SOCP_FAILED;
}

static void solve(void *argument)
{
    struct socp *socp = argument;

    ECOS_updateData(socp->work, socp->g, NULL, socp->c, socp->h, NULL);
    socp->code = ECOS_solve(socp->work);
}

brdffit_status brdffit_socp_solve(struct socp *socp, const struct conic_data *data, double *x, double *z,
                                  struct socp_result *result)
{
    if (!(all_finite(data->g, socp->scaling.entries) && all_finite(data->c, socp->scaling.variables) &&
          all_finite(data->h, socp->scaling.rows))) {
        return BRDFFIT_ERR_VALUE;
    }
    brdffit_scaling_apply(&socp->scaling, data, socp->g, socp->c, socp->h);
    spoil_best_iterate(socp->work);
    if (!brdffit_ecos_memory_call(&socp->memory, solve, socp)) {
        return BRDFFIT_ERR_MEMORY; /* never: the scratch is as large as what it takes */
    }
    result->code = (int)socp->code;
    result->iterations = (size_t)socp->work->info->iter;
    result->outcome = judge(socp, data, socp->code, x, z, result);
    return BRDFFIT_OK;
}

#endif
