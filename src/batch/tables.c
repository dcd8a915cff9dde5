/*
 * The making of a plan's tables: which samples count, which range of theta, and how it is cut. See fast.c.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "batch/fast.h"
#include "fit/fit.h"
#include "model/geometry.h"
#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* A window is as wide as its lobe turns by TURN, and in theta no narrower than NARROWEST and no wider than WIDEST. */
#define TURN 0.19
#define NARROWEST 0.3
#define WIDEST 1.0
/*
 * Largest c_min s, but for the scale of b: models with finite y, all that a fit looks at (domain.c), lie below,
 * because LIMIT_EXPONENT - ln(|I| / scale_b) + ln(lambda^2 H) / 2 does for all data that tiles take (tile.c: |I| >=
 * 1e-130, and lambda <= 1e24). What is proven beyond does no harm.
 */
#define MOST_EXPONENT 1100.0
/* Largest relative error of a lobe by its geometry: the bound is lowered by twice that times |I| E, whatever the window. */
#define MOST_DOUBT 1e-8
/* Columns with less beside a than this share of their square: D is lost in rounding. */
#define LEAST_BESIDE 1e-6

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

/* Samples in order of c, their scales. */
static void keep_samples(struct batch_fast *f, const struct reduced *r, const brdffit_samples *geometry,
                         brdffit_distribution distribution)
{
    size_t place;

    f->used = r->used;
    f->channels = geometry->channels;
    f->distinct = r->distinct;
    f->root_a = sqrt(r->aa[0][0]);
    f->scale_a = r->scale_a[0];
    f->scale_w = r->scale_w;
    f->snapped = r->table[0].snapped;
    f->slack = TOL_UNIT * (8.0 * (TOL_MOMENT_BASE + (double)r->used) + 2.0 * TOL_GAIN);
    for (place = 0; place < r->used; place++) {
        uint32_t j = r->order[place];

        f->sample[place] = r->sample[j];
        f->a[place] = r->sample_a[j];
        f->factor[place] = r->sample_factor[j];
        f->radiance[place] = radiance_of(geometry, distribution, r->sample[j]);
    }
    for (place = 0; place <= r->distinct; place++) {
        f->begin[place] = r->begin[place];
    }
}

/* Column j: its b, and the sums and numbers of the groups. An exponential factor is taken off at the column's own least c. */
static void keep_column(struct batch_fast *f, const struct reduced *r, int j)
{
    const struct table *t = &r->table[j];
    struct batch_column *to = &f->column[j];
    double *c = (double *)to->sight.c, *light = (double *)to->sight.light, *view = (double *)to->sight.view;
    double base = f->steep ? t->c_low : 0.0;
    size_t m, place;

    to->scale_b = t->scale_b;
    to->sight.c_min = t->c_min + base;
    to->sight.tan2_most = t->sight.tan2_most;
    for (place = 0; place < f->used; place++) {
        to->b[place] = t->sample_b[r->order[place]];
    }
    for (m = 0; m < PADDED(f->distinct); m++) {
        int lobe = m < f->distinct && t->bb[m] > 0.0;

        c[m] = lobe || (j == 0 && m < f->distinct) ? larger(t->c[m] - base, 0.0) : 0.0;
        to->bb[m] = lobe ? t->bb[m] : 0.0;
        to->ab[m] = lobe && f->root_a > 0.0 ? t->linear[m] / f->root_a : 0.0;
        f->cross[m] = f->each > 1 && lobe ? reduced_cross(r, 0, 1)[m] : 0.0;
        if (light) {
            light[m] = lobe ? t->light[m] : 0.0;
            view[m] = lobe ? t->view[m] : 0.0;
        }
    }
}

/*
 * What the geometry's rounding costs: one number for the whole range. 0 when that is too much, or a sample hides a lobe:
 * then each texel takes the general path, which knows better.
 */
static int charge_domain(struct batch_fast *f, struct reduced *r, const struct model *model, const double theta[3])
{
    int j;

    f->doubt = f->doubt_tail = 0.0;
    for (j = 0; j < model->kinds; j++) {
        const struct charge *c = &r->table[model->geometry[j]].charge;
        const struct kind_charge *k = &r->kind_charge[j];

        if (c->most_hidden > 0.0 || r->table[0].charge.grazing > 1e-12) {
            return 0;
        }
        brdffit_charge_domain(r, model, j, f->kernels, theta, MOST_DOUBT, r->table[0].charge.light);
        if (k->step != 0.0) {
            return 0;
        }
        f->doubt += k->body;
        f->doubt_tail += k->tail;
    }
    f->doubt += r->table[0].charge.diffuse;
    f->doubt_tail += r->table[0].charge.diffuse;
    return f->doubt <= MOST_DOUBT;
}

/* How fast the lobe turns at theta: the spread of its exponents, per unit of theta. The largest of its columns. */
static double turning(const struct batch_fast *f, double theta)
{
    double *phi = f->scratch, *ahead = f->scratch + PADDED(f->distinct), step = 1e-3, most = 0.0;
    size_t m;
    int j;

    for (j = 0; j < f->each; j++) {
        const double *bb = f->column[j].bb;
        double h = 0.0, mean = 0.0, square = 0.0;

        brdffit_batch_shape(f, j, kernel_exp(theta), phi);
        brdffit_batch_shape(f, j, kernel_exp(theta + step), ahead);
        for (m = 0; m < f->distinct; m++) {
            double weight = bb[m] * (phi[m] * phi[m]), x = phi[m] > 0.0 ? (1.0 - ahead[m] / phi[m]) / step : 0.0;

            h += weight;
            mean += weight * x;
            square += weight * (x * x);
        }
        most = h > 0.0 ? fmax(most, square / h - (mean / h) * (mean / h)) : most;
    }
    return sqrt(most);
}

/* Ends of windows over [low, high], their number a multiple of LANES less 1: as wide as they may be, all in proportion. */
static size_t cut_range(const struct batch_fast *f, double low, double high, double *cut)
{
    double stretch = 1.0;
    size_t count, wanted;

    for (;;) {
        double theta = low;

        for (count = 0; theta < high && count <= BATCH_MOST_NODES; count++) {
            cut[count < BATCH_MOST_NODES ? count : BATCH_MOST_NODES] = theta;
            theta += stretch * fmax(NARROWEST, fmin(WIDEST, TURN / fmax(turning(f, theta), 1e-3)));
        }
        if (count < BATCH_MOST_NODES) {
            break;
        }
        stretch *= 1.1;
    }
    for (wanted = PADDED(count + 1) - 1; count < wanted; count++) { /* nodes come in blocks: use them all */
        size_t widest = 0, i;

        for (i = 0; i < count; i++) {
            double width = (i + 1 < count ? cut[i + 1] : high) - cut[i];

            widest = width > (widest + 1 < count ? cut[widest + 1] : high) - cut[widest] ? i : widest;
        }
        for (i = count; i > widest + 1; i--) {
            cut[i] = cut[i - 1];
        }
        cut[widest + 1] = 0.5 * (cut[widest] + (widest + 1 < count ? cut[widest + 2] : high));
    }
    cut[count] = high;
    return count;
}

/* Shapes at a node over their norms beside a, and the cosine of two; 0 when a norm is lost in rounding. */
static int fill_node(struct batch_fast *f, size_t node, double theta)
{
    double *phi[EACH_MOST] = {f->scratch, f->scratch + PADDED(f->distinct)}, d[BATCH_PAIRS], u[EACH_MOST];
    size_t m;
    int j;

    for (j = 0; j < f->each; j++) {
        brdffit_batch_shape(f, j, kernel_exp(theta), phi[j]);
    }
    brdffit_batch_gram(f, (const double *const *)phi, d, u);
    for (j = 0; j < f->each; j++) {
        double square = d[BATCH_PAIR(j, j)], inverse = 1.0 / sqrt(square);

        if (!(square > LEAST_BESIDE * (square + u[j] * u[j]) && isfinite(inverse))) {
            return 0;
        }
        for (m = 0; m < f->distinct; m++) {
            f->column[j].node[(node / LANES * f->distinct + m) * LANES + node % LANES] = phi[j][m] * inverse;
        }
    }
    f->cosine[node] = f->each > 1
                          ? fmax(-1.0, fmin(d[BATCH_PAIR(0, 1)] / sqrt(d[BATCH_PAIR(0, 0)]) / sqrt(d[BATCH_PAIR(1, 1)]),
                                            1.0 - BATCH_APART))
                          : 0.0;
    return 1;
}

/* Nodes and windows over [low, high]; 0 when D is lost in rounding somewhere. */
static int fill_tables(struct batch_fast *f, double low, double high)
{
    double cut[BATCH_MOST_NODES + 1];
    size_t w, node;

    f->windows = cut_range(f, low, high, cut);
    f->nodes = f->windows + 1;
    f->s_low = kernel_exp(low);
    for (node = 0; node < f->nodes; node++) {
        if (!fill_node(f, node, cut[node])) {
            return 0;
        }
    }
    for (w = 0; w < f->windows; w++) {
        f->window[w].center = 0.5 * (cut[w] + cut[w + 1]);
        f->window[w].radius = 0.5 * (cut[w + 1] - cut[w]) * (1.0 + 1e-13); /* covers its ends whatever was rounded */
        if (!brdffit_batch_window(f, w)) {
            return 0;
        }
        brdffit_batch_screen(f, &f->window[w], w);
    }
    return 1;
}

/* theta of the search: where it begins, where it ends, and where the options' range does. 0: there is none. */
static int find_range(struct batch_fast *f, const struct reduced *r, const brdffit_options *o, double theta[3])
{
    int by_exponent = f->kind->by_exponent, j;
    double c_min = r->table[0].c_min, tail = 0.0;

    for (j = 0; j < f->each; j++) {
        tail = fmax(tail, f->kind->tail(&r->table[j].sight, r->table[j].bb, r->distinct));
    }
    theta[0] = brdffit_fit_outwards(by_exponent ? kernel_log(o->exponent_min) : -2.0 * kernel_log(o->sigma_max), -1.0);
    theta[2] = brdffit_fit_outwards(by_exponent ? kernel_log(o->exponent_max) : -2.0 * kernel_log(o->sigma_min), 1.0);
    if (!(tail > 0.0 && isfinite(tail))) {
        return 0;
    }
    theta[1] = fmin(theta[2], kernel_log(tail));
    f->sigma_floor = by_exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min;
    if (f->steep && c_min > 0.0) {
        double most = (MOST_EXPONENT + fmax(0.0, kernel_log(r->table[0].scale_b))) / c_min;

        if (kernel_log(most) < theta[1]) {
            theta[1] = kernel_log(most);
            f->sigma_floor = (1.0 + 1e-13) / sqrt(most);
        }
    }
    return theta[1] > theta[0];
}

/* A reduction of zeros: all of it but what depends on data. */
static int reduce_geometry(struct reduced *r, const brdffit_samples *geometry, const struct model *model,
                           const brdffit_options *o, double *values)
{
    brdffit_samples samples = *geometry;
    size_t i;

    for (i = 0; i < geometry->count; i++) {
        values[i] = 0.0;
    }
    samples.values = values;
    samples.channels = 1;
    return geometry->channels <= BATCH_MOST_CHANNELS && brdffit_reduce(r, &samples, model, o, NULL) == BRDFFIT_OK &&
           r->distinct <= BATCH_MOST_DISTINCT && r->distinct >= 2 && r->used <= BATCH_MOST_SAMPLES;
}

static int any_lobe(const struct table *t, size_t distinct)
{
    size_t m;

    for (m = 0; m < distinct && !(t->bb[m] > 0.0); m++) {
    }
    return m < distinct;
}

int brdffit_batch_fast_start(struct batch_fast *f, const brdffit_samples *geometry, const brdffit_options *o,
                             struct reduced *r, double *values)
{
    struct model model;
    double theta[3];
    int j;

    brdffit_model_make(&model, o);
    if (!reduce_geometry(r, geometry, &model, o, values) || !(r->table[0].bb[0] > 0.0)) {
        return 0;
    }
    f->kind = model.kind[0];
    f->kernels = brdffit_kernels(o->isa);
    f->each = model.each;
    f->steep = f->kind->steep;
    keep_samples(f, r, geometry, brdffit_model_asked(o, 0));
    for (j = 0; j < f->each; j++) {
        if (!any_lobe(&r->table[j], r->distinct)) {
            return 0;
        }
        keep_column(f, r, j);
    }
    f->alike = f->each > 1 && f->column[1].sight.c_min == f->column[0].sight.c_min;
    return find_range(f, r, o, theta) && charge_domain(f, r, &model, theta) && fill_tables(f, theta[0], theta[1]);
}
