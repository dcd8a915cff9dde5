/*
 * E^2 at a model, and the least one at given roughnesses. SPDX-License-Identifier: MIT
 *
 * Least squares with coefficients >= 0: supports (at most 127) are solved by Cholesky of unit columns, the last optimum's
 * first, then from all columns down, until one has no negative coefficient and no column outside of it that would help:
 * that is the optimum. Where rounding hides it, the best of all of them is taken. From one s to the next the columns of
 * a lobe that has not moved stay, and their products. E^2 is summed from its residuals. A support that is wrong by
 * rounding costs nothing but a slightly worse point: what is returned is the E^2 of coefficients >= 0 all the same.
 */
#include "quad.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define SUPPORTS (1 << QUAD_COLUMNS)
/* A column with less than this new is left out of its support. */
#define DEPENDENT 1e-28

struct normal {
    int columns;
    quad length[QUAD_COLUMNS];
    quad gram[QUAD_COLUMNS][QUAD_COLUMNS];
    quad factor[SUPPORTS][QUAD_COLUMNS][QUAD_COLUMNS]; /* Cholesky of each support, rows of its columns in order */
    quad over[SUPPORTS][QUAD_COLUMNS];                 /* 1 / its diagonal */
    enum { UNKNOWN, USABLE, USELESS } state[SUPPORTS]; /* factored when it is first asked for */
};

struct quad_work {
    int known; /* whether p->column and normal are those at s */
    quad s[QUAD_LOBES];
    struct normal normal;
    int likely[]; /* the last optimum's support, channels of them */
};

struct quad_work *quad_work_new(size_t channels)
{
    return calloc(1, sizeof(struct quad_work) + channels * sizeof(int));
}

static void lobe_columns(const struct quad_problem *p, int j, quad s, quad *column)
{
    const struct quad_lobe *lobe = &p->lobe[j];
    size_t i, n = p->count;
    quad *g = column + (size_t)(p->fixed + j * p->each) * n;

    for (i = 0; i < n; i++) {
        g[i] = lobe->b[i] > 0 ? lobe->b[i] * quad_lobe_shape(lobe, s, i) : 0;
        if (p->each > 1) {
            g[n + i] = g[i] * lobe->w[i];
        }
    }
}

void quad_columns(const struct quad_problem *p, const quad *s, quad *column)
{
    int f, j;

    p->work->known = 0;
    for (f = 0; f < p->fixed; f++) {
        memcpy(column + (size_t)f * p->count, p->a[f], p->count * sizeof *column);
    }
    for (j = 0; j < p->lobes; j++) {
        lobe_columns(p, j, s[j], column);
    }
}

quad quad_residual(const struct quad_problem *p, const quad *column, size_t channel, const quad *z)
{
    const quad *data = p->data + channel * p->count;
    quad sum = 0;
    size_t i;
    int j;

    for (i = 0; i < p->count; i++) {
        quad r = data[i];

        for (j = 0; j < p->columns; j++) {
            if (z[j] > 0) { /* columns may be without meaning where they are not used */
                r -= z[j] * column[(size_t)j * p->count + i];
            }
        }
        if (p->norm == BRDFFIT_NORM_L2) {
            sum += p->weight[i] * r * r;
        } else if (p->norm == BRDFFIT_NORM_L1) {
            sum += p->weight[i] * fabsq(r);
        } else {
            sum = fmaxq(sum, fabsq(r));
        }
    }
    return sum;
}

/* What y of each lobe is multiplied by in units of quad_columns(). */
static void factors(const struct quad_problem *p, const quad *s, quad *factor)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        const struct quad_lobe *lobe = &p->lobe[j];

        factor[j] = quad_lambda(lobe->distribution, s[j]) * quad_shape(lobe->distribution, s[j], lobe->c_min, 0);
    }
}

quad quad_at_model(const struct quad_problem *p, const double *sigma, const double *x, const double *y,
                   const double *f0)
{
    quad sum = 0, s[QUAD_LOBES], z[QUAD_COLUMNS], factor[QUAD_LOBES];
    size_t k, at;
    int j;

    for (j = 0; j < p->lobes; j++) {
        s[j] = quad_s(sigma[j]);
    }
    factors(p, s, factor);
    quad_columns(p, s, p->column);
    for (k = 0; k < p->channels; k++) {
        quad part;

        for (j = 0; j < p->fixed; j++) {
            z[j] = x[k * (size_t)p->fixed + (size_t)j] / p->scale[k];
        }
        for (j = 0; j < p->lobes; j++) {
            quad *own = z + p->fixed + j * p->each;

            at = k * (size_t)p->lobes + (size_t)j;
            own[0] = y[at] * factor[j] / p->scale[k];
            if (p->each > 1) {
                own[1] = own[0] * (1 - (quad)f0[at]);
                own[0] *= f0[at];
            }
        }
        part = quad_residual(p, p->column, k, z);
        sum = p->norm == BRDFFIT_NORM_LINF ? fmaxq(sum, part) : sum + part;
    }
    return sum;
}

/* ---- Least squares ---------------------------------------------------------------------------------------------- */

static quad dot(const quad *u, const quad *v, size_t n)
{
    quad sum = 0;
    size_t i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

static int members(int support, int columns, int *member)
{
    int j, n = 0;

    for (j = 0; j < columns; j++) {
        if (support & (1 << j)) {
            member[n++] = j;
        }
    }
    return n;
}

static int cholesky(struct normal *m, int support)
{
    quad(*f)[QUAD_COLUMNS] = m->factor[support];
    int member[QUAD_COLUMNS], n = members(support, m->columns, member), i, j, k;

    for (i = 0; i < n; i++) {
        if (!(m->length[member[i]] > 0)) {
            return 0;
        }
        for (j = 0; j <= i; j++) {
            quad sum = m->gram[member[i]][member[j]];

            for (k = 0; k < j; k++) {
                sum -= f[i][k] * f[j][k];
            }
            if (i == j && !(sum > DEPENDENT)) {
                return 0;
            }
            f[i][j] = i == j ? sqrtq(sum) : sum * m->over[support][j];
        }
        m->over[support][i] = 1 / f[i][i];
    }
    return 1;
}

/* Of the columns that moved. `weighted` takes the columns times the weights. */
static void normal_equations(const struct quad_problem *p, const quad *column, int moved, quad *weighted,
                             struct normal *m)
{
    size_t n = p->count, row;
    int i, j;

    m->columns = p->columns;
    for (i = 0; i < m->columns; i++) {
        const quad *u = column + (size_t)i * n;
        quad *w = weighted + (size_t)i * n;

        for (row = 0; row < n && moved & (1 << i); row++) {
            w[row] = p->weight[row] * u[row];
        }
        m->length[i] = moved & (1 << i) ? sqrtq(dot(w, u, n)) : m->length[i];
        for (j = 0; j < i; j++) {
            if (moved & (1 << i | 1 << j)) {
                m->gram[i][j] = m->gram[j][i] = dot(w, column + (size_t)j * n, n) / (m->length[i] * m->length[j]);
            }
        }
        m->gram[i][i] = 1;
    }
    if (moved) {
        memset(m->state, 0, sizeof m->state);
    }
}

static int usable(struct normal *m, int support)
{
    if (m->state[support] == UNKNOWN) {
        m->state[support] = cholesky(m, support) ? USABLE : USELESS;
    }
    return m->state[support] == USABLE;
}

/* Coefficients of unit columns on a support; the gain t.z, or -1 when one of them is not positive. */
static quad solve_support(const struct normal *m, int support, const quad *t, quad *z)
{
    const quad(*f)[QUAD_COLUMNS] = m->factor[support];
    int member[QUAD_COLUMNS], n = members(support, m->columns, member), i, k;
    quad y[QUAD_COLUMNS], gain = 0;

    for (i = 0; i < n; i++) {
        y[i] = t[member[i]];
        for (k = 0; k < i; k++) {
            y[i] -= f[i][k] * y[k];
        }
        y[i] *= m->over[support][i];
    }
    memset(z, 0, QUAD_COLUMNS * sizeof *z);
    for (i = n - 1; i >= 0; i--) {
        for (k = i + 1; k < n; k++) {
            y[i] -= f[k][i] * y[k];
        }
        y[i] *= m->over[support][i];
        if (!(y[i] > 0)) {
            return -1;
        }
        z[member[i]] = y[i];
        gain += y[i] * t[member[i]];
    }
    return gain;
}

/* Whether no column outside of a support would make E^2 smaller: z > 0 on the support is then the optimum. */
static int optimal(const struct normal *m, int support, const quad *t, const quad *z)
{
    int i, j;

    for (j = 0; j < m->columns; j++) {
        quad slope = t[j];

        for (i = 0; i < m->columns && !(support & (1 << j)); i++) {
            slope -= z[i] > 0 ? m->gram[j][i] * z[i] : 0;
        }
        if (!(support & (1 << j)) && m->length[j] > 0 && !(slope <= 0)) {
            return 0;
        }
    }
    return 1;
}

/* Take a support that gains more than *best; whether it is the optimum. */
static int try_support(struct normal *m, int support, const quad *t, quad *best, quad *z)
{
    quad trial[QUAD_COLUMNS], gain = usable(m, support) ? solve_support(m, support, t, trial) : -1;

    if (!(gain > *best)) {
        return 0;
    }
    *best = gain;
    memcpy(z, trial, sizeof trial);
    return optimal(m, support, t, trial);
}

static quad channel_l2(const struct quad_problem *p, const quad *column, const quad *weighted, size_t k, quad *z)
{
    struct normal *m = &p->work->normal;
    const quad *data = p->data + k * p->count;
    quad t[QUAD_COLUMNS], best = 0;
    int j, support = p->work->likely[k], done;

    for (j = 0; j < m->columns; j++) {
        t[j] = m->length[j] > 0 ? dot(data, weighted + (size_t)j * p->count, p->count) / m->length[j] : 0;
        z[j] = 0;
    }
    done = support && try_support(m, support, t, &best, z);
    for (support = (1 << m->columns) - 1; support > 0 && !done; support--) {
        done = try_support(m, support, t, &best, z);
        p->work->likely[k] = support;
    }
    for (j = 0; j < m->columns; j++) {
        z[j] = z[j] > 0 ? z[j] / m->length[j] : 0;
    }
    return quad_residual(p, column, k, z);
}

/* Whether x and y are finite as doubles, in the data's units; y times `factor` is what z multiplies. */
static int finite_model(const struct quad_problem *p, const quad *factor, size_t k, const quad *z)
{
    int j, fine = 1;

    for (j = 0; j < p->columns; j++) {
        quad most = j < p->fixed ? DBL_MAX : DBL_MAX * factor[(j - p->fixed) / p->each];

        fine = fine && (!(z[j] > 0) || z[j] * p->scale[k] <= most);
    }
    return fine;
}

/* Columns at s, as bits those that are not what they were. */
static int move_columns(const struct quad_problem *p, const quad *s)
{
    struct quad_work *work = p->work;
    int j, moved = (1 << p->columns) - 1;

    if (!work->known) {
        quad_columns(p, s, p->column);
    }
    for (j = 0; j < p->lobes && work->known; j++) {
        if (s[j] == work->s[j]) {
            moved &= ~(((1 << p->each) - 1) << (p->fixed + j * p->each));
        } else {
            lobe_columns(p, j, s[j], p->column);
        }
    }
    moved &= work->known ? ~((1 << p->fixed) - 1) : ~0;
    memcpy(work->s, s, (size_t)p->lobes * sizeof *s);
    work->known = 1;
    return moved;
}

quad quad_at(const struct quad_problem *p, const quad *s)
{
    quad sum = 0, z[QUAD_COLUMNS], factor[QUAD_LOBES], *weighted = p->column + QUAD_COLUMNS * p->count;
    int moved = move_columns(p, s);
    size_t k;

    factors(p, s, factor);
    if (p->norm == BRDFFIT_NORM_L2) {
        normal_equations(p, p->column, moved, weighted, &p->work->normal);
    }
    for (k = 0; k < p->channels; k++) {
        quad part = p->norm == BRDFFIT_NORM_L2   ? channel_l2(p, p->column, weighted, k, z)
                    : p->norm == BRDFFIT_NORM_L1 ? quad_channel_l1(p, p->column, k, z)
                                                 : quad_channel_linf(p, p->column, k, z);

        if (!finite_model(p, factor, k, z)) {
            return strtoflt128("inf", NULL);
        }
        sum = p->norm == BRDFFIT_NORM_LINF ? fmaxq(sum, part) : sum + part;
    }
    return sum;
}

int quad_solve(quad *matrix, quad *right, int n)
{
    const int stride = QUAD_COLUMNS + 1;
    int i, j, k;

    for (k = 0; k < n; k++) {
        int pivot = k;

        for (i = k + 1; i < n; i++) {
            pivot = fabsq(matrix[i * stride + k]) > fabsq(matrix[pivot * stride + k]) ? i : pivot;
        }
        if (!(fabsq(matrix[pivot * stride + k]) > 0)) {
            return 0;
        }
        for (j = 0; pivot != k && j <= n; j++) {
            quad *p = j < n ? matrix + k * stride + j : right + k,
                 *q = j < n ? matrix + pivot * stride + j : right + pivot;
            quad swap = *p;

            *p = *q;
            *q = swap;
        }
        for (i = k + 1; i < n; i++) {
            quad factor = matrix[i * stride + k] / matrix[k * stride + k];

            for (j = k; j < n; j++) {
                matrix[i * stride + j] -= factor * matrix[k * stride + j];
            }
            right[i] -= factor * right[k];
        }
    }
    for (k = n - 1; k >= 0; k--) {
        for (j = k + 1; j < n; j++) {
            right[k] -= matrix[k * stride + j] * right[j];
        }
        right[k] /= matrix[k * stride + k];
    }
    return 1;
}
