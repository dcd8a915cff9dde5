/*
 * The first incumbent of engine `moment`: the best of the nodes of the first partition. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "base/vector.h"
#include "bound/moment/bound.h"
#include "solve/nnls.h"

/* The columns of the model at some nodes of the first partition. */
struct spot {
    uint32_t index[MOVING_MOST];
    const struct node *node[MOVING_MOST];
    double cosine[COSINES(COLUMNS_MOST)];
};

/* Nodes of the columns of the sides, and their cosines with the fixed ones. */
static void open_spot(struct bound_moment *e, const uint32_t *index, struct point *at, struct spot *s)
{
    const struct model *model = e->model;
    int c, f, F = model->fixed, moving = model->columns - F;

    for (c = 0; c < moving; c++) {
        int p = model_lobe_of(model, c), kind = model_kind_of(model, c);

        at->theta[p] = e->axis[model->lobe[p].kind].coordinate[index[p]];
        s->index[c] = index[p];
        s->node[c] = brdffit_moments_node(&e->moments, kind, index[p], at->theta[p]);
        for (f = 0; f < F; f++) {
            s->cosine[COSINE(model->columns, f, F + c)] = larger(s->node[c]->kappa[f], 0.0);
        }
    }
}

/* Cosines of fixed columns, and of those of the sides. */
static void open_pairs(struct bound_moment *e, struct spot *s)
{
    const struct model *model = e->model;
    int c, d, F = model->fixed, moving = model->columns - F;

    for (c = 0; c < F; c++) {
        for (d = c + 1; d < F; d++) {
            s->cosine[COSINE(model->columns, c, d)] = e->moments.fixed[c][d];
        }
    }
    for (c = 0; c < moving; c++) {
        for (d = c + 1; d < moving; d++) {
            const struct couple pair = {{model_kind_of(model, c), model_kind_of(model, d)}, {s->index[c], s->index[d]}};

            s->cosine[COSINE(model->columns, F + c, F + d)] = larger(brdffit_moments_pair(&e->moments, &pair)->mu, 0.0);
        }
    }
}

/* Objective of the model with its lobes at these nodes of the first partition. */
static double objective_at(struct bound_moment *e, const uint32_t *index, struct point *at)
{
    const struct model *model = e->model;
    struct moments *m = &e->moments;
    double t[COLUMNS_MOST], sum = 0.0;
    struct spot s;
    size_t k;
    int c;

    open_spot(e, index, at, &s);
    open_pairs(e, &s);
    for (k = 0; k < m->data->bounded; k++) {
        for (c = 0; c < model->columns; c++) {
            t[c] = c < model->fixed ? m->omega[c][k] : s.node[c - model->fixed]->tau[k];
        }
        sum += brdffit_nnls_gain(model->columns, s.cosine, t);
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
