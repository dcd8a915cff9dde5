/*
 * One lobe in norm L2, several texels at a time: what the plan holds for it, and what a thread needs. The mathematics is
 * in fast.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_FAST_H
#define BRDFFIT_BATCH_FAST_H

#include <stdint.h>

#include "base/arena.h"
#include "brdffit.h"
#include "model/lobe.h"
#include "base/lanes.h"
#include "data/reduce.h"

/* Tables grow with these; beyond, the general path is the better one. */
#define BATCH_MOST_DISTINCT 512u
#define BATCH_MOST_SAMPLES 8192u
#define BATCH_MOST_CHANNELS 32u
#define BATCH_MOST_NODES 64u
/* Texels of a tile: one a lane. */
#define BATCH_TILE LANES
/* Coefficients of a polynomial over a window: one a lane. */
#define BATCH_TERMS LANES
/* The same where those are too coarse for the gap; and of D, which bends twice as much. */
#define BATCH_TERMS_MORE 12
#define BATCH_TERMS_D 16
/* Terms of the interpolants that all of these are cut off from. */
#define BATCH_REFERENCE 24
/* Cosines of two columns count as lower than they are, by this or more: so D is definite by as much. */
#define BATCH_APART 1e-8
/* Distance of two such polynomials of shapes. */
#define BATCH_STRIDE_MORE 16
/* Entries of a symmetric matrix by columns of the lobe, and which of them is (i, j), i <= j. */
#define BATCH_PAIRS (EACH_MOST * (EACH_MOST + 1) / 2)
#define BATCH_PAIR(i, j) ((j) * ((j) + 1) / 2 + (i))

/*
 * An interval of theta = ln s, [center - radius, center + radius], and t = (theta - center) / radius. In it column j is
 * b_j phi_j times scale[j] exp(tilt[j] t), so that it hardly changes as a whole and its part beside a is about 1 long.
 */
struct batch_window {
    double center, radius;
    double scale[EACH_MOST], tilt[EACH_MOST];
    double d[BATCH_PAIRS][BATCH_TERMS_D];                      /* polynomials of D in t */
    double u[EACH_MOST][2][BATCH_TERMS_MORE];                  /* of u; [1]: with more terms */
    double d_error[BATCH_PAIRS], d_third[BATCH_PAIRS]; /* how far D may be from the truth; |third derivative| / 6 */
    double u_error[EACH_MOST][2], n_error[EACH_MOST][2]; /* of u, and of n_k per |I_k| */
    double u_third[EACH_MOST][2];
    double apart; /* how much lower D of different columns is: for coefficients >= 0 that is safe; see screen.c */
    double rate, excess; /* |d ln (z D z) / dt| at most, for any z; what the error of D does to its inverse, relative */
    double delta, shrink; /* screening: see screen.c; shrink <= 0: it cannot be screened */
};

/* A column of the lobe: b phi, and with Schlick's Fresnel b w phi. */
struct batch_column {
    struct lobe_sight sight; /* arrays in the plan; its c_min is what the column's own smallest c is taken off at */
    double scale_b;
    double *b; /* used: weighted and scaled */
    double *bb, *ab; /* PADDED(M): sum b^2, sum a b / |a| */
    double *node; /* nodes / LANES x M x LANES: phi / sqrt(D) */
    double *shape[2]; /* N x M x BATCH_TERMS, or BATCH_STRIDE_MORE: polynomials of phi in the windows */
};

struct batch_fast {
    size_t used, channels;
    size_t distinct; /* M */
    size_t windows; /* N, at most 63 */
    size_t nodes; /* N + 1, a multiple of LANES */
    int each; /* columns of the lobe */
    int steep; /* struct lobe_kind */
    int alike; /* two columns have the same phi wherever both see a lobe */
    double root_a; /* |a|; 0 when no sample has a diffuse part */
    double slack; /* rounding of the sums, relative to the data's sum of squares */
    double doubt, doubt_tail; /* of the geometry (data/charge.h): in the range, and from its end on */
    double s_low; /* s at the start of the range */
    double sigma_floor; /* what is proven is proven down to this roughness */
    double snapped; /* struct table */
    const struct lobe_kind *kind;
    const struct kernels *kernels;
    double scale_a, scale_w;
    uint32_t *sample; /* used: index of the caller's sample, ordered by c */
    uint32_t *begin; /* M + 1: places of each distinct c; samples without a lobe come after */
    double *a, *factor; /* used: weighted and scaled; factor turns a value into weighted radiance */
    double *radiance; /* used: turns a value into radiance */
    double *cross; /* PADDED(M): sum of the product of the two columns' b */
    double *cosine; /* nodes: cosine of the two columns beside a */
    struct batch_column column[EACH_MOST];
    struct batch_window *window;
    double *scratch; /* while the plan is made: BATCH_REFERENCE + 2 rows of PADDED(M) */
};

/* What became of a texel of a tile, in internal units. */
struct batch_outcome {
    int certified; /* 0: nothing below is meant, take the general path */
    double s, e2, error, lower_bound, total; /* error: how far e2 may be from that of the model that is published */
    size_t boxes, nodes;
};

/* Largest radiance and magnitude of a value's radiance, of each channel: K x LANES; not_finite: of a texel, NaN or 0. */
struct batch_scan {
    double *largest, *magnitude;
    double not_finite[BATCH_TILE];
};

/* A tile of texels in a thread's workspace; lanes are texels wherever the last index is LANES. */
struct batch_tile {
    double *value; /* used x K x LANES: weighted, scaled radiance */
    double *sum[EACH_MOST]; /* K x M x LANES: sums of residual times b; see fast.c */
    double *gain; /* nodes x LANES */
    double *scale; /* K x LANES: channel scale */
    double *omega, *ii; /* K x LANES */
    double *x, *y; /* K x LANES, K x each x LANES: coefficients of a / |a| and b phi */
    double *n; /* K x each x BATCH_TERMS x LANES: polynomials around each texel's optimum */
    double *work; /* K x each x BATCH_STRIDE_MORE, and more */
    double *phi[EACH_MOST]; /* M x LANES */
    double *one; /* PADDED(M) */
    struct batch_scan scan;
    struct batch_outcome outcome[BATCH_TILE];
};

struct batch_rules {
    double relative_gap, absolute_gap;
};

/* Whether these options have this path at all. */
int brdffit_batch_fast_possible(const brdffit_options *options);

/* Room in the plan. */
void brdffit_batch_fast_layout(struct batch_fast *fast, struct arena *arena, size_t count,
                               const brdffit_options *options);
void brdffit_batch_tile_layout(struct batch_tile *tile, struct arena *arena, size_t count, size_t channels,
                               const brdffit_options *options);

/* Room that making the plan needs for a while, and the making; 0 when this geometry has no fast path. */
void brdffit_batch_fast_scratch(struct reduced *reduced, double **values, struct arena *arena, size_t count,
                                const brdffit_options *options);
int brdffit_batch_fast_start(struct batch_fast *fast, const brdffit_samples *geometry, const brdffit_options *options,
                             struct reduced *scratch, double *values);

/* phi of column j at s, every c. */
void brdffit_batch_shape(const struct batch_fast *fast, int j, double s, double *phi);

/*
 * D = (b_i phi_i - u_i a / |a|) . (b_j phi_j - u_j a / |a|) of columns with these shapes, from the samples themselves, so that
 * nothing cancels; and u.
 */
void brdffit_batch_gram(const struct batch_fast *fast, const double *const phi[EACH_MOST], double d[BATCH_PAIRS],
                        double u[EACH_MOST]);

/* Fill window w, whose center and radius are set: polynomials, and how it is screened. 0: it has no use. */
int brdffit_batch_window(struct batch_fast *fast, size_t w);
void brdffit_batch_screen(const struct batch_fast *fast, struct batch_window *window, size_t w);

struct batch_kernels {
    /* The used samples of the texels whose values (samples x K) are given, into tile->value. */
    void (*load)(const struct batch_fast *fast, const double *const row[BATCH_TILE], struct batch_tile *tile,
                 struct batch_scan *scan);
    /* Fit the texels whose weighted values, scales and `live` flags are given; outcome, x and y are the answer. */
    void (*tile)(const struct batch_fast *fast, const struct batch_rules *rules, struct batch_tile *tile,
                 const unsigned char *live);
};

extern const struct batch_kernels brdffit_batch_kernels_base;
extern const struct batch_kernels brdffit_batch_kernels_avx2;
extern const struct batch_kernels brdffit_batch_kernels_avx512;

/* As brdffit_kernels(). */
const struct batch_kernels *brdffit_batch_kernels(brdffit_isa isa);

#endif
