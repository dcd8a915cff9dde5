/*
 * Exact objective and its derivatives: see varpro.h. SPDX-License-Identifier: MIT
 *
 * Columns are a and g_p = b phi(u(theta_p), c'), taken at unit norm. With residual r = I - A z, z optimal and S its
 * support, the objective E(theta) = sum_k |r_k|^2 has
 *
 *     E_p  = -2 sum_k z_p d_p.r
 *     E_pq =  2 sum_k [ z_p z_q d_p.d_q - (p = q) z_p e_p.r  -  B_p G^-1 B_q' ],
 *             B_pj = z_p d_p.A_j - (j = p) d_p.r over j in S,   G = A_S'A_S
 *
 * where d_p, e_p are the first and second derivatives of column p (the norm held constant): the second line is
 * the Schur complement of the full Hessian, so Newton's method on it converges quadratically whatever the size of
 * the residual, and for a zero residual it is Gauss-Newton.
 */
#include "solve/varpro.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"

void brdffit_varpro_layout(struct varpro *v, struct arena *arena, size_t count, size_t channels,
                           const struct model *model)
{
    int p;

    v->model = model;
    v->phi = ARENA_DOUBLES(arena, PADDED(count));
    v->x = ARENA_DOUBLES(arena, PADDED(count));
    v->slope = ARENA_DOUBLES(arena, PADDED(count));
    v->q = brdffit_arena_take(arena, count, (size_t)model->columns * sizeof(double));
    v->residual = ARENA_DOUBLES(arena, count);
    v->answer = brdffit_arena_take(arena, channels, sizeof *v->answer);
    for (p = 0; p < model->lobes; p++) {
        v->column[p] = ARENA_DOUBLES(arena, count);
        v->first[p] = ARENA_DOUBLES(arena, count);
        v->second[p] = ARENA_DOUBLES(arena, count);
    }
}

/* Columns p by theta, from x = -ell and slope of each group; no slopes: 0. */
static void differentiate(struct varpro *v, const struct table *table, int p, const double u[3], const double *x,
                          const double *slopes)
{
    const struct reduced *data = v->data;
    size_t r;

    for (r = 0; r < data->rows; r++) {
        uint32_t j = data->row_c[r];
        double value = table->row_b[r] * v->phi[j], ell = -x[j], slope = slopes ? slopes[j] : 0.0;

        v->column[p][r] = value;
        v->first[p][r] = value * (ell * u[1]);
        v->second[p][r] = value * ((ell * ell + slope) * (u[1] * u[1]) + ell * u[2]);
    }
}

/* Column p and its derivatives at theta. */
static void lobe_columns(struct varpro *v, int p, double theta, int derivatives)
{
    const struct lobe_kind *kind = model_kind(v->model, p);
    const struct table *table = varpro_table(v, p);
    const struct reduced *data = v->data;
    double u[3];
    size_t r;

    kind->variable(table->c_min, theta, u);
    kind->shape(v->kernels, table->c, data->stride, u[0], v->phi);
    if (derivatives && kind->exponential) {
        differentiate(v, table, p, u, table->c, NULL);
    } else if (derivatives) {
        kind->slopes(v->kernels, table->c, data->stride, u[0], v->x, v->slope);
        differentiate(v, table, p, u, v->x, v->slope);
    }
    for (r = 0; r < data->rows && !derivatives; r++) {
        v->column[p][r] = table->row_b[r] * v->phi[data->row_c[r]];
    }
}

/* Products of derivative columns that every channel needs, at unit norm. */
struct products {
    double norm[SIDES_MOST];                /* of the lobe columns */
    double along[SIDES_MOST][COLUMNS_MOST]; /* d_p . A_j */
    double dd[SIDES_MOST][SIDES_MOST];      /* d_p . d_q */
};

static void fill_products(const struct varpro *v, struct products *s)
{
    size_t n = v->data->rows;
    int p, q, j, k;

    for (p = 0; p < v->model->lobes; p++) {
        double along_q[COLUMNS_MOST];

        s->norm[p] = v->nnls.norm[1 + p] * v->nnls.scale[1 + p];
        for (k = 0; k < v->nnls.columns; k++) {
            along_q[k] = s->norm[p] > 0.0 ? v->kernels->dot(v->nnls.q[k], v->first[p], n) / s->norm[p] : 0.0;
        }
        for (j = 0; j < v->nnls.columns; j++) {
            s->along[p][j] = 0.0;
            for (k = 0; k <= j; k++) {
                s->along[p][j] += along_q[k] * v->nnls.r[k][j];
            }
        }
        for (q = 0; q <= p; q++) {
            double value = 0.0;

            if (s->norm[p] > 0.0 && s->norm[q] > 0.0) {
                value = v->kernels->dot(v->first[p], v->first[q], n) / s->norm[p] / s->norm[q];
            }
            s->dd[p][q] = s->dd[q][p] = value;
        }
    }
}

/* B_p G^-1 B_q' over the support, by Cholesky of G = (R'R)_S; a pivot that vanishes is skipped. */
static void eliminate(const struct varpro *v, unsigned support, double b[SIDES_MOST][COLUMNS_MOST],
                      double out[SIDES_MOST][SIDES_MOST])
{
    double g[COLUMNS_MOST][COLUMNS_MOST], w[SIDES_MOST][COLUMNS_MOST];
    int i, j, k, p, q, n = v->nnls.columns;

    for (p = 0; p < v->model->lobes; p++) {
        for (q = 0; q < v->model->lobes; q++) {
            out[p][q] = 0.0;
        }
    }
    for (j = 0; j < n; j++) {
        if (!(support & (1u << j))) {
            continue;
        }
        for (i = 0; i <= j; i++) {
            if (!(support & (1u << i))) {
                continue;
            }
            g[j][i] = 0.0;
            for (k = 0; k <= i; k++) {
                g[j][i] += v->nnls.r[k][i] * v->nnls.r[k][j];
            }
            for (k = 0; k < i; k++) {
                g[j][i] -= support & (1u << k) ? g[j][k] * g[i][k] : 0.0;
            }
            if (i < j) {
                g[j][i] = g[i][i] > 0.0 ? g[j][i] / g[i][i] : 0.0;
            }
        }
        g[j][j] = g[j][j] > TOL_DEPENDENT ? sqrt(g[j][j]) : 0.0;
        for (p = 0; p < v->model->lobes; p++) {
            w[p][j] = b[p][j];
            for (k = 0; k < j; k++) {
                w[p][j] -= support & (1u << k) ? g[j][k] * w[p][k] : 0.0;
            }
            w[p][j] = g[j][j] > 0.0 ? w[p][j] / g[j][j] : 0.0;
            for (q = 0; q <= p; q++) {
                out[p][q] += w[p][j] * w[q][j];
            }
        }
    }
    for (p = 0; p < v->model->lobes; p++) {
        for (q = 0; q < p; q++) {
            out[q][p] = out[p][q];
        }
    }
}

/* One channel's part of the gradient and Hessian; scale2 turns the answer's units into the objective's. */
static void add_channel(const struct varpro *v, const struct products *s, const struct nnls_answer *answer,
                        double scale2, struct varpro_value *value)
{
    double b[SIDES_MOST][COLUMNS_MOST], gone[SIDES_MOST][SIDES_MOST], dr[SIDES_MOST], er[SIDES_MOST];
    size_t n = v->data->rows;
    int p, q, j;

    for (p = 0; p < v->model->lobes; p++) {
        double inverse = s->norm[p] > 0.0 ? 1.0 / s->norm[p] : 0.0;

        dr[p] = v->kernels->dot(v->first[p], v->residual, n) * inverse;
        er[p] = v->kernels->dot(v->second[p], v->residual, n) * inverse;
        for (j = 0; j < v->nnls.columns; j++) {
            b[p][j] = answer->unit[1 + p] * s->along[p][j] - (j == 1 + p ? dr[p] : 0.0);
        }
    }
    eliminate(v, answer->support, b, gone);
    for (p = 0; p < v->model->lobes; p++) {
        double z = answer->unit[1 + p];

        value->gradient[p] -= 2.0 * scale2 * z * dr[p];
        for (q = 0; q < v->model->lobes; q++) {
            double h = z * answer->unit[1 + q] * s->dd[p][q] - (p == q ? z * er[p] : 0.0);

            /* A lobe that this channel does not use has no say in its roughness. */
            if (z > 0.0 && answer->unit[1 + q] > 0.0) {
                value->hessian[p][q] += 2.0 * scale2 * (h - gone[p][q]);
            }
        }
    }
}

void brdffit_varpro_evaluate(struct varpro *v, const struct point *at, int derivatives, struct varpro_value *value)
{
    const double *column[COLUMNS_MOST];
    struct products products;
    size_t k;
    int p, q;

    for (p = 0; p < v->model->lobes; p++) {
        lobe_columns(v, p, at->theta[p], derivatives);
        column[1 + p] = v->column[p];
        value->gradient[p] = 0.0;
        for (q = 0; q < v->model->lobes; q++) {
            value->hessian[p][q] = 0.0;
        }
    }
    column[0] = v->data->row_a;
    brdffit_nnls_factor(&v->nnls, v->kernels, v->data->rows, v->model->columns, column, v->q);
    if (derivatives) {
        fill_products(v, &products);
    }
    value->objective = 0.0;
    value->kkt = 0.0;
    for (k = 0; k < v->data->channels; k++) {
        struct nnls_answer *answer = &v->answer[k];
        double scale2;

        brdffit_nnls_solve(&v->nnls, v->data->row_value + k * v->data->used, v->residual, answer);
        scale2 = answer->data_scale * answer->data_scale;
        value->objective += answer->rss * scale2;
        value->kkt = fmax(value->kkt, answer->kkt);
        if (derivatives) {
            add_channel(v, &products, answer, scale2, value);
        }
    }
}

static void evaluate(void *self, const struct point *at, int derivatives, struct varpro_value *value)
{
    brdffit_varpro_evaluate(self, at, derivatives, value);
}

double brdffit_varpro_descend(struct varpro *v, struct point *point)
{
    const struct newton descent = {v, evaluate, v->model->sides, v->theta_low, v->theta_high, 0.0};

    return brdffit_newton(&descent, point);
}
