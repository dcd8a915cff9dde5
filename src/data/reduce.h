/*
 * Samples to what a fit needs: sums over samples of equal c for the bounds (theory 4.1), and the rows of an
 * equivalent smaller least-squares problem for the vector form (theory 4.3).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_REDUCE_H
#define BRDFFIT_REDUCE_H

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "brdffit.h"
#include "base/lanes.h"
#include "model/model.h"
#include "data/charge.h"

/*
 * Norm l1 minimises sum w |r| and linf the largest |r| where w > 0, so their samples are multiplied by w and by 1
 * instead of sqrt(w): read "w" below as the square of that factor. weight_sum and row_square know the true w.
 *
 * Internal units: a / scale_a, b / scale_b, w / scale_w and values / (channel_scale value_scale), all but channel_scale
 * powers of two, so that nothing is rounded by them. The largest a, b and value, weights included, are about 1, and so is
 * the sum of squares but for the number of samples: gains and their squares stay far from the ends of the number range.
 */

/* What one geometry (a row of b, c and, with Smith's masking, tangents; model.h) makes of the samples. Sums over the samples of one group: */
struct table {
    struct lobe_sight sight; /* what kinds see of the groups: c_min, c; and tangents where there are any */
    int masked;              /* there are: samples of one group agree in these, too */
    double *light,
        *view;    /* by group. Of a lobe whose two roughnesses are searched: c along the tangent, and across it */
    double *sample_light, *sample_view; /* scratch while reducing: used; the smaller first */
    double c_min;
    double snapped;        /* largest relative change of c - c_min by merging */
    struct charge charge;  /* what the geometry's rounding costs a bound */
    double scale_b;
    double c_low;          /* smallest c - c_min where there is a lobe: 0, unless it is of second columns */
    double *c;             /* c - c_min; of geometry 0 ascending and distinct */
    double *bb;            /* sum w b^2 */
    double *concentration; /* sum w^2 b^4 / bb^2, for the effective number of samples */
    double *linear;        /* functionals x stride: see below */
    double *row_b;         /* R */
    double *sample_b, *sample_c; /* scratch while reducing: used */
};

/* Pairs of different geometries. */
#define CROSSES_MOST (KINDS_MOST * (KINDS_MOST - 1) / 2 + (KINDS_MOST == 1)) /* arrays of none are not C */

struct reduced {
    size_t channels;    /* K */
    size_t distinct;    /* M groups: samples that agree in the c of every geometry */
    size_t stride;      /* PADDED(M): distance of two rows of the arrays by group */
    int geometries, bases; /* model.h */
    struct table table[KINDS_MOST];
    struct kind_charge kind_charge[KINDS_MOST];
    double *cross[CROSSES_MOST]; /* sum w b b' of two geometries: reduced_cross() */
    size_t functionals; /* F + B, or F + 2 B when some value is negative */
    size_t bounded;     /* B <= K: channels that bounds look at, without zero ones and with identical ones merged */
    size_t *bound_channel; /* B: each one's channel (the first of identical ones) */
    double *bound_root; /* B: root of how many it stands for, a factor of its sums in `linear` */
    size_t channels_zero, channels_identical;
    int apart; /* whether bounds tell channels of different scale apart, however alike their data are */
    int fixed;         /* F columns without a shape */
    double aa[FIXED_MOST][FIXED_MOST]; /* sum w a a' of them over all samples */
    double *ai;        /* F x K: sum w a I */
    double *ii;        /* K: sum w I^2 */
    double total;      /* objective of the zero model: sum of ii; l1: sum of |I|; linf: largest |I| */
    double weight_sum; /* sum w */

    size_t rows;       /* R <= N rows of the vector form; norms other than l2: every used sample is a row */
    double *row_a;     /* F x used, the first R of each */
    double *row_value; /* K x used, the first R of each */
    uint32_t *row_c;   /* R: index of its group */
    double *row_square; /* R: what a row's squared residual counts for in sum w r^2; 1 unless the norm is not l2 */

    double scale_a[FIXED_MOST], scale_w, value_scale;
    double *channel_scale; /* K: what values are divided by inside, before value_scale */
    size_t used;       /* samples reduced; distance of two channels of row_value */
    size_t counted;    /* samples that the result says were used: the same, unless they came as sums */
    size_t skipped[BRDFFIT_SKIP_COUNT];

    uint32_t *sample; /* used: which of the caller's each is */
    uint32_t *begin;  /* place in `order` where each group begins, and one past the last */
    size_t groups;    /* `distinct` ones with a lobe, then those without */

    /* scratch while reducing, and up to brdffit_charge_domain() */
    size_t room; /* distance of two columns of sample_a */
    double *sample_a, *sample_factor; /* F x room; used: factor = root of w times f_r to radiance */
    int diffuse_off; /* whether there are any: */
    double *off_a; /* F x room: absolute errors of a, but for those of n.l, which all share */
    double off_norm[FIXED_MOST],
        off_share[FIXED_MOST]; /* their norm, that of the fit, and relative to that of a (4 at most) */
    uint32_t *order, *merge;
    double *block;
};

/* linear + f * stride, f < F: sum w a b; f = F + k: sum w max(I_k, 0) b; f = F + B + k: sum w max(-I_k, 0) b; k < B */

/* sum w b b' of two geometries by group; of one with itself, its bb. */
static inline const double *reduced_cross(const struct reduced *r, int g, int h)
{
    if (g == h) {
        return r->table[g].bb;
    }
    return r->cross[g < h ? h * (h - 1) / 2 + g : g * (g - 1) / 2 + h];
}

/* Most functionals. */
static inline size_t reduced_functionals(const struct model *model, size_t channels)
{
    return (size_t)model->fixed + 2 * channels;
}

/* All that a reduction needs, or what stays and what is scratch apart: others may use the memory of the latter later. */
void brdffit_reduce_layout(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                           const struct model *model);
void brdffit_reduce_layout_kept(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                                const struct model *model);
void brdffit_reduce_layout_scratch(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                                   const struct model *model);

/* Pack the arrays by group, which are the last of those that stay, to the groups that there are; where they end then. */
void *brdffit_reduce_pack(struct reduced *reduced);

brdffit_status brdffit_reduce(struct reduced *reduced, const brdffit_samples *samples, const struct model *model,
                              const brdffit_options *options, brdffit_error *error);

/* Whether channels k and l have the same sums, to the bit; before the next call. */
int brdffit_reduce_same_channels(const struct reduced *reduced, size_t k, size_t l);

/* Leave to the bounds only the channels that they need. `linear` is changed in place: once after each reduction. */
void brdffit_reduce_channels(struct reduced *reduced);

#endif
