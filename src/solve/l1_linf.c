/*
 * Restricted problem of norms l1 and linf: see l1_linf.h. SPDX-License-Identifier: MIT
 */
#include "solve/l1_linf.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"
#include "solve/compass.h"

void brdffit_l1_linf_layout(struct l1_linf *r, struct arena *arena, size_t count, size_t channels,
                            const struct model *model, brdffit_norm norm)
{
    int j;

    r->norm = norm;
    brdffit_simplex_layout(&r->simplex, arena, count);
    brdffit_lp_layout(&r->lp, arena, count, (size_t)model->columns, norm);
    for (j = 0; j < model->columns; j++) {
        r->column[j] = ARENA_DOUBLES(arena, count);
    }
    r->data = ARENA_DOUBLES(arena, count);
    r->channel = ARENA_DOUBLES(arena, channels);
}

brdffit_status brdffit_l1_linf_start(struct l1_linf *r, struct varpro *varpro)
{
    int j;

    r->varpro = varpro;
    r->evaluated = 0;
    r->simplex.rows = varpro->data->rows;
    r->simplex.columns = varpro->model->columns;
    for (j = 0; j < varpro->model->columns; j++) {
        r->simplex.column[j] = r->column[j];
    }
    r->simplex.data = r->data;
    return brdffit_lp_start(&r->lp, varpro->data->rows);
}

void brdffit_l1_linf_finish(struct l1_linf *r)
{
    brdffit_lp_finish(&r->lp);
}

static double norm_of(const struct l1_linf *r, const double *z)
{
    return r->norm == BRDFFIT_NORM_L1 ? brdffit_simplex_norm_l1(&r->simplex, z)
                                      : brdffit_simplex_norm_linf(&r->simplex, z);
}

/* Columns of the factorisation at unit norm. */
static void take_columns(struct l1_linf *r)
{
    const struct nnls *nnls = &r->varpro->nnls;
    size_t i;
    int j;

    for (j = 0; j < nnls->columns; j++) {
        for (i = 0; i < nnls->rows; i++) {
            double value = nnls->column[j][i] / nnls->scale[j];

            r->column[j][i] = nnls->norm[j] > 0.0 ? value / nnls->norm[j] : 0.0;
        }
    }
}

static double column_norm(const struct l1_linf *r, int j)
{
    double sum = 0.0;
    size_t i;

    for (i = 0; i < r->simplex.rows && r->norm == BRDFFIT_NORM_L1; i++) {
        sum += fabs(r->column[j][i]);
    }
    return r->norm == BRDFFIT_NORM_L1 ? sum : vector_largest(r->column[j], r->simplex.rows);
}

/* What ECOS finds and proves of the channel in r->data; z and the norm it has improve if they can. Returns the part
 * of `zero`, the norm of the data, that is not proven. */
static double prove_channel(struct l1_linf *r, double zero, double *z, double *norm)
{
    struct lp_data data;
    double found[LP_COLUMNS], bound, here;
    int j;

    data.data = r->data;
    for (j = 0; j < r->simplex.columns; j++) {
        double size = column_norm(r, j);

        data.upper[j] = data.lower[j] = r->column[j];
        data.limit[j] = size > 0.0 ? 2.0 * (1.0 + TOL_CURVATURE) * zero / size : 0.0;
    }
    bound = brdffit_lp_bound(&r->lp, &data, found);
    here = norm_of(r, found);
    if (here < *norm) {
        *norm = here;
        for (j = 0; j < r->simplex.columns; j++) {
            z[j] = found[j];
        }
    }
    return zero > 0.0 ? fmax(0.0, *norm - bound) / zero : 0.0;
}

/* Weighted sum of squared residuals: rows hold what the norm makes of weights (reduce.h). */
static double sum_of_squares(const struct l1_linf *r, const double *z)
{
    double sum = 0.0;
    size_t i;
    int j;

    for (i = 0; i < r->simplex.rows; i++) {
        double residual = r->data[i];

        for (j = 0; j < r->simplex.columns; j++) {
            residual -= r->column[j][i] * z[j];
        }
        sum += residual * r->varpro->data->row_square[i] * residual;
    }
    return sum;
}

static void solve_channel(struct l1_linf *r, size_t k, int prove, struct varpro_value *value)
{
    const struct reduced *data = r->varpro->data;
    struct nnls_answer *answer = &r->varpro->answer[k];
    double z[SIMPLEX_UNKNOWNS] = {0.0}, zero = 0.0, norm;
    size_t i;
    int j;

    for (i = 0; i < data->rows; i++) {
        r->data[i] = data->row_value[k * data->used + i] / answer->data_scale;
        zero = r->norm == BRDFFIT_NORM_L1 ? zero + fabs(r->data[i]) : fmax(zero, fabs(r->data[i]));
    }
    norm = r->norm == BRDFFIT_NORM_L1 ? brdffit_simplex_l1(&r->simplex, z) : brdffit_simplex_linf(&r->simplex, z);
    answer->kkt = prove ? prove_channel(r, zero, z, &norm) : 0.0;
    answer->support = 0;
    for (j = 0; j < r->simplex.columns; j++) {
        double size = r->varpro->nnls.norm[j];

        z[j] = size > 0.0 ? z[j] : 0.0;
        answer->unit[j] = z[j];
        answer->z[j] = z[j] > 0.0 ? z[j] / size / r->varpro->nnls.scale[j] * answer->data_scale : 0.0;
        answer->support |= z[j] > 0.0 ? 1u << j : 0u;
    }
    answer->rss = sum_of_squares(r, z);
    r->channel[k] = norm * answer->data_scale;
    value->objective = r->norm == BRDFFIT_NORM_L1 ? value->objective + r->channel[k]
                                                  : fmax(value->objective, r->channel[k]);
    value->kkt = fmax(value->kkt, answer->kkt);
}

void brdffit_l1_linf_evaluate(struct l1_linf *r, const struct point *at, int prove, struct varpro_value *value)
{
    size_t k;

    brdffit_varpro_evaluate(r->varpro, at, 0, value); /* columns, and the data's scales */
    take_columns(r);
    value->objective = value->kkt = 0.0;
    for (k = 0; k < r->varpro->data->channels; k++) {
        solve_channel(r, k, prove, value);
    }
    r->evaluated++;
}

static double objective_at(void *self, const struct point *at)
{
    struct varpro_value value;

    brdffit_l1_linf_evaluate(self, at, 0, &value);
    return value.objective;
}

/* Derivatives would not help a compass: the objective has kinks. */
double brdffit_l1_linf_descend(struct l1_linf *r, struct point *point)
{
    const struct varpro *v = r->varpro;
    struct compass d = {r, objective_at, v->model->sides, v->theta_low, v->theta_high, point, 0.0, COMPASS_EVALUATIONS};
    struct point smooth = *point;
    struct varpro_value value;

    d.objective = objective_at(r, point);
    /* The smooth objective's optimum nearby is this one's too where the data are exact, and a fair start elsewhere. */
    (void)brdffit_varpro_descend(r->varpro, &smooth);
    (void)brdffit_compass_try(&d, &smooth);
    brdffit_compass(&d);
    brdffit_l1_linf_evaluate(r, point, 1, &value);
    return value.objective;
}
