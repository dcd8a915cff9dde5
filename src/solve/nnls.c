/*
 * Restricted problem, dense form: see nnls.h. SPDX-License-Identifier: MIT
 *
 * Columns are scaled to unit norm (a power of two first, so that squares neither overflow nor vanish) and
 * orthogonalised by Gram-Schmidt with one re-orthogonalisation, which makes Q orthogonal to rounding
 * ("twice is enough"). With t = Q'data every support S is a least-squares problem in the columns of the
 * little triangle R, and the optimum over z >= 0 is the feasible support that leaves least of t: the optimal
 * support is feasible, and any feasible z is an upper bound. A support with a column that depends
 * on the others to rounding is left out: the same cone is spanned without it.
 */
#include "solve/nnls.h"

#include <math.h>

#include "base/tolerance.h"
#include "solve/nnls_parts.h"
#include "base/vector.h"

/* Remove the part of q_j along earlier q, twice; what remains, normalised, is q_j. */
static void orthogonalise(struct nnls *nnls, int j)
{
    double *q = nnls->q[j];
    double rest;
    int pass, i;

    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < j; i++) {
            double part = nnls->kernels->dot(nnls->q[i], q, nnls->rows);

            nnls->kernels->subtract(q, nnls->q[i], 1.0, part, nnls->rows);
            nnls->r[i][j] += part;
        }
    }
    rest = sqrt(nnls->kernels->dot(q, q, nnls->rows));
    if (!(rest > TOL_DEPENDENT)) {
        rest = 0.0;
    }
    nnls->r[j][j] = rest;
    nnls->kernels->scale(q, q, rest > 0.0 ? 1.0 / rest : 0.0, nnls->rows);
}

static void factor_supports(struct nnls *nnls)
{
    unsigned bits;

    nnls->support[0].count = 0;
    for (bits = 1; nnls->columns <= NNLS_CLOSED && bits < 1u << nnls->columns; bits++) {
        brdffit_nnls_support_factor(nnls, bits, &nnls->support[bits]);
    }
}

void brdffit_nnls_factor(struct nnls *nnls, const struct kernels *kernels, size_t rows, int columns,
                         const double *const *column, double *q)
{
    int i, j;

    nnls->kernels = kernels;
    nnls->rows = rows;
    nnls->columns = columns;
    for (j = 0; j < columns; j++) {
        nnls->column[j] = column[j];
        nnls->q[j] = q + (size_t)j * rows;
        nnls->scale[j] = power_of_two(kernels->magnitude(column[j], rows));
        kernels->scale(nnls->q[j], column[j], 1.0 / nnls->scale[j], rows);
        nnls->norm[j] = sqrt(nnls->kernels->dot(nnls->q[j], nnls->q[j], rows));
        if (nnls->norm[j] > 0.0) {
            kernels->scale(nnls->q[j], nnls->q[j], 1.0 / nnls->norm[j], rows);
        }
        for (i = 0; i < NNLS_COLUMNS; i++) {
            nnls->r[i][j] = 0.0;
        }
        if (nnls->norm[j] > 0.0) {
            orthogonalise(nnls, j);
        }
    }
    factor_supports(nnls);
}

static unsigned best_support(const struct nnls *nnls, const double *t, double *unit)
{
    return nnls->columns <= NNLS_CLOSED ? brdffit_nnls_enumerate(nnls, t, unit) : brdffit_nnls_active(nnls, t, unit);
}

static void project(const struct nnls *nnls, const double *v, double *t)
{
    int j;

    for (j = 0; j < nnls->columns; j++) {
        t[j] = nnls->kernels->dot(nnls->q[j], v, nnls->rows);
    }
}

/* residual = data / data_scale - sum unit_j column_j / |column_j| */
static void residual_of(const struct nnls *nnls, const double *data, double data_scale, const double *unit,
                        double *residual)
{
    int j;

    nnls->kernels->scale(residual, data, 1.0 / data_scale, nnls->rows);
    for (j = 0; j < nnls->columns; j++) {
        if (unit[j] != 0.0) {
            /* Two factors: their product may overflow where the column is tiny. */
            nnls->kernels->subtract(residual, nnls->column[j], 1.0 / nnls->scale[j], unit[j] / nnls->norm[j],
                                    nnls->rows);
        }
    }
}

/* Largest violation: stationarity on the support, no ascent elsewhere. `limit`: of a.z <= 1, or NULL. */
static double kkt_residual(const struct nnls *nnls, const double *residual, const struct nnls_answer *answer,
                           const double *limit, double data_norm)
{
    unsigned support = answer->support;
    double worst = 0.0;
    int j;

    for (j = 0; j < nnls->columns; j++) {
        double slope = 0.0;

        if (limit && !(limit[j] <= NNLS_LIMIT_MOST)) {
            continue;
        }
        if (nnls->norm[j] > 0.0) {
            slope = nnls->kernels->dot(nnls->column[j], residual, nnls->rows) / nnls->scale[j] / nnls->norm[j];
        }
        if (answer->multiplier > 0.0) {
            slope -= 0.5 * (answer->multiplier * limit[j]);
        }
        worst = fmax(worst, support & (1u << j) ? fabs(slope) : slope);
    }
    return data_norm > 0.0 ? worst / data_norm : 0.0;
}

/* Room that coefficients leave below the limit; a hair is left where they are at it. */
static double room_of(const struct nnls *nnls, const double *limit, const double *unit)
{
    double room = 1.0;
    int j;

    for (j = 0; j < nnls->columns; j++) {
        room -= unit[j] > 0.0 ? limit[j] * unit[j] : 0.0;
    }
    return room;
}

/* One step of iterative refinement on the chosen support; kept only while it stays feasible. */
static void refine(const struct nnls *nnls, const struct nnls_support *s, const double *residual, const double *limit,
                   double *unit)
{
    double t[NNLS_COLUMNS], step[NNLS_COLUMNS], force;
    int j;

    project(nnls, residual, t);
    if (limit) {
        (void)brdffit_nnls_limit_step(s, t, nnls->columns, limit, room_of(nnls, limit, unit), step, &force);
    } else {
        (void)brdffit_nnls_support_solve(s, t, nnls->columns, step);
    }
    for (j = 0; j < s->count; j++) {
        if (!(unit[s->index[j]] + step[j] > 0.0)) {
            return;
        }
    }
    for (j = 0; j < s->count; j++) {
        unit[s->index[j]] += step[j];
    }
}

/* After data_scale; `limit`: a row in units of data / data_scale, or NULL. */
static void solve(const struct nnls *nnls, const double *data, const double *limit, double *residual,
                  struct nnls_answer *answer)
{
    double t[NNLS_COLUMNS], data_norm;
    struct nnls_support room;
    int j;

    answer->multiplier = 0.0;
    for (j = 0; j < NNLS_COLUMNS; j++) {
        answer->unit[j] = 0.0;
        answer->z[j] = 0.0;
    }
    residual_of(nnls, data, answer->data_scale, answer->unit, residual);
    data_norm = sqrt(nnls->kernels->dot(residual, residual, nnls->rows));
    project(nnls, residual, t);
    answer->support = limit ? brdffit_nnls_limited(nnls, t, limit, answer->unit, &answer->multiplier)
                            : best_support(nnls, t, answer->unit);
    if (answer->support) {
        residual_of(nnls, data, answer->data_scale, answer->unit, residual);
        refine(nnls, brdffit_nnls_factored(nnls, answer->support, &room), residual, limit, answer->unit);
        residual_of(nnls, data, answer->data_scale, answer->unit, residual);
    }
    answer->rss = nnls->kernels->dot(residual, residual, nnls->rows);
    answer->kkt = kkt_residual(nnls, residual, answer, limit, data_norm);
    for (j = 0; j < nnls->columns; j++) {
        if (answer->unit[j] > 0.0) {
            answer->z[j] = answer->unit[j] / nnls->norm[j] / nnls->scale[j] * answer->data_scale;
        }
    }
}

void brdffit_nnls_solve(const struct nnls *nnls, const double *data, double *residual, struct nnls_answer *answer)
{
    answer->data_scale = power_of_two(nnls->kernels->magnitude(data, nnls->rows));
    solve(nnls, data, NULL, residual, answer);
}

void brdffit_nnls_solve_limited(const struct nnls *nnls, const double *data, const double *a, double *residual,
                                struct nnls_answer *answer)
{
    double limit[NNLS_COLUMNS];
    int j;

    answer->data_scale = power_of_two(nnls->kernels->magnitude(data, nnls->rows));
    for (j = 0; j < nnls->columns; j++) {
        limit[j] = nnls->norm[j] > 0.0 ? a[j] * answer->data_scale : 0.0;
    }
    solve(nnls, data, limit, residual, answer);
}

/* Cholesky of the unit matrix of cosines; squares of the diagonal start from (1 - c)(1 + c), which keeps their digits. */
void brdffit_nnls_factor_gram(struct nnls *nnls, int columns, double cosine[NNLS_COLUMNS][NNLS_COLUMNS])
{
    double (*r)[NNLS_COLUMNS] = nnls->r;
    int i, j, k;

    nnls->columns = columns;
    for (j = 0; j < columns; j++) {
        double square = 1.0;

        for (i = 0; i < columns; i++) {
            r[i][j] = 0.0;
        }
        for (i = 0; i < j; i++) {
            double v = cosine[i][j];

            for (k = 0; k < i; k++) {
                v -= r[k][i] * r[k][j];
            }
            r[i][j] = r[i][i] > 0.0 ? v / r[i][i] : 0.0;
            square = i == 0 ? (1.0 - v) * (1.0 + v) : square - r[i][j] * r[i][j];
        }
        r[j][j] = square > 0.0 ? sqrt(square) : 0.0;
    }
    factor_supports(nnls);
}

/* Q'data from A'data: R'^-1 t. */
static void along_q(const struct nnls *nnls, const double *t, double *q)
{
    int i, j;

    for (j = 0; j < nnls->columns; j++) {
        double rest = t[j];

        for (i = 0; i < j; i++) {
            rest -= nnls->r[i][j] * q[i];
        }
        q[j] = nnls->r[j][j] > 0.0 ? rest / nnls->r[j][j] : 0.0;
    }
}

unsigned brdffit_nnls_support(const struct nnls *nnls, const double *t, double unit[NNLS_COLUMNS])
{
    double q[NNLS_COLUMNS];

    along_q(nnls, t, q);
    return best_support(nnls, q, unit);
}

double brdffit_nnls_multiplier(const struct nnls *nnls, const double *t, const double *a, double unit[NNLS_COLUMNS])
{
    double q[NNLS_COLUMNS], multiplier;

    along_q(nnls, t, q);
    (void)brdffit_nnls_limited(nnls, q, a, unit, &multiplier);
    return multiplier;
}
