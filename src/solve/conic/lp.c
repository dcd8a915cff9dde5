/*
 * Linear programs of columns with an allowance: see lp.h. SPDX-License-Identifier: MIT
 *
 * Variables: z, then t (a row each in L1, a single one in L-infinity). Rows of h - G x >= 0: z >= 0; t >= 0; the
 * upper ones, t + U z - data >= 0; the lower ones, t - L z + data >= 0. With multipliers p (upper) and q (lower) >= 0
 * the dual is max data.(p - q) subject to L'q - U'p >= 0 and, for each t, the sum of its p + q at most 1. What ECOS returns obeys
 * that to 1e-8 or so. The sums are brought to 1 exactly by dividing, and the multipliers of z >= 0 and t >= 0 are then
 * known; only the entries of L'q - U'p that stay negative cost something, at the limit of their z.
 */
#include "solve/conic/lp.h"

#include <math.h>

#include "base/tolerance.h"

static size_t heights(const struct lp *lp, size_t rows)
{
    return lp->norm == BRDFFIT_NORM_L1 ? rows : 1;
}

static size_t entries(const struct lp *lp, size_t rows)
{
    return lp->columns * (1 + 2 * rows) + heights(lp, rows) + 2 * rows;
}

void brdffit_lp_layout(struct lp *lp, struct arena *arena, size_t count, size_t columns, brdffit_norm norm)
{
    size_t variables, all;

    lp->norm = norm;
    lp->columns = columns;
    variables = columns + heights(lp, count);
    all = variables + 2 * count;
    if (count > (size_t)-1 / 64 / (2 * LP_COLUMNS + 4)) {
        arena->failed = 1;
        return;
    }
    lp->column = brdffit_arena_take(arena, variables + 1, sizeof *lp->column);
    lp->row = brdffit_arena_take(arena, entries(lp, count), sizeof *lp->row);
    lp->g = ARENA_DOUBLES(arena, entries(lp, count));
    lp->c = ARENA_DOUBLES(arena, variables);
    lp->h = ARENA_DOUBLES(arena, all);
    lp->x = ARENA_DOUBLES(arena, variables);
    lp->dual = ARENA_DOUBLES(arena, all);
    lp->low = ARENA_DOUBLES(arena, variables);
    lp->high = ARENA_DOUBLES(arena, variables);
}

/* The column of the t of row i, or of the only t. */
static size_t height_of(const struct lp *lp, size_t i)
{
    return lp->norm == BRDFFIT_NORM_L1 ? i : 0;
}

/* Pattern of G, its constant entries (all -1), c and the rows of h that are 0. */
static void make_pattern(struct lp *lp)
{
    size_t n = lp->rows, t = heights(lp, n), first = lp->columns + t, entry = 0, i, j;

    for (j = 0; j < lp->columns; j++) {
        lp->column[j] = entry;
        lp->g[entry] = -1.0;
        lp->row[entry++] = j;
        for (i = 0; i < 2 * n; i++) {
            lp->row[entry++] = first + i;
        }
        lp->c[j] = lp->h[j] = lp->low[j] = 0.0;
    }
    for (j = 0; j < t; j++) {
        size_t step = lp->norm == BRDFFIT_NORM_L1 ? n : 1;

        lp->column[lp->columns + j] = entry;
        lp->g[entry] = -1.0;
        lp->row[entry++] = lp->columns + j;
        for (i = j; i < 2 * n; i += step) {
            lp->g[entry] = -1.0;
            lp->row[entry++] = first + i;
        }
        lp->c[lp->columns + j] = 1.0;
        lp->h[lp->columns + j] = lp->low[lp->columns + j] = 0.0;
    }
    lp->column[lp->columns + t] = entry;
    lp->shape.variables = lp->columns + t;
    lp->shape.linear = first + 2 * n;
    lp->shape.cones = 0;
    lp->shape.cone = NULL;
    lp->shape.column = lp->column;
    lp->shape.row = lp->row;
}

brdffit_status brdffit_lp_start(struct lp *lp, size_t rows)
{
    brdffit_status status;

    lp->rows = rows;
    lp->solver = NULL;
    lp->solved = lp->refused = 0;
    make_pattern(lp);
    status = brdffit_socp_new(&lp->shape, &lp->solver);
    if (status == BRDFFIT_OK) {
        brdffit_socp_trust_scale(lp->solver);
    }
    return status;
}

void brdffit_lp_finish(struct lp *lp)
{
    brdffit_socp_free(lp->solver);
    lp->solver = NULL;
}

static void fill(struct lp *lp, const struct lp_data *data)
{
    size_t n = lp->rows, t = heights(lp, n), first = lp->columns + t, i, j;

    for (j = 0; j < t; j++) {
        lp->high[lp->columns + j] = 0.0;
    }
    for (i = 0; i < n; i++) {
        double reach = fabs(data->data[i]), *high = &lp->high[lp->columns + height_of(lp, i)];

        lp->h[first + i] = -data->data[i];
        lp->h[first + n + i] = data->data[i];
        for (j = 0; j < lp->columns; j++) {
            reach += data->limit[j] * fmax(fabs(data->upper[j][i]), fabs(data->lower[j][i]));
        }
        *high = fmax(*high, 2.0 * reach);
    }
    for (j = 0; j < lp->columns; j++) {
        double *g = lp->g + lp->column[j] + 1;

        lp->high[j] = data->limit[j];
        lp->c[j] = data->limit[j] > 0.0 ? 0.0 : 1.0; /* a column that is not there: hold its z at 0 */
        for (i = 0; i < n; i++) {
            g[i] = -data->upper[j][i];
            g[n + i] = data->lower[j][i];
        }
    }
}

/* Sums of p + q at most 1: divide by what is above it. */
static void repair_heights(struct lp *lp)
{
    size_t n = lp->rows, t = heights(lp, n), first = lp->columns + t, i, j;

    for (j = 0; j < t; j++) {
        size_t step = lp->norm == BRDFFIT_NORM_L1 ? n : 1;
        double sum = 0.0;

        for (i = j; i < 2 * n; i += step) {
            lp->dual[first + i] = fmax(0.0, lp->dual[first + i]);
            sum += lp->dual[first + i];
        }
        for (i = j; i < 2 * n && sum > 1.0; i += step) {
            lp->dual[first + i] /= sum;
        }
        lp->dual[lp->columns + j] = fmax(0.0, 1.0 - sum);
    }
}

static void repair_columns(struct lp *lp)
{
    size_t n = lp->rows, first = lp->columns + heights(lp, n), i, j;

    for (j = 0; j < lp->columns; j++) {
        const double *g = lp->g + lp->column[j] + 1;
        double sum = 0.0;

        for (i = 0; i < 2 * n; i++) {
            sum += g[i] * lp->dual[first + i];
        }
        lp->dual[j] = fmax(0.0, sum);
    }
}

double brdffit_lp_bound(struct lp *lp, const struct lp_data *data, double *z)
{
    struct conic_data program;
    struct socp_result result;
    double bound;
    size_t j;

    fill(lp, data);
    program.g = lp->g;
    program.c = lp->c;
    program.h = lp->h;
    lp->solved++;
    if (brdffit_socp_solve(lp->solver, &program, lp->x, lp->dual, &result) != BRDFFIT_OK) {
        for (j = 0; j < lp->columns; j++) {
            z[j] = 0.0;
        }
        lp->refused++;
        return 0.0;
    }
    for (j = 0; j < lp->columns; j++) {
        z[j] = fmax(0.0, fmin(lp->x[j], data->limit[j]));
    }
    repair_heights(lp);
    repair_columns(lp);
    bound = brdffit_socp_certified_bound(&lp->shape, &program, lp->low, lp->high, lp->dual);
    if (!(bound > 0.0)) {
        lp->refused += result.outcome != SOCP_OPTIMAL;
        return 0.0;
    }
    return bound;
}
