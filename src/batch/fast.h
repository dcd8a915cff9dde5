/*
 * One lobe of an exponential family in norm L2, several texels at a time: what the plan holds for it, and what a
 * thread needs. The mathematics is in fast.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_FAST_H
#define BRDFFIT_BATCH_FAST_H

#include <stdint.h>

#include "base/arena.h"
#include "brdffit.h"
#include "model/lobe.h"
#include "base/lanes.h"
#include "data/reduce.h"

/* Texels of a tile: one a lane. */
#define BATCH_TILE LANES
/* Coefficients of a polynomial over a window: one a lane. */
#define BATCH_TERMS LANES
/* The same where those are too coarse for the gap; and of D, which bends twice as much. */
#define BATCH_TERMS_MORE 12
#define BATCH_TERMS_D 16
/* Distance of two such polynomials of shapes. */
#define BATCH_STRIDE_MORE 16

/* An interval of s, [center - radius, center + radius], and t = (s - center) / radius. */
struct batch_window {
    double center, radius;
    double d[BATCH_TERMS_D], u[2][BATCH_TERMS_MORE]; /* polynomials of D and u in t; [1]: with more terms */
    double d_error, u_error[2], n_error[2]; /* how far they, and those of n_k per |I_k|, may be from the truth */
    double d_third, u_third[2];             /* |third derivative| / 6 of the polynomials, at most */
    double delta, shrink;                    /* screening: see window.c; shrink <= 0: it cannot be screened */
};

struct batch_fast {
    size_t used, channels;
    size_t distinct;        /* M */
    size_t windows;         /* N, at most 63 */
    size_t nodes;           /* N + 1, a multiple of LANES */
    double root_a;          /* |a|; 0 when no sample has a diffuse part */
    double slack;           /* rounding of the sums, relative to the data's sum of squares */
    double doubt, doubt_tail; /* of the geometry (data/charge.h): in the range, and from its end on */
    double s_low;           /* s at the start of the range */
    double sigma_floor;     /* what is proven is proven down to this roughness */
    const struct lobe_kind *kind;
    double c_min, scale_a, scale_b, scale_w;
    uint32_t *sample;       /* used: index of the caller's sample, ordered by c */
    uint32_t *begin;        /* M + 1: places of each distinct c; samples without a lobe come after */
    double *a, *b, *factor; /* used: weighted and scaled; factor turns a value into weighted radiance */
    double *radiance;       /* used: turns a value into radiance */
    double *c, *bb, *ab;    /* PADDED(M): c - c_min, sum b^2, sum a b / |a| */
    double *phi;            /* nodes / LANES x M x LANES: exp(-c s) */
    double *inverse_d;      /* nodes: 1 / D */
    double *shape[2];       /* N x M x BATCH_TERMS, or BATCH_STRIDE_MORE: polynomials of exp(-c s) */
    struct batch_window *window;
};

/* What became of a texel of a tile, in internal units. */
struct batch_outcome {
    int certified;      /* 0: nothing below is meant, take the general path */
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
    double *value;      /* used x K x LANES: weighted, scaled radiance */
    double *sum;        /* K x M x LANES: sums of residual times b; see fast.c */
    double *gain;       /* nodes x LANES */
    double *scale;      /* K x LANES: channel scale */
    double *omega, *ii; /* K x LANES */
    double *x, *y;      /* K x LANES: coefficients of a / |a| and b phi */
    double *n;          /* K x BATCH_TERMS x LANES: polynomials around each texel's optimum */
    double *work;       /* K x BATCH_TERMS, and more */
    double *phi;        /* M x LANES */
    struct batch_scan scan;
    struct batch_outcome outcome[BATCH_TILE];
};

struct batch_rules {
    double relative_gap, absolute_gap;
};

/* Whether these options have this path at all. */
int brdffit_batch_fast_possible(const brdffit_options *options);

/* Room in the plan. */
void brdffit_batch_fast_layout(struct batch_fast *fast, struct arena *arena, size_t count);
void brdffit_batch_tile_layout(struct batch_tile *tile, struct arena *arena, size_t count, size_t channels);

/* Room that making the plan needs for a while, and the making; 0 when this geometry has no fast path. */
void brdffit_batch_fast_scratch(struct reduced *reduced, double **values, struct arena *arena, size_t count,
                                const brdffit_options *options);
int brdffit_batch_fast_start(struct batch_fast *fast, const brdffit_samples *geometry, const brdffit_options *options,
                             struct reduced *scratch, double *values);

/* D(s) = |b phi - u a / |a||^2 from the samples themselves, so that nothing cancels; and u(s). */
double brdffit_batch_d(const struct batch_fast *fast, double s, double *u);

/* Fill window w, whose center and radius are set and whose ends have these D. snapped: see struct reduced. */
void brdffit_batch_window(struct batch_fast *fast, size_t w, double d_low, double d_high, double snapped);

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
