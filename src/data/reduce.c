/*
 * Samples to reduced data: see reduce.h. This file classifies samples, chooses the internal units and sorts by
 * c; reduce_sums.c and reduce_rows.c do the rest. SPDX-License-Identifier: MIT
 */
#include "data/reduce.h"

#include <math.h>

#include "base/error.h"
#include "model/geometry.h"
#include "model/diffuse.h"
#include "model/lobe.h"
#include "data/reduce_parts.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* Values of one sample that counts: all finite; keep each channel's largest radiance, and in ii its magnitude. */
static brdffit_status check_values(struct reduced *r, const brdffit_samples *s, size_t i, double to_radiance,
                                   brdffit_error *error)
{
    const double *value = s->values + i * s->channels;
    size_t k;

    for (k = 0; k < s->channels; k++) {
        double radiance = value[k] * to_radiance;

        if (!isfinite(value[k])) {
            return brdffit_fail_at(error, "value is not finite", i, k, value[k]);
        }
        r->channel_scale[k] = larger(r->channel_scale[k], radiance);
        r->ii[k] = larger(r->ii[k], fabs(radiance));
    }
    return BRDFFIT_OK;
}

static void keep_table(struct reduced *r, int t, const struct geometry *g, const double *split)
{
    r->table[t].sample_b[r->used] = g->b;
    r->table[t].sample_c[r->used] = g->c;
    if (split) {
        r->table[t].sample_light[r->used] = split[0];
        r->table[t].sample_view[r->used] = split[1];
    } else if (r->table[t].masked) {
        r->table[t].sample_light[r->used] = smaller(g->tan2_light, g->tan2_view);
        r->table[t].sample_view[r->used] = larger(g->tan2_light, g->tan2_view);
    }
    brdffit_charge_sample(&r->table[t].charge, r->used, g);
}

/* Columns without a shape of a sample that counts. */
static void keep_fixed(struct reduced *r, const struct model *model, const struct geometry *lead)
{
    double column[FIXED_MOST], error[FIXED_MOST];
    int f;

    if (model->diffuse == BRDFFIT_DIFFUSE_LAMBERT) {
        r->sample_a[r->used] = lead->a;
        return;
    }
    brdffit_diffuse_row(model->diffuse, lead, column, error);
    for (f = 0; f < r->fixed; f++) {
        r->sample_a[(size_t)f * r->room + r->used] = column[f];
        r->off_a[(size_t)f * r->room + r->used] = error[f];
    }
}

/* Of an anisotropic lobe: c of the stretched geometry, or, where that is searched, along the tangent and across it. */
static brdffit_status turn_sample(const brdffit_samples *s, const struct model *model, size_t i, struct geometry *g,
                                  double *split, brdffit_error *error)
{
    double turn[2];

    if (!brdffit_turn_of(s, i, turn)) {
        return brdffit_fail_at(error, "an anisotropic lobe needs a tangent that is not along the normal", i,
                               BRDFFIT_NONE, NAN);
    }
    if (split) {
        brdffit_turn_split(&model->stretch, turn, g, split);
    } else {
        brdffit_turn_stretch(&model->stretch, turn, g);
    }
    return BRDFFIT_OK;
}

/* a of a sample that counts, and its b and c in every geometry. */
static brdffit_status keep_sample(struct reduced *r, const brdffit_samples *s, const struct model *model, size_t i,
                                  const struct geometry *lead, brdffit_error *error)
{
    brdffit_status status = BRDFFIT_OK;
    double room[2], *split;
    struct geometry g;
    int t;

    r->sample[r->used] = (uint32_t)i;
    keep_fixed(r, model, lead);
    for (t = 0; t < r->bases && status == BRDFFIT_OK; t++) {
        split = t == 0 && model->shapes > 1 ? room : NULL;
        g = *lead;
        if ((t != model->lead || model->masking != BRDFFIT_MASKING_V_CAVITY) && s->form != BRDFFIT_FORM_COEFFICIENTS) {
            g.b_hidden = g.c_hidden = 0.0;
            model->kind[model->shown_by[t]]->row(&lead->angles, &g);
        }
        if (t == 0 && model->turned) {
            status = turn_sample(s, model, i, &g, split, error);
        }
        keep_table(r, t, &g, split);
        if (r->geometries > r->bases) {
            brdffit_schlick_column(&g);
            keep_table(r, t + r->bases, &g, split);
        }
    }
    return status;
}

/* First pass: (a, b, c) of every sample that counts, in sample_*; the number of used and skipped ones. */
static brdffit_status classify(struct reduced *r, const brdffit_samples *s, const struct model *model,
                               const brdffit_options *options, brdffit_error *error)
{
    double min_cosine = brdffit_geometry_min_cosine(options->max_incidence);
    brdffit_distribution lead = brdffit_model_lead(model);
    size_t i, k;

    r->used = 0;
    for (k = 0; k < BRDFFIT_SKIP_COUNT; k++) {
        r->skipped[k] = 0;
    }
    for (k = 0; k < s->channels; k++) {
        r->channel_scale[k] = 0.0;
        r->ii[k] = 0.0;
    }
    for (i = 0; i < s->count; i++) {
        struct geometry g;
        brdffit_status status;
        brdffit_skip skip = brdffit_geometry_sample(s, lead, min_cosine, i, &g, &status, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            r->skipped[skip]++;
            continue;
        }
        status = keep_sample(r, s, model, i, &g, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        r->sample_factor[r->used] = s->quantity == BRDFFIT_QUANTITY_RADIANCE ? 1.0 : g.cos_light;
        status = check_values(r, s, i, r->sample_factor[r->used], error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        r->used++;
    }
    return r->used ? BRDFFIT_OK : brdffit_fail(error, BRDFFIT_ERR_NO_SAMPLES, "every sample was skipped");
}

/* Divisor of each channel; with NORMALISE_NONE one power of two for all, undone in the result. */
brdffit_status brdffit_reduce_channel_scales(struct reduced *r, const brdffit_options *options, brdffit_error *error)
{
    double magnitude = vector_largest(r->ii, r->channels);
    size_t k;

    if (options->normalise == BRDFFIT_NORMALISE_NONE && !(magnitude <= LIMIT_VALUE)) {
        return brdffit_fail_at(error, "a value is too large to minimise in the data's units", BRDFFIT_NONE,
                               BRDFFIT_NONE, magnitude);
    }
    for (k = 0; k < r->channels; k++) {
        if (options->normalise == BRDFFIT_NORMALISE_NONE) {
            r->channel_scale[k] = power_of_two(magnitude);
        } else if (!(r->channel_scale[k] > 0.0)) {
            r->channel_scale[k] = 1.0;
        }
        if (r->ii[k] > 0.0 && !(r->ii[k] >= LIMIT_SMALLEST)) {
            return brdffit_fail_at(error, "a channel's values are all below 1e-304: scale them", BRDFFIT_NONE, k,
                                   r->ii[k]);
        }
        if (!(r->ii[k] / r->channel_scale[k] <= LIMIT_VALUE)) {
            return brdffit_fail_at(error, "a channel's values span more than 150 orders of magnitude", BRDFFIT_NONE, k,
                                   r->ii[k]);
        }
    }
    return BRDFFIT_OK;
}

/* What a sample of weight w is multiplied by. A subnormal w has a root with all its digits, and w / scale_w has not. */
static double root_of(double w, double scale_w, brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_LINF ? 1.0 : norm == BRDFFIT_NORM_L1 ? w / scale_w : sqrt(w) / sqrt(scale_w);
}

/* A power of four near the largest weight, so that its root is a power of two; weights of at most 1 stay what they are. */
static double weight_scale(double largest)
{
    int exponent;

    if (largest > 0.25 && largest <= 1.0) {
        return 1.0;
    }
    (void)frexp(power_of_two(largest), &exponent);
    exponent -= 1; /* of the power of two itself */
    return ldexp(1.0, exponent + (exponent % 2 != 0));
}

/* Divide v by a power of two that brings its largest entry to about 1; *scale takes it up, as far as a double holds it. */
static void bring_to_one(double *v, size_t n, double *scale)
{
    double power = power_of_two(vector_largest(v, n));
    size_t j;

    while (!(isnormal(*scale * power) && isnormal(1.0 / (*scale * power)))) {
        power = power < 1.0 ? 2.0 * power : 0.5 * power;
    }
    for (j = 0; j < n && power != 1.0; j++) {
        v[j] /= power;
    }
    *scale *= power;
}

/* v times the root of each sample's weight, brought to about 1 before (so that nothing overflows) and after. */
static void weigh(const struct reduced *r, double *v, const double *root, double *scale)
{
    size_t j;

    *scale = 1.0;
    bring_to_one(v, r->used, scale);
    if (root) {
        for (j = 0; j < r->used; j++) {
            v[j] *= root[j];
        }
        bring_to_one(v, r->used, scale);
    }
}

static brdffit_status finish_table(const struct reduced *r, struct table *t, const double *root, brdffit_error *error)
{
    size_t j;

    weigh(r, t->sample_b, root, &t->scale_b);
    t->snapped = 0.0;
    for (j = 0; j < r->used; j++) {
        if (t->sample_b[j] > 0.0 && !(t->sample_b[j] * LIMIT_COEFFICIENT_RATIO >= 1.0)) {
            return brdffit_fail_at(error, "b (with its weight) spans more than 140 orders of magnitude", r->sample[j],
                                   BRDFFIT_NONE, t->sample_b[j] * t->scale_b);
        }
        if (t->sample_b[j] == 0.0) {
            t->sample_c[j] = INFINITY; /* no lobe here, so c means nothing: sort it last */
            t->charge.b[j] *= (root ? root[j] : 1.0) / t->scale_b; /* what it hides */
        }
    }
    return BRDFFIT_OK;
}

/* Roots of the weights over scale_w, or NULL; in the scratch of the rows. */
static const double *roots_of(struct reduced *r, const brdffit_samples *s, brdffit_norm norm)
{
    double *root = r->row_square;
    size_t j;

    r->scale_w = 1.0;
    if (!s->weights) {
        return NULL;
    }
    for (j = 0; j < r->used; j++) {
        root[j] = s->weights[r->sample[j]];
    }
    r->scale_w = weight_scale(vector_largest(root, r->used));
    for (j = 0; j < r->used; j++) {
        root[j] = root_of(root[j], r->scale_w, norm);
        r->sample_factor[j] *= root[j];
    }
    return root;
}

/* Largest magnitude of a value in internal units so far. */
static double largest_value(const struct reduced *r, const brdffit_samples *s)
{
    double largest = 0.0;
    size_t j, k;

    for (k = 0; k < r->channels; k++) {
        if (!s->weights) {
            largest = larger(largest, r->ii[k] / r->channel_scale[k]);
        }
        for (j = 0; j < r->used && s->weights; j++) {
            largest = larger(largest, fabs(brdffit_reduce_value(r, s, (uint32_t)j, k)));
        }
    }
    return largest;
}

void brdffit_reduce_value_scale(struct reduced *r, double magnitude)
{
    r->value_scale = magnitude >= 0.5 && magnitude <= 1.0 ? 1.0 : power_of_two(magnitude);
}

/* Errors of a become those of the weighted column. */
static void weigh_errors(struct reduced *r, int f, const double *root)
{
    double *off = r->off_a + (size_t)f * r->room;
    size_t j;

    for (j = 0; j < r->used && r->diffuse_off; j++) {
        off[j] *= (root ? root[j] : 1.0) / r->scale_a[f];
    }
}

/* Scales of a, b, w and values; sample_a, sample_b and sample_factor get their final, weighted values. */
static brdffit_status choose_scales(struct reduced *r, const brdffit_samples *s, brdffit_norm norm,
                                    brdffit_error *error)
{
    const double *root = roots_of(r, s, norm);
    brdffit_status status = BRDFFIT_OK;
    size_t j;
    int f, g;

    for (f = 0; f < r->fixed; f++) {
        weigh(r, r->sample_a + (size_t)f * r->room, root, &r->scale_a[f]);
        weigh_errors(r, f, root);
    }
    for (g = 0; g < r->geometries && status == BRDFFIT_OK; g++) {
        status = finish_table(r, &r->table[g], root, error);
    }
    brdffit_reduce_value_scale(r, largest_value(r, s));
    for (j = 0; j < r->used && r->value_scale != 1.0; j++) {
        r->sample_factor[j] /= r->value_scale;
    }
    return status;
}

brdffit_status brdffit_reduce(struct reduced *reduced, const brdffit_samples *samples, const struct model *model,
                              const brdffit_options *options, brdffit_error *error)
{
    double s_end[KINDS_MOST];
    brdffit_status status;

    brdffit_charge_none(reduced);
    reduced->diffuse_off = model->diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR || model->diffuse == BRDFFIT_DIFFUSE_BURLEY;
    status = classify(reduced, samples, model, options, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_reduce_channel_scales(reduced, options, error);
    }
    if (status == BRDFFIT_OK) {
        status = choose_scales(reduced, samples, options->norm, error);
    }
    if (status == BRDFFIT_OK) {
        brdffit_reduce_sort(reduced);
        reduced->counted = reduced->used;
        if (samples->form == BRDFFIT_FORM_DIRECTIONS && model->shapes == 1) {
            brdffit_reduce_ends(model, options, s_end);
            brdffit_reduce_snap(reduced, s_end);
        }
        brdffit_reduce_sums(reduced, samples);
        brdffit_reduce_every_channel(reduced);
        brdffit_reduce_rows(reduced, samples, options->norm);
        brdffit_charge_samples(reduced, samples, options->norm);
    }
    return status;
}
