/*
 * Nodes and pairs: see moments.h. SPDX-License-Identifier: MIT
 */
#include "data/moments.h"

#include <math.h>
#include <string.h>

#include "base/tolerance.h"

/* Doubles for lobe shapes: all of them where that is reasonable, else those of the first nodes. */
static size_t shape_doubles(size_t stride, uint32_t capacity)
{
    return stride < LIMIT_SHAPE_DOUBLES / capacity ? stride * capacity : LIMIT_SHAPE_DOUBLES;
}

void brdffit_moments_layout(struct moments *m, struct arena *arena, size_t count, size_t channels, uint32_t capacity,
                            int lobes)
{
    size_t stride = PADDED(count);

    m->capacity = capacity;
    capacity += 2; /* and the scratch nodes */
    m->omega = ARENA_DOUBLES(arena, channels);
    m->norm = ARENA_DOUBLES(arena, channels);
    m->node = brdffit_arena_take(arena, capacity, sizeof *m->node);
    m->ready = brdffit_arena_take(arena, capacity, 1);
    m->cache = lobes > 1 ? brdffit_arena_take(arena, PAIR_CACHE, sizeof *m->cache) : NULL;
    m->tau_pool = brdffit_arena_take(arena, capacity, channels * sizeof(double));
    m->functional_pool = brdffit_arena_take(arena, capacity, (1 + 2 * channels) * sizeof(struct functional));
    m->phi_doubles = shape_doubles(stride, capacity);
    m->phi_pool = ARENA_DOUBLES(arena, m->phi_doubles);
    m->scratch = ARENA_DOUBLES(arena, stride > SIZE_MAX / 64 ? SIZE_MAX / 8 : 4 * stride);
}

void brdffit_moments_start(struct moments *m, const struct reduced *data, const struct lobe_kind *kind,
                           const struct kernels *kernels, int lobes)
{
    double root = sqrt(data->aa);
    size_t k;

    m->data = data;
    m->kind = kind;
    m->kernels = kernels;
    m->evaluated = 0;
    m->epsilon = TOL_UNIT * (2.0 * (TOL_MOMENT_BASE + (double)data->stride / LANES));
    m->exponent_epsilon = 4.0 * TOL_UNIT + 2.0 * data->snapped;
    m->slack = (TOL_GAIN * TOL_UNIT + m->epsilon) * data->total;
    for (k = 0; k < data->bounded; k++) {
        double factor = data->bound_root[k], along = data->ai[data->bound_channel[k]];

        m->norm[k] = factor * sqrt(data->ii[data->bound_channel[k]]);
        m->omega[k] = (data->aa > 0.0 ? factor * along / root : 0.0) + m->epsilon * m->norm[k];
    }
    memset(m->ready, 0, m->capacity + 2);
    if (lobes > 1) {
        memset(m->cache, 0xff, PAIR_CACHE * sizeof *m->cache);
    }
}

const double *brdffit_moments_shape(const struct moments *m, const struct node *node, double *scratch)
{
    if (node->phi) {
        return node->phi;
    }
    m->kind->shape(m->kernels, m->data->c, m->data->stride, node->u, scratch);
    return scratch;
}

/* x_j = -ell_j at the node: c' for exponential families, else computed into scratch. */
static const double *slopes(const struct moments *m, double u, double *scratch)
{
    size_t j;
    double slope;

    if (m->kind->exponential) {
        return m->data->c;
    }
    for (j = 0; j < m->data->stride; j++) {
        m->kind->slope(m->data->c[j], u, &scratch[j], &slope);
        scratch[j] = -scratch[j];
    }
    return scratch;
}

/* H, mean and central moments. */
static void own_moments(const struct moments *m, struct node *node, const double *phi, const double *x)
{
    const double *bb = m->data->bb;
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

/* Allowance of the node's sums: the largest mean exponent among them decides (moments.h). */
static double node_epsilon(const struct moments *m, const struct node *node)
{
    double largest = 0.0;
    size_t f;

    for (f = 0; f < m->data->functionals; f++) {
        const struct functional *w = &node->functional[f];

        largest = w->f1 > largest * w->f0 ? w->f1 / w->f0 : largest;
    }
    return m->epsilon + m->exponent_epsilon * (node->u * (node->mean + largest));
}

/* kappa and tau from the functionals, with the rounding allowance on the safe side. */
static void projections(const struct moments *m, struct node *node)
{
    const struct reduced *data = m->data;
    size_t k, K = data->bounded;
    double inverse = node->root > 0.0 ? 1.0 / node->root : 0.0;
    double kappa = data->aa > 0.0 ? node->functional[0].f0 * inverse / sqrt(data->aa) : 0.0;

    node->epsilon = node_epsilon(m, node);
    node->kappa = kappa - node->epsilon;
    for (k = 0; k < K; k++) {
        double v = node->functional[1 + k].f0;

        if (data->functionals > 1 + K) {
            v -= node->functional[1 + K + k].f0;
        }
        node->tau[k] = v * inverse + node->epsilon * m->norm[k];
    }
}

const struct node *brdffit_moments_node(struct moments *m, uint32_t index, double theta)
{
    struct node *node = &m->node[index];
    size_t stride = m->data->stride;
    double u[3];

    if (m->ready[index]) {
        return node;
    }
    m->ready[index] = 1;
    m->evaluated++;
    m->kind->variable(m->data->c_min, theta, u);
    node->u = u[0];
    node->tau = m->tau_pool + index * m->data->channels;
    node->functional = m->functional_pool + index * m->data->functionals;
    node->phi = (index + (size_t)1) * stride <= m->phi_doubles ? m->phi_pool + index * stride : NULL;
    if (node->phi) {
        m->kind->shape(m->kernels, m->data->c, stride, node->u, node->phi);
    }
    {
        const double *phi = brdffit_moments_shape(m, node, m->scratch);
        const double *x = slopes(m, node->u, m->scratch + stride);

        own_moments(m, node, phi, x);
        m->kernels->functionals(m->data->linear, m->data->functionals, phi, x, node->mean, stride, node->functional);
    }
    projections(m, node);
    return node;
}

/* Value, mean and variance of the products of two shapes. */
static void fill_pair(struct moments *m, struct pair *pair)
{
    const struct reduced *data = m->data;
    const struct node *p = &m->node[pair->first], *q = &m->node[pair->second];
    const double *phi = brdffit_moments_shape(m, p, m->scratch);
    const double *psi = brdffit_moments_shape(m, q, m->scratch + data->stride);
    double limit = m->kind->exponential ? PAIR_EXPONENT / (p->u + q->u) : INFINITY, sums[3], exponent;

    m->kernels->pair(data->bb, phi, psi, data->c, limit, data->stride, sums);
    pair->value = sums[0];
    pair->mean = sums[1];
    pair->variance = sums[2];
    pair->mu = 0.0;
    if (!(pair->value > 0.0)) {
        return;
    }
    /* The nodes allow for their own roots, the last term for the exponents of the pair. */
    exponent = m->kind->exponential ? pair->mean * (p->u + q->u) : 4.0;
    pair->mu = pair->value / (p->root * q->root) - fmax(p->epsilon, q->epsilon) - m->exponent_epsilon * exponent;
}

const struct pair *brdffit_moments_pair(struct moments *m, uint32_t first, uint32_t second)
{
    struct pair *pair = &m->cache[(first * 2654435761u ^ second * 40503u) % PAIR_CACHE];

    if (pair->first != first || pair->second != second) {
        pair->first = first;
        pair->second = second;
        fill_pair(m, pair);
    }
    return pair;
}

const struct node *brdffit_moments_scratch(struct moments *m, uint32_t slot, double theta)
{
    m->ready[m->capacity + slot] = 0;
    return brdffit_moments_node(m, m->capacity + slot, theta);
}

struct pair brdffit_moments_scratch_pair(struct moments *m)
{
    struct pair pair = {.first = m->capacity, .second = m->capacity + 1};

    fill_pair(m, &pair);
    return pair;
}
