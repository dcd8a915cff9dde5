/*
 * Engine `socp`: see bound_socp.h; theory section 3, the paper's Problem 5. SPDX-License-Identifier: MIT
 *
 * For a box of roughness with centre s-, unit columns A of the model at s-, and e_p = |sup |g_p(s) - g_p(s-)|| the
 * deviation of column p of the lobes over the box (sup taken sample by sample), every model of the box obeys
 *
 *     |I - model(s)|  >=  |I - A z| - sum_p e_p sum_k z_kp
 *
 * with z the coefficients in units of the columns at s-. So the second-order cone program
 *
 *     minimise r - sum_p e_p sum_k z_kp   subject to   |I - A z| <= r,  z >= 0
 *
 * bounds the root of the objective from below: this is Problem 5 with s + eps_min for its optimum, asked once for
 * all thresholds. A = Q R turns N rows into n a channel and one constant (the part outside the span): the cone has
 * dimension 2 + K n whatever N is, n the columns of the model.
 *
 * Lobes are taken without the scalar lambda(s) exp(-c_min s), which only rescales y: the cone of models is the same,
 * every b phi(s, c) then falls with s, so that the sup over a box is exactly the larger of the two end differences
 * (with the scalar there is also a peak at s = 1/c, and no bound at all for sigma near 0).
 *
 * ECOS only suggests the dual point; brdffit_socp_certified_bound() makes a proof of it, with limits on z that hold
 * at an optimum of any sigma of the box: z_kp <= |I_k| |g_p(s-)| / |g_p(s_high)|, since the columns are >= 0.
 */
#include "bound/socp/bound_socp.h"

#include <math.h>

#include "base/tolerance.h"
#include "base/vector.h"

/* Rows and columns of the program: r, then a group of n coefficients a channel, one a column of the model. */
static size_t coefficients(size_t channels, const struct model *model)
{
    return channels * (size_t)model->columns;
}

void brdffit_bound_socp_layout(struct bound_socp *e, struct arena *arena, size_t count, size_t channels,
                               const struct model *model)
{
    size_t n = 1 + coefficients(channels, model), rows = 2 * n, entries = 1 + (n - 1) * (size_t)(2 + model->columns), i;

    for (i = 0; i < 3; i++) {
        e->shape[i] = ARENA_DOUBLES(arena, PADDED(count));
    }
    e->ell = ARENA_DOUBLES(arena, PADDED(count));
    e->slope = ARENA_DOUBLES(arena, PADDED(count));
    e->column = brdffit_arena_take(arena, n + 1, sizeof *e->column);
    e->row = brdffit_arena_take(arena, entries, sizeof *e->row);
    e->g = ARENA_DOUBLES(arena, entries);
    e->c = ARENA_DOUBLES(arena, n);
    e->h = ARENA_DOUBLES(arena, rows);
    e->x = ARENA_DOUBLES(arena, n);
    e->z = ARENA_DOUBLES(arena, rows);
    e->lower = ARENA_DOUBLES(arena, n);
    e->upper = ARENA_DOUBLES(arena, n);
}

/*
 * Pattern. Rows: n - 1 linear ones (z >= 0), then the cone: r; R z - t of each channel; the constant. Column 0 is r;
 * column of coefficient j of channel k has its linear row and rows 0 .. j of its channel's triangle.
 */
static void make_pattern(struct bound_socp *e)
{
    size_t group = (size_t)e->varpro->model->columns, n = 1 + coefficients(e->varpro->data->channels, e->varpro->model);
    size_t entry = 0, j, i;

    e->column[0] = 0;
    e->row[entry++] = n - 1;
    e->column[1] = entry;
    for (j = 0; j + 1 < n; j++) {
        size_t first = n + j / group * group;

        e->row[entry++] = j;
        for (i = 0; i <= j % group; i++) {
            e->row[entry++] = first + i;
        }
        e->column[j + 2] = entry;
    }
    e->cone = n + 1;
    e->program.variables = n;
    e->program.linear = n - 1;
    e->program.cones = 1;
    e->program.cone = &e->cone;
    e->program.column = e->column;
    e->program.row = e->row;
}

brdffit_status brdffit_bound_socp_start(struct bound_socp *e, struct varpro *varpro, const struct axis *axis, int cheap)
{
    brdffit_status status;

    e->axis = axis;
    e->varpro = varpro;
    e->cheap = cheap;
    e->evaluated = e->solved = e->refused = e->decided = 0;
    e->solver = NULL;
    make_pattern(e);
    status = brdffit_socp_new(&e->program, &e->solver);
    if (status == BRDFFIT_OK) {
        brdffit_socp_trust_scale(e->solver); /* unit columns; and e_p is as small as it is */
    }
    return status;
}

void brdffit_bound_socp_finish(struct bound_socp *e)
{
    brdffit_socp_free(e->solver);
    e->solver = NULL;
}

/* What the box needs of one column of a lobe. */
struct deviation {
    double size;     /* e_p, in units of the column at the centre */
    double ratio;    /* |g(centre)| / |g(high end)|: how far z may exceed |I_k| */
    double rounding; /* of any column of the box by its exponents, in the same units */
};

/* Shapes of column c at the ends and the centre; u at both ends into `ends`. */
static void fill_shapes(const struct bound_socp *e, int c, const double theta[3], double ends[2])
{
    const struct varpro *v = e->varpro;
    const struct lobe_kind *kind = model_column_kind(v->model, c);
    const struct table *table = varpro_table(v, c);
    double u[3];
    int i;

    for (i = 0; i < 3; i++) {
        kind->variable(&table->sight, theta[i], u);
        kind->shape(v->kernels, &table->sight, v->data->stride, u[0], e->shape[i]);
        if (i != 1) {
            ends[i / 2] = u[0];
        }
    }
    if (!kind->exponential) {
        kind->slopes(v->kernels, &table->sight, v->data->stride, ends[0], e->ell, e->slope);
    }
}

static struct deviation deviation(const struct bound_socp *e, int c, double low, double centre, double high)
{
    const double theta[3] = {low, centre, high};
    const struct table *table = varpro_table(e->varpro, c);
    const double *at_low = e->shape[0], *at_centre = e->shape[1], *at_high = e->shape[2];
    const double *x = model_column_kind(e->varpro->model, c)->exponential ? table->c : e->ell;
    /* With masking phi may be above 1. */
    double most_steep = model_column_kind(e->varpro->model, c)->smith ? INFINITY : 1.0;
    double sum = 0.0, norm2 = 0.0, least2 = 0.0, slope2 = 0.0, u[2];
    struct deviation d;
    size_t j;

    fill_shapes(e, c, theta, u);
    for (j = 0; j < e->varpro->data->distinct; j++) {
        double most = fmax(at_low[j] - at_centre[j], at_centre[j] - at_high[j]);
        /* Largest |d phi / d ln u| = |ell| u phi of the box: x exp(-x) < 1, and 2 x / (1 + x)^3 < 1 besides. It turns
         * relative errors of c' u into errors of phi. */
        double steep = fmin(most_steep, x[j] * u[1] * at_low[j]);

        slope2 += table->bb[j] * (steep * steep);
        sum += table->bb[j] * (most * most);
        norm2 += table->bb[j] * (at_centre[j] * at_centre[j]);
        least2 += table->bb[j] * (at_high[j] * at_high[j]);
    }
    d.size = norm2 > 0.0 ? (1.0 + TOL_CURVATURE) * sqrt(sum / norm2) : 0.0;
    d.rounding = norm2 > 0.0 ? (8.0 * TOL_UNIT + 2.0 * table->snapped) * sqrt(slope2 / norm2) : 0.0;
    d.ratio = least2 > 0.0 ? (1.0 + TOL_CURVATURE) * sqrt(norm2 / least2) : 1.0;
    return d;
}

/* A box at its centre: the exact restricted problem, and what can be said without a cone program. */
struct view {
    struct point centre;
    struct deviation column[MOVING_MOST];
    double root;     /* root of the objective at the centre */
    double left;     /* the objective's optimum there is not below this, whatever an active set left of it */
    double paid;     /* sum_p e_p sum_k z_kp at its optimum: feasible slack of Problem 5 */
    double at_most;  /* the same at the limits of z: no optimum of the box can gain more */
    double rounding; /* of columns, triangle, data and their reduction to rows: absolute, of the root */
    struct doubt doubt; /* of the geometry */
};

/* How far an active set may have stopped above the optimum: no z exceeds |I|, there nor here (theory 2). */
static double left_of_optimum(const struct varpro *v, const struct varpro_value *value)
{
    return v->model->columns > NNLS_CLOSED ? 4.0 * v->model->columns * value->kkt * v->data->total : 0.0;
}

static void open_view(struct bound_socp *e, const struct box *box, struct view *view)
{
    struct varpro *v = e->varpro;
    struct varpro_value value;
    double limits = 0.0, low[SIDES_MOST], high[SIDES_MOST];
    int c, p, F = v->model->fixed, moving = varpro_moving(v);
    size_t k;

    view->paid = view->at_most = view->rounding = 0.0;
    for (p = 0; p < v->model->lobes; p++) {
        brdffit_axis_ends(&e->axis[v->model->lobe[p].kind], box->interval[p], &low[p], &high[p]);
        view->centre.theta[p] = 0.5 * (low[p] + high[p]);
    }
    for (c = 0; c < moving; c++) {
        p = model_lobe_of(v->model, c);
        view->column[c] = deviation(e, c, low[p], view->centre.theta[p], high[p]);
    }
    view->doubt = brdffit_charge_box(v->data, v->model, low, high);
    brdffit_varpro_evaluate(v, &view->centre, 0, &value);
    e->evaluated++;
    view->root = sqrt(value.objective);
    view->left = value.objective - left_of_optimum(v, &value);
    for (k = 0; k < v->data->channels; k++) {
        double norm = sqrt(v->data->ii[k]);

        limits += F * norm;
        for (c = 0; c < moving; c++) {
            const struct deviation *d = &view->column[c];

            view->rounding += norm * d->ratio * d->rounding;
            view->paid += d->size * v->answer[k].unit[F + c] * v->answer[k].data_scale;
            view->at_most += d->size * norm * d->ratio;
            limits += norm * d->ratio;
        }
    }
    view->rounding += 8.0 * TOL_UNIT * ((double)v->data->used + TOL_GAIN) * limits;
}

/* Channel k's part of the right-hand side: what the optimum at the centre leaves of the data within the span of the
 * columns, and its square outside. */
static double project(struct bound_socp *e, size_t k, double *left)
{
    const struct varpro *v = e->varpro;
    const struct nnls_answer *answer = &v->answer[k];
    const double *value = v->data->row_value + k * v->data->used;
    int group = v->model->columns, i, j;
    size_t r;

    for (r = 0; r < v->data->rows; r++) {
        v->residual[r] = value[r];
    }
    for (i = 0; i < group; i++) {
        double t = v->kernels->dot(v->nnls.q[i], v->residual, v->data->rows);

        left[i] = t;
        for (j = i; j < group; j++) {
            left[i] -= v->nnls.r[i][j] * (answer->unit[j] * answer->data_scale);
        }
        for (r = 0; r < v->data->rows; r++) {
            v->residual[r] -= t * v->nnls.q[i][r];
        }
    }
    return v->kernels->dot(v->residual, v->residual, v->data->rows);
}

/*
 * The numbers of the program; the factorisation at the centre is in varpro->nnls. The unknowns are r and z less the
 * restricted optimum at the centre: what ECOS then sees is of the size of the residual and not of the data, and so
 * are its errors.
 */
static void fill_program(struct bound_socp *e, const struct view *view)
{
    const struct varpro *v = e->varpro;
    const struct reduced *data = v->data;
    size_t group = (size_t)v->model->columns, F = (size_t)v->model->fixed, n = e->program.variables, entry = 0, i, j, k;
    double outside = 0.0, reach = sqrt(data->total);

    e->g[entry++] = -1.0;
    e->c[0] = 1.0;
    for (j = 0; j + 1 < n; j++) {
        const struct nnls_answer *answer = &v->answer[j / group];
        double norm = sqrt(data->ii[j / group]), z = answer->unit[j % group] * answer->data_scale;
        double most = j % group >= F ? norm * view->column[j % group - F].ratio : norm;

        e->g[entry++] = -1.0;
        for (i = 0; i <= j % group; i++) {
            e->g[entry++] = v->nnls.r[i][j % group];
        }
        e->h[j] = z;
        e->c[1 + j] = j % group >= F ? -view->column[j % group - F].size : 0.0;
        e->lower[1 + j] = -z;
        e->upper[1 + j] = fmax(0.0, most - z);
        reach += most + z;
    }
    e->h[n - 1] = 0.0;
    for (k = 0; k < data->channels; k++) {
        outside += project(e, k, e->h + n + k * group);
    }
    e->h[2 * n - 1] = sqrt(outside);
    e->lower[0] = 0.0;
    e->upper[0] = 2.0 * reach;
}

/* Lower bound of the objective from one of its root. */
static double squared(const struct bound_socp *e, const struct view *view, double root)
{
    return brdffit_charge_pay(e->varpro->data, &view->doubt, (1.0 - TOL_CURVATURE) * root * root);
}

/*
 * Whether the solver's word did not become a proof: it failed, or was not sure, or claims an optimum that would close
 * the box. (A program without a finite optimum is a wide box's answer: nothing to discard.)
 */
static int is_refused(const struct bound_socp *e, const struct view *view, const struct socp_result *result,
                      double target)
{
    return (result->outcome != SOCP_OPTIMAL && result->outcome != SOCP_DUAL_INFEASIBLE) ||
           (result->primal > view->paid && squared(e, view, result->primal - view->paid) >= target);
}

/* Root of the objective, from below, proven; 0 when there is no certificate. */
static double solve(struct bound_socp *e, const struct view *view, double target)
{
    struct conic_data data;
    struct socp_result result;
    double bound;

    fill_program(e, view);
    data.g = e->g;
    data.c = e->c;
    data.h = e->h;
    e->solved++;
    if (brdffit_socp_solve(e->solver, &data, e->x, e->z, &result) != BRDFFIT_OK) {
        e->refused++;
        return 0.0;
    }
    bound = brdffit_socp_certified_bound(&e->program, &data, e->lower, e->upper, e->z) - view->paid - view->rounding;
    bound = bound > 0.0 ? bound : 0.0;
    if (!(squared(e, view, bound) >= target)) {
        e->refused += is_refused(e, view, &result, target) ? 1 : 0;
    }
    return bound;
}

double brdffit_bound_socp(struct bound_socp *e, struct box *box, struct point *met)
{
    double target = box->bound, root, largest;
    struct view view;
    int c;

    open_view(e, box, &view);
    *met = view.centre;
    box->split = 0;
    largest = view.column[0].size;
    for (c = 1; c < varpro_moving(e->varpro); c++) {
        if (view.column[c].size > largest) {
            largest = view.column[c].size;
            box->split = (uint32_t)model_lobe_of(e->varpro->model, c);
        }
    }
    root = view.left > 0.0 ? fmax(0.0, fmin(view.root, sqrt(view.left)) - view.at_most - view.rounding) : 0.0;
    if (e->cheap && (squared(e, &view, root) >= target || view.root - view.paid <= sqrt(target))) {
        e->decided++; /* proven by the triangle inequality, or no program could prove it */
    } else {
        root = fmax(root, solve(e, &view, target));
    }
    box->bound = squared(e, &view, root);
    return view.root * view.root;
}
