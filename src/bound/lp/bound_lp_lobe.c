/*
 * Envelope of a lobe over an interval of roughness. SPDX-License-Identifier: MIT
 *
 * A lobe may be multiplied by any positive function of s: y takes it up. Take f_i(u) = b_i phi(u, c_i) e^{k (u - m)}
 * with m the middle of [u_0, u_1] and k = the mean of -d ln phi / du at m, so that f hardly moves as a whole. phi is
 * log-convex in u (lobe.h), so f is convex: with v = (u - u_0) / (u_1 - u_0), sample by sample,
 *
 *     (1 - v) T(u_0) + v T(u_1)  <=  f(u)  <=  (1 - v) f(u_0) + v f(u_1),        T the tangent at m
 *
 * and the two sides differ by O((u_1 - u_0)^2). With y_0 = (1 - v) y and y_1 = v y >= 0 both are linear in
 * (y_0, y_1): the relaxation forgets only that v is the same for every channel.
 */
#include "bound/lp/bound_lp_lobe.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* Longest exponent of the tilt over half an interval: wide ones gain nothing from more. */
#define LONGEST_TILT 30.0

/* An interval in u, and the tilt. */
struct span {
    double u[3]; /* ends, middle */
    double rate; /* k */
    double tilt[2];
};

/* -ell at each group at the middle of the interval. */
static const double *slopes_at(struct bound_lp *e, int p, double u)
{
    const struct varpro *v = e->restricted->varpro;
    const struct table *table = varpro_table(v, p);
    const struct lobe_kind *kind = model_column_kind(v->model, p);

    if (kind->exponential) {
        return table->c;
    }
    kind->slopes(v->kernels, &table->sight, v->data->stride, u, e->x, e->slope);
    return e->x;
}

static struct span open_span(struct bound_lp *e, int p, double low, double high)
{
    const struct varpro *v = e->restricted->varpro;
    const struct table *table = varpro_table(v, p);
    const struct lobe_kind *kind = model_column_kind(v->model, p);
    double u[3], weight = 0.0, sum = 0.0, half;
    const double *x;
    struct span s;
    size_t j;

    kind->variable(&table->sight, low, u);
    s.u[0] = u[0];
    kind->variable(&table->sight, high, u);
    s.u[1] = u[0];
    s.u[2] = 0.5 * s.u[0] + 0.5 * s.u[1];
    for (j = 0; j < 3; j++) {
        kind->shape(v->kernels, &table->sight, v->data->stride, s.u[j], e->phi[j]);
    }
    x = slopes_at(e, p, s.u[2]);
    for (j = 0; j < v->data->distinct; j++) {
        double share = table->bb[j] * (e->phi[2][j] * e->phi[2][j]);

        weight += share;
        sum += share > 0.0 ? share * x[j] : 0.0;
    }
    half = s.u[1] - s.u[2];
    s.rate = weight > 0.0 && half > 0.0 ? fmin(sum / weight, LONGEST_TILT / half) : 0.0;
    s.tilt[0] = kernel_exp(s.rate * (s.u[0] - s.u[2]));
    s.tilt[1] = kernel_exp(s.rate * (s.u[1] - s.u[2]));
    return s;
}

static void fill_rows(struct bound_lp *e, int p, const struct span *s)
{
    const struct varpro *v = e->restricted->varpro;
    const struct table *table = varpro_table(v, p);
    const double *x = slopes_at(e, p, s->u[2]);
    struct bound_lp_lobe *lobe = &e->lobe[p];
    size_t i;
    int end;

    for (i = 0; i < v->data->rows; i++) {
        uint32_t j = v->data->row_c[i];
        double b = table->row_b[i], middle = b * e->phi[2][j], tangent[2], slack[2];

        for (end = 0; end < 2; end++) {
            double rise = (s->rate - x[j]) * (s->u[end] - s->u[2]);

            tangent[end] = middle * (1.0 + rise);
            slack[end] = TOL_SHAPE * middle * (1.0 + fabs(rise));
            lobe->upper[end][i] = b * e->phi[end][j] * s->tilt[end] * (1.0 + TOL_SHAPE);
        }
        if (!(tangent[0] + tangent[1] > 0.0)) {
            tangent[0] = tangent[1] = slack[0] = slack[1] = 0.0; /* 0 is the better line */
        }
        lobe->lower[0][i] = tangent[0] - slack[0];
        lobe->lower[1][i] = tangent[1] - slack[1];
    }
}

static double norm_of(const struct bound_lp *e, const double *column, double factor)
{
    size_t i, rows = e->restricted->varpro->data->rows;
    double sum = 0.0;

    for (i = 0; i < rows && e->lp.norm == BRDFFIT_NORM_L1; i++) {
        sum += fabs(column[i]);
    }
    return factor * (e->lp.norm == BRDFFIT_NORM_L1 ? sum : vector_largest(column, rows));
}

/* How much of a column changes, whatever its length: decides only which lobe is split. */
static double change_of(const struct bound_lp *e, const struct bound_lp_lobe *lobe)
{
    double norm[2], sum = 0.0;
    size_t i;

    norm[0] = norm_of(e, lobe->upper[0], 1.0);
    norm[1] = norm_of(e, lobe->upper[1], 1.0);
    if (!(norm[0] > 0.0 && norm[1] > 0.0)) {
        return 0.0;
    }
    for (i = 0; i < e->restricted->varpro->data->rows; i++) {
        double difference = fabs(lobe->upper[0][i] / norm[0] - lobe->upper[1][i] / norm[1]);

        sum = e->lp.norm == BRDFFIT_NORM_L1 ? sum + difference : fmax(sum, difference);
    }
    return sum;
}

void brdffit_bound_lp_lobe(struct bound_lp *e, int p, double low, double centre, double high)
{
    const struct varpro *v = e->restricted->varpro;
    const struct span s = open_span(e, p, low, high);
    struct bound_lp_lobe *lobe = &e->lobe[p];
    double u[3], rows = (double)v->data->rows;
    size_t i;
    int end;

    fill_rows(e, p, &s);
    lobe->change = change_of(e, lobe);
    /* phi falls and the tilt rises, so f >= b phi(u_1) times the tilt at u_0. */
    lobe->least = norm_of(e, lobe->upper[1], s.tilt[0] / s.tilt[1]) * (1.0 - TOL_CURVATURE - rows * 4.0 * TOL_UNIT);
    model_column_kind(v->model, p)->variable(&varpro_table(v, p)->sight, centre, u);
    lobe->place = s.u[1] > s.u[0] ? fmin(1.0, fmax(0.0, (u[0] - s.u[0]) / (s.u[1] - s.u[0]))) : 0.0;
    lobe->tilt = kernel_exp(s.rate * (u[0] - s.u[2]));
    for (end = 0; end < 2; end++) {
        double scale = power_of_two(vector_largest(lobe->upper[end], v->data->rows));

        lobe->scale[end] = scale;
        for (i = 0; i < v->data->rows; i++) {
            lobe->upper[end][i] /= scale;
            lobe->lower[end][i] /= scale;
        }
    }
}
