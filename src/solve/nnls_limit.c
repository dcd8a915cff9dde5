/*
 * The restricted problem with one more row, a.z <= 1, a >= 0 (theory 7.9). SPDX-License-Identifier: MIT
 *
 * On a support with columns B U (B orthonormal) and t, the best z with a.z <= 1 is z = U^-1 v, where v is B't or, where that
 * is beyond the limit, its projection onto w.v = 1, w = U'^-1 a: v = B't - w (w.B't - 1) / w.w. A projection loses no digits
 * however close to collinear the columns are. Every support is tried, as without the limit: that of the optimum is among
 * those with z > 0, and any z that is feasible is an upper bound. Where columns depend on each other, the optimum can be
 * had without one of them: along the direction that changes nothing, a.z changes too or not at all.
 *
 * The multiplier is that of min |t - R z|^2 + multiplier (a.z - 1): 2 (w.B't - 1) / w.w.
 */
#include <math.h>

#include "solve/nnls_parts.h"

/* Corrections after a projection, for what is left of its rounding. */
#define NNLS_LIMIT_PASSES 2
/* A support so close to collinear that its z exceeds the limit by more is left to its parts. */
#define NNLS_LIMIT_OFF 1e-12

static double dot(const double *u, const double *v, int n)
{
    double sum = 0.0;
    int i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

/* v = B't. */
static void project(const struct nnls_support *s, const double *t, int columns, double *v)
{
    double rest[NNLS_COLUMNS];
    int j, k;

    for (k = 0; k < columns; k++) {
        rest[k] = t[k];
    }
    for (j = 0; j < s->count; j++) {
        v[j] = dot(s->basis[j], rest, columns);
        for (k = 0; k < columns; k++) {
            rest[k] -= v[j] * s->basis[j][k];
        }
    }
}

/* |t - B v|^2, from what is left itself. */
static double left_of(const struct nnls_support *s, const double *t, int columns, const double *v)
{
    double rest[NNLS_COLUMNS];
    int j, k;

    for (k = 0; k < columns; k++) {
        rest[k] = t[k];
    }
    for (j = 0; j < s->count; j++) {
        for (k = 0; k < columns; k++) {
            rest[k] -= v[j] * s->basis[j][k];
        }
    }
    return dot(rest, rest, columns);
}

static void back(const struct nnls_support *s, const double *v, double *z)
{
    int i, j;

    for (j = s->count - 1; j >= 0; j--) {
        z[j] = v[j];
        for (i = j + 1; i < s->count; i++) {
            z[j] -= s->upper[j][i] * z[i];
        }
        z[j] /= s->upper[j][j];
    }
}

/* a.z on the support. */
static double count_of(const struct nnls_support *s, const double *a, const double *z)
{
    double sum = 0.0;
    int j;

    for (j = 0; j < s->count; j++) {
        sum += a[s->index[j]] * z[j];
    }
    return sum;
}

/* U z. */
static void forth(const struct nnls_support *s, const double *z, double *v)
{
    int i, j;

    for (j = 0; j < s->count; j++) {
        v[j] = 0.0;
        for (i = j; i < s->count; i++) {
            v[j] += s->upper[j][i] * z[i];
        }
    }
}

static void subtract(double *v, const double *w, double factor, int n)
{
    int i;

    for (i = 0; i < n; i++) {
        v[i] -= factor * w[i];
    }
}

/* The projection in v, where no digits are lost; what its rounding leaves of a.z - most in z, where that can be told. */
double brdffit_nnls_limit_step(const struct nnls_support *s, const double *t, int columns, const double *a, double most,
                               double *z, double *multiplier)
{
    double v[NNLS_COLUMNS], w[NNLS_COLUMNS], step[NNLS_COLUMNS], square, over;
    int pass;

    project(s, t, columns, v);
    nnls_transposed_solve(s, a, w);
    square = dot(w, w, s->count);
    over = dot(w, v, s->count) - most;
    *multiplier = over > 0.0 ? 2.0 * (over / square) : 0.0;
    subtract(v, w, 0.5 * *multiplier, s->count);
    back(s, v, z);
    back(s, w, step);
    for (pass = 0; pass < NNLS_LIMIT_PASSES && *multiplier > 0.0; pass++) {
        subtract(z, step, (count_of(s, a, z) - most) / square, s->count);
    }
    forth(s, z, v);
    return count_of(s, a, z) - most <= NNLS_LIMIT_OFF ? left_of(s, t, columns, v) : (double)INFINITY;
}

static int all_positive(const double *z, int count)
{
    int j, fine = count > 0;

    for (j = 0; j < count; j++) {
        fine = fine && z[j] > 0.0;
    }
    return fine;
}

static void scatter(const struct nnls_support *s, const double *z, double *unit)
{
    int j;

    for (j = 0; j < NNLS_COLUMNS; j++) {
        unit[j] = 0.0;
    }
    for (j = 0; j < s->count; j++) {
        unit[s->index[j]] = z[j];
    }
}

/* Columns whose coefficient the limit holds at nothing. */
static unsigned barred(const double *a, int columns)
{
    unsigned bits = 0;
    int j;

    for (j = 0; j < columns; j++) {
        bits |= a[j] <= NNLS_LIMIT_MOST ? 0u : 1u << j;
    }
    return bits;
}

unsigned brdffit_nnls_limited(const struct nnls *nnls, const double *t, const double *a, double *unit,
                              double *multiplier)
{
    const int columns = nnls->columns;
    double least = dot(t, t, columns);
    unsigned bits, chosen = 0, out = barred(a, columns);
    struct nnls_support room;

    for (bits = 0; bits < NNLS_COLUMNS; bits++) {
        unit[bits] = 0.0;
    }
    *multiplier = 0.0;
    for (bits = 1; bits < 1u << columns; bits++) {
        const struct nnls_support *s = bits & out ? &nnls->support[0] : brdffit_nnls_factored(nnls, bits, &room);
        double z[NNLS_COLUMNS], force, left;

        if (s->count == 0) {
            continue;
        }
        left = brdffit_nnls_limit_step(s, t, columns, a, 1.0, z, &force);
        if (left < least && all_positive(z, s->count)) {
            least = left;
            chosen = bits;
            *multiplier = force;
            scatter(s, z, unit);
        }
    }
    return chosen;
}
