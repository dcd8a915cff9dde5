/*
 * The published model: see published.h. SPDX-License-Identifier: MIT
 *
 * The search knows a lobe by theta = ln s and by coefficients of unit columns. What a caller gets is sigma, x and y in
 * doubles. The objective of a result is that of these numbers: residuals of the rows at s = 1 / sigma^2 and at x and y
 * brought back to internal units, so that whoever evaluates the model finds the same.
 *
 * y = z / (|g| lambda(s) phi(s, c_min)) is formed with an exponent of its own (wide.h): phi(s, c_min) may be far below
 * the smallest double where y is an ordinary number. A coefficient that no double holds with all its digits is published
 * as the nearest one, and the objective says what that costs.
 *
 * Error. A row's residual I - a x - sum y g is off by at most
 *
 *     d = u [TOL_PUBLISHED (|I| + a x + sum y |g|) + TOL_PUBLISHED_EXPONENT sum (c' s) y |g|] + snapped sum (c' s) y |g|
 *
 * and by what triangles did to it, so that a channel's |r| is off by at most |d| in the same norm (Minkowski), and
 * E^2 = sum |r|^2 by at most sum 2 |r| |d| + |d|^2. Sums of norms l1 and linf are compensated, their own rounding is within
 * TOL_PUBLISHED; of l2, d is taken by norms. What directions make of sharp lobes, and what samples may
 * hide of a lobe, is added (charge.h).
 */
#include "fit/published.h"

#include <float.h>
#include <math.h>

#include "base/log.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "data/reduce_parts.h"
#include "data/sums.h"

/* Each lobe's s, what coefficients are divided by in internal units, and what is known of the lobes' columns. */
struct scales {
    struct twofold s[BRDFFIT_MAX_LOBES];
    struct wide factor[COLUMNS_MOST];
    double norm[MOVING_MOST], error[MOVING_MOST]; /* norm l2 only */
};

static void open_scales(const struct fit *f, const double *sigma, struct scales *v)
{
    int c, p, F = f->model.fixed;

    for (p = 0; p < f->model.lobes; p++) {
        v->s[p] = twofold_inverse_square(sigma[p]);
    }
    for (c = 0; c < F; c++) {
        v->factor[c] = wide_of(f->data.scale_a[c]);
    }
    for (c = 0; c < varpro_moving(&f->varpro); c++) {
        const struct table *t = varpro_table(&f->varpro, c);

        p = model_lobe_of(&f->model, c);
        v->factor[F + c] = brdffit_lobe_divisor(model_kind(&f->model, p), v->s[p], &t->sight);
        v->factor[F + c] = wide_times(v->factor[F + c], wide_of(t->scale_b));
        if (f->model.turned && p == 0) {
            double lambda = brdffit_turn_lambda(model_kind(&f->model, p), f->model.stretch.ratio, v->s[p].high);

            v->factor[F + c] = wide_times(v->factor[F + c], wide_of(lambda));
        }
    }
}

/* What values of channel k are divided by. */
static struct wide unit_of(const struct fit *f, size_t k)
{
    return wide_times(wide_of(f->data.channel_scale[k]), wide_of(f->data.value_scale));
}

/* The coefficient of column j of the vector form, divided by `factor`, in the data's units. */
static double in_data_units(const struct fit *f, const struct nnls_answer *answer, size_t k, int j, struct wide factor)
{
    const struct nnls *nnls = &f->varpro.nnls;
    struct wide z;

    if (!(answer->unit[j] > 0.0) || !(factor.value > 0.0)) {
        return 0.0;
    }
    z = wide_times(wide_times(wide_of(answer->unit[j]), wide_of(answer->data_scale)), unit_of(f, k));
    z = wide_over(wide_over(wide_over(z, wide_of(nnls->norm[j])), wide_of(nnls->scale[j])), factor);
    return fmin(wide_value(z), DBL_MAX);
}

/* And back. */
static double in_internal_units(const struct fit *f, double coefficient, size_t k, struct wide factor)
{
    return wide_value(wide_over(wide_times(wide_of(coefficient), factor), unit_of(f, k)));
}

/* y and F0 of a lobe from its two coefficients, as a caller puts them together again: y F0 and y (1 - F0). */
static void split_fresnel(double *z, double *y, double *f0)
{
    double sum = z[0] + z[1];

    sum = fmin(sum, DBL_MAX);
    *y = sum;
    *f0 = sum > 0.0 ? fmin(1.0, z[0] / sum) : 0.0;
    z[0] = *y * *f0;
    z[1] = *y * (1.0 - *f0);
}

/* Sums of at most 10 terms, a product each, are within this of it: below 1 by as much, nothing exceeds 1 in any order. */
#define PHYSICAL_MOST (1.0 - 16.0 * TOL_UNIT)

/* x and reflectances of channel k, together. */
static double reflected(const struct fit *f, size_t k)
{
    size_t lobes = (size_t)f->model.lobes, F = (size_t)f->model.fixed, p, c;
    double sum = f->x[k];

    for (c = 1; c < F; c++) {
        sum += f->x_more[k * (F - 1) + c - 1];
    }
    for (p = 0; p < lobes; p++) {
        sum += model_kind(&f->model, (int)p)->reflectance * f->y[k * lobes + p];
    }
    return sum;
}

int brdffit_fit_is_physical(const struct fit *f)
{
    int fine = 1;
    size_t k;

    for (k = 0; k < f->data.channels; k++) {
        fine = fine && reflected(f, k) <= PHYSICAL_MOST;
    }
    return fine;
}

/* The coefficients of channel k that f->z has, as a caller sees them; z becomes what they stand for. */
static void hand_out(struct fit *f, size_t k, double *z)
{
    size_t lobes = (size_t)f->model.lobes, F = (size_t)f->model.fixed, p, c;

    f->x[k] = z[0];
    for (c = 1; c < F; c++) {
        f->x_more[k * (F - 1) + c - 1] = z[c];
    }
    for (p = 0; p < lobes; p++) {
        double *own = z + f->model.lobe[p].column;

        f->y[k * lobes + p] = own[0];
        if (f->f0) {
            split_fresnel(own, &f->y[k * lobes + p], &f->f0[k * lobes + p]);
        }
    }
}

/* What rounding has put beyond physical bounds goes back. */
static void make_physical(struct fit *f, size_t k, double *z)
{
    double sum = reflected(f, k);
    int c;

    if (sum > PHYSICAL_MOST) {
        for (c = 0; c < f->model.columns; c++) {
            z[c] *= (1.0 - 8.0 * TOL_UNIT) * PHYSICAL_MOST / sum;
        }
        hand_out(f, k, z);
    }
}

/* The model in the data's units, and f->z: the coefficient of each column that it stands for. */
static void coefficients(struct fit *f, const struct scales *v)
{
    size_t k, n = (size_t)f->model.columns, c;

    for (k = 0; k < f->data.channels; k++) {
        double *z = f->z + k * n;

        for (c = 0; c < n; c++) {
            z[c] = in_data_units(f, &f->varpro.answer[k], k, (int)c, v->factor[c]);
        }
        hand_out(f, k, z);
        if (f->physical) {
            make_physical(f, k, z);
        }
    }
}

/* Sums over the rows of one channel, of data divided by its data_scale. */
struct channel_sums {
    struct sums_pair objective, error, squares;
    double largest, largest_error;
};

static void add_row(const struct fit *f, size_t r, double residual, double rounding, struct channel_sums *sums)
{
    sums_add(&sums->objective, fabs(residual));
    sums_add(&sums->error, rounding);
    sums_add(&sums->squares, residual * f->data.row_square[r] * residual);
    sums->largest = fmax(sums->largest, fabs(residual));
    sums->largest_error = fmax(sums->largest_error, rounding);
}

/* How far the shape of column c of the lobes at a row may be off, but for TOL_PUBLISHED, relative to it. */
static double shape_error(const struct fit *f, const struct scales *v, int c, size_t r)
{
    const struct table *t = varpro_table(&f->varpro, c);
    double exponent =
        t->c[f->data.row_c[r]] *
        v->s[model_lobe_of(&f->model, c)].high; /* -d ln phi / d ln s, of which no other kind has more than 2 */

    exponent = model_column_kind(&f->model, c)->steep ? fmin(1e30, exponent) : fmin(2.0, 2.0 * exponent);
    return (TOL_PUBLISHED_EXPONENT * TOL_UNIT + t->snapped) * exponent + (t->masked ? TOL_MASKING * TOL_UNIT : 0.0);
}

/* A fixed column of the rows. */
static const double *fixed_column(const struct fit *f, int c)
{
    return f->data.row_a + (size_t)c * f->data.used;
}

/* Residuals of channel k at internal coefficients z, in units of `scale`: norms l1 and linf. */
static struct channel_sums residuals(const struct fit *f, const struct scales *v, size_t k, const double *z,
                                     double scale)
{
    const struct reduced *data = &f->data;
    const double *value = data->row_value + k * data->used;
    struct channel_sums sums = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, 0.0, 0.0};
    int c, F = f->model.fixed;
    size_t r;

    for (r = 0; r < data->rows; r++) {
        double residual = value[r], size = fabs(value[r]), steep = 0.0;

        for (c = 0; c < f->model.columns; c++) {
            double part = z[c] * (c < F ? fixed_column(f, c)[r] : f->varpro.column[c - F][r]);

            residual -= part;
            size += fabs(part);
            steep += c >= F && part != 0.0 ? fabs(part) * shape_error(f, v, c - F, r) : 0.0;
        }
        add_row(f, r, residual / scale, (TOL_PUBLISHED * TOL_UNIT * size + steep) / scale, &sums);
    }
    return sums;
}

/*
 * What sums over the groups say of column p of the lobes: its norm and how far it may be off by its exponents, both l2, and
 * N_eff = (sum g^2)^2 / sum g^4 over samples.
 */
static double measure_column(const struct fit *f, struct scales *v, int p)
{
    const struct table *t = varpro_table(&f->varpro, p);
    int exponential = model_column_kind(&f->model, p)->steep;
    double h = 0.0, off = 0.0, fourth = 0.0, s = v->s[model_lobe_of(&f->model, p)].high;
    size_t j;

    for (j = 0; j < f->data.distinct; j++) {
        double square = t->bb[j] * (f->varpro.phi[j] * f->varpro.phi[j]);
        /* -d ln phi / d ln s, of which no other kind has more than 2 */
        double exponent = exponential ? smaller(1e30, t->c[j] * s) : smaller(2.0, 2.0 * t->c[j] * s);

        h += square;
        off += square * (exponent * exponent);
    }
    for (j = 0; j < f->data.distinct && h > 0.0; j++) {
        double share = t->bb[j] * (f->varpro.phi[j] * f->varpro.phi[j]) / h;

        fourth += share * share * t->concentration[j];
    }
    v->norm[p] = sqrt(h) * (1.0 + TOL_CURVATURE);
    v->error[p] = (TOL_PUBLISHED_EXPONENT * TOL_UNIT + t->snapped) * sqrt(off) * (1.0 + TOL_CURVATURE);
    v->error[p] += t->masked ? TOL_MASKING * TOL_UNIT * v->norm[p] : 0.0;
    return fourth > 0.0 ? 1.0 / fourth : 0.0;
}

/* Columns b phi of each lobe, into varpro's. A lobe rests on what its first column does. */
static void columns(struct fit *f, struct scales *v, struct published *out)
{
    size_t r;
    int c;

    for (c = 0; c < varpro_moving(&f->varpro); c++) {
        const struct lobe_kind *kind = model_column_kind(&f->model, c);
        const struct table *t = varpro_table(&f->varpro, c);
        int p = model_lobe_of(&f->model, c);
        double effective;

        kind->shape(f->varpro.kernels, &t->sight, f->data.stride, kind->argument(&t->sight, v->s[p].high),
                    f->varpro.phi);
        for (r = 0; r < f->data.rows; r++) {
            f->varpro.column[c][r] = t->row_b[r] * f->varpro.phi[f->data.row_c[r]];
        }
        effective = measure_column(f, v, c);
        out->effective[p] = c % f->model.each == 0 ? effective : out->effective[p];
    }
}

/*
 * The same of norm l2 in lanes, with the error of a whole channel from norms: |d| <= the sum of the norms of its parts.
 * Sums of squares in lanes are within (rows / 8 + 16) u.
 */
static struct channel_sums residuals_l2(const struct fit *f, const struct scales *v, size_t k, const double *z,
                                        double scale)
{
    const struct varpro *w = &f->varpro;
    const struct kernels *kernels = w->kernels;
    size_t n = f->data.rows;
    double size = sqrt(f->data.ii[k]), steep = 0.0, sum, error;
    struct channel_sums sums = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, 0.0, 0.0};
    int c, F = f->model.fixed;

    kernels->scale(w->residual, f->data.row_value + k * f->data.used, 1.0 / scale, n);
    for (c = 0; c < F; c++) {
        kernels->subtract(w->residual, fixed_column(f, c), z[c], 1.0 / scale, n);
        size += z[c] * sqrt(f->data.aa[c][c]);
    }
    for (; c < f->model.columns; c++) {
        kernels->subtract(w->residual, w->column[c - F], z[c], 1.0 / scale, n);
        size += z[c] * v->norm[c - F];
        steep += z[c] > 0.0 ? z[c] * v->error[c - F] : 0.0;
    }
    sum = kernels->dot(w->residual, w->residual, n);
    error = (TOL_PUBLISHED * TOL_UNIT * size + steep) / scale * (1.0 + TOL_CURVATURE) +
            ((double)(n / LANES) + 16.0) * TOL_UNIT * sqrt(sum);
    sums.objective.high = sums.squares.high = sum;
    sums.error.high = error * error;
    return sums;
}

/* What the errors of the fixed columns make of a channel's residuals, in the norm of the fit. */
static double fixed_error(const struct fit *f, const double *z)
{
    double sum = 0.0;
    int c;

    for (c = 0; c < f->model.fixed; c++) {
        sum += z[c] * f->data.off_norm[c];
    }
    return sum;
}

/* One channel's part of the objective and its error. `more`: absolute, of the residuals' norm, beside what the sums have. */
static void add_channel(const struct fit *f, const struct channel_sums *sums, double scale, double more,
                        struct published *out)
{
    double objective = sums_value(&sums->objective), error = sums_value(&sums->error);

    if (f->norm == BRDFFIT_NORM_L2) {
        error = sqrt(error) + more / scale;
        out->objective += objective * (scale * scale);
        out->error += (2.0 * sqrt(objective) * error + error * error) * (scale * scale);
    } else if (f->norm == BRDFFIT_NORM_L1) {
        out->objective += objective * scale;
        out->error += error * scale + more;
    } else {
        out->objective = fmax(out->objective, sums->largest * scale);
        out->error = fmax(out->error, sums->largest_error * scale + more);
    }
    out->squares += sums_value(&sums->squares) * (scale * scale);
}

double brdffit_fit_triangle_error(const struct reduced *r)
{
    size_t g, largest = 0, width = r->channels + (size_t)(r->fixed + r->geometries);

    if (r->rows >= r->used) {
        return 0.0;
    }
    for (g = 0; g < r->groups; g++) {
        size_t size = r->begin[g + 1] - r->begin[g];

        largest = size > largest ? size : largest;
    }
    return 3.0 * TOL_TRIANGLE * TOL_UNIT * (double)(largest / REDUCE_BLOCK + 1) *
           (double)((REDUCE_BLOCK + width) * width);
}

/* What the rounding of directions makes of an objective at a point: of sharp lobes, and of hidden ones. */
static double geometry_error(const struct fit *f, const double *theta, double objective)
{
    double error = brdffit_charge_point(&f->data, &f->model, theta);

    return !(error > 0.0) ? 0.0 : f->norm == BRDFFIT_NORM_L2 ? (2.0 * sqrt(objective) + error) * error : error;
}

struct published brdffit_fit_publish(struct fit *f, const double *sigma)
{
    struct published out = {.objective = 0.0};
    double theta[BRDFFIT_MAX_LOBES];
    size_t k, n = (size_t)f->model.columns, c;
    struct scales v;
    int p;

    open_scales(f, sigma, &v);
    coefficients(f, &v);
    columns(f, &v, &out);
    for (k = 0; k < f->data.channels; k++) {
        double scale = f->varpro.answer[k].data_scale, z[COLUMNS_MOST];
        struct channel_sums sums;

        for (c = 0; c < n; c++) {
            z[c] = in_internal_units(f, f->z[k * n + c], k, v.factor[c]);
        }
        sums = f->norm == BRDFFIT_NORM_L2 ? residuals_l2(f, &v, k, z, scale) : residuals(f, &v, k, z, scale);
        add_channel(f, &sums, scale, f->triangle_error * sqrt(f->data.ii[k]) + fixed_error(f, z), &out);
        f->rms[k] = scale * sqrt(sums_value(&sums.squares) / f->data.weight_sum) * f->data.value_scale *
                    f->data.channel_scale[k];
    }
    out.error += f->rows_error * f->data.total + 4.0 * (double)f->data.channels * TOL_UNIT * out.objective;
    for (p = 0; p < f->model.lobes; p++) {
        theta[p] = kernel_log(v.s[p].high);
    }
    out.error += geometry_error(f, theta, out.objective);
    return out;
}

double brdffit_fit_allowance(const struct fit *f, const struct point *at, double objective)
{
    double unit = (TOL_PUBLISHED + (f->data.table[0].masked ? TOL_MASKING : 0.0) + (f->physical ? TOL_PHYSICAL : 0.0)) *
                  TOL_UNIT,
           total = f->data.total, geometry;
    int c;

    for (c = 0; c < f->model.fixed; c++) {
        unit += f->data.off_share[c];
    }
    geometry = geometry_error(f, at->theta, objective) * (1.0 + TOL_ALLOWANCE);
    if (f->norm != BRDFFIT_NORM_L2) {
        return 4.0 * unit * total + geometry;
    }
    unit = 2.0 * (2.0 * unit + f->triangle_error);
    return 2.0 * unit * sqrt(objective) * sqrt(total) + unit * unit * total + f->rows_error * total + geometry +
           (16.0 + 8.0 * (double)f->data.channels) * TOL_UNIT * objective;
}
