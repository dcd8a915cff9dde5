/*
 * Samples that are not kept (brdffit.h, "Sums"): groups of equal c, each with the products that the reduction needs,
 * in pairs high + low. SPDX-License-Identifier: MIT
 *
 * A group's products are, with a, b and the radiance I of its samples and their weights w,
 *
 *     w a a, w a b, w b b, w^2 b^4, and per channel  w a I, w b max(I, 0), w b max(-I, 0), w I I
 *
 * Rounding: single samples are added by TwoSum (an error of 2 u beside that of the product, 4 u at most), rows by
 * table_row.h within TABLE_ROW_BLOCKS + 8 units; a row's shared factors cost 8 more.
 */
#ifndef BRDFFIT_SUMS_H
#define BRDFFIT_SUMS_H

#include "brdffit.h"
#include "base/environment.h"
#include "data/reduce.h"
#include "data/table_row.h"

enum sums_product { SUMS_AA = 0, SUMS_AB, SUMS_BB, SUMS_B4, SUMS_CHANNEL };
enum sums_of_channel { SUMS_AI = 0, SUMS_POSITIVE, SUMS_NEGATIVE, SUMS_II, SUMS_PER_CHANNEL };

#define SUMS_PRODUCTS(channels) (SUMS_CHANNEL + SUMS_PER_CHANNEL * (channels))

struct sums_pair {
    double high, low;
};

/* Largest errors of a group's samples (struct geometry). A row's samples share that of c: it is no spread. */
struct sums_errors {
    double b, c, spread;
};

struct brdffit_sums {
    size_t channels;
    brdffit_distribution distribution;
    double max_incidence, min_cosine;
    const struct table_row_kernels *kernels;

    size_t capacity, groups;
    double *c;               /* capacity: of each group; INFINITY for samples without a lobe (b = 0) */
    struct sums_pair *product; /* capacity x SUMS_PRODUCTS */
    uint32_t *slot;          /* open addressing by the bits of c: 1 + index of the group, 0 empty */
    size_t slots;            /* a power of two > 1.5 x capacity */
    size_t recent;           /* group found last */

    int bits;                /* 0: every c has its group; else nodes have that many bits after the first
                                (sums_bins.c) */
    size_t exact, exact_used; /* groups 0 .. exact - 1 are those of the smallest c, by themselves and not in
                                 `slot` */
    uint32_t *ascending;     /* exact_used groups in ascending c */
    struct sums_pair *cell;  /* capacity: sum w b^2 of the samples between the node and the next */

    struct sums_errors *errors; /* capacity */
    double light_error;      /* largest of a sample */
    double hidden, hidden_c, any_hidden, any_c,
        hidden_data; /* of charge.h, squares, in the caller's units; the data over largest[] */

    double *largest;         /* K: largest radiance, >= 0 */
    double *magnitude;       /* K: largest |radiance| */
    double largest_weight;
    struct sums_pair weight; /* sum of weights */
    int directions;          /* samples came as directions: close c are one (reduce.c) */
    size_t used;
    size_t skipped[BRDFFIT_SKIP_COUNT];

    struct table_row_totals totals; /* scratch of a row */
    double *totals_memory;
};

static inline void sums_add(struct sums_pair *s, double term)
{
    double sum = s->high + term, back = sum - s->high;

    s->low += (s->high - (sum - back)) + (term - back);
    s->high = sum;
}

static inline void sums_note_errors(struct sums_errors *to, const struct sums_errors *from)
{
    to->b = from->b > to->b ? from->b : to->b;
    to->c = from->c > to->c ? from->c : to->c;
    to->spread = from->spread > to->spread ? from->spread : to->spread;
}

static inline double sums_value(const struct sums_pair *s)
{
    return s->high + s->low;
}

/* Room for a sample of c and b > 0 in binned sums, and its w b^2 noted. Returns how many groups share it, 0 when there
 * is no room; group[i] gets share[i] of its weight. */
struct sums_split {
    size_t group[2];
    double share[2];
};
int brdffit_sums_split(struct brdffit_sums *sums, double c, double bb, struct sums_split *split);

/* Width of the cell above a node. */
double brdffit_sums_width(const struct brdffit_sums *sums, double node);

/* Make the result of a fit of binned sums one of the samples: lower bound, e2_error and what follows (sums_remainder.c). */
void brdffit_sums_remainder(const struct brdffit_sums *sums, const brdffit_options *options, brdffit_result *result);

/* Products of group g. */
static inline struct sums_pair *sums_group(const struct brdffit_sums *sums, size_t g)
{
    return sums->product + g * SUMS_PRODUCTS(sums->channels);
}

/* brdffit_sums_init() with checked options and enough memory. */
struct brdffit_sums *brdffit_sums_start(void *memory, size_t size, size_t channels, size_t groups,
                                        const brdffit_options *options);

/* The group of c, made if need be; capacity when there is no room. */
size_t brdffit_sums_find(struct brdffit_sums *sums, double c);

/* Reduced data with rows by Cholesky (sums_reduce.c); laid out for count = brdffit_sums_rows(). */
brdffit_status brdffit_sums_reduce(const struct brdffit_sums *sums, const brdffit_options *options,
                                   struct reduced *reduced, brdffit_error *error);
size_t brdffit_sums_rows(const struct brdffit_sums *sums);

/* The public functions of these names in the floating-point environment as it is (entry.c calls them). */
ENVIRONMENT_APART brdffit_status brdffit_sums_add_run(brdffit_sums *sums, const brdffit_samples *samples,
                                                      brdffit_error *error);
ENVIRONMENT_APART brdffit_status brdffit_sums_add_row_run(brdffit_sums *sums, const brdffit_row *row,
                                                          size_t cells[BRDFFIT_CELL_COUNT], brdffit_error *error);

#endif
