/*
 * Strips of a table in half/difference angles: cells that share theta_h and theta_d, summed in lanes while the file
 * streams by. One table of functions per instruction set, all with the same bits (lanes.h). Layer 1.
 * SPDX-License-Identifier: MIT
 *
 * Cell p has n.l, n.v = upright -+ across cos phi_p. Of b only what changes from cell to cell is computed here
 * (enum strip_kind, and its factor in geometry_rows.h), and n.l stands for a = (n.l) / pi: the factors that a row
 * shares are multiplied into its sums.
 *
 * Rounding: a lane adds at most STRIP_BLOCKS products plainly, and TwoSum adds such sums to high and low without
 * another error (but those of low itself), so a sum of terms of one sign is within STRIP_BLOCKS + 8 units of the exact
 * one however many strips there are: the promise of reduce_sums.c.
 */
#ifndef BRDFFIT_STRIP_H
#define BRDFFIT_STRIP_H

#include <stddef.h>
#include <stdint.h>

#include "brdffit.h"
#include "lanes.h"

/* Most blocks of LANES cells that are summed plainly. */
#define STRIP_BLOCKS 64u
#define STRIP_CELLS (STRIP_BLOCKS * LANES)

/* What b is made of, given l = n.l and v = n.v. */
enum strip_kind {
    STRIP_SHADOWED, /* min(1, shared min(l, v)) / v */
    STRIP_ROOT,     /* sqrt(l / v) */
    STRIP_LIGHT,    /* l */
    STRIP_SIDE,     /* shared l / max(l, v) */
    STRIP_KINDS
};

struct strip {
    enum strip_kind kind;
    double upright, across, shared; /* across >= 0 */
    double horizon;    /* l and v must be above this */
    double min_cosine; /* l must not be below this */
    size_t cells;      /* 1 .. STRIP_CELLS */
    size_t readable;   /* doubles from the first cell on that may be read in each plane, >= cells */
    const double *cosine;            /* cos phi_p, padded with NaN to whole blocks */
    const double *low, *high;        /* smallest and largest cosine of each block, padding apart */
    size_t channels;
    const unsigned char *const *plane; /* per channel, the first cell of the ROW: native doubles of any alignment */
    size_t first;                    /* the strip's first cell in the row */
    const double *scale;             /* per channel: entry * scale is f_r */
};

/* Sums, in this order: ll, lb, bb, b^4, then l I, b I, I^2 of each channel, I = f_r l. */
#define STRIP_SUMS(channels) (4 + 3 * (channels))
#define STRIP_TOTALS_DOUBLES(channels) (LANES * (2 * STRIP_SUMS(channels) + (channels) + 1))

/* Running totals in lanes; the caller's arrays, zero at first. */
struct strip_totals {
    double *high, *low; /* STRIP_SUMS x LANES each */
    double *largest;    /* channels x LANES: of I */
    double *seen;       /* LANES: NaN or infinite when some entry is (or when the entries' sum overflows) */
    int64_t used, below, absent; /* cells that count; on or below the horizon; above it with a negative entry */
};

struct strip_kernels {
    void (*add)(const struct strip *strip, struct strip_totals *totals);
};

extern const struct strip_kernels brdffit_strip_base;
extern const struct strip_kernels brdffit_strip_avx2;
extern const struct strip_kernels brdffit_strip_avx512;

/* As brdffit_kernels() of kernels.h. */
const struct strip_kernels *brdffit_strip_kernels(brdffit_isa isa);

#endif
