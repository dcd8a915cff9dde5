/*
 * MERL .binary tables. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_MERL_H
#define BRDFFIT_IO_MERL_H

#include <stdint.h>
#include <string.h>

#include "io/table.h"

/* Bytes of the header: three int32. */
#define MERL_HEADER ((size_t)12)
#define MERL_CHANNELS 3

struct merl {
    size_t dims[3];             /* theta_h, theta_d, phi_d bins */
    size_t cells;               /* their product */
    const unsigned char *plane; /* red; green and blue follow, little-endian float64, of any alignment */
};

/* Check the header against the true size. `error` may be NULL. */
brdffit_status brdffit_io_merl_open(const unsigned char *data, size_t size, struct merl *merl, brdffit_error *error);

/* 1 when the twelve bytes are positive dimensions whose table would not overflow the largest file. */
int brdffit_io_merl_plausible(const unsigned char *data);

/* Bytes of the file that a header of twelve bytes announces; 0: it is none. */
uint64_t brdffit_io_merl_bytes(const unsigned char *data);

/* Little-endian bits on any host; compilers make one load of it. */
static inline uint64_t brdffit_io_merl_bits(const unsigned char *p)
{
    return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 | (uint64_t)p[4] << 32 |
           (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

/* Entry of one plane, unscaled. */
static inline double brdffit_io_merl_entry(const struct merl *merl, size_t channel, size_t cell)
{
    uint64_t bits = brdffit_io_merl_bits(merl->plane + (channel * merl->cells + cell) * sizeof bits);
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

/* f_r = entry * scale, 1/sr. */
extern const double brdffit_io_merl_scale[MERL_CHANNELS];

/* Fill `table` (new and empty) with what the options ask for. The caller frees the table, on failure too. */
brdffit_status brdffit_io_merl_read(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                    struct io_table *table, brdffit_error *error);

/* Parts of the above: names and what the options said (0: no memory); the whole table must be finite; no samples. */
int brdffit_io_merl_describe(const struct merl *merl, const brdffit_io_options *options, struct io_table *table);
brdffit_status brdffit_io_merl_finite(const struct merl *merl, brdffit_error *error);
brdffit_status brdffit_io_merl_empty(brdffit_error *error);

/*
 * The same file as sums for a fit with these options (merl_sums.c): table->open.sums. BRDFFIT_ERR_UNSUPPORTED when only
 * samples will do.
 */
brdffit_status brdffit_io_merl_sum(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                   const brdffit_options *fit, struct io_table *table, brdffit_error *error);

/* Parts of brdffit_io_merl_read(): every cell (merl_table.c), or the cells of directions (merl_lookup.c). */
brdffit_status brdffit_io_merl_all(const struct merl *merl, brdffit_io_merl_bins bins, struct io_table *table,
                                   brdffit_error *error);
brdffit_status brdffit_io_merl_at(const struct merl *merl, const brdffit_samples *directions, struct io_table *table,
                                  brdffit_error *error);

/*
 * Index of the cell that unit vectors l and v around the normal +z fall into, both above the horizon.
 */
size_t brdffit_io_merl_cell(const size_t dims[3], const double l[3], const double v[3]);

#endif
