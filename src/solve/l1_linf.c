/*
 * Restricted problem of norms l1 and linf: see l1_linf.h. SPDX-License-Identifier: MIT
 */
#include "solve/l1_linf.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"

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

/* ---- Descent ------------------------------------------------------------------------------------------------ */

/* First step in theta = ln s, and the relative one that ends the descent. */
#define LONGEST 0.25
#define SHORTEST 1e-15
/* Most evaluations of one descent. */
#define EVALUATIONS 1500

struct descent {
    struct l1_linf *r;
    struct point *at;
    double objective;
    int left; /* evaluations */
};

static int try_at(struct descent *d, const struct point *there)
{
    const struct varpro *v = d->r->varpro;
    struct point next = *there;
    struct varpro_value value;
    int p, moved = 0;

    for (p = 0; p < v->model->sides; p++) {
        next.theta[p] = fmin(v->theta_high[p], fmax(v->theta_low[p], next.theta[p]));
        moved = moved || next.theta[p] != d->at->theta[p];
    }
    if (!moved || d->left <= 0) {
        return 0;
    }
    d->left--;
    brdffit_l1_linf_evaluate(d->r, &next, 0, &value);
    if (!(value.objective < d->objective)) {
        return 0;
    }
    d->objective = value.objective;
    *d->at = next;
    return 1;
}

/* Ways to go: both along each side, then the four diagonals of each pair of sides. */
#define WAYS_MOST (2 * SIDES_MOST + 2 * SIDES_MOST * (SIDES_MOST - 1))

struct ways {
    int count;
    signed char to[WAYS_MOST][SIDES_MOST];
};

static void add_way(struct ways *w, int p, int up, int q, int up_too)
{
    int i;

    for (i = 0; i < SIDES_MOST; i++) {
        w->to[w->count][i] = (signed char)(i == p ? up : i == q ? up_too : 0);
    }
    w->count++;
}

static struct ways all_ways(int sides)
{
    struct ways w = {.count = 0};
    int p, q;

    for (p = 0; p < sides; p++) {
        add_way(&w, p, 1, -1, 0);
        add_way(&w, p, -1, -1, 0);
    }
    for (p = 0; p < sides; p++) {
        for (q = p + 1; q < sides; q++) {
            add_way(&w, p, 1, q, 1);
            add_way(&w, p, -1, q, -1);
            add_way(&w, p, 1, q, -1);
            add_way(&w, p, -1, q, 1);
        }
    }
    return w;
}

/*
 * Compass search: steps along the axes and diagonals, doubled where they lead down and halved where none does. The
 * objective has kinks, so derivatives would not help; at a kink halving still gains a bit a round.
 */
static void compass(struct descent *d)
{
    const int sides = d->r->varpro->model->sides;
    const struct ways ways = all_ways(sides);
    double step = LONGEST;
    int last = 0, i, p;

    while (d->left > 0 && d->objective > 0.0 && step > SHORTEST * (1.0 + fabs(d->at->theta[0]))) {
        int down = 0;

        for (i = 0; i < ways.count && !down; i++) {
            int way = (last + i) % ways.count;
            struct point there = *d->at;

            for (p = 0; p < sides; p++) {
                there.theta[p] += step * ways.to[way][p];
            }
            down = try_at(d, &there);
            last = down ? way : last;
        }
        step = down ? fmin(2.0 * step, LONGEST) : 0.5 * step;
    }
}

double brdffit_l1_linf_descend(struct l1_linf *r, struct point *point)
{
    struct descent d = {.r = r, .at = point, .left = EVALUATIONS};
    struct point smooth = *point;
    struct varpro_value value;

    brdffit_l1_linf_evaluate(r, point, 0, &value);
    d.objective = value.objective;
    /* The smooth objective's optimum nearby is this one's too where the data are exact, and a fair start elsewhere. */
    (void)brdffit_varpro_descend(r->varpro, &smooth);
    (void)try_at(&d, &smooth);
    compass(&d);
    brdffit_l1_linf_evaluate(r, point, 1, &value);
    return value.objective;
}
