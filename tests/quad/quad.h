/*
 * The objective of a fit in 113-bit arithmetic (libquadmath), from the samples and the text of brdffit.h alone: the
 * judge of printed lower bounds. Shares no code with the library. SPDX-License-Identifier: MIT
 *
 * The doubles that are given are taken as exact, whatever they were meant to be. Every E^2 here is that of residuals
 * at coefficients >= 0 and roughnesses inside the domain, so each one is an upper bound of the least E^2: a lower bound
 * above it is false. Their own error is a few 1e-34 of |I| |r| (QUAD_RELATIVE, QUAD_ABSOLUTE); c of a half vector
 * from two unequal unit vectors is known to about 1e-34 tan(alpha).
 *
 * E^2 stands for what the norm minimises: the sum of w |r| for L1 and the largest |r| for LINF.
 * E^2 has to be compared in the units that were minimised, so quad_scale() takes the result's own channel_scale.
 */
#ifndef BRDFFIT_TESTS_QUAD_H
#define BRDFFIT_TESTS_QUAD_H

#include <quadmath.h>

#include "brdffit.h"

__extension__ typedef __float128 quad;

#define QUAD_LOBES 3
#define QUAD_FIXED 3   /* columns of a diffuse term, at most */
#define QUAD_COLUMNS 7 /* of all, at most: brdffit_options.diffuse */

/* What an E^2 of ours may be too small by: relative to itself, and to that of the zero model. */
#define QUAD_RELATIVE 1e-30
#define QUAD_ABSOLUTE 1e-62

/* A lobe of each sample: g = b lambda(s) shape(s, c) G(s, tan^2 of light and of viewer), and g w with Fresnel's w. */
struct quad_lobe {
    brdffit_distribution distribution;
    brdffit_masking masking;
    quad *b, *c, *light, *view, *w; /* a row each */
    quad c_min; /* of rows with b > 0; 0 when there are none */
};

struct quad_problem {
    size_t count, channels; /* rows: samples that are used */
    int lobes;              /* 1 to QUAD_LOBES, of any distributions */
    int fixed, each, columns; /* columns of the diffuse term, of a lobe, of all: in that order */
    brdffit_diffuse diffuse;
    brdffit_norm norm;
    struct quad_lobe lobe[QUAD_LOBES];
    quad *a[QUAD_FIXED], *weight, *to_radiance;
    quad *radiance;         /* channels x count, in the data's units */
    quad *data;             /* the same divided by scale */
    quad *scale;            /* channels */
    quad total;             /* E^2 of the zero model */
    size_t skipped[BRDFFIT_SKIP_COUNT];
    int doubtful;           /* samples that double arithmetic may see on the other side of a limit */
    quad *column;           /* work: 2 x QUAD_COLUMNS x count */
    struct quad_work *work; /* of quad_at(): what the next s may share with the last */
    quad *block;
};

/* ---- quad_rows.c: samples to rows ----------------------------------------------------------------------------- */

/* As with options->norm, max_incidence, fresnel, diffuse and masking, but one distribution a lobe. 0, or 1 without memory.
 * Every channel_scale is 1 until quad_scale(). */
int quad_problem_new(struct quad_problem *p, const brdffit_samples *samples, const brdffit_options *options, int lobes,
                     const brdffit_distribution *distribution);
void quad_problem_free(struct quad_problem *p);
void quad_scale(struct quad_problem *p, const double *channel_scale);

/* Largest used radiance of a channel. */
quad quad_largest(const struct quad_problem *p, size_t channel);

/* Coefficients of one sample; 1 when it counts, else 0. `doubtful` as above, incremented. */
struct quad_row {
    quad a[QUAD_FIXED], b, c, light, view, w, to_radiance; /* light, view: tan^2 of their angles with the normal */
};
int quad_row(const brdffit_samples *samples, size_t i, brdffit_distribution distribution,
             const brdffit_options *options, struct quad_row *row, brdffit_skip *why, int *doubtful);

/* Sum of n terms as if in threefold precision; the terms are destroyed. */
quad quad_sum(quad *term, int n);

/* ---- quad_lobe.c: the table of distributions ------------------------------------------------------------------- */

struct quad_angles {
    quad nl, nv, vh, tan2;
    quad off, rv; /* 1 - r.v and r.v of the mirrored light */
    quad tan2_light, tan2_view, lv, versine; /* l.v; 1 - v.h */
};

int quad_by_exponent(brdffit_distribution distribution);
/* b and c of brdffit.h's table, tangents and w of the row; b without V-cavities' G for another masking. */
void quad_coefficients(brdffit_distribution distribution, brdffit_masking masking, const struct quad_angles *angles,
                       struct quad_row *row);
quad quad_lambda(brdffit_distribution distribution, quad s);
/* shape(s, c) / shape(s, c_min). */
quad quad_shape(brdffit_distribution distribution, quad s, quad c, quad c_min);
/* The same of row i, times Smith's G where it depends on s. */
quad quad_lobe_shape(const struct quad_lobe *lobe, quad s, size_t i);
/* The columns of a diffuse term. */
void quad_diffuse(brdffit_diffuse diffuse, const struct quad_angles *angles, quad *column);
/* s = 1 / sigma^2. */
quad quad_s(double sigma);

/* ---- quad_fit.c: E^2 ------------------------------------------------------------------------------------------ */

/* At a model: sigma of each lobe, x (channels x fixed), y and f0 (channels x lobes), in the data's units. */
quad quad_at_model(const struct quad_problem *p, const double *sigma, const double *x, const double *y,
                   const double *f0);

/* The least over coefficients >= 0 at these s; INFINITY where a coefficient would be beyond any double. */
quad quad_at(const struct quad_problem *p, const quad *s);

/* NULL without memory; free() it. */
struct quad_work *quad_work_new(size_t channels);

/* Columns a and g_j(s_j) shape / shape(c_min), `column` holds columns x count. */
void quad_columns(const struct quad_problem *p, const quad *s, quad *column);

/* Of a channel whose coefficients z (of quad_columns) are given. */
quad quad_residual(const struct quad_problem *p, const quad *column, size_t channel, const quad *z);

/* Solves the n x n system (row-major, leading dimension QUAD_COLUMNS + 1) in place; 0 when it is singular. */
int quad_solve(quad *matrix, quad *right, int n);

/* ---- quad_norms.c: L1 and LINF by enumeration of the vertices of their linear programs, for a dozen rows ------ */

quad quad_channel_l1(const struct quad_problem *p, const quad *column, size_t channel, quad *z);
quad quad_channel_linf(const struct quad_problem *p, const quad *column, size_t channel, quad *z);

/* ---- quad_search.c: good points of a domain -------------------------------------------------------------------- */

struct quad_domain {
    quad low[QUAD_LOBES], high[QUAD_LOBES]; /* of s */
};

struct quad_search {
    const struct quad_problem *problem;
    struct quad_domain domain;
    size_t evaluations, limit;
    quad best, s[QUAD_LOBES]; /* the best point met */
};

/* The domain of the options, down to the result's sigma_floor; 0 when it is empty. */
int quad_domain_of(const struct quad_problem *p, const brdffit_options *options, double sigma_floor,
                   struct quad_domain *domain);

void quad_search_begin(struct quad_search *search, const struct quad_problem *p, const struct quad_domain *domain,
                       size_t limit);
/* E^2 at s, moved into the domain. */
quad quad_try(struct quad_search *search, const quad *s);
/* Downhill from s: Newton's method by differences (L2), else a pattern search. */
void quad_descend(struct quad_search *search, const quad *s);
/* Ends and a grid over the domain (points an axis), then down from the best few. */
void quad_scan(struct quad_search *search, int points);

#endif
