/*
 * Kinds of directions: see kind.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/kind.h"

static int all_of(const struct csv_layout *layout, enum csv_role first, enum csv_role last)
{
    int role;

    for (role = (int)first; role <= (int)last; role++) {
        if (!brdffit_io_csv_has(layout, (enum csv_role)role)) {
            return 0;
        }
    }
    return 1;
}

static brdffit_status check_angles(struct csv_layout *layout, brdffit_error *error)
{
    const int phi_i = brdffit_io_csv_has(layout, CSV_PHI_I), phi_o = brdffit_io_csv_has(layout, CSV_PHI_O);

    layout->kind = CSV_ANGLES;
    if (brdffit_io_layout_any(layout, CSV_LX, CSV_TZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header mixes angles and vectors", error);
    }
    if (!brdffit_io_csv_has(layout, CSV_THETA_I) || !brdffit_io_csv_has(layout, CSV_THETA_O)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs both theta_i and theta_o", error);
    }
    if (brdffit_io_csv_has(layout, CSV_PHI) && (phi_i || phi_o)) {
        return brdffit_io_layout_fail(layout, layout->column[CSV_PHI],
                                      "an azimuth beside phi_i or phi_o: which is it (--column phi_o=NAME)?", error);
    }
    if (phi_i && !phi_o) {
        return brdffit_io_layout_fail(
            layout, BRDFFIT_NONE, "the header needs both phi_i and phi_o, or neither, or phi between the two", error);
    }
    return BRDFFIT_OK;
}

static brdffit_status check_half_angles(struct csv_layout *layout, brdffit_error *error)
{
    layout->kind = CSV_HALF_ANGLES;
    if (brdffit_io_layout_any(layout, CSV_LX, CSV_TZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header mixes angles and vectors", error);
    }
    if (!brdffit_io_csv_has(layout, CSV_THETA_H) || !brdffit_io_csv_has(layout, CSV_THETA_D) ||
        !brdffit_io_csv_has(layout, CSV_PHI_D)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of theta_h, theta_d, phi_d", error);
    }
    return BRDFFIT_OK;
}

static brdffit_status check_vectors(struct csv_layout *layout, brdffit_error *error)
{
    layout->kind = CSV_VECTORS;
    if (!all_of(layout, CSV_LX, CSV_VZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of lx, ly, lz, vx, vy, vz", error);
    }
    if (brdffit_io_layout_any(layout, CSV_NX, CSV_NZ) && !all_of(layout, CSV_NX, CSV_NZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of nx, ny, nz, or none", error);
    }
    if (brdffit_io_layout_any(layout, CSV_TX, CSV_TZ) && !all_of(layout, CSV_TX, CSV_TZ)) {
        return brdffit_io_layout_fail(layout, BRDFFIT_NONE, "the header needs all of tx, ty, tz, or none", error);
    }
    return BRDFFIT_OK;
}

/* The first column whose name looks like a direction and is none. */
static brdffit_status fail_direction(const struct csv_layout *layout, brdffit_error *error)
{
    size_t j = 0;

    while (layout->meaning[j].role != CSV_DIRECTION) {
        j++;
    }
    return brdffit_io_layout_fail(layout, j,
                                  "this column looks like a direction (theta, phi ...) but is not understood, its unit "
                                  "included: say what it is by --column phi=NAME, or ignore=NAME",
                                  error);
}

static brdffit_status check_kind(struct csv_layout *layout, brdffit_error *error)
{
    if (brdffit_io_layout_any(layout, CSV_THETA_H, CSV_PHI_D) && !brdffit_io_layout_any(layout, CSV_THETA_I, CSV_PHI)) {
        return check_half_angles(layout, error);
    }
    if (brdffit_io_layout_any(layout, CSV_THETA_I, CSV_PHI_D)) {
        return check_angles(layout, error);
    }
    if (brdffit_io_layout_any(layout, CSV_LX, CSV_TZ)) {
        return check_vectors(layout, error);
    }
    layout->kind = CSV_COEFFICIENTS;
    if (brdffit_io_layout_any(layout, CSV_DIRECTION, CSV_DIRECTION)) {
        return fail_direction(layout, error);
    }
    if (!all_of(layout, CSV_A, CSV_C)) {
        return brdffit_io_layout_fail(
            layout, BRDFFIT_NONE,
            "the header names no directions (theta_i,phi_i,theta_o,phi_o or lx,ly,lz,vx,vy,vz or "
            "a,b,c; --column theta_i=NAME,... says what others mean)",
            error);
    }
    return BRDFFIT_OK;
}

/* A name with theta or phi in it that is not understood: harmless only where the directions are complete without it. */
static brdffit_status check_directions(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    const int complete = layout->kind != CSV_ANGLES || brdffit_io_csv_has(layout, CSV_PHI) ||
                         brdffit_io_csv_has(layout, CSV_PHI_O);
    char name[IO_QUOTED];
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role != CSV_DIRECTION) {
            continue;
        }
        if (!complete) {
            return fail_direction(layout, error);
        }
        layout->meaning[j].role = CSV_IGNORED;
        if (table) {
            brdffit_io_table_note(table, 0, "column %s is left out: it looks like an angle that the directions imply",
                                  brdffit_io_column_name(layout, j, name));
        }
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_layout_kind(struct csv_layout *layout, struct io_table *table, brdffit_error *error)
{
    brdffit_status status = check_kind(layout, error);

    return status == BRDFFIT_OK ? check_directions(layout, table, error) : status;
}
