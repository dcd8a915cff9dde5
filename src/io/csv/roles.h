/*
 * What a column of a text table means, by its name. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_ROLES_H
#define BRDFFIT_IO_ROLES_H

#include "io/csv/words.h"

/* In the order of the names that users give them: brdffit_io_role_name(). */
enum csv_role {
    CSV_THETA_I = 0,
    CSV_PHI_I,
    CSV_THETA_O,
    CSV_PHI_O,
    CSV_PHI, /* azimuth between light and viewer */
    CSV_THETA_H,
    CSV_PHI_H,
    CSV_THETA_D,
    CSV_PHI_D,
    CSV_LX,
    CSV_LY,
    CSV_LZ,
    CSV_VX,
    CSV_VY,
    CSV_VZ,
    CSV_NX,
    CSV_NY,
    CSV_NZ,
    CSV_TX, /* tangent: where anisotropic lobes are turned from */
    CSV_TY,
    CSV_TZ,
    CSV_A,
    CSV_B,
    CSV_C,
    CSV_WEIGHT,
    CSV_UNCERTAINTY, /* standard deviation of the values: of weight 1 / u^2, see csv_weight.h */
    CSV_WAVELENGTH,  /* of the one channel of this row */
    CSV_ROLE_COUNT,
    /* Any number of columns each: */
    CSV_CHANNEL = CSV_ROLE_COUNT,
    CSV_IGNORED,
    CSV_NAMED_ROLES,
    /* Not yet decided: by the other columns, or by what they hold */
    CSV_THETA_S = CSV_NAMED_ROLES, /* of the sun, or of scatter */
    CSV_PHI_S,
    CSV_W,         /* a weight, or white */
    CSV_UNKNOWN,   /* a channel, unless its fields say otherwise */
    CSV_DIRECTION, /* looks like one that is not understood */
    CSV_SPREAD,
    CSV_MASK,
    CSV_INDEX,
    CSV_CONDITION,
    CSV_CORRECTION,
    CSV_REMARK,
    CSV_GROUP,
    CSV_LOGARITHM,
    CSV_UNNAMED
};

struct csv_meaning {
    enum csv_role role;
    enum io_unit unit;
    int elevation; /* a polar angle from the surface up */
};

struct csv_meaning brdffit_io_meaning(const struct io_field *name);

/* "theta_i", "channel", "ignore": of roles below CSV_NAMED_ROLES. */
const char *brdffit_io_role_name(enum csv_role role);

/* The role of that name, or CSV_NAMED_ROLES. */
enum csv_role brdffit_io_role_named(const char *text, size_t length);

/* What --values calls the quantity that a channel's name says, or NULL: f_r, or nothing. */
const char *brdffit_io_names_values(const struct io_field *name);

int brdffit_io_is_angle(enum csv_role role);

#endif
