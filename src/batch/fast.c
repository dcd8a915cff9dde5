/*
 * What a plan holds for one lobe: any distribution, masking, and Fresnel. SPDX-License-Identifier: MIT
 *
 * Let I be a channel's weighted data, a and b_j the weighted columns, one of the lobe or (Schlick) two, omega = I.a / |a|,
 * and r = I - omega a / |a| what the diffuse term leaves. With phi_m the shape of the m-th group of samples at theta,
 *
 *     n_kj = sum_m r_kjm phi_m        r_kjm: sum of r b_j over the samples of group m, known once per texel
 *     u_j  = sum_m ab_jm phi_m / |a|, D_ij = (b_i phi - u_i a / |a|) . (b_j phi - u_j a / |a|)
 *
 * For any lambda >= 0 and l_j >= 0, 2 (omega + lambda) x + 2 l.y replaces 2 omega x without lowering the maximum over
 * x, y >= 0. Eliminating x leaves what channel k gains: at most the maximum over all y of
 *
 *     (omega + lambda)^2 + 2 (n - lambda u + l).y - y D y
 *
 * which about any y0 is   (omega + lambda)^2 + 2 (n - lambda u + l).y0 - y0 D y0 + rho D^-1 rho,   rho = n - lambda u + l - D y0
 *
 * and rho = 0 where lambda, l, y0 solve the restricted problem. n, u and D are smooth, D and u are the plan's, n is linear
 * in the data. So the proof needs nothing of a distribution but that phi is a polynomial over a short interval of theta,
 * to a known error.
 *
 * The range of theta = ln s is cut into windows: window.c, screen.c. The bound on a piece of one: lanes_bound.h.
 */
#include "batch/fast.h"

#include "fit/fit.h"
#include "base/isa.h"

int brdffit_batch_fast_possible(const brdffit_options *o)
{
    struct model model;

    brdffit_model_make(&model, o);
    return o->norm == BRDFFIT_NORM_L2 && o->engine == BRDFFIT_ENGINE_MOMENT && model.axes == 1 && model.fixed == 1 &&
           !model.turned && !o->physical && o->sigma_resolution == 0.0 && o->box_budget >= 1000;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static int columns_of(const brdffit_options *o)
{
    struct model model;

    brdffit_model_make(&model, o);
    return model.each;
}

static void layout_column(struct batch_column *c, struct arena *arena, size_t count, const struct lobe_kind *kind)
{
    size_t m = PADDED(least(count, BATCH_MOST_DISTINCT)), nodes = BATCH_MOST_NODES;
    double *own = ARENA_DOUBLES(arena, m), *light = kind->smith ? ARENA_DOUBLES(arena, m) : NULL;
    double *view = kind->smith ? ARENA_DOUBLES(arena, m) : NULL;

    c->sight = (struct lobe_sight){.c = own, .light = light, .view = view};
    c->b = ARENA_DOUBLES(arena, count);
    c->bb = ARENA_DOUBLES(arena, m);
    c->ab = ARENA_DOUBLES(arena, m);
    c->node = ARENA_DOUBLES(arena, nodes * m);
    c->shape[0] = ARENA_DOUBLES(arena, BATCH_MOST_NODES * m * BATCH_TERMS);
    c->shape[1] = ARENA_DOUBLES(arena, BATCH_MOST_NODES * m * BATCH_STRIDE_MORE);
}

void brdffit_batch_fast_layout(struct batch_fast *f, struct arena *arena, size_t count, const brdffit_options *o)
{
    size_t m = PADDED(least(count, BATCH_MOST_DISTINCT));
    struct model model;
    int j;

    brdffit_model_make(&model, o);
    f->sample = brdffit_arena_take(arena, count, sizeof *f->sample);
    f->begin = brdffit_arena_take(arena, m + 1, sizeof *f->begin);
    f->a = ARENA_DOUBLES(arena, count);
    f->factor = ARENA_DOUBLES(arena, count);
    f->radiance = ARENA_DOUBLES(arena, count);
    f->cross = ARENA_DOUBLES(arena, m);
    f->cosine = ARENA_DOUBLES(arena, BATCH_MOST_NODES);
    for (j = 0; j < model.each; j++) {
        layout_column(&f->column[j], arena, count, model.kind[0]);
    }
    f->window = brdffit_arena_take(arena, BATCH_MOST_NODES, sizeof *f->window);
    f->scratch = ARENA_DOUBLES(arena, (BATCH_REFERENCE + 2) * m);
}

void brdffit_batch_tile_layout(struct batch_tile *t, struct arena *arena, size_t count, size_t channels,
                               const brdffit_options *o)
{
    size_t m = PADDED(least(count, BATCH_MOST_DISTINCT)), nodes = BATCH_MOST_NODES, C = (size_t)columns_of(o), j;
    size_t n = least(count, BATCH_MOST_SAMPLES), K = least(channels, BATCH_MOST_CHANNELS);

    t->value = ARENA_DOUBLES(arena, n * K * LANES);
    for (j = 0; j < C; j++) {
        t->sum[j] = ARENA_DOUBLES(arena, K * m * LANES);
        t->phi[j] = ARENA_DOUBLES(arena, m * LANES);
    }
    t->gain = ARENA_DOUBLES(arena, nodes * LANES);
    t->scale = ARENA_DOUBLES(arena, K * LANES);
    t->omega = ARENA_DOUBLES(arena, K * LANES);
    t->ii = ARENA_DOUBLES(arena, K * LANES);
    t->x = ARENA_DOUBLES(arena, K * LANES);
    t->y = ARENA_DOUBLES(arena, K * C * LANES);
    t->n = ARENA_DOUBLES(arena, K * C * BATCH_TERMS * LANES);
    t->work = ARENA_DOUBLES(arena, K * (C * BATCH_STRIDE_MORE + C + 2));
    t->one = ARENA_DOUBLES(arena, m);
    t->scan.largest = ARENA_DOUBLES(arena, K * LANES);
    t->scan.magnitude = ARENA_DOUBLES(arena, K * LANES);
}

void brdffit_batch_fast_scratch(struct reduced *r, double **values, struct arena *arena, size_t count,
                                const brdffit_options *options)
{
    struct model model;

    brdffit_model_make(&model, options);
    brdffit_reduce_layout(r, arena, count, 1, &model);
    *values = ARENA_DOUBLES(arena, count);
}

const struct batch_kernels *brdffit_batch_kernels(brdffit_isa isa)
{
    isa = brdffit_isa_resolve(isa);
    switch (isa) {
#ifdef BRDFFIT_HAVE_AVX2
    case BRDFFIT_ISA_AVX2: return &brdffit_batch_kernels_avx2;
#endif
#ifdef BRDFFIT_HAVE_AVX512
    case BRDFFIT_ISA_AVX512: return &brdffit_batch_kernels_avx512;
#endif
    default: return &brdffit_batch_kernels_base;
    }
}
