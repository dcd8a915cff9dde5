/*
 * Sums to reduced data. SPDX-License-Identifier: MIT
 *
 * The vector form needs rows whose residual norm is that of the samples. All samples of a group have g = b phi, so what
 * counts is, for each channel, the Gram matrix G of (a, b, I): any rows with it will do, and its Cholesky factor is
 *
 *     ra  rab  q1          ra = |a|   rab = a.b / ra   q1 = a.I / ra
 *      0  rb   q2          rb^2 = b.b - rab^2          q2 = (b.I - rab q1) / rb
 *      0  0    rem         rem^2 = I.I - q1^2 - q2^2
 *
 * The first two rows are shared by the channels, and the last has no model in it, so that those of all groups become
 * one row: 2 groups + 1 rows. A factor R of the rounded G has R'R = G + E with |E_ij| <= TOL_GRAM u |i||j|: the
 * objective at (x, Y) is off by z'E z <= TOL_GRAM u (|a x| + |b Y| + |I|)^2, whatever the condition of G. Where the
 * rounded G is not positive semidefinite (a and b parallel to rounding), a multiple of its diagonal as large as its
 * rounding is added first.
 */
#include <math.h>

#include "base/error.h"
#include "model/geometry.h"
#include "data/reduce_parts.h"
#include "data/sums.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* A group's Gram matrix in internal units. */
struct gram {
    double aa, ab, bb;
};

size_t brdffit_sums_rows(const struct brdffit_sums *sums)
{
    return 2 * sums->groups + 1;
}

static double root_largest(const struct brdffit_sums *s, enum sums_product product)
{
    double largest = 0.0;
    size_t g;

    for (g = 0; g < s->groups; g++) {
        largest = fmax(largest, sums_value(sums_group(s, g) + product));
    }
    return sqrt(largest);
}

/* sum w I^2 of a channel, before value_scale. */
static double channel_square(const struct brdffit_sums *s, const struct reduced *r, size_t k)
{
    double sum = 0.0;
    size_t g;

    for (g = 0; g < s->groups; g++) {
        sum += sums_value(sums_group(s, g) + SUMS_CHANNEL + SUMS_PER_CHANNEL * k + SUMS_II) / r->scale_w /
               r->channel_scale[k] / r->channel_scale[k];
    }
    return sum;
}

static brdffit_status choose_scales(const struct brdffit_sums *s, const brdffit_options *options, struct reduced *r,
                                    brdffit_error *error)
{
    brdffit_status status;
    double root, largest = 0.0;
    size_t k;

    for (k = 0; k < s->channels; k++) {
        r->channel_scale[k] = s->largest[k];
        r->ii[k] = s->magnitude[k];
        if (s->magnitude[k] > 0.0 && !(s->magnitude[k] >= 1.0 / LIMIT_SUMS_VALUE)) {
            return brdffit_fail_at(error, "a channel's values are all below 1e-100, too small for sums", BRDFFIT_NONE,
                                   k, s->magnitude[k]);
        }
    }
    r->scale_w = s->largest_weight == 1.0 ? 1.0 : power_of_two(s->largest_weight);
    root = sqrt(r->scale_w);
    r->scale_a[0] = power_of_two(root_largest(s, SUMS_AA) / root);
    r->table[0].scale_b = power_of_two(root_largest(s, SUMS_BB) / root);
    status = brdffit_reduce_channel_scales(r, options, error);
    if (status == BRDFFIT_OK) {
        r->value_scale = 1.0;
        for (k = 0; k < s->channels; k++) {
            largest = fmax(largest, channel_square(s, r, k));
        }
        brdffit_reduce_value_scale(r, sqrt(largest));
    }
    return status;
}

/* What reduced.charge has not from the groups. */
static void charge_sums(const struct brdffit_sums *s, struct reduced *r)
{
    struct table *t = &r->table[0];
    struct charge *c = &t->charge;

    c->diffuse = 2.01 * s->light_error;
    if (!(t->c_min <= MIRROR_C_MIN)) {
        c->spread = larger(c->spread, 2.0 * s->errors[r->order[0]].spread);
    }
    c->hidden = sqrt(s->hidden / r->scale_w) / t->scale_b;
    c->hidden_c = larger(0.0, s->hidden_c - t->c_min);
    c->any_hidden = sqrt(s->any_hidden / r->scale_w) / t->scale_b;
    c->any_c = larger(0.0, s->any_c - t->c_min);
    c->hidden_data = sqrt(s->hidden_data / r->scale_w) / r->value_scale;
}

/* Groups in ascending c, as if they were samples. */
static void order_groups(const struct brdffit_sums *s, struct reduced *r, double s_end)
{
    struct table *t = &r->table[0];
    size_t g;

    r->used = s->groups;
    brdffit_charge_none(r);
    for (g = 0; g < s->groups; g++) {
        /* A node that was made in vain, for a sample that was refused, is no c. */
        r->table[0].sample_c[g] = sums_value(sums_group(s, g) + SUMS_BB) > 0.0 ? s->c[g] : INFINITY;
        t->sample_b[g] = sqrt(sums_value(sums_group(s, g) + SUMS_BB) / r->scale_w) / t->scale_b;
        t->charge.b[g] = s->errors[g].b;
        t->charge.c[g] = s->errors[g].c;
        t->charge.relative = larger(t->charge.relative, s->errors[g].b);
    }
    brdffit_reduce_sort(r);
    r->table[0].snapped = 0.0;
    if (s->directions && !s->bits) { /* nodes are never that close, and are to stay where they are */
        brdffit_reduce_snap(r, &s_end);
    }
    brdffit_reduce_group(r);
    brdffit_reduce_groups(r);
    brdffit_charge_groups(r);
    charge_sums(s, r);
    r->counted = s->used;
    r->weight_sum = sums_value(&s->weight) / r->scale_w;
    for (g = 0; g < BRDFFIT_SKIP_COUNT; g++) {
        r->skipped[g] = s->skipped[g];
    }
}

/* Products of places begin .. end - 1 together. */
static void merge(const struct brdffit_sums *s, const struct reduced *r, size_t begin, size_t end,
                  struct sums_pair *sum)
{
    size_t place, i, n = SUMS_PRODUCTS(s->channels);

    for (i = 0; i < n; i++) {
        sum[i].high = sum[i].low = 0.0;
    }
    for (place = begin; place < end; place++) {
        const struct sums_pair *group = sums_group(s, r->order[place]);

        for (i = 0; i < n; i++) {
            sums_add(&sum[i], group[i].high);
            sum[i].low += group[i].low;
        }
    }
}

/* Value of a channel's product in internal units; `scale` is that of its coefficient. */
static double scaled(const struct reduced *r, const struct sums_pair *sum, size_t k, enum sums_of_channel which,
                     double scale)
{
    double value = sums_value(sum + SUMS_CHANNEL + SUMS_PER_CHANNEL * k + which) / r->scale_w / scale;

    value = value / r->channel_scale[k] / r->value_scale;
    return which == SUMS_II ? value / r->channel_scale[k] / r->value_scale : value;
}

/* The group's sums for the bounds, at index j of the distinct c (if it has a lobe), and its part of the totals. */
static int add_sums(struct reduced *r, const struct sums_pair *sum, size_t j, const struct gram *gram)
{
    struct table *t = &r->table[0];
    size_t k, K = r->channels;
    int negative = 0;

    if (gram->bb > 0.0) {
        double bb = sums_value(sum + SUMS_BB);

        t->bb[j] = gram->bb;
        t->concentration[j] = sums_value(sum + SUMS_B4) / bb / bb;
        t->linear[j] = gram->ab;
    }
    for (k = 0; k < K; k++) {
        if (gram->bb > 0.0) {
            t->linear[(1 + k) * r->stride + j] = scaled(r, sum, k, SUMS_POSITIVE, t->scale_b);
            t->linear[(1 + K + k) * r->stride + j] = scaled(r, sum, k, SUMS_NEGATIVE, t->scale_b);
            negative = negative || sums_value(sum + SUMS_CHANNEL + SUMS_PER_CHANNEL * k + SUMS_NEGATIVE) > 0.0;
        }
    }
    return negative;
}

/* The factor's entries that a channel has for itself; 0 when the matrix was not positive semidefinite. */
static int factor_channel(const struct gram *g, double ai, double bi, double ii, double q[2], double *rest)
{
    double ra = sqrt(g->aa), rab = ra > 0.0 ? g->ab / ra : 0.0, rb = sqrt(fmax(0.0, g->bb - rab * rab)), across;

    q[0] = ra > 0.0 ? ai / ra : 0.0;
    across = bi - rab * q[0];
    q[1] = rb > 0.0 ? across / rb : 0.0;
    *rest = ii - q[0] * q[0] - q[1] * q[1];
    return *rest >= -16.0 * TOL_UNIT * ii && (rb > 0.0 || fabs(across) <= 16.0 * TOL_UNIT * sqrt(g->bb) * sqrt(ii));
}

/* Two rows of a group at least; those of the shift that is enough for every channel. Adds the remainders to rest. */
static void add_rows(struct reduced *r, const struct sums_pair *sum, size_t j, const struct gram *exact,
                     struct sums_pair *rest)
{
    static const double shift[4] = {0.0, 16.0 * TOL_UNIT, 64.0 * TOL_UNIT, 160.0 * TOL_UNIT};
    size_t row = r->rows, k, step;
    double grown = 1.0, left, rab;
    struct gram g = *exact;
    int fine = 0;

    r->rows += 2;
    for (step = 0; step < 4 && !fine; step++) {
        grown = 1.0 + shift[step];
        g.aa = exact->aa * grown;
        g.bb = exact->bb * grown;
        fine = 1;
        for (k = 0; k < r->channels && fine; k++) {
            double q[2], bi = scaled(r, sum, k, SUMS_POSITIVE, r->table[0].scale_b) -
                              scaled(r, sum, k, SUMS_NEGATIVE, r->table[0].scale_b);

            fine = factor_channel(&g, scaled(r, sum, k, SUMS_AI, r->scale_a[0]), bi,
                                  scaled(r, sum, k, SUMS_II, 1.0) * grown, q, &left);
        }
    }
    rab = g.aa > 0.0 ? g.ab / sqrt(g.aa) : 0.0;
    r->row_a[row] = sqrt(g.aa);
    r->row_a[row + 1] = 0.0;
    r->table[0].row_b[row] = rab;
    r->table[0].row_b[row + 1] = sqrt(fmax(0.0, g.bb - rab * rab));
    for (k = 0; k < r->channels; k++) {
        double q[2], bi = scaled(r, sum, k, SUMS_POSITIVE, r->table[0].scale_b) -
                          scaled(r, sum, k, SUMS_NEGATIVE, r->table[0].scale_b);

        (void)factor_channel(&g, scaled(r, sum, k, SUMS_AI, r->scale_a[0]), bi, scaled(r, sum, k, SUMS_II, 1.0) * grown,
                             q, &left);
        r->row_value[k * r->used + row] = q[0];
        r->row_value[k * r->used + row + 1] = q[1];
        sums_add(&rest[k], fmax(0.0, left));
    }
    for (step = row; step < row + 2; step++) {
        r->row_c[step] = (uint32_t)(j < r->distinct ? j : 0);
        r->row_square[step] = 1.0;
    }
}

static void add_group(struct reduced *r, const struct sums_pair *sum, size_t j, struct sums_pair *rest, int *negative)
{
    struct gram gram;
    size_t k;

    gram.aa = sums_value(sum + SUMS_AA) / r->scale_w / r->scale_a[0] / r->scale_a[0];
    gram.ab = sums_value(sum + SUMS_AB) / r->scale_w / r->scale_a[0] / r->table[0].scale_b;
    gram.bb = sums_value(sum + SUMS_BB) / r->scale_w / r->table[0].scale_b / r->table[0].scale_b;
    *negative = add_sums(r, sum, j, &gram) || *negative;
    add_rows(r, sum, j, &gram, rest);
    r->aa[0][0] += gram.aa;
    for (k = 0; k < r->channels; k++) {
        r->ai[k] += scaled(r, sum, k, SUMS_AI, r->scale_a[0]);
        r->ii[k] += scaled(r, sum, k, SUMS_II, 1.0);
    }
}

/* The row that has no model in it. */
static void add_last_row(struct reduced *r, const struct sums_pair *rest)
{
    size_t row = r->rows++, k;

    r->row_a[row] = r->table[0].row_b[row] = 0.0;
    r->row_c[row] = 0;
    r->row_square[row] = 1.0;
    for (k = 0; k < r->channels; k++) {
        r->row_value[k * r->used + row] = sqrt(sums_value(&rest[k]));
    }
}

brdffit_status brdffit_sums_reduce(const struct brdffit_sums *s, const brdffit_options *options, struct reduced *r,
                                   brdffit_error *error)
{
    /* The block has room for (K + 2) x 64 doubles and more. */
    struct sums_pair *rest = (struct sums_pair *)(void *)r->block, *sum = rest + r->channels;
    struct model model;
    double s_end[KINDS_MOST];
    brdffit_status status;
    size_t j, k;
    int negative = 0;

    if (s->used == 0) {
        return brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
    }
    status = choose_scales(s, options, r, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    brdffit_model_make(&model, options);
    brdffit_reduce_ends(&model, options, s_end);
    order_groups(s, r, s_end[0]);
    r->rows = 0;
    r->aa[0][0] = r->total = 0.0;
    for (k = 0; k < r->channels; k++) {
        r->ai[k] = r->ii[k] = 0.0;
        rest[k].high = rest[k].low = 0.0;
    }
    r->used = brdffit_sums_rows(s);
    for (j = 0; j < r->groups; j++) {
        merge(s, r, r->begin[j], r->begin[j + 1], sum);
        add_group(r, sum, j, rest, &negative);
    }
    add_last_row(r, rest);
    for (k = 0; k < r->channels; k++) {
        r->total += r->ii[k];
    }
    r->functionals = negative ? 1 + 2 * r->channels : 1 + r->channels;
    brdffit_reduce_every_channel(r);
    return BRDFFIT_OK;
}
