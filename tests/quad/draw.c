/*
 * See draw.h: random numbers, room, options, geometry and values. SPDX-License-Identifier: MIT
 */
#include "draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lobes that this build's options can say. */
#define DRAW_LOBES (BRDFFIT_MAX_LOBES < QUAD_LOBES ? BRDFFIT_MAX_LOBES : QUAD_LOBES)

/* Samples and channels that norms L1 and LINF are tried on: their judge enumerates. */
#define LP_COUNT 7
#define LP_CHANNELS 2

uint64_t draw_bits(struct draw *d)
{
    uint64_t x = d->state += UINT64_C(0x9e3779b97f4a7c15);

    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

double draw_uniform(struct draw *d, double low, double high)
{
    return low + (high - low) * ((double)(draw_bits(d) >> 11) * 0x1p-53);
}

double draw_power(struct draw *d, double low, double high)
{
    return pow(10.0, draw_uniform(d, low, high));
}

size_t draw_below(struct draw *d, size_t n)
{
    return (size_t)(draw_bits(d) % n);
}

int draw_one_in(struct draw *d, size_t n)
{
    return draw_below(d, n) == 0;
}

double draw_normal(struct draw *d)
{
    double sum = -6.0;
    int i;

    for (i = 0; i < 12; i++) {
        sum += draw_uniform(d, 0.0, 1.0);
    }
    return sum;
}

void draw_problem(struct draw *d, const struct draw_family *family, uint64_t seed)
{
    memset(d, 0, sizeof *d);
    d->state = seed;
    (void)draw_bits(d);
    brdffit_samples_init(&d->samples);
    family->draw(d);
    d->question.samples = &d->samples;
}

void draw_free(struct draw *d)
{
    free(d->block);
    d->block = NULL;
}

/* Fresnel, diffuse and masking, of at most as many columns as there may be. */
static void draw_model(struct draw *d)
{
    static const int columns[BRDFFIT_DIFFUSE_COUNT] = {1, 1, 2, 3};
    struct fit_question *q = &d->question;
    brdffit_options *o = &q->options;
    int j, masked = draw_below(d, 4) > 0;

    o->masking = masked ? (brdffit_masking)draw_below(d, BRDFFIT_MASKING_COUNT) : BRDFFIT_MASKING_V_CAVITY;
    for (j = 0; j < QUAD_LOBES && o->masking != BRDFFIT_MASKING_V_CAVITY; j++) {
        q->distribution[j] = j == 0 || q->distribution[j] != q->distribution[0] ? (brdffit_distribution)draw_below(d, 2)
                                                                                : q->distribution[0];
        if (j && q->distribution[j] < q->distribution[j - 1]) { /* lobes of one distribution stand together */
            q->distribution[j] = q->distribution[j - 1];
        }
    }
    o->diffuse = (brdffit_diffuse)draw_below(d, d->wide == 2 ? 2 : BRDFFIT_DIFFUSE_COUNT);
    o->fresnel = (brdffit_fresnel)(d->wide == 2 ? 0 : draw_below(d, 3) > 0);
    if (columns[o->diffuse] + q->lobes * (1 + (int)o->fresnel) > QUAD_COLUMNS) {
        o->diffuse = BRDFFIT_DIFFUSE_LAMBERT;
    }
}

/* So many that the judge of L1 and LINF may enumerate. */
static int few_columns(const struct draw *d)
{
    static const int columns[BRDFFIT_DIFFUSE_COUNT] = {1, 1, 2, 3};
    const brdffit_options *o = &d->question.options;

    return columns[o->diffuse] + d->question.lobes * (1 + (int)o->fresnel) <= 4;
}

void draw_shape(struct draw *d, size_t count, size_t channels, size_t texels, brdffit_form form)
{
    brdffit_samples *s = &d->samples;
    double *next;
    int j, lobes = 1 + (int)draw_below(d, DRAW_LOBES), mixed = draw_one_in(d, 3);

    if (d->wide && form == BRDFFIT_FORM_COEFFICIENTS) { /* these have no angles */
        form = (brdffit_form)draw_below(d, 2);
    }
    next = d->block = calloc(count * (17 + channels * texels) + 1, sizeof *next);
    if (!next) {
        abort();
    }
    s->count = count;
    s->channels = channels;
    s->form = form;
    s->light = d->light = next;
    s->view = d->view = next += 3 * count;
    d->normal = next += 3 * count;
    s->cos_light = d->cos_light = next += 3 * count;
    s->cos_view = d->cos_view = next += count;
    s->tan2_half = d->tan2_half = next += count;
    s->cos_difference = d->cos_difference = next += count;
    s->a = d->a = next += count;
    s->b = d->b = next += count;
    s->c = d->c = next += count;
    d->weights = next += count;
    s->values = d->values = next + count;
    d->texels = texels;
    s->quantity = form == BRDFFIT_FORM_COEFFICIENTS || draw_one_in(d, 2) ? BRDFFIT_QUANTITY_RADIANCE
                                                                         : BRDFFIT_QUANTITY_BRDF;
    fit_question_init(&d->question, s, lobes, (brdffit_distribution)draw_below(d, BRDFFIT_DISTRIBUTION_COUNT));
    for (j = 1; j < lobes && mixed; j++) { /* ascending, so that lobes of one distribution stand together */
        int rest = BRDFFIT_DISTRIBUTION_COUNT - (int)d->question.distribution[j - 1];

        d->question.distribution[j] = (brdffit_distribution)((int)d->question.distribution[j - 1] +
                                                             (int)draw_below(d, (size_t)rest));
    }
    if (d->wide) {
        draw_model(d);
    }
}

static brdffit_isa any_isa(struct draw *d)
{
    brdffit_isa isa = (brdffit_isa)draw_below(d, BRDFFIT_ISA_COUNT);

    return brdffit_isa_supported(isa) ? isa : BRDFFIT_ISA_AUTO;
}

void draw_options(struct draw *d)
{
    brdffit_options *o = &d->question.options;

    o->relative_gap = draw_power(d, -13.0, -1.0);
    o->absolute_gap = draw_one_in(d, 2) ? 0.0 : draw_power(d, -16.0, -6.0);
    o->normalise = draw_one_in(d, 3) ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
    o->box_budget = d->question.lobes == 1 ? 2000 : 3000;
    o->max_incidence = draw_one_in(d, 4) ? 60.0 : 90.0;
    o->isa = any_isa(d);
    if (draw_one_in(d, 12)) {
        o->engine = BRDFFIT_ENGINE_SOCP;
        o->box_budget = 200;
    }
    if (d->samples.count <= LP_COUNT && d->samples.channels <= LP_CHANNELS && d->question.lobes <= 2 &&
        few_columns(d) && draw_one_in(d, 6)) {
        o->norm = draw_one_in(d, 2) ? BRDFFIT_NORM_L1 : BRDFFIT_NORM_LINF;
        o->box_budget = 60;
    }
    if (draw_one_in(d, 6)) {
        o->sigma_max = draw_power(d, -2.0, 3.0);
        o->sigma_min = fmin(o->sigma_max, draw_power(d, -12.0, 0.0));
        o->exponent_min = draw_power(d, -6.0, 3.0);
        o->exponent_max = o->exponent_min * draw_power(d, 0.0, 12.0);
    }
}

/* ---- Geometry --------------------------------------------------------------------------------------------------- */

void draw_direction(double theta, double phi, double *out)
{
    double degree = 0.017453292519943295;

    out[0] = sin(theta * degree) * cos(phi * degree);
    out[1] = sin(theta * degree) * sin(phi * degree);
    out[2] = cos(theta * degree);
}

void draw_geometry(struct draw *d, double steepest)
{
    double spread = draw_one_in(d, 3) ? 0.0 : draw_power(d, -2.0, 1.5); /* of half vectors around the normal */
    size_t i;

    for (i = 0; i < d->samples.count; i++) {
        double theta = draw_uniform(d, 0.0, steepest), phi = draw_uniform(d, 0.0, 360.0);
        double other = spread > 0.0 ? theta + spread * draw_normal(d) : draw_uniform(d, 0.0, steepest);

        draw_direction(theta, phi, d->light + 3 * i);
        draw_direction(fmin(fabs(other), steepest), spread > 0.0 ? phi + 180.0 : draw_uniform(d, 0.0, 360.0),
                       d->view + 3 * i);
        d->cos_light[i] = draw_uniform(d, cos(steepest * 0.0174533), 1.0);
        d->cos_view[i] = draw_uniform(d, cos(steepest * 0.0174533), 1.0);
        d->cos_difference[i] = draw_uniform(d, 0.2, 1.0);
        d->tan2_half[i] = draw_one_in(d, 8) ? 0.0 : draw_power(d, -6.0, 0.5);
        d->a[i] = draw_one_in(d, 8) ? 0.0 : draw_uniform(d, 0.1, 0.3);
        d->b[i] = draw_one_in(d, 8) ? 0.0 : draw_power(d, -1.0, 0.5);
        d->c[i] = draw_one_in(d, 8) ? 0.0 : draw_power(d, -4.0, 1.0);
    }
}

void draw_random_weights(struct draw *d, double low, double high)
{
    size_t i;

    d->samples.weights = d->weights;
    for (i = 0; i < d->samples.count; i++) {
        d->weights[i] = draw_one_in(d, 12) ? 0.0 : draw_power(d, low, high);
    }
}

/* ---- Values ----------------------------------------------------------------------------------------------------- */

/* Radiance of a random model at the samples, without noise: x a + y1 g1 + ..., peaks of g set to those of a. */
static void radiance(struct draw *d, const struct quad_problem *p, const size_t *row, double low, double high,
                     double *out)
{
    quad s[QUAD_LOBES], z[QUAD_COLUMNS];
    size_t i;
    int j;

    for (j = 0; j < p->columns; j++) {
        z[j] = j < p->fixed ? draw_one_in(d, 5) || d->no_diffuse ? 0.0 : draw_uniform(d, 0.2, 1.0)
                            : draw_power(d, -2.0, 3.0);
        s[j < p->fixed ? 0 : (j - p->fixed) / p->each] = quad_s(low * pow(high / low, draw_uniform(d, 0.0, 1.0)));
    }
    quad_columns(p, s, p->column);
    for (j = 0; j < p->columns; j++) {
        quad largest = 0;

        for (i = 0; i < p->count; i++) {
            largest = fmaxq(largest, p->column[(size_t)j * p->count + i]);
        }
        z[j] = largest > 0 ? z[j] / largest : 0;
    }
    for (i = 0; i < d->samples.count; i++) {
        quad sum = 0;

        for (j = 0; j < p->columns && row[i] != BRDFFIT_NONE; j++) {
            sum += z[j] * p->column[(size_t)j * p->count + row[i]];
        }
        out[i] = row[i] == BRDFFIT_NONE ? draw_uniform(d, 0.0, 1.0) : (double)(sum / p->to_radiance[row[i]]);
    }
}

static void find_rows(const struct draw *d, const struct quad_problem *p, size_t *row)
{
    size_t i, next = 0;

    for (i = 0; i < d->samples.count; i++) {
        struct quad_row ignored;
        brdffit_skip why;
        int doubtful = 0;

        row[i] = quad_row(&d->samples, i, p->lobe[0].distribution, &d->question.options, &ignored, &why, &doubtful)
                     ? next++
                     : BRDFFIT_NONE;
    }
}

void draw_truth(struct draw *d, double low, double high, double noise)
{
    brdffit_distribution distribution[QUAD_LOBES];
    size_t n = d->samples.count, channels = d->samples.channels, k, i, *row = calloc(n, sizeof *row);
    double *one = calloc(n, sizeof *one);
    struct quad_problem p;

    memcpy(distribution, d->question.distribution, sizeof distribution);
    if (draw_one_in(d, 4)) {
        distribution[0] = (brdffit_distribution)draw_below(d, d->question.options.masking ? 2
                                                                                          : BRDFFIT_DISTRIBUTION_COUNT);
    }
    if (!row || !one ||
        quad_problem_new(&p, &d->samples, &d->question.options, 1 + (int)draw_below(d, 2), distribution)) {
        abort();
    }
    find_rows(d, &p, row);
    for (k = 0; k < channels * d->texels; k++) {
        double largest = 0.0, *values = d->values + k / channels * n * channels + k % channels;

        radiance(d, &p, row, low, high, one);
        for (i = 0; i < n; i++) {
            largest = fmax(largest, one[i]);
        }
        for (i = 0; i < n; i++) {
            values[i * channels] = one[i] + (noise > 0.0 ? noise * largest * draw_normal(d) : 0.0);
        }
    }
    quad_problem_free(&p);
    free(one);
    free(row);
}

void draw_values(struct draw *d)
{
    draw_truth(d, 0.02, 2.0, draw_one_in(d, 4) ? 0.0 : draw_power(d, -9.0, 0.0));
}
