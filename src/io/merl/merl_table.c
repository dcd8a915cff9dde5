/*
 * Every cell of a MERL table as a sample in half/difference angles. SPDX-License-Identifier: MIT
 *
 * Cell (h, d, p) stands for theta_h = 90 (h + o)^2 / n_h^2, theta_d = 90 (d + o) / n_d, phi_d = 180 (p + o) / n_p
 * degrees, o = 0 (edge) or 1/2 (centre). With light and view at h +- d,
 *
 *     n.l, n.v = cos theta_h cos theta_d -+ sin theta_h sin theta_d cos phi_d        v.h = cos theta_d
 *
 * tan^2 alpha depends on theta_h alone and is computed once a row, so that the fit merges the row to the bit.
 */
#include "io/csv/angle.h"
#include "io/fail.h"
#include "io/limits.h"
#include "io/bytes/memory.h"
#include "io/merl/merl.h"
#include "io/merl/merl_axes.h"

const double brdffit_io_merl_scale[MERL_CHANNELS] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

static int axis_new(struct merl_axis *axis, size_t bins)
{
    axis->sine = brdffit_io_alloc(bins, sizeof(double));
    axis->cosine = brdffit_io_alloc(bins, sizeof(double));
    return axis->sine && axis->cosine;
}

static void axis_free(struct merl_axis *axis)
{
    brdffit_io_release(axis->sine);
    brdffit_io_release(axis->cosine);
}

/* theta_h spends its bins near 0: the square of the fraction. phi_d spans two right angles. */
static void axis_fill(struct merl_axis *axis, size_t bins, brdffit_io_merl_bins convention, int squared,
                      int right_angles)
{
    uint64_t step = convention == BRDFFIT_IO_MERL_CENTRE ? 2 : 1, n = step * bins, i;

    for (i = 0; i < bins; i++) {
        uint64_t at = step * i + (step - 1);

        if (squared) {
            brdffit_io_sincos_ratio(at * at, n * n, &axis->sine[i], &axis->cosine[i]);
        } else {
            brdffit_io_sincos_ratio((uint64_t)right_angles * at, n, &axis->sine[i], &axis->cosine[i]);
        }
    }
}

/* What the cells of one (h, d) share. */
struct cells {
    size_t first;
    double upright, across; /* the two products of the formula above, without cos phi_d */
    double tan2_half, cos_difference;
};

/* Write the usable cells from sample `at` on; returns the sample after the last. */
static size_t fill_cells(const struct merl *merl, const struct cells *cells, const double *cos_phi,
                         struct io_table *table, size_t at)
{
    double *cos_light = table->array[IO_COS_LIGHT], *cos_view = table->array[IO_COS_VIEW];
    double *tan2_half = table->array[IO_TAN2_HALF], *cos_difference = table->array[IO_COS_DIFFERENCE];
    double *values = table->array[IO_VALUES];
    const double r = brdffit_io_merl_scale[0], g = brdffit_io_merl_scale[1], b = brdffit_io_merl_scale[2];
    size_t p, bins = merl->dims[2], start = at, below = 0;

    for (p = 0; p < bins; p++) {
        double swing = cells->across * cos_phi[p], light = cells->upright - swing, view = cells->upright + swing;
        double red, green, blue;

        if (!(light > IO_HORIZON && view > IO_HORIZON)) {
            below++;
            continue;
        }
        red = brdffit_io_merl_entry(merl, 0, cells->first + p);
        green = brdffit_io_merl_entry(merl, 1, cells->first + p);
        blue = brdffit_io_merl_entry(merl, 2, cells->first + p);
        if (red < 0.0 || green < 0.0 || blue < 0.0) {
            continue;
        }
        cos_light[at] = light < 1.0 ? light : 1.0; /* cos^2 + sin^2 may round above 1 */
        cos_view[at] = view < 1.0 ? view : 1.0;
        tan2_half[at] = cells->tan2_half;
        cos_difference[at] = cells->cos_difference;
        values[3 * at] = red * r;
        values[3 * at + 1] = green * g;
        values[3 * at + 2] = blue * b;
        at++;
    }
    table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON] += below;
    table->dropped[BRDFFIT_IO_DROP_MASKED] += bins - below - (at - start);
    return at;
}

static void fill(const struct merl *merl, const struct merl_axis axis[3], struct io_table *table)
{
    struct cells cells;
    size_t h, d, count = 0;

    cells.first = 0;
    for (h = 0; h < merl->dims[0]; h++) {
        double sine = axis[0].sine[h], cosine = axis[0].cosine[h], tangent = sine / cosine;

        cells.tan2_half = tangent * tangent;
        for (d = 0; d < merl->dims[1]; d++) {
            cells.upright = cosine * axis[1].cosine[d];
            cells.across = sine * axis[1].sine[d];
            cells.cos_difference = axis[1].cosine[d];
            count = fill_cells(merl, &cells, axis[2].cosine, table, count);
            cells.first += merl->dims[2];
        }
    }
    table->samples.count = count;
}

int brdffit_io_merl_axes_new(struct merl_axis axis[3], const size_t dims[3], brdffit_io_merl_bins bins)
{
    int i, enough = 1;

    memset(axis, 0, 3 * sizeof *axis);
    for (i = 0; i < 3 && enough; i++) {
        enough = axis_new(&axis[i], dims[i]);
        if (enough) {
            axis_fill(&axis[i], dims[i], bins, i == 0, i == 2 ? 2 : 1);
        }
    }
    return enough;
}

void brdffit_io_merl_axes_free(struct merl_axis axis[3])
{
    int i;

    for (i = 0; i < 3; i++) {
        axis_free(&axis[i]);
    }
}

brdffit_status brdffit_io_merl_all(const struct merl *merl, brdffit_io_merl_bins bins, struct io_table *table,
                                   brdffit_error *error)
{
    struct merl_axis axis[3];
    int enough = brdffit_io_merl_axes_new(axis, merl->dims, bins);

    table->samples.form = BRDFFIT_FORM_ANGLES;
    table->width[IO_COS_LIGHT] = 1;
    table->width[IO_COS_VIEW] = 1;
    table->width[IO_TAN2_HALF] = 1;
    table->width[IO_COS_DIFFERENCE] = 1;
    /* Room for every cell: pages of those that are dropped are never touched. */
    enough = enough && brdffit_io_table_reserve(table, merl->cells);
    if (enough) {
        fill(merl, axis, table);
    }
    brdffit_io_merl_axes_free(axis);
    return enough ? BRDFFIT_OK : brdffit_io_no_memory(error);
}
