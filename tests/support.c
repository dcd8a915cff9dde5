/*
 * See support.h. SPDX-License-Identifier: MIT
 */
#include "support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "verify.h"
#include "verify_samples.h"

#define PRINTED_SAMPLES 300

uint64_t brdffit_test_bits(struct brdffit_test_random *random)
{
    uint64_t x = random->state += UINT64_C(0x9e3779b97f4a7c15);

    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

double brdffit_test_uniform(struct brdffit_test_random *random, double low, double high)
{
    return low + (high - low) * ((double)(brdffit_test_bits(random) >> 11) * 0x1p-53);
}

double brdffit_test_log_uniform(struct brdffit_test_random *random, double low, double high)
{
    double x = low * pow(high / low, brdffit_test_uniform(random, 0.0, 1.0));

    return x > high ? high : x;
}

size_t brdffit_test_below(struct brdffit_test_random *random, size_t count)
{
    return (size_t)(brdffit_test_bits(random) % count);
}

double brdffit_test_normal(struct brdffit_test_random *random)
{
    double sum = -6.0;
    int i;

    for (i = 0; i < 12; i++) {
        sum += brdffit_test_uniform(random, 0.0, 1.0);
    }
    return sum;
}

struct brdffit_test_spec brdffit_test_spec_default(void)
{
    struct brdffit_test_spec spec;

    memset(&spec, 0, sizeof spec);
    spec.seed = 1;
    spec.count = 84;
    spec.channels = 3;
    spec.layout = BRDFFIT_TEST_GRID;
    spec.quantity = BRDFFIT_QUANTITY_RADIANCE;
    spec.lobes = 2;
    spec.sigma[0] = 0.1;
    spec.sigma[1] = 0.4;
    spec.diffuse = 0.3;
    spec.specular[0] = 0.01;
    spec.specular[1] = 0.1;
    return spec;
}

static void direction(double theta, double phi, double *out)
{
    double degree = (double)(VERIFY_PI / 180.0L);

    out[0] = sin(theta * degree) * cos(phi * degree);
    out[1] = sin(theta * degree) * sin(phi * degree);
    out[2] = cos(theta * degree);
}

/* Light and view of sample i; grids repeat when they are used up. */
static void directions(const struct brdffit_test_spec *spec, size_t i, struct brdffit_test_random *random,
                       double *light, double *view)
{
    size_t per_view = (spec->count + 3) / 4, j = i % per_view;

    switch (spec->layout) {
    case BRDFFIT_TEST_RANDOM:
        direction(brdffit_test_uniform(random, 0.0, 80.0), brdffit_test_uniform(random, 0.0, 360.0), light);
        direction(brdffit_test_uniform(random, 0.0, 80.0), brdffit_test_uniform(random, 0.0, 360.0), view);
        return;
    case BRDFFIT_TEST_GRID: direction(10.0 * (double)(j / 3 % 7), 90.0 * (double)(j % 3), light); break;
    case BRDFFIT_TEST_IN_PLANE:
        direction(per_view > 1 ? 60.0 * (double)j / (double)(per_view - 1) : 0.0, 180.0, light);
        break;
    }
    direction(20.0 * (double)(i / per_view), 0.0, view);
}

/* Turn the frame of sample i so that `normal` is what +z was. */
static void tilt(struct brdffit_test_random *random, double *light, double *view, double *normal)
{
    double frame[3][3], *vector[2] = {light, view};
    double theta = brdffit_test_uniform(random, 0.0, 180.0), phi = brdffit_test_uniform(random, 0.0, 360.0);
    int i, j;

    direction(theta, phi, normal);
    direction(theta + 90.0, phi, frame[0]);
    direction(90.0, phi + 90.0, frame[1]);
    memcpy(frame[2], normal, sizeof frame[2]);
    for (i = 0; i < 2; i++) {
        double turned[3], *v = vector[i];

        for (j = 0; j < 3; j++) {
            turned[j] = v[0] * frame[0][j] + v[1] * frame[1][j] + v[2] * frame[2][j];
        }
        memcpy(v, turned, sizeof turned);
    }
}

/* The arrays of the form, cut from the block in order. */
struct arrays {
    double *light, *view, *normal, *cos_light, *cos_view, *tan2_half, *cos_difference, *a, *b, *c;
};

static void take_arrays(const struct brdffit_test_spec *spec, struct brdffit_test_data *data, struct arrays *to)
{
    size_t n = spec->count;
    brdffit_samples *s = &data->samples;

    data->block = calloc((n + 1) * (17 + spec->channels), sizeof(double));
    assert_non_null(data->block);
    s->light = to->light = data->block;
    s->view = to->view = to->light + 3 * n;
    to->normal = to->view + 3 * n;
    s->normal = spec->normals ? to->normal : NULL;
    s->cos_light = to->cos_light = to->normal + 3 * n;
    s->cos_view = to->cos_view = to->cos_light + n;
    s->tan2_half = to->tan2_half = to->cos_view + n;
    s->cos_difference = to->cos_difference = to->tan2_half + n;
    s->a = to->a = to->cos_difference + n;
    s->b = to->b = to->a + n;
    s->c = to->c = to->b + n;
    data->weights = to->c + n;
    data->values = data->weights + n;
    s->values = data->values;
    s->weights = spec->weighted ? data->weights : NULL;
}

/* Angles or coefficients of a sample that has directions. */
static void convert(const brdffit_samples *s, brdffit_distribution distribution, size_t i, struct arrays *to)
{
    struct verify_angles angles;
    struct verify_sample sample;

    verify_directions(s, i, &angles);
    verify_coefficients_of(distribution, &angles, 0, &sample);
    to->cos_light[i] = (double)angles.nl;
    to->cos_view[i] = (double)angles.nv;
    to->tan2_half[i] = (double)angles.tan2;
    to->cos_difference[i] = (double)fminl(angles.vh, 1.0L);
    to->a[i] = (double)sample.a;
    to->b[i] = (double)sample.b;
    to->c[i] = (double)sample.c;
}

/* Radiance of the truth from the inputs as rounded, then noise, then f_r when asked for. */
static void fill_values(const struct brdffit_test_spec *spec, struct brdffit_test_data *data,
                        struct brdffit_test_random *random)
{
    size_t i, k, channels = spec->channels;

    for (k = 0; k < channels; k++) {
        long double tint = (1.0L + (long double)k / 4.0L) / (1.0L + (long double)k / 8.0L), largest = 0.0L;

        for (i = 0; i < spec->count; i++) {
            struct verify_sample at;
            long double value;
            int p;

            if (verify_sample_of(spec->distribution, &data->samples, 90.0, i, &at) != BRDFFIT_SKIP_COUNT) {
                continue;
            }
            value = at.a * spec->diffuse * tint;
            for (p = 0; p < spec->lobes; p++) {
                value += at.b * spec->specular[p] * tint * verify_lobe(spec->distribution, at.c, spec->sigma[p]);
            }
            largest = fmaxl(largest, value);
            data->values[i * channels + k] = (double)(value / at.to_radiance);
        }
        for (i = 0; spec->noise > 0.0 && i < spec->count; i++) {
            data->values[i * channels + k] += spec->noise * (double)largest * brdffit_test_normal(random);
        }
    }
}

void brdffit_test_data_new(const struct brdffit_test_spec *spec, struct brdffit_test_data *data)
{
    struct brdffit_test_random random = {spec->seed};
    brdffit_samples *s = &data->samples;
    struct arrays to;
    size_t i;

    memset(data, 0, sizeof *data);
    brdffit_samples_init(s);
    take_arrays(spec, data, &to);
    s->count = spec->count;
    s->channels = spec->channels;
    s->form = spec->form;
    s->quantity = spec->quantity;
    for (i = 0; i < spec->count; i++) {
        directions(spec, i, &random, to.light + 3 * i, to.view + 3 * i);
        if (spec->normals) {
            tilt(&random, to.light + 3 * i, to.view + 3 * i, to.normal + 3 * i);
        }
        if (spec->weighted) {
            data->weights[i] = brdffit_test_below(&random, 8) ? brdffit_test_log_uniform(&random, 0.1, 10.0) : 0.0;
        }
        convert(s, spec->distribution, i, &to);
    }
    fill_values(spec, data, &random);
}

void brdffit_test_data_free(struct brdffit_test_data *data)
{
    free(data->block);
    memset(data, 0, sizeof *data);
}

brdffit_samples brdffit_test_coefficients(size_t count, size_t channels, const double *a, const double *b,
                                          const double *c, const double *values)
{
    brdffit_samples samples;

    brdffit_samples_init(&samples);
    samples.count = count;
    samples.channels = channels;
    samples.form = BRDFFIT_FORM_COEFFICIENTS;
    samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples.a = a;
    samples.b = b;
    samples.c = c;
    samples.values = values;
    return samples;
}

static void print_numbers(const char *name, const double *value, size_t count)
{
    size_t j;

    for (j = 0; value && j < count; j++) {
        fprintf(stderr, "%s%a", j ? "," : name, value[j]);
    }
}

void brdffit_test_print(const brdffit_samples *s, const brdffit_options *o)
{
    size_t i;

    if (o) {
        fprintf(stderr,
                "options: lobes %d distribution %d normalise %d sigma [%a, %a] gap %a %a resolution %a budget %zu "
                "incidence %a\n",
                o->lobes, (int)o->distribution, (int)o->normalise, o->sigma_min, o->sigma_max, o->relative_gap,
                o->absolute_gap, o->sigma_resolution, o->box_budget, o->max_incidence);
    }
    fprintf(stderr, "samples: count %zu channels %zu form %d quantity %d\n", s->count, s->channels, (int)s->form,
            (int)s->quantity);
    for (i = 0; i < s->count && i < PRINTED_SAMPLES; i++) {
        if (s->form == BRDFFIT_FORM_DIRECTIONS) {
            print_numbers("light ", s->light + 3 * i, 3);
            print_numbers(" view ", s->view + 3 * i, 3);
            print_numbers(" normal ", s->normal ? s->normal + 3 * i : NULL, 3);
        } else if (s->form == BRDFFIT_FORM_ANGLES) {
            print_numbers("cos_light ", s->cos_light + i, 1);
            print_numbers(" cos_view ", s->cos_view + i, 1);
            print_numbers(" tan2_half ", s->tan2_half + i, 1);
            print_numbers(" cos_difference ", s->cos_difference + i, 1);
        } else {
            print_numbers("a ", s->a + i, 1);
            print_numbers(" b ", s->b + i, 1);
            print_numbers(" c ", s->c + i, 1);
        }
        print_numbers(" weight ", s->weights ? s->weights + i : NULL, 1);
        print_numbers(" values ", s->values + i * s->channels, s->channels);
        fputc('\n', stderr);
    }
    if (s->count > PRINTED_SAMPLES) {
        fprintf(stderr, "... and %zu more\n", s->count - PRINTED_SAMPLES);
    }
}

void brdffit_test_flatten(const brdffit_result *r, struct brdffit_test_result *flat)
{
    const size_t lobes = (size_t)r->model->lobes;
    size_t p;

    memset(flat, 0, sizeof *flat);
    flat->model.distribution = r->model->distribution;
    flat->model.lobes = r->model->lobes;
    flat->model.channels = r->model->channels;
    memcpy(flat->model.sigma, r->model->sigma, lobes * sizeof(double));
    flat->model.x = r->model->x;
    flat->model.y = r->model->y;
    flat->model.distributions = r->model->distributions;
    for (p = 0; p < lobes; p++) {
        memcpy(&flat->lobe[p], r->lobe[p], sizeof flat->lobe[p]);
    }
    flat->channel_scale = r->channel_scale;
    flat->rms = r->rms;
    flat->rms_total = r->rms_total;
    flat->e2 = r->e2;
    flat->e2_error = r->e2_error;
    flat->lower_bound = r->lower_bound;
    flat->gap = r->gap;
    flat->sum_of_squares = r->sum_of_squares;
    flat->sigma_floor = r->sigma_floor;
    flat->sigma_tail = r->sigma_tail;
    flat->kkt_residual = r->kkt_residual;
    flat->stop = r->stop;
    flat->certified = r->certified;
    flat->boxes = r->boxes;
    flat->nodes = r->nodes;
    flat->programs_solved = r->programs_solved;
    flat->programs_refused = r->programs_refused;
    flat->programs_decided = r->programs_decided;
    flat->distinct_c = r->distinct_c;
    flat->channels_zero = r->channels_zero;
    flat->channels_identical = r->channels_identical;
    flat->samples_used = r->samples_used;
    memcpy(flat->samples_skipped, r->samples_skipped, sizeof flat->samples_skipped);
}

brdffit_status brdffit_test_eval(const struct brdffit_test_model *flat, const brdffit_samples *at, double *out,
                                 brdffit_error *error)
{
    brdffit_model model;

    if (!flat) {
        return brdffit_eval(NULL, at, out, error);
    }
    brdffit_model_init(&model);
    model.distribution = flat->distribution;
    model.lobes = flat->lobes;
    model.channels = flat->channels;
    model.sigma = flat->sigma;
    model.x = flat->x;
    model.y = flat->y;
    model.distributions = flat->distributions;
    return brdffit_eval(&model, at, out, error);
}

brdffit_status brdffit_test_run(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                size_t size, struct brdffit_test_result *result, brdffit_error *error)
{
    const brdffit_result *made;
    brdffit_status status = brdffit_fit(samples, options, workspace, size, &made, error);

    if (status == BRDFFIT_OK) {
        brdffit_test_flatten(made, result);
    }
    return status;
}

brdffit_status brdffit_test_run_sums(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                     size_t size, struct brdffit_test_result *result, brdffit_error *error)
{
    const brdffit_result *made;
    brdffit_status status = brdffit_fit_sums(sums, options, workspace, size, &made, error);

    if (status == BRDFFIT_OK) {
        brdffit_test_flatten(made, result);
    }
    return status;
}

void brdffit_test_fit(const brdffit_samples *samples, const brdffit_options *options, struct brdffit_test_fit *fit)
{
    brdffit_error error;
    brdffit_status status;
    char why[512];

    fit->workspace_size = brdffit_workspace_size(samples->count, samples->channels, options);
    assert_true(fit->workspace_size > 0);
    fit->workspace = malloc(fit->workspace_size);
    assert_non_null(fit->workspace);
    memset(&error, 0, sizeof error);
    status = brdffit_test_run(samples, options, fit->workspace, fit->workspace_size, &fit->result, &error);
    if (status != BRDFFIT_OK) {
        brdffit_test_print(samples, options);
        fail_msg("brdffit_fit: %s (sample %zu, channel %zu, value %g)", error.message, error.sample, error.channel,
                 error.value);
    }
    if (brdffit_test_verify(samples, options, &fit->result, why, sizeof why)) {
        brdffit_test_print(samples, options);
        fail_msg("brdffit_test_verify: %s", why);
    }
}

void brdffit_test_fit_free(struct brdffit_test_fit *fit)
{
    free(fit->workspace);
    memset(fit, 0, sizeof *fit);
}

brdffit_error brdffit_test_fit_fails(const brdffit_samples *samples, const brdffit_options *options,
                                     brdffit_status status)
{
    size_t size = brdffit_workspace_size(samples->count, samples->channels, options);
    void *workspace = malloc(size + 64);
    unsigned char before = 0xa5;
    const brdffit_result *result = (const brdffit_result *)(const void *)&before;
    brdffit_error error;

    assert_non_null(workspace);
    memset(&error, before, sizeof error);
    assert_string_equal(brdffit_status_string(brdffit_fit(samples, options, workspace, size + 64, &result, &error)),
                        brdffit_status_string(status));
    free(workspace);
    assert_ptr_equal(result, &before);
    assert_int_equal(error.status, status);
    assert_non_null(error.message);
    assert_true(strlen(error.message) > 0);
    return error;
}
