/*
 * A MERL table as sums, in one sweep over the file. SPDX-License-Identifier: MIT
 *
 * Cells are those of merl_table.c, a theta_h at a time: one group of the sums each (brdffit_row of brdffit.h). Sines and
 * cosines of the axes are all that is computed beforehand; n.l and n.v are cheaper made anew than loaded.
 */
#include <stdint.h>

#include "io/fail.h"
#include "io/limits.h"
#include "io/bytes/memory.h"
#include "io/merl/merl.h"
#include "io/merl/merl_axes.h"

/* Rows hold native doubles, files little-endian ones. */
static int host_is_little(void)
{
    const uint16_t one = 1;
    unsigned char first;

    memcpy(&first, &one, 1);
    return first == 1;
}

static brdffit_status add_rows(const struct merl *merl, const struct merl_axis axis[3], brdffit_sums *sums,
                               size_t cells[BRDFFIT_CELL_COUNT], brdffit_error *error)
{
    const size_t row_bytes = merl->dims[1] * merl->dims[2] * sizeof(double);
    const void *entries[MERL_CHANNELS];
    brdffit_status status = BRDFFIT_OK;
    brdffit_row row;
    size_t h, k;

    brdffit_row_init(&row);
    row.differences = merl->dims[1];
    row.azimuths = merl->dims[2];
    row.horizon = IO_HORIZON;
    row.sin_difference = axis[1].sine;
    row.cos_difference = axis[1].cosine;
    row.cos_azimuth = axis[2].cosine;
    row.entries = entries;
    row.scale = brdffit_io_merl_scale;
    for (h = 0; h < merl->dims[0] && status == BRDFFIT_OK; h++) {
        row.sin_half = axis[0].sine[h];
        row.cos_half = axis[0].cosine[h];
        for (k = 0; k < MERL_CHANNELS; k++) {
            entries[k] = merl->plane + (k * merl->dims[0] + h) * row_bytes;
        }
        status = brdffit_sums_add_row(sums, &row, cells, error);
    }
    return status;
}

static brdffit_status sum_table(const struct merl *merl, const brdffit_io_options *options, const brdffit_options *fit,
                                struct io_table *table, brdffit_error *error)
{
    size_t size = brdffit_sums_size(MERL_CHANNELS, merl->dims[0]), cells[BRDFFIT_CELL_COUNT] = {0, 0, 0};
    struct merl_axis axis[3];
    brdffit_status status;

    table->sums_memory = size > 0 ? brdffit_io_alloc(size, 1) : NULL;
    if (!brdffit_io_merl_axes_new(axis, merl->dims, options->merl_bins) || !table->sums_memory) {
        brdffit_io_merl_axes_free(axis);
        return brdffit_io_no_memory(error);
    }
    status = brdffit_sums_init(table->sums_memory, size, MERL_CHANNELS, merl->dims[0], fit, &table->open.sums, error);
    if (status == BRDFFIT_OK) {
        status = add_rows(merl, axis, table->open.sums, cells, error);
    }
    brdffit_io_merl_axes_free(axis);
    table->samples.form = BRDFFIT_FORM_ANGLES;
    table->samples.count = cells[BRDFFIT_CELL_SAMPLE];
    table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON] = cells[BRDFFIT_CELL_BELOW_HORIZON];
    table->dropped[BRDFFIT_IO_DROP_MASKED] = cells[BRDFFIT_CELL_ABSENT];
    return status;
}

brdffit_status brdffit_io_merl_sum(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                   const brdffit_options *fit, struct io_table *table, brdffit_error *error)
{
    struct merl merl;
    brdffit_status status = brdffit_io_merl_open(data, size, &merl, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!host_is_little() || (options->quantity_set && options->quantity != BRDFFIT_QUANTITY_BRDF)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_UNSUPPORTED, "not as sums");
    }
    if (!brdffit_io_merl_describe(&merl, options, table)) {
        return brdffit_io_no_memory(error);
    }
    status = sum_table(&merl, options, fit, table, error);
    if (status == BRDFFIT_ERR_VALUE) {
        status = brdffit_io_merl_finite(&merl, error); /* names the cell */
        return status == BRDFFIT_OK ? BRDFFIT_ERR_UNSUPPORTED : status;
    }
    return status == BRDFFIT_OK && table->samples.count == 0 ? brdffit_io_merl_empty(error) : status;
}
