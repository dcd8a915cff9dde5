/*
 * Bounds by linear programs: see bound_lp.h; theory section 3. SPDX-License-Identifier: MIT
 *
 * Every model of a box has columns of lobes between two that are linear in one parameter (bound_lp_lobe.c), so a channel's
 * objective is at least the optimum of lp.h with the fixed columns, and two for each column of a lobe. That overshoots the centre by the
 * square of the box's width, where the triangle inequality with the deviation from the centre costs its first power.
 * Channels add up in l1; in linf the largest counts.
 */
#include "bound/lp/bound_lp.h"

#include <math.h>

#include "bound/lp/bound_lp_lobe.h"
#include "base/tolerance.h"
#include "base/vector.h"

void brdffit_bound_lp_layout(struct bound_lp *e, struct arena *arena, size_t count, size_t channels,
                             const struct model *model, brdffit_norm norm)
{
    int p, end;
    int moving = model->columns - model->fixed;

    brdffit_lp_layout(&e->lp, arena, count, (size_t)(model->fixed + 2 * moving), norm);
    for (p = 0; p < 3; p++) {
        e->phi[p] = ARENA_DOUBLES(arena, PADDED(count));
    }
    for (p = 0; p < moving; p++) {
        for (end = 0; end < 2; end++) {
            e->lobe[p].upper[end] = ARENA_DOUBLES(arena, count);
            e->lobe[p].lower[end] = ARENA_DOUBLES(arena, count);
        }
    }
    e->x = ARENA_DOUBLES(arena, PADDED(count));
    e->slope = ARENA_DOUBLES(arena, PADDED(count));
    e->data = ARENA_DOUBLES(arena, count);
    e->relaxed = ARENA_DOUBLES(arena, channels);
    e->no_lobe = ARENA_DOUBLES(arena, channels);
}

static double accumulate(const struct bound_lp *e, double sum, double value)
{
    return e->lp.norm == BRDFFIT_NORM_L1 ? sum + value : fmax(sum, value);
}

brdffit_status brdffit_bound_lp_start(struct bound_lp *e, struct l1_linf *restricted, const struct axis *axis,
                                      int cheap)
{
    const struct reduced *data = restricted->varpro->data;
    size_t k, i;

    e->axis = axis;
    e->restricted = restricted;
    e->cheap = cheap;
    e->decided = 0;
    for (k = 0; k < data->channels; k++) {
        e->no_lobe[k] = 0.0;
        for (i = 0; i < data->rows; i++) {
            e->no_lobe[k] = accumulate(e, e->no_lobe[k], fabs(data->row_value[k * data->used + i]));
        }
    }
    return brdffit_lp_start(&e->lp, data->rows);
}

void brdffit_bound_lp_finish(struct bound_lp *e)
{
    brdffit_lp_finish(&e->lp);
}

/* The program of channel k, in units of answer->data_scale. Limits: the norm of an optimum's model is at most twice
 * the data's, and so is that of each of its columns, which are >= 0. */
static void open_channel(struct bound_lp *e, size_t k, double data_scale, struct lp_data *program)
{
    const struct reduced *data = e->restricted->varpro->data;
    double most = 2.0 * (1.0 + TOL_CURVATURE) * e->no_lobe[k] / data_scale;
    int c, end, F = data->fixed;
    size_t i;

    for (i = 0; i < data->rows; i++) {
        e->data[i] = data->row_value[k * data->used + i] / data_scale;
    }
    program->data = e->data;
    for (c = 0; c < F; c++) {
        const double *column = data->row_a + (size_t)c * data->used;
        double a = 0.0;

        for (i = 0; i < data->rows; i++) {
            a = accumulate(e, a, column[i]);
        }
        program->upper[c] = program->lower[c] = column;
        program->limit[c] = a > 0.0 ? most / a : 0.0;
    }
    for (c = 0; c < varpro_moving(e->restricted->varpro); c++) {
        const struct bound_lp_lobe *lobe = &e->lobe[c];

        for (end = 0; end < 2; end++) {
            program->upper[F + 2 * c + end] = lobe->upper[end];
            program->lower[F + 2 * c + end] = lobe->lower[end];
            program->limit[F + 2 * c + end] = lobe->least > 0.0 ? most / lobe->least * lobe->scale[end] : 0.0;
        }
    }
}

/* Objective of the program at the coefficients of the centre: no bound of this channel can be better. */
static double relaxed_of(const struct bound_lp *e, const struct nnls_answer *answer, const struct lp_data *program)
{
    const struct varpro *v = e->restricted->varpro;
    double z[LP_COLUMNS], sum = 0.0;
    int c, F = v->model->fixed;
    size_t i, j;

    for (c = 0; c < v->model->columns; c++) {
        double unit = answer->unit[c], y = unit > 0.0 ? unit / v->nnls.norm[c] / v->nnls.scale[c] : 0.0;

        if (c < F) {
            z[c] = y;
        } else {
            const struct bound_lp_lobe *lobe = &e->lobe[c - F];

            y /= lobe->tilt;
            z[F + 2 * (c - F)] = y * (1.0 - lobe->place) * lobe->scale[0];
            z[F + 2 * (c - F) + 1] = y * lobe->place * lobe->scale[1];
        }
    }
    for (i = 0; i < v->data->rows; i++) {
        double high = 0.0, low = 0.0;

        for (j = 0; j < e->lp.columns; j++) {
            high += program->upper[j][i] * z[j];
            low += program->lower[j][i] * z[j];
        }
        sum = accumulate(e, sum, fmax(0.0, fmax(e->data[i] - high, low - e->data[i])));
    }
    return sum;
}

/* Bound of the whole, channel by channel, the most promising first in linf; stops once it reaches `target`. */
static double solve(struct bound_lp *e, double target)
{
    const struct varpro *v = e->restricted->varpro;
    size_t channels = v->data->channels, turn, k, next = 0;
    double bound = 0.0;

    for (turn = 0; turn < channels && !(bound >= target); turn++) {
        struct lp_data program;
        double z[LP_COLUMNS], scale;

        for (k = 0; k < channels; k++) {
            next = e->relaxed[k] > e->relaxed[next] || e->relaxed[next] < 0.0 ? k : next;
        }
        if (e->lp.norm == BRDFFIT_NORM_LINF && e->relaxed[next] <= bound) {
            break;
        }
        if (e->relaxed[next] > 0.0) {
            scale = v->answer[next].data_scale;
            open_channel(e, next, scale, &program);
            bound = accumulate(e, bound, (1.0 - TOL_CURVATURE) * brdffit_lp_bound(&e->lp, &program, z) * scale);
        }
        e->relaxed[next] = -1.0; /* done */
    }
    return bound;
}

double brdffit_bound_lp(struct bound_lp *e, struct box *box, struct point *met)
{
    const struct varpro *v = e->restricted->varpro;
    double target = box->bound, reachable = 0.0, low[SIDES_MOST], high[SIDES_MOST], charged, change;
    struct varpro_value value;
    struct doubt doubt;
    struct lp_data program;
    size_t k;
    int c, p;

    for (p = 0; p < v->model->lobes; p++) {
        brdffit_axis_ends(&e->axis[v->model->lobe[p].kind], box->interval[p], &low[p], &high[p]);
        met->theta[p] = 0.5 * (low[p] + high[p]);
    }
    for (c = 0; c < varpro_moving(v); c++) {
        p = model_lobe_of(v->model, c);
        brdffit_bound_lp_lobe(e, c, low[p], met->theta[p], high[p]);
    }
    doubt = brdffit_charge_box(v->data, v->model, low, high);
    charged = target + (doubt.error + doubt.hidden) * v->data->table[0].charge.root * (1.0 + 16.0 * TOL_UNIT);
    charged *= 1.0 + 16.0 * TOL_UNIT; /* what pays for the target */
    box->split = 0;
    change = e->lobe[0].change;
    for (c = 1; c < varpro_moving(v); c++) {
        if (e->lobe[c].change > change) {
            change = e->lobe[c].change;
            box->split = (uint32_t)model_lobe_of(v->model, c);
        }
    }
    brdffit_l1_linf_evaluate(e->restricted, met, 0, &value);
    for (k = 0; k < v->data->channels; k++) {
        open_channel(e, k, v->answer[k].data_scale, &program);
        e->relaxed[k] = relaxed_of(e, &v->answer[k], &program) * v->answer[k].data_scale;
        reachable = accumulate(e, reachable, e->relaxed[k]);
    }
    box->bound = 0.0;
    if (e->cheap && isfinite(target) && reachable <= target) {
        e->decided++; /* no program could close it */
    } else {
        box->bound = brdffit_charge_pay(v->data, &doubt, solve(e, charged));
    }
    return value.objective;
}
