/*
 * The first incumbent of engine `moment`: the best of the nodes of the first partition. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "base/vector.h"
#include "bound/moment/bound.h"
#include "solve/nnls.h"

/* Objective of the model with its lobes at these nodes of the first partition. */
static double objective_at(struct bound_moment *e, const uint32_t *index, struct point *at)
{
    const struct model *model = e->model;
    struct moments *m = &e->moments;
    const struct node *node[SIDES_MOST];
    double cosine[COSINES(SIDES_MOST)], t[COLUMNS_MOST], sum = 0.0;
    int p, q, entry = 0;
    size_t k;

    for (p = 0; p < model->sides; p++) {
        int kind = model->lobe[p].kind;

        at->theta[p] = e->axis[kind].coordinate[index[p]];
        node[p] = brdffit_moments_node(m, kind, index[p], at->theta[p]);
        cosine[entry++] = larger(node[p]->kappa, 0.0);
    }
    for (p = 0; p < model->sides; p++) {
        for (q = p + 1; q < model->sides; q++) {
            const struct couple pair = {{model->lobe[p].kind, model->lobe[q].kind}, {index[p], index[q]}};

            cosine[entry++] = larger(brdffit_moments_pair(m, &pair)->mu, 0.0);
        }
    }
    for (k = 0; k < m->data->bounded; k++) {
        t[0] = m->omega[k];
        for (p = 0; p < model->sides; p++) {
            t[1 + p] = node[p]->tau[k];
        }
        sum += brdffit_nnls_gain(1 + model->sides, cosine, t);
    }
    return m->data->total - sum;
}

/* The next combination of nodes, those of like lobes ascending; 0 after the last. */
static int next_nodes(const struct bound_moment *e, uint32_t *index)
{
    const struct model *model = e->model;
    int p, q;

    for (p = model->sides - 1; p >= 0; p--) {
        if (index[p] < e->axis[model->lobe[p].kind].first) {
            index[p]++;
            for (q = p + 1; q < model->sides; q++) {
                index[q] = model->lobe[q].first <= p ? index[p] : 0;
            }
            return 1;
        }
    }
    return 0;
}

double brdffit_bound_moment_first(struct bound_moment *e, struct point *met)
{
    uint32_t index[SIDES_MOST] = {0};
    double best = INFINITY;

    do {
        struct point at;
        double objective = objective_at(e, index, &at);

        if (objective < best) {
            best = objective;
            *met = at;
        }
    } while (next_nodes(e, index));
    return best;
}
