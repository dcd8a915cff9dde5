/*
 * Directions from angles, half angles, vectors and coefficients: see csv_directions.h. SPDX-License-Identifier: MIT
 *
 * With a polar angle t from +z and an azimuth p from +x a direction is (sin t cos p, sin t sin p, cos t); a negative polar
 * angle is on the other side, as signed angles in a plane have it. Without azimuths the light is at 0 and the viewer at
 * 180 degrees, so that the mirror direction is at theta_o = theta_i. Half and difference angles: the light is at theta_d,
 * phi_d around the half vector, turned there by R_z(phi_h) R_y(theta_h), and the viewer opposite to it.
 */
#include "io/csv/csv_directions.h"

#include <math.h>

#include "io/csv/angle.h"

#define DEGREES 57.29577951308232 /* 180 / pi */

/* Degrees beyond which an azimuth is a mark of missing ones or damage: two turns. */
#define MOST_AZIMUTH 720.0

/* Radians beyond which an angle cannot be one: two turns. */
#define MOST_RADIANS 12.6

int brdffit_io_in_radians(const struct csv_layout *layout, enum csv_role role)
{
    const size_t column = layout->column[role];
    const enum io_unit unit = column == BRDFFIT_NONE ? UNIT_NONE : layout->meaning[column].unit;

    return unit == UNIT_RADIANS || (unit != UNIT_DEGREES && (layout->options->directions_as & BRDFFIT_IO_RADIANS) != 0);
}

static int is_polar(enum csv_role role)
{
    return role == CSV_THETA_I || role == CSV_THETA_O || role == CSV_THETA_H || role == CSV_THETA_D;
}

static void see(struct csv_reader *r, enum csv_role role, double written)
{
    const double size = fabs(written);

    if (!is_polar(role)) {
        return;
    }
    r->polar_most = fmax(r->polar_most, size);
    r->polar_signed += written < 0.0;
    r->polar_broken += written != floor(written);
    r->light_at_right += fabs(size - 90.0) < 0.01;
    r->near_normal += size < 1.0;
}

/* The angle of a role in degrees, 0 without a column; 0 returned where it cannot be one. */
static int angle(struct csv_reader *r, const double *value, enum csv_role role, double *degrees)
{
    const size_t column = r->layout->column[role];
    const int elevation = column != BRDFFIT_NONE && is_polar(role) &&
                          (r->layout->meaning[column].elevation ||
                           (r->layout->options->directions_as & BRDFFIT_IO_ELEVATION));

    *degrees = 0.0;
    if (column == BRDFFIT_NONE) {
        return 1;
    }
    if (!elevation) {
        see(r, role, value[role]);
    }
    *degrees = value[role];
    if (brdffit_io_in_radians(r->layout, role)) {
        if (!(fabs(*degrees) <= MOST_RADIANS)) {
            return 0;
        }
        *degrees *= DEGREES;
    }
    *degrees = elevation ? 90.0 - *degrees : *degrees;
    return fabs(*degrees) <= (is_polar(role) ? 180.0 : MOST_AZIMUTH);
}

static const char *bad_angle(const struct csv_reader *r, enum csv_role role)
{
    if (brdffit_io_in_radians(r->layout, role)) {
        return is_polar(role) ? "a polar angle in radians (theta) beyond pi: are these degrees?"
                              : "an azimuth in radians (phi) beyond two turns: are these degrees?";
    }
    return role == CSV_THETA_I   ? "theta_i is not in [-180, 180] degrees"
           : role == CSV_THETA_O ? "theta_o is not in [-180, 180] degrees"
           : is_polar(role)      ? "the polar angle is not in [-180, 180] degrees"
                                 : "an azimuth beyond two turns";
}

/* Angles of the roles from `first` to `last`, in degrees; or what is wrong. */
static const char *angles(struct csv_reader *r, const double *value, enum csv_role first, enum csv_role last,
                          double *degrees, enum csv_role *role)
{
    int i;

    for (i = (int)first; i <= (int)last; i++) {
        if (!angle(r, value, (enum csv_role)i, &degrees[i - (int)first])) {
            *role = (enum csv_role)i;
            return bad_angle(r, *role);
        }
    }
    return NULL;
}

static const char *store_angles(struct csv_reader *r, size_t sample, const double *value, enum csv_role *role)
{
    const double turn = r->layout->options->directions_as & BRDFFIT_IO_MIRROR_AT_ZERO ? 180.0 : 0.0;
    double a[CSV_PHI - CSV_THETA_I + 1];
    const char *fault = angles(r, value, CSV_THETA_I, CSV_PHI, a, role);
    double phi_o;

    if (fault) {
        return fault;
    }
    phi_o = brdffit_io_csv_has(r->layout, CSV_PHI)     ? a[CSV_PHI]
            : brdffit_io_csv_has(r->layout, CSV_PHI_O) ? a[CSV_PHI_O]
                                                       : 180.0;
    brdffit_io_direction(a[CSV_THETA_I], a[CSV_PHI_I], r->table->array[IO_LIGHT] + 3 * sample);
    brdffit_io_direction(a[CSV_THETA_O], phi_o + turn, r->table->array[IO_VIEW] + 3 * sample);
    return NULL;
}

/* R_z(phi) R_y(theta) d. */
static void turn_to(double theta, double phi, const double d[3], double out[3])
{
    double sin_theta, cos_theta, sin_phi, cos_phi, x, z;

    brdffit_io_sincos_degrees(theta, &sin_theta, &cos_theta);
    brdffit_io_sincos_degrees(phi, &sin_phi, &cos_phi);
    x = cos_theta * d[0] + sin_theta * d[2];
    z = cos_theta * d[2] - sin_theta * d[0];
    out[0] = cos_phi * x - sin_phi * d[1];
    out[1] = sin_phi * x + cos_phi * d[1];
    out[2] = z;
}

static const char *store_half_angles(struct csv_reader *r, size_t sample, const double *value, enum csv_role *role)
{
    double a[CSV_PHI_D - CSV_THETA_H + 1], d[3];
    const char *fault = angles(r, value, CSV_THETA_H, CSV_PHI_D, a, role);

    if (fault) {
        return fault;
    }
    brdffit_io_direction(a[CSV_THETA_D - CSV_THETA_H], a[CSV_PHI_D - CSV_THETA_H], d);
    turn_to(a[0], a[1], d, r->table->array[IO_LIGHT] + 3 * sample);
    d[0] = -d[0];
    d[1] = -d[1];
    turn_to(a[0], a[1], d, r->table->array[IO_VIEW] + 3 * sample);
    return NULL;
}

/* +y to +z. */
static void turn_up(double *v)
{
    const double y = v[1];

    v[1] = -v[2];
    v[2] = y;
}

static int store_vector(struct csv_reader *r, size_t sample, const double *value, enum io_array array)
{
    double *out = r->table->array[array] + 3 * sample;
    int i;

    for (i = 0; i < 3; i++) {
        out[i] = value[i];
    }
    if (r->layout->options->directions_as & BRDFFIT_IO_Y_UP) {
        turn_up(out);
    }
    return value[0] != 0.0 || value[1] != 0.0 || value[2] != 0.0;
}

static const char *store_vectors(struct csv_reader *r, size_t sample, const double *value, enum csv_role *role)
{
    *role = CSV_LX;
    if (!store_vector(r, sample, value + CSV_LX, IO_LIGHT)) {
        return "lx, ly, lz has no length";
    }
    *role = CSV_VX;
    if (!store_vector(r, sample, value + CSV_VX, IO_VIEW)) {
        return "vx, vy, vz has no length";
    }
    *role = CSV_NX;
    if (brdffit_io_csv_has(r->layout, CSV_NX) && !store_vector(r, sample, value + CSV_NX, IO_NORMAL)) {
        return "nx, ny, nz has no length";
    }
    *role = CSV_TX;
    if (brdffit_io_csv_has(r->layout, CSV_TX) && !store_vector(r, sample, value + CSV_TX, IO_TANGENT)) {
        return "tx, ty, tz has no length";
    }
    return NULL;
}

static const char *store_coefficients(struct csv_reader *r, size_t sample, const double *value, enum csv_role *role)
{
    static const char *const message[3] = {"a is negative", "b is negative", "c is negative"};
    int i;

    for (i = 0; i < 3; i++) {
        *role = (enum csv_role)(CSV_A + i);
        if (!(value[*role] >= 0.0)) {
            return message[i];
        }
        r->table->array[IO_A + i][sample] = value[*role];
    }
    return NULL;
}

const char *brdffit_io_csv_store(struct csv_reader *reader, size_t sample, const double *value, enum csv_role *role)
{
    const char *fault = NULL;

    switch (reader->layout->kind) {
    case CSV_ANGLES: fault = store_angles(reader, sample, value, role); break;
    case CSV_HALF_ANGLES: fault = store_half_angles(reader, sample, value, role); break;
    case CSV_VECTORS: fault = store_vectors(reader, sample, value, role); break;
    case CSV_COEFFICIENTS: return store_coefficients(reader, sample, value, role);
    }
    if (!fault && (reader->layout->options->directions_as & BRDFFIT_IO_LIGHT_TRAVELS)) {
        double *light = reader->table->array[IO_LIGHT] + 3 * sample;

        light[0] = -light[0];
        light[1] = -light[1];
        light[2] = -light[2];
    }
    return fault;
}
