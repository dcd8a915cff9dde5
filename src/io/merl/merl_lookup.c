/*
 * Directions looked up in a MERL table, as the database's own reader does. SPDX-License-Identifier: MIT
 *
 * Half vector h = l + v, difference d = (l - v) / 2, in a frame with the normal as z:
 *
 *     theta_h = angle(n, h)      theta_d = angle(h, l) = atan2(|l - v|, |l + v|)
 *     phi_d   = azimuth of d after h was turned onto z through the plane of n and h, mod 180 degrees
 *
 * (l and d differ by a multiple of h, so their azimuth is the same.) Everything goes through atan2 of sums and
 * differences: an arc cosine would lose half of the digits at theta_h = 0, where MERL's bins are 0.01 degrees.
 *
 * Bins are those of the database: theta_h floor(n_h sqrt(theta_h / 90)), theta_d floor(n_d theta_d / 90), phi_d
 * floor(n_p phi_d / 180). Directions are often aimed at a bin's edge (theta_h = 0.4 degrees is 90 (6/90)^2) and
 * then rounding decides. So an angle within IO_EDGE_SNAP below an edge counts as on it, which is the upper bin;
 * for phi_d the allowance grows as the lever arms sin theta_h and sin theta_d shrink, and the last edge, 180,
 * is 0 again. At theta_h = 0 (to that allowance) phi_d is the light's own azimuth, at theta_d = 0 it is 0.
 */
#include <math.h>
#include <string.h>

#include "io/fail.h"
#include "io/limits.h"
#include "io/merl/merl.h"

#define PI 3.14159265358979323846

static double dot3(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static double norm3(const double *v)
{
    return sqrt(dot3(v, v));
}

/* Of any finite non-zero length: scaled by a power of two first, so that squares neither overflow nor vanish. */
static void unit(const double *v, double out[3])
{
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))), length;
    int exponent, i;

    (void)frexp(largest, &exponent);
    for (i = 0; i < 3; i++) {
        out[i] = ldexp(v[i], -exponent);
    }
    length = norm3(out);
    for (i = 0; i < 3; i++) {
        out[i] /= length;
    }
}

/* Bin of `angle` among `bins`, given a first guess by rounding down and the edge above it. */
static size_t settle(double guess, double angle, double snap, double (*edge)(size_t, size_t), size_t bins)
{
    size_t bin = guess >= (double)bins ? bins : (size_t)guess; /* guess >= 0 */

    if (bin < bins && !(edge(bin + 1, bins) - angle > snap)) {
        bin++;
    }
    return bin;
}

static double edge_half(size_t i, size_t bins)
{
    double part = (double)i / (double)bins;

    return 0.5 * PI * (part * part);
}

static double edge_difference(size_t i, size_t bins)
{
    return 0.5 * PI * ((double)i / (double)bins);
}

static double edge_azimuth(size_t i, size_t bins)
{
    return PI * ((double)i / (double)bins);
}

/* In [0, pi]; 0 where it is undefined. */
static double azimuth(const double h[3], const double d[3], double theta_h, double theta_d)
{
    double flat = hypot(h[0], h[1]), length = norm3(h), east = 1.0, north = 0.0, x, y, phi;

    if (!(theta_d > IO_EDGE_SNAP)) {
        return 0.0;
    }
    if (theta_h > IO_EDGE_SNAP) {
        east = h[0] / flat;
        north = h[1] / flat;
    }
    x = (h[2] * (east * d[0] + north * d[1]) - flat * d[2]) / length;
    y = east * d[1] - north * d[0];
    phi = atan2(y, x);
    return phi < 0.0 ? phi + PI : phi;
}

static double azimuth_snap(double theta_h, double theta_d, size_t bins)
{
    double lever = IO_EDGE_SNAP / fmin(theta_d, theta_h > IO_EDGE_SNAP ? theta_h : theta_d);

    return fmin(IO_EDGE_SNAP + lever, 0.25 * PI / (double)bins);
}

size_t brdffit_io_merl_cell(const size_t dims[3], const double l[3], const double v[3])
{
    double h[3], d[3], theta_h, theta_d, phi_d;
    size_t at_h, at_d, at_p;
    int i;

    for (i = 0; i < 3; i++) {
        h[i] = l[i] + v[i];
        d[i] = 0.5 * (l[i] - v[i]);
    }
    theta_h = atan2(hypot(h[0], h[1]), h[2]);
    theta_d = atan2(2.0 * norm3(d), norm3(h));
    phi_d = azimuth(h, d, theta_h, theta_d);
    at_h = settle((double)dims[0] * sqrt(theta_h / (0.5 * PI)), theta_h, IO_EDGE_SNAP, edge_half, dims[0]);
    at_d = settle((double)dims[1] * (theta_d / (0.5 * PI)), theta_d, IO_EDGE_SNAP, edge_difference, dims[1]);
    at_p = settle((double)dims[2] * (phi_d / PI), phi_d, azimuth_snap(theta_h, theta_d, dims[2]), edge_azimuth,
                  dims[2]);
    at_h = at_h < dims[0] ? at_h : dims[0] - 1;
    at_d = at_d < dims[1] ? at_d : dims[1] - 1;
    at_p = at_p < dims[2] ? at_p : 0;
    return at_p + dims[2] * (at_d + dims[1] * at_h);
}

/* Coordinates of u in a right-handed frame with z = n; for n = +z exactly u itself. */
static void to_frame(const double n[3], const double u[3], double out[3])
{
    /* Duff et al. 2017, "Building an Orthonormal Basis, Revisited". */
    double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
    double x[3] = {1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    double y[3] = {b, sign + n[1] * n[1] * a, -n[1]};

    out[0] = dot3(x, u);
    out[1] = dot3(y, u);
    out[2] = dot3(n, u);
}

static void open_arrays(const brdffit_samples *directions, struct io_table *table)
{
    table->samples.form = BRDFFIT_FORM_DIRECTIONS;
    table->width[IO_LIGHT] = 3;
    table->width[IO_VIEW] = 3;
    table->width[IO_NORMAL] = directions->normal ? 3 : 0;
    table->width[IO_WEIGHTS] = directions->weights ? 1 : 0;
}

static void look_up(const struct merl *merl, const brdffit_samples *at, size_t i, struct io_table *table)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    const size_t vector = 3 * sizeof(double), to = table->samples.count;
    double n[3], u[3], l[3], v[3], entry[MERL_CHANNELS];
    size_t cell, k;

    unit(at->normal ? at->normal + 3 * i : up, n);
    unit(at->light + 3 * i, u);
    to_frame(n, u, l);
    unit(at->view + 3 * i, u);
    to_frame(n, u, v);
    if (!(l[2] > IO_HORIZON && v[2] > IO_HORIZON)) {
        table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON]++;
        return;
    }
    cell = brdffit_io_merl_cell(merl->dims, l, v);
    for (k = 0; k < MERL_CHANNELS; k++) {
        entry[k] = brdffit_io_merl_entry(merl, k, cell);
    }
    if (entry[0] < 0.0 || entry[1] < 0.0 || entry[2] < 0.0) {
        table->dropped[BRDFFIT_IO_DROP_MASKED]++;
        return;
    }
    for (k = 0; k < MERL_CHANNELS; k++) {
        table->array[IO_VALUES][MERL_CHANNELS * to + k] = entry[k] * brdffit_io_merl_scale[k];
    }
    memcpy(table->array[IO_LIGHT] + 3 * to, at->light + 3 * i, vector);
    memcpy(table->array[IO_VIEW] + 3 * to, at->view + 3 * i, vector);
    if (at->normal) {
        memcpy(table->array[IO_NORMAL] + 3 * to, at->normal + 3 * i, vector);
    }
    if (at->weights) {
        table->array[IO_WEIGHTS][to] = at->weights[i];
    }
    table->samples.count++;
}

brdffit_status brdffit_io_merl_at(const struct merl *merl, const brdffit_samples *directions, struct io_table *table,
                                  brdffit_error *error)
{
    size_t i;

    open_arrays(directions, table);
    if (!brdffit_io_table_reserve(table, directions->count)) {
        return brdffit_io_no_memory(error);
    }
    for (i = 0; i < directions->count; i++) {
        look_up(merl, directions, i, table);
    }
    return BRDFFIT_OK;
}
