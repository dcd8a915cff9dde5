/*
 * Nodes and pairs: see moments.h. SPDX-License-Identifier: MIT
 */
#include "data/moments.h"

#include <math.h>
#include <string.h>

#include "base/tolerance.h"
#include "data/slack.h"

size_t brdffit_moments_scratches(const struct model *model)
{
    int i;

    for (i = 0; i < model->kinds && model->kind[i]->exponential; i++) {
    }
    return i < model->kinds ? 6 : 2;
}

static void layout_kind(struct kind_moments *m, struct arena *arena, const struct moments_room *room,
                        const struct model *model)
{
    uint32_t nodes = room->nodes + (uint32_t)model->lobes; /* one a lobe at any theta */
    size_t fixed = (size_t)model->fixed;

    m->node = brdffit_arena_take(arena, nodes, sizeof *m->node);
    marks_layout(&m->ready, arena, nodes);
    m->tau_pool = brdffit_arena_take(arena, nodes, (room->channels + fixed) * sizeof(double));
    m->functional_pool = brdffit_arena_take(arena, nodes, room->functionals * sizeof(struct functional));
    m->phi_doubles = room->stride * moments_kept(m->kind) * room->shaped;
    m->phi_pool = brdffit_arena_take(arena, room->shaped * moments_kept(m->kind), room->stride * sizeof(double));
}

void brdffit_moments_layout(struct moments *m, struct arena *arena, const struct moments_room *room,
                            const struct model *model)
{
    int i;

    m->capacity = room->nodes;
    m->kinds = model->kinds;
    for (i = 0; i < model->fixed; i++) {
        m->omega[i] = ARENA_DOUBLES(arena, room->channels);
    }
    m->norm = ARENA_DOUBLES(arena, room->channels);
    m->cached = room->pairs;
    m->cache = m->cached ? brdffit_arena_take(arena, m->cached, sizeof *m->cache) : NULL;
    for (i = 0; i < model->kinds; i++) {
        m->kind[i].kind = model->kind[i];
        m->kind[i].geometry = model->geometry[i];
        layout_kind(&m->kind[i], arena, room, model);
    }
    m->scratch = brdffit_arena_take(arena, room->stride, brdffit_moments_scratches(model) * sizeof(double));
}

/* Fixed columns against each other and the data. */
static void start_fixed(struct moments *m)
{
    const struct reduced *data = m->data;
    int f, g;
    size_t k;

    for (f = 0; f < data->fixed; f++) {
        double root = sqrt(data->aa[f][f]);

        m->inverse_a[f] = root > 0.0 ? 1.0 / root : 0.0;
        for (k = 0; k < data->bounded; k++) {
            double along = data->ai[(size_t)f * data->channels + data->bound_channel[k]];

            m->omega[f][k] = (root > 0.0 ? data->bound_root[k] * along / root : 0.0) + m->epsilon * m->norm[k];
        }
        for (g = 0; g < f; g++) {
            double cosine = data->aa[f][g] * m->inverse_a[f] * m->inverse_a[g] - m->epsilon;

            m->fixed[f][g] = m->fixed[g][f] = cosine > 0.0 ? cosine : 0.0;
        }
    }
}

void brdffit_moments_start(struct moments *m, const struct reduced *data, const struct model *model,
                           const struct kernels *kernels)
{
    size_t k;
    int i;

    m->data = data;
    m->kernels = kernels;
    m->evaluated = 0;
    m->epsilon = TOL_UNIT * (2.0 * (TOL_MOMENT_BASE + (double)data->stride / LANES));
    m->slack = TOL_GAIN * (model->columns > 3 ? TOL_GAIN_COLUMNS : 1.0) * TOL_UNIT + m->epsilon;
    m->slack = (m->slack + slack_of_channels(data->channels)) * data->total;
    for (k = 0; k < data->bounded; k++) {
        m->norm[k] = data->bound_root[k] * sqrt(data->ii[data->bound_channel[k]]);
    }
    start_fixed(m);
    for (i = 0; i < m->kinds; i++) {
        m->kind[i].kind = model->kind[i];
        m->kind[i].table = &data->table[m->kind[i].geometry];
        marks_start(&m->kind[i].ready);
    }
    if (m->cache) {
        memset(m->cache, 0xff, m->cached * sizeof *m->cache);
    }
}

const double *brdffit_moments_shape(const struct moments *m, int kind, const struct node *node, double *scratch)
{
    const struct kind_moments *own = &m->kind[kind];

    if (node->phi) {
        return node->phi;
    }
    own->kind->shape(m->kernels, &own->table->sight, m->data->stride, node->u, scratch);
    return scratch;
}

const double *brdffit_moments_slopes(const struct moments *m, int kind, const struct node *node, double *scratch,
                                     const double **slope)
{
    const struct kind_moments *own = &m->kind[kind];
    double *x = node->x ? node->x : scratch;

    *slope = NULL;
    if (own->kind->exponential) {
        return own->table->c;
    }
    if (!node->x) {
        own->kind->slopes(m->kernels, &own->table->sight, m->data->stride, node->u, x, x + m->data->stride);
    }
    *slope = x + m->data->stride;
    return x;
}

/* H, mean and central moments. */
static void own_moments(const struct moments *m, const double *bb, struct node *node, const double *phi,
                        const double *x)
{
    size_t n = m->data->stride;
    double first, central[3];

    node->h = m->kernels->weigh(bb, phi, x, n, &first);
    node->root = sqrt(node->h);
    if (!(node->h > 0.0)) {
        node->mean = 0.0;
        node->m2 = node->m3 = node->m4 = 0.0;
        return;
    }
    node->mean = first / node->h;
    m->kernels->central(bb, phi, x, node->mean, n, central);
    node->m2 = central[0] / node->h;
    node->m3 = central[1] / node->h;
    node->m4 = central[2] / node->h;
}

/* Relative error of an exponent, that of merged c included. */
static double exponent_epsilon(const struct table *t)
{
    return 4.0 * TOL_UNIT + 2.0 * t->snapped;
}

/* Allowance of the node's sums: the largest mean exponent among them decides (moments.h). */
static double node_epsilon(const struct moments *m, const struct table *t, const struct node *node)
{
    double largest = 0.0;
    size_t f;

    for (f = 0; f < m->data->functionals; f++) {
        const struct functional *w = &node->functional[f];

        largest = w->f1 > largest * w->f0 ? w->f1 / w->f0 : largest;
    }
    /* x is at least c', which is what counts; masking's own rounding is that of phi, twice. */
    return m->epsilon + (t->masked ? TOL_MASKING * TOL_UNIT : 0.0) +
           exponent_epsilon(t) * (node->u * (node->mean + largest));
}

/* kappa and tau from the functionals, with the rounding allowance on the safe side. */
static void projections(const struct moments *m, const struct table *t, struct node *node)
{
    const struct reduced *data = m->data;
    size_t k, f, K = data->bounded, F = (size_t)data->fixed;
    double inverse = node->root > 0.0 ? 1.0 / node->root : 0.0;

    node->epsilon = node_epsilon(m, t, node);
    for (f = 0; f < F; f++) {
        double kappa = m->inverse_a[f] > 0.0 ? node->functional[f].f0 * inverse / sqrt(data->aa[f][f]) : 0.0;

        node->kappa[f] = kappa - node->epsilon;
    }
    for (k = 0; k < K; k++) {
        double v = node->functional[F + k].f0;

        if (data->functionals > F + K) {
            v -= node->functional[F + K + k].f0;
        }
        node->tau[k] = v * inverse + node->epsilon * m->norm[k];
    }
}

/* Where a node keeps its shapes, and these. */
static void fill_shapes(struct moments *m, struct kind_moments *own, uint32_t index, struct node *node)
{
    size_t stride = m->data->stride, each = stride * moments_kept(own->kind);

    node->phi = (index + (size_t)1) * each <= own->phi_doubles ? own->phi_pool + index * each : NULL;
    node->x = node->phi && !own->kind->exponential ? node->phi + stride : NULL;
    if (node->phi) {
        own->kind->shape(m->kernels, &own->table->sight, stride, node->u, node->phi);
    }
    if (node->x) {
        own->kind->slopes(m->kernels, &own->table->sight, stride, node->u, node->x, node->x + stride);
    }
}

const struct node *brdffit_moments_node(struct moments *m, int kind, uint32_t index, double theta)
{
    struct kind_moments *own = &m->kind[kind];
    struct node *node = &own->node[index];
    size_t stride = m->data->stride;
    const double *phi, *x, *slope;
    double u[3];

    if (index < m->capacity && marks_set(&own->ready, index)) {
        return node;
    }
    m->evaluated++;
    own->kind->variable(&own->table->sight, theta, u);
    node->u = u[0];
    node->tau = own->tau_pool + index * (m->data->channels + (size_t)m->data->fixed);
    node->kappa = node->tau + m->data->channels;
    node->functional = own->functional_pool + index * m->data->functionals;
    fill_shapes(m, own, index, node);
    phi = brdffit_moments_shape(m, kind, node, m->scratch);
    x = brdffit_moments_slopes(m, kind, node, m->scratch + stride, &slope);
    own_moments(m, own->table->bb, node, phi, x);
    m->kernels->functionals(own->table->linear, m->data->functionals, phi, x, node->mean, stride, node->functional);
    projections(m, own->table, node);
    return node;
}

/*
 * What multiplies the relative error of a lobe's exponents in a cosine with a lobe of another kind: by Cauchy-Schwarz at
 * most the root mean square exponent. (1 + x)^-2 moves by 2 of it at most.
 */
static double spread_exponent(const struct kind_moments *own, const struct node *node)
{
    return own->kind->steep ? node->u * sqrt(node->mean * node->mean + node->m2) : 2.0;
}

/* Value, mean and variance of the products of two shapes. */
void brdffit_moments_fill_pair(struct moments *m, const struct couple *at, struct pair *pair)
{
    const struct reduced *data = m->data;
    const struct kind_moments *one = &m->kind[at->kind[0]], *two = &m->kind[at->kind[1]];
    const struct node *p = &one->node[at->node[0]], *q = &two->node[at->node[1]];
    const double *phi = brdffit_moments_shape(m, at->kind[0], p, m->scratch);
    const double *psi = brdffit_moments_shape(m, at->kind[1], q, m->scratch + data->stride);
    const double *w = reduced_cross(data, one->geometry, two->geometry);
    int exponential = moments_one_family(m, at->kind[0], at->kind[1]);
    double limit = exponential ? PAIR_EXPONENT / (p->u + q->u) : INFINITY, sums[3], exponent, error;

    pair->kinds = (uint32_t)(at->kind[0] + KINDS_MOST * at->kind[1]);
    pair->first = at->node[0];
    pair->second = at->node[1];
    m->kernels->pair(w, phi, psi, one->table->c, limit, data->stride, sums);
    pair->value = sums[0];
    pair->mean = sums[1];
    pair->variance = sums[2];
    pair->mu = 0.0;
    if (!(pair->value > 0.0)) {
        return;
    }
    /* The nodes allow for their own roots, the last term for the exponents of the pair. */
    exponent = exponential ? pair->mean * (p->u + q->u) : spread_exponent(one, p) + spread_exponent(two, q);
    error = fmax(exponent_epsilon(one->table), exponent_epsilon(two->table));
    pair->mu = pair->value / (p->root * q->root) - fmax(p->epsilon, q->epsilon) - error * exponent;
}

const struct node *brdffit_moments_scratch(struct moments *m, int kind, uint32_t slot, double theta)
{
    return brdffit_moments_node(m, kind, m->capacity + slot, theta);
}

struct pair brdffit_moments_scratch_pair(struct moments *m, int kind, uint32_t first, uint32_t second)
{
    const struct couple at = {{kind, kind}, {m->capacity + first, m->capacity + second}};
    struct pair pair;

    brdffit_moments_fill_pair(m, &at, &pair);
    return pair;
}

void brdffit_moments_forget(struct moments *m, int kind, uint32_t index)
{
    size_t i;

    marks_clear(&m->kind[kind].ready, index);
    for (i = 0; i < m->cached; i++) {
        if (m->cache[i].first == index || m->cache[i].second == index) {
            m->cache[i].kinds = UINT32_MAX;
        }
    }
}
