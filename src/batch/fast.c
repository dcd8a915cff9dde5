/*
 * What a plan holds for one lobe of an exponential family. SPDX-License-Identifier: MIT
 *
 * Let I be a channel's weighted data, a and b the weighted columns, omega = I.a / |a|, and r = I - omega a / |a|
 * what the diffuse term leaves. For s = 1 / sigma^2 and phi_m = exp(-c_m s), m over distinct c,
 *
 *     n_k(s) = sum_m r_km phi_m        r_km: sum of r b over the samples of c_m, known once per texel
 *     u(s)   = sum_m ab_m phi_m / |a|, H(s) = sum_m bb_m phi_m^2, D(s) = H - u^2 = |b phi - u a / |a||^2
 *
 * What channel k gains beyond omega^2 when x_k may have any sign is n_k^2 / D for n_k > 0, else 0. For any
 * lambda >= 0, 2 omega x + 2 lambda x replaces 2 omega x without lowering the maximum over x >= 0, so
 *
 *     J_k <= (omega + lambda)^2 + max(0, n_k - lambda u)^2 / D
 *
 * with equality at one s for lambda = max(0, max(0, u V / H) - omega), V = n_k + omega u. So "no s of an interval
 * gains more than Gamma" is   sum_k max(0, n_k - lambda_k u)^2 - (Gamma - sum lambda (2 omega + lambda)) D <= 0:
 * n, u and D are sums of exponentials and smooth, D and u are the plan's, n is linear in the data.
 *
 * The range of theta = ln s is cut into windows: window.c. The bound on a piece of one: lanes_bound.h.
 */
#include "batch/fast.h"

#include <math.h>

#include "fit/fit.h"
#include "model/geometry.h"
#include "base/isa.h"
#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"

/* Tables grow with these; beyond, the general path is the better one. */
#define MOST_DISTINCT 512u
#define MOST_SAMPLES 8192u
#define MOST_CHANNELS 32u
#define MOST_NODES 64u
/* Width of a window in theta: the error of its polynomials, about 1e-8 |I|, falls with its 8th power. */
#define WINDOW 0.375
/*
 * Largest c_min s, but for the scale of b: models with finite y, all that a fit looks at (domain.c), lie below,
 * because LIMIT_EXPONENT - ln(|I| / scale_b) + ln(lambda^2 H) / 2 does for all data that tiles take (tile.c: |I| >=
 * 1e-130, and lambda <= 1e24). What is proven beyond does no harm.
 */
#define MOST_EXPONENT 1100.0
/* Largest relative error of a lobe by its geometry: the bound is lowered by twice that times |I| E, whatever the window. */
#define MOST_DOUBT 1e-8

int brdffit_batch_fast_possible(const brdffit_options *o)
{
    struct model model;

    brdffit_model_make(&model, o);
    return o->norm == BRDFFIT_NORM_L2 && o->engine == BRDFFIT_ENGINE_MOMENT && model_exponential(&model) &&
           !brdffit_options_special(o) && !o->physical && o->sigma_resolution == 0.0 && o->box_budget >= 1000;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

void brdffit_batch_fast_layout(struct batch_fast *f, struct arena *arena, size_t count)
{
    size_t m = PADDED(least(count, MOST_DISTINCT)), nodes = MOST_NODES;

    f->sample = brdffit_arena_take(arena, count, sizeof *f->sample);
    f->begin = brdffit_arena_take(arena, m + 1, sizeof *f->begin);
    f->a = ARENA_DOUBLES(arena, count);
    f->b = ARENA_DOUBLES(arena, count);
    f->factor = ARENA_DOUBLES(arena, count);
    f->radiance = ARENA_DOUBLES(arena, count);
    f->c = ARENA_DOUBLES(arena, m);
    f->bb = ARENA_DOUBLES(arena, m);
    f->ab = ARENA_DOUBLES(arena, m);
    f->phi = ARENA_DOUBLES(arena, nodes * m);
    f->inverse_d = ARENA_DOUBLES(arena, nodes);
    f->shape[0] = ARENA_DOUBLES(arena, MOST_NODES * m * BATCH_TERMS);
    f->shape[1] = ARENA_DOUBLES(arena, MOST_NODES * m * BATCH_STRIDE_MORE);
    f->window = brdffit_arena_take(arena, MOST_NODES, sizeof *f->window);
}

void brdffit_batch_tile_layout(struct batch_tile *t, struct arena *arena, size_t count, size_t channels)
{
    size_t m = PADDED(least(count, MOST_DISTINCT)), nodes = MOST_NODES;
    size_t n = least(count, MOST_SAMPLES), K = least(channels, MOST_CHANNELS);

    t->value = ARENA_DOUBLES(arena, n * K * LANES);
    t->sum = ARENA_DOUBLES(arena, K * m * LANES);
    t->gain = ARENA_DOUBLES(arena, nodes * LANES);
    t->scale = ARENA_DOUBLES(arena, K * LANES);
    t->omega = ARENA_DOUBLES(arena, K * LANES);
    t->ii = ARENA_DOUBLES(arena, K * LANES);
    t->x = ARENA_DOUBLES(arena, K * LANES);
    t->y = ARENA_DOUBLES(arena, K * LANES);
    t->n = ARENA_DOUBLES(arena, K * BATCH_TERMS * LANES);
    t->work = ARENA_DOUBLES(arena, K * (BATCH_STRIDE_MORE + 4));
    t->phi = ARENA_DOUBLES(arena, m * LANES);
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

/* What turns a value of sample i, which counts, into radiance. */
static double radiance_of(const brdffit_samples *geometry, brdffit_distribution distribution, size_t i)
{
    struct geometry g = {.cos_light = 1.0};
    brdffit_status status;

    if (geometry->quantity == BRDFFIT_QUANTITY_RADIANCE) {
        return 1.0;
    }
    (void)brdffit_geometry_sample(geometry, distribution, 0.0, i, &g, &status, NULL);
    return g.cos_light;
}

/* Samples in order of c, their sums, scales. */
static void keep_samples(struct batch_fast *f, const struct reduced *r, const brdffit_samples *geometry,
                         brdffit_distribution distribution)
{
    const struct table *t = &r->table[0];
    size_t place, m = 0;

    f->used = r->used;
    f->channels = geometry->channels;
    f->distinct = r->distinct;
    f->root_a = sqrt(r->aa[0][0]);
    f->c_min = t->c_min;
    f->scale_a = r->scale_a[0];
    f->scale_b = t->scale_b;
    f->scale_w = r->scale_w;
    f->slack = TOL_UNIT * (8.0 * (TOL_MOMENT_BASE + (double)r->used) + 2.0 * TOL_GAIN);
    for (place = 0; place < r->used; place++) {
        uint32_t j = r->order[place];

        while (m < r->distinct && t->sample_c[j] - t->c_min > t->c[m]) {
            f->begin[++m] = (uint32_t)place;
        }
        f->sample[place] = r->sample[j];
        f->a[place] = r->sample_a[j];
        f->b[place] = t->sample_b[j];
        f->factor[place] = r->sample_factor[j];
        f->radiance[place] = radiance_of(geometry, distribution, r->sample[j]);
    }
    f->begin[0] = 0;
    while (m < r->distinct) {
        f->begin[++m] = (uint32_t)place;
    }
    for (m = 0; m < PADDED(f->distinct); m++) {
        f->c[m] = t->c[m];
        f->bb[m] = t->bb[m];
        f->ab[m] = f->root_a > 0.0 ? t->linear[m] / f->root_a : 0.0;
    }
}

/*
 * What the geometry's rounding costs: one number for the whole range. 0 when that is too much, or a sample hides a lobe:
 * then each texel takes the general path, which knows better.
 */
static int charge_domain(struct batch_fast *f, struct reduced *r, const struct model *model, const double theta[3],
                         const brdffit_options *o)
{
    const struct charge *c = &r->table[0].charge;
    const struct kind_charge *k = &r->kind_charge[0];

    if (c->most_hidden > 0.0 || c->grazing > 1e-12) {
        return 0;
    }
    brdffit_charge_domain(r, model, 0, brdffit_kernels(o->isa), theta, MOST_DOUBT, c->light);
    f->doubt = c->diffuse + k->body;
    f->doubt_tail = c->diffuse + k->tail;
    return k->step == 0.0 && f->doubt <= MOST_DOUBT;
}

/* Nodes and windows over [theta_low, theta_high]; 0 when D is lost in rounding somewhere. */
static int fill_tables(struct batch_fast *f, double theta_low, double theta_high, double snapped)
{
    double d_before = 0.0, s_before = 0.0;
    size_t w, m, node;

    for (node = 0; node <= f->windows; node++) {
        double s = kernel_exp(node == f->windows
                                  ? theta_high
                                  : theta_low + (theta_high - theta_low) * ((double)node / (double)f->windows));
        double u, d = brdffit_batch_d(f, s, &u);

        if (!(d > 1e-6 * (d + u * u))) {
            return 0;
        }
        f->inverse_d[node] = 1.0 / d;
        for (m = 0; m < f->distinct; m++) {
            f->phi[(node / LANES * f->distinct + m) * LANES + node % LANES] = kernel_exp(-f->c[m] * s);
        }
        if (node > 0) {
            w = node - 1;
            f->window[w].center = 0.5 * (s_before + s);
            f->window[w].radius = 0.5 * (s - s_before) * (1.0 + 1e-15); /* covers its ends whatever was rounded */
            brdffit_batch_window(f, w, d_before, d, snapped);
        } else {
            f->s_low = s;
        }
        d_before = d;
        s_before = s;
    }
    return 1;
}

int brdffit_batch_fast_start(struct batch_fast *f, const brdffit_samples *geometry, const brdffit_options *o,
                             struct reduced *r, double *values)
{
    const struct lobe_kind *kind = brdffit_lobe_kind_of(brdffit_model_asked(o, 0));
    const struct table *table = &r->table[0];
    brdffit_samples samples = *geometry;
    struct model model;
    double theta_low, theta_high, theta_end, tail;
    size_t i;

    for (i = 0; i < geometry->count; i++) {
        values[i] = 0.0;
    }
    brdffit_model_make(&model, o);
    samples.values = values;
    samples.channels = 1;
    if (geometry->channels > MOST_CHANNELS || brdffit_reduce(r, &samples, &model, o, NULL) != BRDFFIT_OK ||
        r->distinct > MOST_DISTINCT || r->distinct < 2 || r->used > MOST_SAMPLES || !(table->bb[0] > 0.0)) {
        return 0;
    }
    theta_low = brdffit_fit_outwards(kind->by_exponent ? kernel_log(o->exponent_min) : -2.0 * kernel_log(o->sigma_max),
                                     -1.0);
    theta_high = brdffit_fit_outwards(kind->by_exponent ? kernel_log(o->exponent_max) : -2.0 * kernel_log(o->sigma_min),
                                      1.0);
    tail = kind->tail(&table->sight, table->bb, r->distinct);
    if (!(tail > 0.0 && isfinite(tail))) {
        return 0;
    }
    theta_end = theta_high;
    theta_high = fmin(theta_high, kernel_log(tail));
    f->sigma_floor = kind->by_exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min;
    if (table->c_min > 0.0) {
        double most = (MOST_EXPONENT + fmax(0.0, kernel_log(table->scale_b))) / table->c_min;

        if (kernel_log(most) < theta_high) {
            theta_high = kernel_log(most);
            f->sigma_floor = (1.0 + 1e-13) / sqrt(most);
        }
    }
    if (!(theta_high > theta_low)) {
        return 0;
    }
    f->kind = kind;
    if (!charge_domain(f, r, &model, (const double[3]){theta_low, theta_high, theta_end}, o)) {
        return 0;
    }
    f->nodes = PADDED((size_t)fmin(ceil((theta_high - theta_low) / WINDOW), (double)(MOST_NODES - 1)) + 1);
    f->windows = f->nodes - 1; /* nodes come in blocks: use them all */
    keep_samples(f, r, geometry, brdffit_model_asked(o, 0));
    return fill_tables(f, theta_low, theta_high, table->snapped);
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
