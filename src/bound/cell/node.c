/*
 * Corners of cells: see cell.h. SPDX-License-Identifier: MIT
 *
 * Rounding. Sums of positive terms over the groups are within moments.epsilon of exact ones, relative. An exponent E = sum c_d s_d
 * is off by 4 u E, and exp(-E) by as much, (1 + E)^-2 by 8 u: by Cauchy and Schwarz a sum I.g over the unit column is off by
 * 4 u sqrt(E_p[E^2]) of |I|, E_p under p = bb phi^2 / H, and half of that again by the norm.
 */
#include "bound/cell/cell.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* Doubles that the nodes' shapes may take, and how many nodes there are at least: those of one box, and its children's. */
#define SHAPE_DOUBLES ((size_t)1 << 21)
#define NODES_LEAST 32u
#define NODES_MOST 4096u
#define CELLS_MOST 512u

static size_t node_count(size_t stride)
{
    size_t fit = SHAPE_DOUBLES / (2 * stride);

    return fit < NODES_LEAST ? NODES_LEAST : fit > NODES_MOST ? NODES_MOST : fit;
}

static void layout_node(struct cell_node *node, struct arena *arena, size_t stride, size_t channels, size_t fixed,
                        int each, int counting)
{
    double *tau[EACH_MOST] = {NULL}, *kappa[EACH_MOST] = {NULL}, *sum[EACH_MOST] = {NULL}, *phi, *exponent;
    int j;

    for (j = 0; j < each; j++) {
        tau[j] = ARENA_DOUBLES(arena, channels);
        kappa[j] = ARENA_DOUBLES(arena, fixed);
        sum[j] = ARENA_DOUBLES(arena, fixed + 2 * channels);
    }
    phi = ARENA_DOUBLES(arena, stride);
    exponent = ARENA_DOUBLES(arena, stride);
    for (j = 0; j < each && !counting; j++) {
        node->tau[j] = tau[j];
        node->kappa[j] = kappa[j];
        node->sum[j] = sum[j];
    }
    if (!counting) {
        node->phi = phi;
        node->exponent = exponent;
    }
}

static void layout_cell(struct cell *cell, struct arena *arena, size_t stride, size_t channels, size_t fixed, int each,
                        int counting)
{
    double *sup_phi = ARENA_DOUBLES(arena, stride), *inf_phi = ARENA_DOUBLES(arena, stride);
    int j, d;

    if (!counting) {
        cell->sup = sup_phi;
        cell->inf = inf_phi;
    }
    for (j = 0; j < each; j++) {
        double *sup = ARENA_DOUBLES(arena, channels), *inf = ARENA_DOUBLES(arena, fixed);
        double *shift = ARENA_DOUBLES(arena, SHAPES_MOST * fixed), *tau[SHAPES_MOST];

        for (d = 0; d < SHAPES_MOST; d++) {
            tau[d] = ARENA_DOUBLES(arena, channels);
        }
        for (d = 0; d < SHAPES_MOST && !counting; d++) {
            cell->tau_shift[j][d] = tau[d];
        }
        if (!counting) {
            cell->tau_sup[j] = sup;
            cell->kappa_inf[j] = inf;
            cell->kappa_shift[j] = shift;
        }
    }
}

void brdffit_bound_cell_layout(struct bound_cell *e, struct arena *arena, size_t count, size_t channels,
                               const struct model *model)
{
    size_t stride = PADDED(count), i, fixed = (size_t)model->fixed, n = (size_t)model->columns;
    int counting = arena->base == NULL, p, j;
    /* Of the moments only what does not move is used. */
    const struct moments_room room = {
        .nodes = 1, .stride = stride, .channels = channels, .functionals = reduced_functionals(model, channels)};

    brdffit_moments_layout(&e->moments, arena, &room, model);
    e->nodes = node_count(stride);
    e->cells = e->nodes < CELLS_MOST ? e->nodes : CELLS_MOST;
    e->node = brdffit_arena_take(arena, e->nodes, sizeof *e->node);
    e->cell = brdffit_arena_take(arena, e->cells, sizeof *e->cell);
    counting = counting || !e->node || !e->cell;
    for (i = 0; i < e->nodes; i++) {
        layout_node(counting ? NULL : &e->node[i], arena, stride, channels, fixed, model->each, counting);
    }
    for (i = 0; i < e->cells; i++) {
        layout_cell(counting ? NULL : &e->cell[i], arena, stride, channels, fixed, model->each, counting);
    }
    for (p = 0; p < model->lobes; p++) {
        for (j = 0; j < model->each; j++) {
            e->lobe[p].weighted[j] = ARENA_DOUBLES(arena, stride);
        }
    }
    e->range = brdffit_arena_take(arena, reduced_functionals(model, channels), 2 * EACH_MOST * sizeof(double));
    e->scratch = ARENA_DOUBLES(arena, 8 * stride);
    e->list = brdffit_arena_take(arena, GAINS(SIDES_MOST), (COSINES(n) + n * channels) * sizeof(double));
    e->gain = ARENA_DOUBLES(arena, GAINS(SIDES_MOST));
}

void brdffit_bound_cell_forget(struct bound_cell *e)
{
    size_t i;

    for (i = 0; i < e->nodes; i++) {
        e->node[i].lobe = -1;
        e->node[i].used = 0;
    }
    for (i = 0; i < e->cells; i++) {
        e->cell[i].lobe = -1;
        e->cell[i].used = 0;
    }
}

static void open_lobe(struct bound_cell *e, int p)
{
    const struct reduced *data = e->moments.data;
    struct cell_lobe *lobe = &e->lobe[p];
    size_t i;
    int j;

    lobe->kind = model_kind(e->model, p);
    lobe->shapes = model_shapes(e->model, p);
    lobe->side = e->model->lobe[p].side;
    lobe->turned = lobe->shapes > 1;
    for (j = 0; j < e->model->each; j++) {
        const struct table *t = &data->table[e->model->geometry[model_kind_of(e->model, p * e->model->each + j)]];

        lobe->table[j] = t;
        for (i = 0; i < data->stride; i++) {
            double error = i < data->distinct ? t->charge.gamma[i] : 0.0;

            lobe->weighted[j][i] = t->bb[i] * (error * error);
        }
    }
    lobe->c[0] = lobe->turned ? lobe->table[0]->light : lobe->table[0]->c;
    lobe->c[1] = lobe->turned ? lobe->table[0]->view : NULL;
}

void brdffit_bound_cell_start(struct bound_cell *e, const struct reduced *data, const struct model *model,
                              const struct kernels *kernels, struct axis *axis)
{
    int p;

    e->model = model;
    e->axis = axis;
    e->box = 0;
    e->evaluated = 0;
    brdffit_moments_start(&e->moments, data, model, kernels);
    for (p = 0; p < model->lobes; p++) {
        open_lobe(e, p);
    }
    brdffit_bound_cell_forget(e);
}

static void fill_shape(const struct bound_cell *e, const struct cell_lobe *lobe, struct cell_node *node)
{
    size_t n = e->moments.data->stride, j;

    if (lobe->turned) {
        brdffit_turned_shape(e->moments.kernels, lobe->kind, &lobe->table[0]->sight, n, node->s, node->exponent,
                             node->phi);
        return;
    }
    for (j = 0; j < n; j++) {
        node->exponent[j] = lobe->c[0][j] * node->s[0];
    }
    lobe->kind->shape(e->moments.kernels, &lobe->table[0]->sight, n, node->s[0], node->phi);
}

const double *brdffit_cell_slopes(const struct bound_cell *e, int p, const struct cell_node *node, int d, double *x,
                                  const double **slope)
{
    const struct cell_lobe *lobe = &e->lobe[p];
    size_t n = e->moments.data->stride, j;

    *slope = NULL;
    if (lobe->kind->exponential) {
        return lobe->c[d];
    }
    *slope = x + n;
    for (j = 0; j < n; j++) {
        double at = 2.0 * lobe->c[d][j] / (1.0 + node->exponent[j]);

        x[j] = at;
        x[n + j] = 0.5 * (at * at);
    }
    return x;
}

/* H and means of column j of the lobe, and what its sums may be off by. */
static void own_moments(struct bound_cell *e, int p, int j, struct cell_node *node)
{
    const struct moments *m = &e->moments;
    const struct cell_lobe *lobe = &e->lobe[p];
    const double *bb = lobe->table[j]->bb, *slope;
    size_t n = m->data->stride;
    double square[3] = {0.0};
    int d;

    for (d = 0; d < lobe->shapes; d++) {
        const double *x = brdffit_cell_slopes(e, p, node, d, e->scratch, &slope);
        double first;

        node->h[j] = m->kernels->weigh(bb, node->phi, x, n, &first);
        node->mean[j][d] = node->h[j] > 0.0 ? first / node->h[j] : 0.0;
    }
    node->root[j] = sqrt(node->h[j]);
    m->kernels->central(bb, node->phi, node->exponent, 0.0, n, square);
    node->epsilon[j] = m->epsilon + 16.0 * TOL_UNIT;
    if (lobe->kind->exponential && node->h[j] > 0.0) {
        node->epsilon[j] += 8.0 * TOL_UNIT * sqrt(square[0] / node->h[j]);
    }
}

/* Data and fixed columns along column j, with the rounding allowance on the safe side. */
static void projections(struct bound_cell *e, int p, int j, struct cell_node *node)
{
    const struct moments *m = &e->moments;
    const struct reduced *data = m->data;
    const double *linear = e->lobe[p].table[j]->linear;
    size_t f, k, K = data->bounded, F = (size_t)data->fixed;
    double inverse = node->root[j] > 0.0 ? 1.0 / node->root[j] : 0.0;

    for (f = 0; f < data->functionals; f++) {
        node->sum[j][f] = m->kernels->dot(linear + f * data->stride, node->phi, data->stride);
    }
    for (f = 0; f < F; f++) {
        node->kappa[j][f] = node->sum[j][f] * inverse * m->inverse_a[f] - node->epsilon[j];
    }
    for (k = 0; k < K; k++) {
        double value = node->sum[j][F + k];

        if (data->functionals > F + K) {
            value -= node->sum[j][F + K + k];
        }
        node->tau[j][k] = value * inverse + node->epsilon[j] * m->norm[k];
    }
}

static void fill_node(struct bound_cell *e, int p, struct cell_node *node)
{
    const struct cell_lobe *lobe = &e->lobe[p];
    int d, j;

    e->evaluated++;
    for (d = 0; d < lobe->shapes; d++) {
        node->s[d] = kernel_exp(e->axis[lobe->side + d].coordinate[node->at[d]]);
    }
    if (!lobe->turned) {
        node->s[0] = lobe->kind->argument(&lobe->table[0]->sight, node->s[0]);
    }
    fill_shape(e, lobe, node);
    for (j = 0; j < e->model->each; j++) {
        own_moments(e, p, j, node);
        projections(e, p, j, node);
    }
    if (e->model->each > 1) {
        node->beside = brdffit_cell_cosine(e, node, 0, node, 1);
    }
}

double brdffit_cell_cosine(struct bound_cell *e, const struct cell_node *one, int c, const struct cell_node *two, int d)
{
    const struct reduced *data = e->moments.data;
    const struct model *model = e->model;
    int g = model->geometry[model_kind_of(model, one->lobe * model->each + c)];
    int h = model->geometry[model_kind_of(model, two->lobe * model->each + d)];
    const double *w = reduced_cross(data, g, h);
    double norms = one->root[c] * two->root[d], sums[3];

    if (!(norms > 0.0)) {
        return 0.0;
    }
    e->moments.kernels->pair(w, one->phi, two->phi, e->lobe[one->lobe].c[0], INFINITY, data->stride, sums);
    return sums[0] / norms - (one->epsilon[c] + two->epsilon[d]);
}

static size_t place_of(int lobe, const uint32_t *at, int count, size_t places)
{
    uint32_t hash = (uint32_t)lobe * 2246822519u + at[0] * 2654435761u + (count > 1 ? at[1] * 3266489917u : 0u);

    return (hash ^ hash >> 15) % places;
}

static int is_at(const struct cell_node *node, int lobe, const uint32_t *at, int shapes)
{
    return node->lobe == lobe && node->at[0] == at[0] && (shapes < 2 || node->at[1] == at[1]);
}

const struct cell_node *brdffit_cell_node(struct bound_cell *e, int p, const uint32_t *at)
{
    int shapes = e->lobe[p].shapes, d;
    size_t place = place_of(p, at, shapes, e->nodes), tries;
    struct cell_node *node = &e->node[place];

    /* The first place that this box does not need; there are more of them than a box has nodes. */
    for (tries = 0; tries < e->nodes && node->used == e->box && !is_at(node, p, at, shapes); tries++) {
        place = place + 1 < e->nodes ? place + 1 : 0;
        node = &e->node[place];
    }
    node->used = e->box;
    if (!is_at(node, p, at, shapes)) {
        node->lobe = p;
        for (d = 0; d < shapes; d++) {
            node->at[d] = at[d];
        }
        fill_node(e, p, node);
    }
    return node;
}

const struct cell_node *brdffit_cell_corner(struct bound_cell *e, int p, const uint32_t *interval, unsigned corner)
{
    uint32_t at[SHAPES_MOST] = {0};
    int d;

    for (d = 0; d < e->lobe[p].shapes; d++) {
        const struct axis_interval *i = &e->axis[e->lobe[p].side + d].interval[interval[d]];

        at[d] = corner >> d & 1u ? i->high : i->low;
    }
    return brdffit_cell_node(e, p, at);
}
