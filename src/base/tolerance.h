/*
 * Every tolerance and limit of the library: name, unit, why this value.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TOLERANCE_H
#define BRDFFIT_TOLERANCE_H

#include "base/ieee.h"

/* Half a unit in the last place of 1: the rounding unit u of IEEE double. */
#define TOL_UNIT 1.1102230246251565e-16

/* Smallest roughness that an option may ask for: sigma^-2 = 1e24 stays far from overflow. */
#define LIMIT_SIGMA_MIN 1e-12
/* Largest: beyond, every lobe is the same smooth function to rounding. */
#define LIMIT_SIGMA_MAX 1e3
/* The same limits of s for distributions whose parameter is the exponent, s = n. */
#define LIMIT_EXPONENT_MIN 1e-6
#define LIMIT_EXPONENT_MAX 1e24

/* Largest ratio of the two roughnesses of an anisotropic lobe, and its inverse the smallest. */
#define ANISOTROPY_MOST 1e6

/* cos(max_incidence) is compared with this absolute allowance, so that a light at exactly the limit
 * counts whatever its trigonometric functions rounded to (60 degrees: 4 ulp of cos). */
#define TOL_INCIDENCE 1e-12

/* Radians: directions are taken to be known to this (brdffit.h), so half-vector angles within it are one. */
#define TOL_ANGLE 1e-15
/* Relative to c - c_min: larger changes by that merging are left alone, where they would cost the bound. */
#define TOL_SNAP 1e-13
/* Change of c s by merging with c_min, at the end of the search: less than objectives are told apart by (1e-9). */
#define TOL_JOIN 1e-11

/* A direction whose cosine with the normal is below this counts as on the horizon: c and b stay finite. */
#define LIMIT_GRAZING 1e-30

/* Largest ratio of two non-zero b (or a) that squares into a double with room for sums. */
#define LIMIT_COEFFICIENT_RATIO 1e140
/* Products of two shapes below exp(-this) = 5e-301 are left out of sums: a relative 1e-20 with that ratio. */
#define PAIR_EXPONENT 690.0
/* Largest c (tan^2 alpha): its products with s stay finite. */
#define LIMIT_C 1e100
/* Smallest largest value of a channel: coefficients in the data's units must keep their digits. */
#define LIMIT_SMALLEST 1e-304
/* Largest magnitude of data that is minimised in its own units: its square must stay finite. */
#define LIMIT_VALUE 1e150

/* Fewer effective samples than this: a lobe is a fit to single samples (theory 4.5). */
#define LIMIT_EFFECTIVE_SAMPLES 3.0

/*
 * The tail of s (theory 4.1): beyond s_tail the normalised lobe is within exp(-TAIL_EXPONENT) = 4e-18 of its
 * limit, so that whole tail is one point. The inflation of the bound's inputs below covers the difference.
 */
#define TAIL_EXPONENT 40.0

/* y = y' exp(c_min s) / lambda(s) must be a finite double: its logarithm may not exceed this (ln DBL_MAX = 709.78; the
 * rest is for the rounding of c_min s and of the sigma that is published). */
#define LIMIT_EXPONENT 709.0
/* Least H of a second column that has no sample at c_min (theory 7.2): the square of its largest b is about 1, and what
 * PAIR_EXPONENT leaves out of sums, or underflows in them, is below 1e-30 of it. */
#define LIMIT_SECOND_NORM 1e-270
/* Below this exponent exp() and its inverse are ordinary numbers, with room for every scale that goes with them. */
#define LIMIT_PLAIN_EXPONENT 300.0

/*
 * E^2 of the model that is published (published.c), in units of u relative to |I| + |a x| + sum |y g| of a row: rows 3,
 * coefficients back from the data's units 8, lambda exp(-c_min s) 12, shapes 4 and residuals 5. The exponents of shapes
 * count apart: c' s has 3 u of its own (c - c_min, s, their product), an error of 3 u c' s in the shape.
 */
#define TOL_PUBLISHED 32.0
#define TOL_PUBLISHED_EXPONENT 3.0
/* What publishing may take off coefficients at a physical bound, in units of u relative to them: 24 u, and what rounding of sigma
 * makes of y (theta within 60 u, exponents apart). */
#define TOL_PHYSICAL 256.0
/* Rows by Householder's triangles: 64 rows and the triangle at a time, m x n of them with a backward error, column by
 * column, of a small constant times m n u (Higham, Accuracy and Stability, theorem 19.4). */
#define TOL_TRIANGLE 4.0

/* What the search allows for hidden lobes at a point is more by this part than what the published one will be charged, at
 * rounded roughness and with another objective. */
#define TOL_ALLOWANCE 1e-6

/* Ends of the range of theta = ln s, in units of u relative to 1 + |theta|: kernel_log within 2 ulp (4 u |theta|), its
 * rounding, and 3 u in s of sigma^-2. The range that is searched is wider by this on each side. */
#define TOL_END 8.0

/*
 * Rounding of the moments, in units of u relative to a sum of positive terms (moments.c): 64-sample blocks,
 * compensated across blocks (reduce.c), then 8 lanes of M/8 terms, exp within 2 u, products and a root:
 * TOL_MOMENT_BASE + M / 8 with a factor of 2 to spare. Inputs of the bound are inflated by this much.
 */
#define TOL_MOMENT_BASE 100.0
/*
 * What rows made of sums (sums_reduce.c) may be off, in units of u relative to (|a x| + |b Y| + |I|)^2: sums within 80
 * (table_row.h, sums.h), their factors within 8, Cholesky within 16, and its shift of 160 at most. The
 * optimum has no negative terms, so that each norm is at most |I|: its objective is off by at most 9 such units of the data's sum of squares.
 */
#define TOL_GRAM 320.0
/* Sums keep products of weights and coefficients without scaling them: each non-zero b and w within this of 1, and a
 * and |I| below the second, so that w^2 b^4 and w I^2 are normal numbers with room for 1e8 samples. */
#define LIMIT_SUMS_RANGE 1e50
#define LIMIT_SUMS_VALUE 1e100

/* Evaluation of the restricted gain (gain.h), at most 64, and of the climb over a box (gains.h), in units of u
 * relative to |t|^2. */
#define TOL_GAIN 128.0
/* The same for more than three columns (gain_n.h): n^2 u for the factorisation of up to 7, beside multipliers that count as
 * zero, in units of TOL_GAIN. */
#define TOL_GAIN_COLUMNS 4.0
/* Relative inflation of curvature bounds, whose own rounding is about 1e-13 at worst. */
#define TOL_CURVATURE 1e-10

/* Relative rounding of one lobe value from our exp (arguments to 708) with its slope and tilt: 1e-13 (bound_lp). */
#define TOL_SHAPE 1e-12

/* Shifts of tau beyond this many |I_k| are no use for a bound, and would take its arithmetic out of range (gains.h). */
#define LIMIT_SHIFT 1e6

/* Off-diagonals of a Gram matrix are kept this far below 1 (lower is the safe side of a bound). */
#define LIMIT_COSINE (1.0 - 1e-15)

/* A column is dependent on earlier ones when less than this part of its norm is new (nnls.c). */
#define TOL_DEPENDENT 4e-16

/* An objective this close to the optimum is the optimum to rounding: relative to E^2, and to the data's sum of
 * squares (residuals of an exact fit are a few u of the data each). */
#define TOL_FLAT_RELATIVE 1e-12
#define TOL_FLAT_ABSOLUTE 1e-28
/* Of norms l1 and linf, whose objective is not squared, relative to that of the zero model. */
#define TOL_FLAT_LINEAR 1e-14
/* Step in ln s that shows whether the objective is flat; 0.5 % of sigma. */
#define FLAT_STEP 0.01
/* The second derivative alone decides where it says this many times what counts as a change. */
#define FLAT_DOUBT 1e3
/* Ends of a flat stretch are found to this in ln s; they are never outside of it. */
#define FLAT_END 1e-3
/* Longest step in ln s along a flat stretch: between two such points the objective is taken to be level too. */
#define FLAT_STRIDE 0.15

/* Newton steps of one refinement; it converges quadratically, so this is only ever a guard. */
#define LIMIT_REFINE_STEPS 60

/* An interval of ln s narrower than this relative to its magnitude is not split: the midpoint would round. */
#define LIMIT_SPLIT 1e-14

/* Halvings of a side until it is that narrow: its range is below 100, and the least width 1e-14. */
#define LIMIT_HALVINGS 56

/* Internal caps that size the workspace; a smaller box budget lowers them. Of one lobe and two: eight times what the hardest
 * of 100 materials wants, and more. A search that is out of them goes on depth first. */
#define LIMIT_NODES_ONE 512
#define LIMIT_NODES_TWO 1024
#define LIMIT_NODES_MORE 8192
#define LIMIT_NODES_SOCP 1048576
#define LIMIT_HEAP_ONE 4096
#define LIMIT_HEAP_TWO 32768
#define LIMIT_HEAP 262144
/* Places for pairs of nodes of lobes of one column each. */
#define LIMIT_PAIRS 1024u
/* The first nodes keep their lobe shape (M doubles each), up to this many doubles together. */
#define LIMIT_SHAPE_DOUBLES ((size_t)16 << 20)

/*
 * An interval whose mean exponent changes by more than this is refined by its halves, or by its quarters
 * (bound.c): wide intervals have loose shifts, and many boxes share an interval.
 */
#define REFINE_ONCE 0.02
#define REFINE_TWICE 0.3

/* Boxes whose mean exponents change by less than this in all are not bounded by plain ranges. */
#define MONOTONE_LEAST 0.5

/* First partition of the axis: this many intervals, a power of two. */
#define FIRST_INTERVALS 8

/* Relative error of a sum of phi^2 with Smith's masking beyond what sums of other lobes have, in u: phi is within 10 u and
 * the exponent (model/smith.h), its square within 20. */
#define TOL_MASKING 24.0

/* Gains of a level set (solve/level.c), in units of u relative to |t|^2: TOL_GAIN TOL_GAIN_COLUMNS, and entries of a merged
 * column. */
#define TOL_LEVEL (2.0 * TOL_GAIN * TOL_GAIN_COLUMNS)
/* Relative error of the norm of a column, root of its sums (some 1e-13) times a scalar of c_min s up to 709. */
#define TOL_NORM 1e-11
/* Relative error of sigma and 1 / sigma^2 from theta. */
#define TOL_SIGMA 1e-14
/* Room below the threshold of what an interval says is reached, in units of the slack of an objective. */
#define TOL_REACHED 16.0
/* Boxes narrower than this in every theta are not split for an interval: near the least change of theta that sums over
 * samples can see. */
#define INTERVAL_RESOLUTION 1e-7
/* The gap of an end is at least this part of the value, where it is hardly away from the fitted one. */
#define INTERVAL_LEAST 1e-6
/* Beyond the domain lobes differ in a scalar alone: its range is taken over so many pieces, and so many points are tried. */
#define TAIL_PIECES 64
#define TAIL_POINTS 16

/* ---- Does the model describe the data? (fit/quality.c) ------------------- */

/* R^2 and residuals by data of a fit that is POOR. Directions that are read in another frame leave R^2 of -0.04 to 0.38 and
 * 0.43 to 0.92 of the data; the worst of 100 MERL-like materials with GGX and Schlick 0.66 in a channel. */
#define TOL_POOR_R2 0.5
#define TOL_POOR_RELATIVE 0.1

/* Share of squared residuals that neighbours foretell, residuals by data, and samples of a fit that is PATTERNED. Beckmann
 * and GGX lobes fitted to each other's data, to rough diffuse and two-lobe materials: 0.77 to 0.96; the same models to their
 * own data with 1 % noise: below 0; MERL-like materials, 84 coarse samples: 0.84, 0.78, 0.76, the rest below. */
#define TOL_PATTERN_FORESEEN 0.77
#define TOL_PATTERN_RELATIVE 0.02
#define TOL_PATTERN_SAMPLES 20

/* Squared distance below which neighbours count alike, of a cube of width 2: a thousandth of it. */
#define TOL_NEIGHBOUR 1e-6

#endif
