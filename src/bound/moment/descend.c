/*
 * Descent in moment space: see descend.h. SPDX-License-Identifier: MIT
 *
 * With t, M of theory 2 and z the optimum on its support S, J = sum_k 2 t.z_k - z_k'M z_k has for lobe p and s = s_p
 *
 *     J_p  = sum_k 2 z_p r_p,                r = t_p' - kappa_p' z_0 - sum_q mu_pq' z_q     (primes: by s_p)
 *     J_pp = sum_k 2 z_p (t_p'' - kappa_p'' z_0 - mu_pp z_q)  +  2 v_p' (M_S)^-1 v_p
 *     J_pq = sum_k - 2 z_p z_q mu_pq                          +  2 v_p' (M_S)^-1 v_q
 *
 * where v_p is the derivative of t - M z with z held: -kappa_p' z_p at 0, r_p at p, -mu_p' z_p at q. The derivatives of
 * tau, kappa and mu come from the sums about a lobe's mean (theory 4.2): with x = c - mean
 *
 *     tau' = - sum I x g^,   tau'' = sum I x^2 g^ - 2 m2 tau,   mu_p' = - mu d_p,   d_p = mean(pair) - mean(p),
 *     mu_pp = mu (var + d_p^2 - 2 m2),   mu_pq = mu (var + d_p d_q).
 *
 * Finally d/dtheta = s d/ds.
 */
#include "bound/moment/descend.h"

#include <math.h>

#include "solve/newton.h"
#include "solve/nnls.h"

struct descender {
    struct moments *moments;
    const struct model *model;
};

/* Value, first and second derivative by s. */
struct jet {
    double value, first, second;
};

/* mu of lobes p and q as lobe p sees it: derivatives by s_p, and the mixed one. */
struct cross {
    double value, first, second, mixed;
};

/* A point: everything that does not depend on the channel. */
struct spot {
    const struct node *node[SIDES_MOST];
    struct jet kappa[SIDES_MOST];
    struct cross mu[SIDES_MOST][SIDES_MOST]; /* [p][q], q != p */
    struct nnls nnls;
};

static struct jet jet_of(const struct node *node, const struct functional *f, double scale)
{
    double value = f->f0 * scale;
    struct jet jet = {value, -f->f1 * scale, f->f2 * scale - 2.0 * node->m2 * value};

    return jet;
}

static double inverse_root(const struct node *node)
{
    return node->root > 0.0 ? 1.0 / node->root : 0.0;
}

static struct jet tau_of(const struct moments *m, const struct node *node, size_t k)
{
    size_t K = m->data->bounded;
    struct jet jet = jet_of(node, &node->functional[1 + k], inverse_root(node));

    if (m->data->functionals > 1 + K) {
        struct jet minus = jet_of(node, &node->functional[1 + K + k], inverse_root(node));

        jet.value -= minus.value;
        jet.first -= minus.first;
        jet.second -= minus.second;
    }
    return jet;
}

static void open_pair(struct moments *m, struct spot *s, int p, int q)
{
    struct pair pair = brdffit_moments_scratch_pair(m, 0, (uint32_t)p, (uint32_t)q);
    double mu = pair.value * inverse_root(s->node[p]) * inverse_root(s->node[q]);
    double dp = pair.mean - s->node[p]->mean, dq = pair.mean - s->node[q]->mean;

    s->mu[p][q].value = s->mu[q][p].value = mu;
    s->mu[p][q].first = -mu * dp;
    s->mu[q][p].first = -mu * dq;
    s->mu[p][q].second = mu * (pair.variance + dp * dp - 2.0 * s->node[p]->m2);
    s->mu[q][p].second = mu * (pair.variance + dq * dq - 2.0 * s->node[q]->m2);
    s->mu[p][q].mixed = s->mu[q][p].mixed = mu * (pair.variance + dp * dq);
}

static void open_spot(struct moments *m, int lobes, const struct point *at, struct spot *s)
{
    double inverse_a = m->inverse_a[0], cosine[NNLS_COLUMNS][NNLS_COLUMNS];
    int p, q;

    for (p = 0; p < lobes; p++) {
        s->node[p] = brdffit_moments_scratch(m, 0, (uint32_t)p, at->theta[p]);
    }
    for (p = 0; p < lobes; p++) {
        s->kappa[p] = jet_of(s->node[p], &s->node[p]->functional[0], inverse_root(s->node[p]) * inverse_a);
        cosine[0][1 + p] = s->kappa[p].value;
        for (q = 0; q < p; q++) {
            open_pair(m, s, q, p);
            cosine[1 + q][1 + p] = s->mu[q][p].value;
        }
    }
    brdffit_nnls_factor_gram(&s->nnls, 1 + lobes, cosine);
}

/* Gradient and own second derivatives of a channel with coefficients z; w[p] = U'^-1 v_p on its support. */
static void add_slopes(const struct spot *s, int lobes, const struct nnls_support *on, const struct jet *tau,
                       const double *z, double w[SIDES_MOST][NNLS_COLUMNS], struct varpro_value *j)
{
    int p, q;

    for (p = 0; p < lobes; p++) {
        double v[NNLS_COLUMNS], curved = tau[p].second - s->kappa[p].second * z[0];

        v[0] = -s->kappa[p].first * z[1 + p];
        v[1 + p] = tau[p].first - s->kappa[p].first * z[0];
        for (q = 0; q < lobes; q++) {
            if (q != p) {
                v[1 + q] = -s->mu[p][q].first * z[1 + p];
                v[1 + p] -= s->mu[p][q].first * z[1 + q];
                curved -= s->mu[p][q].second * z[1 + q];
            }
        }
        nnls_transposed_solve(on, v, w[p]);
        j->gradient[p] += 2.0 * z[1 + p] * v[1 + p];
        if (z[1 + p] > 0.0) {
            j->hessian[p][p] += 2.0 * z[1 + p] * curved;
        }
    }
}

/* Add a channel to the value, the gradient and the Hessian of J by s. */
static void add_channel(const struct descender *d, const struct spot *s, size_t k, struct varpro_value *j)
{
    const struct moments *m = d->moments;
    double t[NNLS_COLUMNS], z[NNLS_COLUMNS], w[SIDES_MOST][NNLS_COLUMNS];
    struct jet tau[SIDES_MOST];
    const struct nnls_support *on;
    struct nnls_support room;
    int lobes = d->model->lobes, p, q, i;

    t[0] = m->data->bound_root[k] * m->data->ai[m->data->bound_channel[k]] * m->inverse_a[0];
    for (p = 0; p < lobes; p++) {
        tau[p] = tau_of(m, s->node[p], k);
        t[1 + p] = tau[p].value;
    }
    on = brdffit_nnls_factored(&s->nnls, brdffit_nnls_support(&s->nnls, t, z), &room);
    for (i = 0; i <= lobes; i++) {
        j->objective += z[i] * t[i]; /* stationary: 2 t.z - z'Mz = t.z */
    }
    add_slopes(s, lobes, on, tau, z, w, j);
    for (p = 0; p < lobes; p++) {
        for (q = 0; q < lobes; q++) {
            if (!(z[1 + p] > 0.0 && z[1 + q] > 0.0)) {
                continue; /* a lobe that this channel does not use has no say in its roughness */
            }
            j->hessian[p][q] -= p == q ? 0.0 : 2.0 * z[1 + p] * z[1 + q] * s->mu[p][q].mixed;
            for (i = 0; i < on->count; i++) {
                j->hessian[p][q] += 2.0 * w[p][i] * w[q][i];
            }
        }
    }
}

/* E^2 = T - J, by theta = ln s. */
static void evaluate(void *self, const struct point *at, int derivatives, struct varpro_value *value)
{
    static const struct varpro_value zero;
    const struct descender *d = self;
    struct varpro_value j = zero;
    struct spot spot;
    size_t k;
    int p, q;

    (void)derivatives;
    open_spot(d->moments, d->model->lobes, at, &spot);
    for (k = 0; k < d->moments->data->bounded; k++) {
        add_channel(d, &spot, k, &j);
    }
    *value = zero;
    value->objective = fmax(d->moments->data->total - j.objective, 0.0);
    for (p = 0; p < d->model->lobes; p++) {
        double s = spot.node[p]->u;

        value->gradient[p] = -s * j.gradient[p];
        for (q = 0; q < d->model->lobes; q++) {
            value->hessian[p][q] = -s * spot.node[q]->u * j.hessian[p][q];
        }
        value->hessian[p][p] += value->gradient[p];
    }
}

void brdffit_moment_descend(struct moments *m, const struct model *model, const double *low, const double *high,
                            struct point *point)
{
    struct descender descender = {m, model};
    const struct newton descent = {&descender, evaluate, model->sides, low, high, m->slack};

    (void)brdffit_newton(&descent, point);
}
