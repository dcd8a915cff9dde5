/*
 * Certified lower bounds of conic programs: see certificate.h.
 *
 * Rounding: a sum of L terms, each a rounded product, is off by at most L u / (1 - L u) times the sum of
 * their magnitudes, and by less than DBL_MIN a term where products underflow. `struct sum` keeps both sums;
 * sum_error() charges twice that much and a few terms more, which also covers its own rounding and the few
 * operations that follow. No compensated arithmetic: bounds are compared with gaps of 1e-9 and more.
 * SPDX-License-Identifier: MIT
 */
#include "solve/conic/certificate.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "base/tolerance.h"

struct sum {
    double value, magnitude;
    double terms;
};

static void sum_add(struct sum *sum, double term)
{
    sum->value += term;
    sum->magnitude += fabs(term);
    sum->terms += 1.0;
}

static double sum_error(const struct sum *sum)
{
    return 2.0 * TOL_UNIT * (sum->terms + 8.0) * sum->magnitude + sum->terms * DBL_MIN;
}

size_t brdffit_conic_rows(const struct conic_shape *shape)
{
    size_t rows = shape->linear;
    size_t i;

    for (i = 0; i < shape->cones; i++) {
        rows += shape->cone[i];
    }
    return rows;
}

size_t brdffit_conic_entries(const struct conic_shape *shape)
{
    return shape->column ? shape->column[shape->variables] : shape->variables * brdffit_conic_rows(shape);
}

static int pattern_valid(const struct conic_shape *shape, size_t rows)
{
    size_t j, k;

    if (!shape->column || !shape->row) {
        return !shape->column && !shape->row;
    }
    if (shape->column[0] != 0) {
        return 0;
    }
    for (j = 0; j < shape->variables; j++) {
        size_t end = shape->column[j + 1];

        if (end < shape->column[j] || end - shape->column[j] > rows) {
            return 0;
        }
        for (k = shape->column[j]; k < end; k++) {
            if (shape->row[k] >= rows || (k > shape->column[j] && shape->row[k] <= shape->row[k - 1])) {
                return 0;
            }
        }
    }
    return 1;
}

/* Sizes stay below SIZE_MAX / 64, so that nobody's count of bytes overflows. */
int brdffit_conic_valid(const struct conic_shape *shape)
{
    const size_t most = SIZE_MAX / 64;
    size_t rows;
    size_t i;

    if (!shape || shape->variables < 1 || shape->variables > most || shape->linear > most ||
        (shape->cones > 0 && !shape->cone)) {
        return 0;
    }
    rows = shape->linear;
    for (i = 0; i < shape->cones; i++) {
        if (shape->cone[i] < 2 || shape->cone[i] > most - rows) {
            return 0;
        }
        rows += shape->cone[i];
    }
    return rows >= 1 && rows <= most / shape->variables && pattern_valid(shape, rows);
}

/* An upper bound of the norm of v. Divided by the largest entry first: no overflow, no harmful underflow. */
static double norm_above(const double *v, size_t count)
{
    double largest = 0.0;
    double squares = 0.0;
    size_t i;

    for (i = 0; i < count; i++) {
        largest = fmax(largest, fabs(v[i]));
    }
    if (!(largest > 0.0)) {
        return 0.0;
    }
    for (i = 0; i < count; i++) {
        squares += (v[i] / largest) * (v[i] / largest);
    }
    return largest * sqrt(squares) * (1.0 + 2.0 * TOL_UNIT * ((double)count + 8.0)) + DBL_MIN;
}

static void move_into_cone(const struct conic_shape *shape, double *z)
{
    size_t first = shape->linear;
    size_t i;

    for (i = 0; i < shape->linear; i++) {
        z[i] = z[i] > 0.0 ? z[i] : 0.0;
    }
    for (i = 0; i < shape->cones; i++) {
        double norm = norm_above(z + first + 1, shape->cone[i] - 1);

        z[first] = z[first] >= norm ? z[first] : norm;
        first += shape->cone[i];
    }
}

/* c_j + (G'z)_j */
static struct sum residual(const struct conic_shape *shape, const struct conic_data *data, const double *z, size_t rows,
                           size_t j)
{
    struct sum sum = {0.0, 0.0, 0.0};
    size_t begin = shape->column ? shape->column[j] : j * rows;
    size_t end = shape->column ? shape->column[j + 1] : begin + rows;
    size_t k;

    sum_add(&sum, data->c[j]);
    for (k = begin; k < end; k++) {
        sum_add(&sum, data->g[k] * z[shape->row ? shape->row[k] : k - begin]);
    }
    return sum;
}

/* x is finite even where its limit is not, hence 0. */
static double product(double r, double limit)
{
    return r == 0.0 ? 0.0 : r * limit;
}

/* Smallest r x with r within the rounding of the residual and x within its limits. */
static double worst(const struct sum *r, double lower, double upper)
{
    double error = sum_error(r);
    double low = r->value - error;
    double high = r->value + error;

    return fmin(fmin(product(low, lower), product(low, upper)), fmin(product(high, lower), product(high, upper)));
}

double brdffit_socp_certified_bound(const struct conic_shape *shape, const struct conic_data *data, const double *lower,
                                    const double *upper, double *z)
{
    struct sum bound = {0.0, 0.0, 0.0};
    size_t rows = brdffit_conic_rows(shape);
    size_t i, j;

    for (i = 0; i < rows; i++) {
        if (!isfinite(z[i])) {
            return -INFINITY;
        }
    }
    move_into_cone(shape, z);
    for (i = 0; i < rows; i++) {
        sum_add(&bound, -data->h[i] * z[i]);
    }
    for (j = 0; j < shape->variables; j++) {
        struct sum r = residual(shape, data, z, rows, j);

        if (!(lower[j] <= upper[j] && lower[j] < INFINITY && upper[j] > -INFINITY && isfinite(r.magnitude))) {
            return -INFINITY;
        }
        sum_add(&bound, worst(&r, lower[j], upper[j]));
    }
    bound.value -= sum_error(&bound);
    return isfinite(bound.value) ? bound.value : -INFINITY;
}
