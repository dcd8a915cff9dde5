/*
 * Strips of a table in half/difference angles: cells that share theta_h and theta_d, summed in lanes while the file
 * streams by. One table of functions per instruction set, all with the same bits (lanes.h).
 * SPDX-License-Identifier: MIT
 *
 * Cell p has n.l, n.v = upright -+ across cos phi_p. Of b only what changes from cell to cell is computed here
 * (enum table_row_kind, and its factor in lobe.h), and n.l stands for a = (n.l) / pi: the factors that a row
 * shares are multiplied into its sums.
 *
 * Rounding: a lane adds at most TABLE_ROW_BLOCKS products plainly, and TwoSum adds such sums to high and low without
 * another error (but those of low itself), so a sum of terms of one sign is within TABLE_ROW_BLOCKS + 8 units of the exact
 * one however many strips there are: the promise of reduce_sums.c.
 */
#ifndef BRDFFIT_TABLE_ROW_H
#define BRDFFIT_TABLE_ROW_H

#include <stddef.h>
#include <stdint.h>

#include "brdffit.h"
#include "base/lanes.h"
#include "model/lobe.h"

/* Most blocks of LANES cells that are summed plainly. */
#define TABLE_ROW_BLOCKS 64u
#define TABLE_ROW_CELLS (TABLE_ROW_BLOCKS * LANES)

struct strip {
    enum table_row_kind kind;
    double upright, across, shared; /* across >= 0 */
    double horizon;    /* l and v must be above this */
    double min_cosine; /* l must not be below this */
    size_t cells;      /* 1 .. TABLE_ROW_CELLS */
    size_t readable;   /* doubles from the first cell on that may be read in each plane, >= cells */
    const double *cosine;            /* cos phi_p, padded with NaN to whole blocks */
    const double *low, *high;        /* smallest and largest cosine of each block, padding apart */
    size_t channels;
    const unsigned char *const *plane; /* per channel, the first cell of the ROW: native doubles of any alignment */
    size_t first;                    /* the strip's first cell in the row */
    const double *scale;             /* per channel: entry * scale is f_r */
};

/* Sums, in this order: ll, lb, bb, b^4, then l I, b I, I^2 of each channel, I = f_r l. */
#define TABLE_ROW_SUMS(channels) (4 + 3 * (channels))
#define TABLE_ROW_TOTALS_DOUBLES(channels) (LANES * (2 * TABLE_ROW_SUMS(channels) + (channels) + 1))

/* Running totals in lanes; the caller's arrays, zero at first. */
struct table_row_totals {
    double *high, *low; /* TABLE_ROW_SUMS x LANES each */
    double *largest;    /* channels x LANES: of I */
    double *seen;       /* LANES: NaN or infinite when some entry is (or when the entries' sum overflows) */
    int64_t used, below, absent; /* cells that count; on or below the horizon; above it with a negative entry */
};

struct table_row_kernels {
    void (*add)(const struct strip *strip, struct table_row_totals *totals);
};

extern const struct table_row_kernels brdffit_table_row_base;
extern const struct table_row_kernels brdffit_table_row_avx2;
extern const struct table_row_kernels brdffit_table_row_avx512;

/* As brdffit_kernels() of kernels.h. */
const struct table_row_kernels *brdffit_table_row_kernels(brdffit_isa isa);

#endif
