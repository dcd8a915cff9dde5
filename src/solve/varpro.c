/*
 * Exact objective and its derivatives: see varpro.h. SPDX-License-Identifier: MIT
 *
 * Columns are a_f and g_c = b_c phi(u(theta_p), c'), c in p the columns of lobe p, taken at unit norm. With residual
 * r = I - A z, z optimal and S its support, the objective E(theta) = sum_k |r_k|^2 has, sums over the columns of p and q,
 *
 *     E_p  = -2 sum_k [sum z_c d_c].r
 *     E_pq =  2 sum_k ( [sum z_c d_c].[sum z_e d_e] - (p = q) [sum z_c e_c].r  -  B_p G^-1 B_q' ),
 *             B_pj = [sum z_c d_c].A_j - (j in p) d_j.r over j in S,   G = A_S'A_S
 *
 * where d_c, e_c are the first and second derivatives of column c (the norm held constant; of an anisotropic lobe with two
 * sides, by either and by both): the second line is
 * the Schur complement of the full Hessian, so Newton's method on it converges quadratically whatever the size of
 * the residual, and for a zero residual it is Gauss-Newton.
 */
#include "solve/varpro.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "data/physical.h"
#include "solve/compass.h"

/* Which columns change with which sides, of the model as it is: it may have fewer lobes than there is room for. */
static void list_derivatives(struct varpro *v)
{
    int c, d, e;

    v->slopes = v->bends = 0;
    for (c = 0; c < varpro_moving(v); c++) {
        int p = model_lobe_of(v->model, c), side = v->model->lobe[p].side;

        for (d = 0; d < model_shapes(v->model, p); d++) {
            const struct slope slope = {c, side + d};

            v->slope_of[v->slopes++] = slope;
            for (e = 0; e <= d; e++) {
                const struct bend bend = {c, {side + d, side + e}};

                v->bend_of[v->bends++] = bend;
            }
        }
    }
}

void brdffit_varpro_layout(struct varpro *v, struct arena *arena, size_t count, size_t channels,
                           const struct model *model)
{
    int c;

    v->model = model;
    v->physical = 0;
    v->phi = ARENA_DOUBLES(arena, PADDED(count));
    for (c = 0; c < model->kinds && model->kind[c]->exponential; c++) {
    }
    v->x = c < model->kinds ? ARENA_DOUBLES(arena, PADDED(count)) : NULL;
    v->slope = c < model->kinds ? ARENA_DOUBLES(arena, PADDED(count)) : NULL;
    v->q = brdffit_arena_take(arena, count, (size_t)model->columns * sizeof(double));
    v->residual = ARENA_DOUBLES(arena, count);
    _Static_assert(sizeof *v->answer <= NNLS_ANSWER_BYTES, "sizes to count with");
    v->answer = brdffit_arena_take(arena, channels, NNLS_ANSWER_BYTES);
    v->exponent = model->shapes > 1 ? ARENA_DOUBLES(arena, PADDED(count)) : NULL;
    list_derivatives(v);
    for (c = 0; c < varpro_moving(v); c++) {
        v->column[c] = ARENA_DOUBLES(arena, count);
    }
    for (c = 0; c < v->slopes; c++) {
        v->first[c] = ARENA_DOUBLES(arena, count);
    }
    for (c = 0; c < v->bends; c++) {
        v->second[c] = ARENA_DOUBLES(arena, count);
    }
}

/* Column c of a lobe with one side by theta, from x = -ell and slope of each group; no slopes: 0. */
static void differentiate(struct varpro *v, int c, const double u[3], const double *x, const double *slopes)
{
    const struct reduced *data = v->data;
    const double *row_b = varpro_table(v, c)->row_b;
    double *first = v->first[c + v->slopes - varpro_moving(v)], *second = v->second[c + v->bends - varpro_moving(v)];
    size_t r;

    for (r = 0; r < data->rows; r++) {
        uint32_t j = data->row_c[r];
        double value = row_b[r] * v->phi[j], ell = -x[j], slope = slopes ? slopes[j] : 0.0;

        v->column[c][r] = value;
        first[r] = value * (ell * u[1]);
        second[r] = value * ((ell * ell + slope) * (u[1] * u[1]) + ell * u[2]);
    }
}

/* The columns of lobe p and their derivatives at theta: they share phi. */
static void lobe_columns(struct varpro *v, int p, double theta, int derivatives)
{
    const struct lobe_kind *kind = model_kind(v->model, p);
    int first = p * v->model->each, c;
    const struct table *table = varpro_table(v, first);
    const struct reduced *data = v->data;
    double u[3];
    size_t r;

    kind->variable(&table->sight, theta, u);
    kind->shape(v->kernels, &table->sight, data->stride, u[0], v->phi);
    if (derivatives && !kind->exponential) {
        kind->slopes(v->kernels, &table->sight, data->stride, u[0], v->x, v->slope);
    }
    for (c = first; c < first + v->model->each; c++) {
        const double *row_b = varpro_table(v, c)->row_b;

        if (derivatives) {
            differentiate(v, c, u, kind->exponential ? table->c : v->x, kind->exponential ? NULL : v->slope);
        }
        for (r = 0; r < data->rows && !derivatives; r++) {
            v->column[c][r] = row_b[r] * v->phi[data->row_c[r]];
        }
    }
}

/* Products of derivative columns that every channel needs, at unit norm. */
struct products {
    double norm[MOVING_MOST];                /* of the lobe columns */
    double along[SLOPES_MOST][COLUMNS_MOST]; /* d_c . A_j */
    double dd[SLOPES_MOST][SLOPES_MOST];     /* d_c . d_e */
};

static void fill_products(const struct varpro *v, struct products *s)
{
    size_t n = v->data->rows;
    int c, e, j, k, F = v->model->fixed;

    for (c = 0; c < varpro_moving(v); c++) {
        s->norm[c] = v->nnls.norm[F + c] * v->nnls.scale[F + c];
    }
    for (c = 0; c < v->slopes; c++) {
        double along_q[COLUMNS_MOST], norm = s->norm[v->slope_of[c].column];

        for (k = 0; k < v->nnls.columns; k++) {
            along_q[k] = norm > 0.0 ? v->kernels->dot(v->nnls.q[k], v->first[c], n) / norm : 0.0;
        }
        for (j = 0; j < v->nnls.columns; j++) {
            s->along[c][j] = 0.0;
            for (k = 0; k <= j; k++) {
                s->along[c][j] += along_q[k] * v->nnls.r[k][j];
            }
        }
        for (e = 0; e <= c; e++) {
            double other = s->norm[v->slope_of[e].column], value = 0.0;

            if (norm > 0.0 && other > 0.0) {
                value = v->kernels->dot(v->first[c], v->first[e], n) / norm / other;
            }
            s->dd[c][e] = s->dd[e][c] = value;
        }
    }
}

/* The lower triangle of the Cholesky factor of G = (R'R)_S; a pivot that vanishes is 0, and skipped. */
static void factor_support(const struct varpro *v, unsigned support, double g[COLUMNS_MOST][COLUMNS_MOST])
{
    int i, j, k;

    for (j = 0; j < v->nnls.columns; j++) {
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
    }
}

/* B_p G^-1 B_q' over the support, by Cholesky of G. */
static void eliminate(const struct varpro *v, unsigned support, double b[SIDES_MOST][COLUMNS_MOST],
                      double out[SIDES_MOST][SIDES_MOST])
{
    double g[COLUMNS_MOST][COLUMNS_MOST], w[SIDES_MOST][COLUMNS_MOST];
    int j, k, p, q, sides = v->model->sides;

    factor_support(v, support, g);
    for (p = 0; p < sides; p++) {
        for (j = 0; j < v->nnls.columns; j++) {
            w[p][j] = support & (1u << j) ? b[p][j] : 0.0;
            for (k = 0; k < j && support & (1u << j); k++) {
                w[p][j] -= support & (1u << k) ? g[j][k] * w[p][k] : 0.0;
            }
            w[p][j] = support & (1u << j) && g[j][j] > 0.0 ? w[p][j] / g[j][j] : 0.0;
        }
        for (q = 0; q <= p; q++) {
            out[p][q] = 0.0;
            for (j = 0; j < v->nnls.columns; j++) {
                out[p][q] += w[p][j] * w[q][j];
            }
            out[q][p] = out[p][q];
        }
    }
}

/* What one channel makes of the columns of each side: sum z_c d_c . r, sum z_c e_c . r, B_p; and whether it uses the side. */
struct part {
    double dr[SIDES_MOST], er[SIDES_MOST][SIDES_MOST], b[SIDES_MOST][COLUMNS_MOST];
    int used[SIDES_MOST];
};

static void clear_part(const struct varpro *v, struct part *out)
{
    int j, p, q;

    for (p = 0; p < v->model->sides; p++) {
        out->dr[p] = 0.0;
        out->used[p] = 0;
        for (q = 0; q < v->model->sides; q++) {
            out->er[p][q] = 0.0;
        }
        for (j = 0; j < v->nnls.columns; j++) {
            out->b[p][j] = 0.0;
        }
    }
}

static void fill_part(const struct varpro *v, const struct products *s, const struct nnls_answer *answer,
                      struct part *out)
{
    size_t n = v->data->rows;
    int c, j, m, p, F = v->model->fixed;

    clear_part(v, out);
    for (m = 0; m < v->slopes; m++) {
        double inverse, z, dr;

        c = v->slope_of[m].column;
        p = v->slope_of[m].side;
        inverse = s->norm[c] > 0.0 ? 1.0 / s->norm[c] : 0.0;
        z = answer->unit[F + c];
        dr = v->kernels->dot(v->first[m], v->residual, n) * inverse;
        out->dr[p] += z * dr;
        out->used[p] = out->used[p] || z > 0.0;
        for (j = 0; j < v->nnls.columns; j++) {
            out->b[p][j] += z * s->along[m][j] - (j == F + c ? dr : 0.0);
        }
    }
    for (m = 0; m < v->bends; m++) {
        const int *side = v->bend_of[m].side;
        double inverse, bend;

        c = v->bend_of[m].column;
        inverse = s->norm[c] > 0.0 ? 1.0 / s->norm[c] : 0.0;
        bend = answer->unit[F + c] * (v->kernels->dot(v->second[m], v->residual, n) * inverse);
        out->er[side[0]][side[1]] += bend;
        out->er[side[1]][side[0]] = out->er[side[0]][side[1]];
    }
}

/* One channel's part of the gradient and Hessian; scale2 turns the answer's units into the objective's. */
static void add_channel(const struct varpro *v, const struct products *s, const struct nnls_answer *answer,
                        double scale2, struct varpro_value *value)
{
    double gone[SIDES_MOST][SIDES_MOST];
    struct part part;
    int c, e, p, q, F = v->model->fixed;

    fill_part(v, s, answer, &part);
    eliminate(v, answer->support, part.b, gone);
    for (p = 0; p < v->model->sides; p++) {
        value->gradient[p] -= 2.0 * scale2 * part.dr[p];
        for (q = 0; q < v->model->sides; q++) {
            /* A lobe that this channel does not use has no say in its roughness. */
            if (part.used[p] && part.used[q]) {
                value->hessian[p][q] -= 2.0 * scale2 * (gone[p][q] + part.er[p][q]);
            }
        }
    }
    for (c = 0; c < v->slopes; c++) {
        for (e = 0; e < v->slopes; e++) {
            const struct slope *one = &v->slope_of[c], *two = &v->slope_of[e];

            value->hessian[one->side][two->side] += 2.0 * scale2 *
                                                    (answer->unit[F + one->column] * answer->unit[F + two->column] *
                                                     s->dd[c][e]);
        }
    }
}

/* What coefficients of unit columns count for at a point: that of channel k into `limit`. */
static void fill_limit(const struct varpro *v, const struct wide *counts, size_t k, double *limit)
{
    int c;

    for (c = 0; c < v->model->columns; c++) {
        limit[c] = brdffit_physical_unit(v->data, counts[c], v->nnls.norm[c] * v->nnls.scale[c], k);
    }
}

static void fill_counts(const struct varpro *v, const struct point *at, struct wide *counts)
{
    int c, F = v->model->fixed;

    for (c = 0; c < F; c++) {
        counts[c] = brdffit_physical_fixed(v->data, c);
    }
    for (c = 0; c < varpro_moving(v); c++) {
        counts[F + c] = brdffit_physical_lobe(model_column_kind(v->model, c), varpro_table(v, c),
                                              at->theta[model_lobe_of(v->model, c)]);
    }
}

/* The restricted problem of channel k. */
static void solve_channel(struct varpro *v, const struct wide *counts, size_t k)
{
    const double *data = v->data->row_value + k * v->data->used;
    double limit[COLUMNS_MOST];

    if (v->physical) {
        fill_limit(v, counts, k, limit);
        brdffit_nnls_solve_limited(&v->nnls, data, limit, v->residual, &v->answer[k]);
    } else {
        brdffit_nnls_solve(&v->nnls, data, v->residual, &v->answer[k]);
    }
}

void brdffit_varpro_evaluate(struct varpro *v, const struct point *at, int derivatives, struct varpro_value *value)
{
    const double *column[COLUMNS_MOST];
    struct wide counts[COLUMNS_MOST];
    struct products products;
    size_t k;
    int c, p, q;

    list_derivatives(v);
    for (p = 0; p < v->model->lobes; p++) {
        if (model_shapes(v->model, p) > 1) {
            brdffit_varpro_turned(v, at->theta, derivatives);
        } else {
            lobe_columns(v, p, at->theta[v->model->lobe[p].side], derivatives);
        }
    }
    for (p = 0; p < v->model->sides; p++) {
        value->gradient[p] = 0.0;
        for (q = 0; q < v->model->sides; q++) {
            value->hessian[p][q] = 0.0;
        }
    }
    for (c = 0; c < v->model->columns; c++) {
        column[c] = c < v->model->fixed ? v->data->row_a + (size_t)c * v->data->used : v->column[c - v->model->fixed];
    }
    brdffit_nnls_factor(&v->nnls, v->kernels, v->data->rows, v->model->columns, column, v->q);
    if (derivatives) {
        fill_products(v, &products);
    }
    if (v->physical) {
        fill_counts(v, at, counts);
    }
    value->objective = 0.0;
    value->kkt = 0.0;
    for (k = 0; k < v->data->channels; k++) {
        struct nnls_answer *answer = &v->answer[k];
        double scale2;

        solve_channel(v, counts, k);
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

static double objective_at(void *self, const struct point *at)
{
    struct varpro_value value;

    brdffit_varpro_evaluate(self, at, 0, &value);
    return value.objective;
}

double brdffit_varpro_feel(struct varpro *v, struct point *point)
{
    struct compass d = {v, objective_at, v->model->sides, v->theta_low, v->theta_high, point, 0.0, COMPASS_EVALUATIONS};

    d.objective = objective_at(v, point);
    brdffit_compass(&d);
    return d.objective;
}
