/*
 * bench_many: certified fits of the texels of a synthetic map with one shared geometry, texels per second.
 *
 *   bench_many [--lobes N|NAME,...] [--distribution NAME] [--fresnel NAME] [--masking NAME] [--diffuse NAME] [--size N]
 *              [--gap X] [--noise X] [--repeat N] [--isa NAME] [--float] [--csv] [--check N]
 *
 * The map: size x size texels, 3 channels, 84 samples (the goniometer of the paper: 4 views, 21 lights), image stack
 * layout (sample, texel, channel), of the model that is fitted. Parameters vary smoothly; noise is relative to each texel's largest radiance.
 * Beside the speed: the share of certified texels, and the worst excess of E^2 over that of brdffit_fit() at gap
 * 1e-9 on --check texels. One thread. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "brdffit.h"
#include "lobes.h"

#define SAMPLES 84
#define CHANNELS 3
#define MOST_REPEATS 101
#define PI 3.14159265358979323846

struct settings {
    brdffit_options lobes; /* of which only these */
    brdffit_distribution list[BRDFFIT_MAX_LOBES];
    int repeat, single, csv;
    size_t size, check;
    double gap, noise;
    brdffit_isa isa;
};

struct run {
    double seconds; /* median */
    double plan_seconds;
    double worst;   /* excess of E^2, relative */
    brdffit_many_stats stats;
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t); /* of this core alone: others may share the machine */
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t random_bits(uint64_t *state)
{
    uint64_t x = *state += UINT64_C(0x9e3779b97f4a7c15);

    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

static double normal(uint64_t *state)
{
    double sum = -6.0;
    int i;

    for (i = 0; i < 12; i++) {
        sum += (double)(random_bits(state) >> 11) * 0x1p-53;
    }
    return sum;
}

static void direction(double theta, double phi, double *out)
{
    double degree = PI / 180.0;

    out[0] = sin(theta * degree) * cos(phi * degree);
    out[1] = sin(theta * degree) * sin(phi * degree);
    out[2] = cos(theta * degree);
}

static void make_geometry(double *light, double *view)
{
    size_t i;

    for (i = 0; i < SAMPLES; i++) {
        direction(10.0 * (double)(i % 21 / 3), 90.0 * (double)(i % 3), light + 3 * i);
        direction(20.0 * (double)(i / 21), 0.0, view + 3 * i);
    }
}

/* Radiance of texel (u, v) in [0, 1]^2, sample by sample. */
static int render(const struct settings *s, const brdffit_samples *at, double u, double v, double *out)
{
    double wave = 0.5 + 0.5 * sin(2.0 * PI * (1.5 * u + 0.5 * v)), x[CHANNELS], sigma[BRDFFIT_MAX_LOBES];
    double y[CHANNELS * BRDFFIT_MAX_LOBES], f0[CHANNELS * BRDFFIT_MAX_LOBES], x_more[CHANNELS * 2];
    const int lobes = s->lobes.lobes;
    brdffit_model model;
    size_t k;
    int p;

    brdffit_model_init(&model);
    model.sigma = sigma;
    model.lobes = lobes;
    model.distribution = s->lobes.distribution;
    model.distributions = s->lobes.distributions;
    model.fresnel = s->lobes.fresnel;
    model.masking = s->lobes.masking;
    model.diffuse = s->lobes.diffuse;
    model.f0 = f0;
    model.x_more = x_more;
    model.channels = CHANNELS;
    model.x = x;
    model.y = y;
    sigma[0] = 0.08 * pow(4.0, u);
    sigma[1] = sigma[0] * (1.5 + 2.0 * v);
    sigma[2] = sigma[1] * 1.8;
    for (k = 0; k < CHANNELS; k++) {
        x[k] = (0.05 + 0.4 * v) * (1.0 - 0.25 * (double)k * wave);
        x_more[2 * k] = x_more[2 * k + 1] = 0.5 * x[k]; /* for any number of them */
        for (p = 0; p < lobes; p++) {
            f0[k * (size_t)lobes + (size_t)p] = 0.04 + 0.5 * u * wave;
            y[k * (size_t)lobes + (size_t)p] = (0.02 + 0.08 * wave) * sigma[p] * (1.0 + 0.2 * (double)k * u);
        }
    }
    return brdffit_eval(&model, at, out, NULL) == BRDFFIT_OK;
}

/* values[(sample * texels + texel) * CHANNELS + channel] */
static int make_values(const struct settings *s, const brdffit_samples *at, double *values, float *single)
{
    size_t n = s->size * s->size, t, i, k;
    double out[SAMPLES * CHANNELS];
    uint64_t state = 1;

    for (t = 0; t < n; t++) {
        double largest = 0.0;

        if (!render(s, at, ((double)(t % s->size) + 0.5) / (double)s->size,
                    ((double)(t / s->size) + 0.5) / (double)s->size, out)) {
            return 0;
        }
        for (i = 0; i < SAMPLES * CHANNELS; i++) {
            largest = fmax(largest, out[i]);
        }
        for (i = 0; i < SAMPLES; i++) {
            for (k = 0; k < CHANNELS; k++) {
                size_t place = (i * n + t) * CHANNELS + k;

                values[place] = out[i * CHANNELS + k] + s->noise * largest * normal(&state);
                single[place] = (float)values[place];
            }
        }
    }
    return 1;
}

static int compare(const void *first, const void *second)
{
    double x = *(const double *)first, y = *(const double *)second;

    return (x > y) - (x < y);
}

static int fail(const brdffit_error *error)
{
    fprintf(stderr, "bench_many: %s\n", error->message);
    return 0;
}

/* Excess of E^2 over the optimum, on `check` texels spread over the map. */
static int check(const struct settings *s, const brdffit_samples *geometry, const brdffit_options *base,
                 const double *values, const float *single, const double *e2, struct run *run)
{
    size_t n = s->size * s->size, c, i, k;
    double one[SAMPLES * CHANNELS];
    brdffit_samples samples = *geometry;
    brdffit_options options = *base;

    options.relative_gap = 1e-9;
    samples.values = one;
    run->worst = 0.0;
    for (c = 0; c < s->check; c++) {
        size_t t = (c * 7919) % n;
        const brdffit_result *result;
        brdffit_error error;

        for (i = 0; i < SAMPLES; i++) {
            for (k = 0; k < CHANNELS; k++) {
                size_t place = (i * n + t) * CHANNELS + k;

                one[i * CHANNELS + k] = s->single ? (double)single[place] : values[place];
            }
        }
        if (brdffit_fit_new(&samples, &options, &result, &error) != BRDFFIT_OK) {
            return fail(&error);
        }
        run->worst = fmax(run->worst, result->e2 > 0.0 ? e2[t] / result->e2 - 1.0 : 0.0);
        brdffit_result_free(result);
    }
    return 1;
}

static int measure(const struct settings *s, struct run *run)
{
    size_t n = s->size * s->size, size, plan_size;
    double light[3 * SAMPLES], view[3 * SAMPLES], seconds[MOST_REPEATS];
    double *values = malloc(n * SAMPLES * CHANNELS * sizeof *values), *results = malloc(n * 10 * sizeof *results);
    float *single = malloc(n * SAMPLES * CHANNELS * sizeof *single);
    brdffit_samples geometry;
    brdffit_options options;
    brdffit_texels texels;
    brdffit_texel_results to;
    brdffit_error error;
    const brdffit_plan *plan;
    void *memory, *workspace;
    int r, good;

    make_geometry(light, view);
    brdffit_samples_init(&geometry);
    geometry.count = SAMPLES;
    geometry.channels = CHANNELS;
    geometry.quantity = BRDFFIT_QUANTITY_RADIANCE;
    geometry.light = light;
    geometry.view = view;
    brdffit_options_init(&options);
    options.lobes = s->lobes.lobes;
    options.distribution = s->lobes.distribution;
    options.distributions = s->lobes.distributions;
    options.fresnel = s->lobes.fresnel;
    options.masking = s->lobes.masking;
    options.diffuse = s->lobes.diffuse;
    options.relative_gap = s->gap;
    options.isa = s->isa;
    plan_size = brdffit_plan_size(&geometry, &options);
    memory = malloc(plan_size);
    if (!values || !results || !single || !memory || !make_values(s, &geometry, values, single)) {
        fprintf(stderr, "bench_many: no memory, or no model\n");
        return 0;
    }
    run->plan_seconds = now();
    if (brdffit_plan_init(&geometry, &options, memory, plan_size, &plan, &error) != BRDFFIT_OK) {
        return fail(&error);
    }
    run->plan_seconds = now() - run->plan_seconds;
    size = brdffit_many_workspace_size(plan);
    workspace = malloc(size);
    brdffit_texels_init(&texels, plan);
    texels.count = n;
    texels.type = s->single ? BRDFFIT_TYPE_FLOAT : BRDFFIT_TYPE_DOUBLE;
    texels.values = s->single ? (const void *)single : values;
    texels.texel_stride = CHANNELS;
    texels.sample_stride = (ptrdiff_t)(n * CHANNELS);
    brdffit_texel_results_init(&to);
    to.e2 = results;
    to.lower_bound = results + n;
    to.sigma = results + 2 * n;
    to.x = results + 4 * n;
    to.y = NULL;
    good = workspace != NULL;
    for (r = 0; r < s->repeat && good; r++) {
        double start = now();

        brdffit_many_stats_init(&run->stats);
        good = brdffit_fit_many(plan, &texels, &to, workspace, size, &run->stats, &error) == BRDFFIT_OK || fail(&error);
        seconds[r] = now() - start;
    }
    if (good) {
        qsort(seconds, (size_t)s->repeat, sizeof *seconds, compare);
        run->seconds = seconds[s->repeat / 2];
        good = check(s, &geometry, &options, values, single, to.e2, run);
    }
    free(workspace);
    free(memory);
    free(single);
    free(results);
    free(values);
    return good;
}

static void print_run(const struct settings *s, const struct run *run)
{
    double n = (double)(s->size * s->size), rate = n / run->seconds, share = (double)run->stats.certified / n;

    if (s->csv) {
        printf("lobes,texels,samples,channels,gap,noise,isa,texels_per_second,seconds,plan_seconds,certified,general,"
               "boxes_per_texel,checked,worst_excess\n");
        printf("%d,%.0f,%d,%d,%g,%g,%s,%.6g,%.6g,%.6g,%.9g,%zu,%.6g,%zu,%.3g\n", s->lobes.lobes, n, SAMPLES, CHANNELS,
               s->gap, s->noise, brdffit_isa_string(s->isa), rate, run->seconds, run->plan_seconds, share,
               run->stats.general, (double)run->stats.boxes / n, s->check, run->worst);
        return;
    }
    printf("%.0f texels, %d samples, %d channels, %d lobe%s, gap %g, noise %g, isa %s\n", n, SAMPLES, CHANNELS,
           s->lobes.lobes, s->lobes.lobes > 1 ? "s" : "", s->gap, s->noise, brdffit_isa_string(s->isa));
    printf("  %.0f texels a second (%.3f us each; median of %d); plan %.1f ms\n", rate, 1e6 * run->seconds / n,
           s->repeat, 1e3 * run->plan_seconds);
    printf("  certified %.4f %%, by the general path %zu, boxes a texel %.1f\n", 100.0 * share, run->stats.general,
           (double)run->stats.boxes / n);
    printf("  worst excess of E^2 over brdffit_fit() at gap 1e-9, %zu texels: %.2g\n", s->check, run->worst);
}

static int usage(void)
{
    fprintf(stderr, "usage: bench_many [--lobes N|NAME,...] [--distribution NAME] [--fresnel NAME] [--masking NAME] "
                    "[--diffuse NAME] [--size N] [--gap X] [--noise X] [--repeat N] [--isa NAME] [--float] [--csv] "
                    "[--check N]\n");
    return 2;
}

/* Names of the model; 0 when `name` is another option or its value no name. */
static int set_model(brdffit_options *o, const char *name, const char *value)
{
    int i;

    for (i = 0; strcmp(name, "--distribution") == 0 && i < BRDFFIT_DISTRIBUTION_COUNT; i++) {
        if (strcmp(value, brdffit_distribution_string((brdffit_distribution)i)) == 0) {
            o->distribution = (brdffit_distribution)i;
            return 1;
        }
    }
    for (i = 0; strcmp(name, "--fresnel") == 0 && i < BRDFFIT_FRESNEL_COUNT; i++) {
        if (strcmp(value, brdffit_fresnel_string((brdffit_fresnel)i)) == 0) {
            o->fresnel = (brdffit_fresnel)i;
            return 1;
        }
    }
    for (i = 0; strcmp(name, "--masking") == 0 && i < BRDFFIT_MASKING_COUNT; i++) {
        if (strcmp(value, brdffit_masking_string((brdffit_masking)i)) == 0) {
            o->masking = (brdffit_masking)i;
            return 1;
        }
    }
    for (i = 0; strcmp(name, "--diffuse") == 0 && i < BRDFFIT_DIFFUSE_COUNT; i++) {
        if (strcmp(value, brdffit_diffuse_string((brdffit_diffuse)i)) == 0) {
            o->diffuse = (brdffit_diffuse)i;
            return 1;
        }
    }
    return 0;
}

static int set(struct settings *s, const char *name, const char *value)
{
    int i;

    if (strcmp(name, "--lobes") == 0) {
        return bench_lobes(value, &s->lobes, s->list);
    } else if (strcmp(name, "--size") == 0) {
        s->size = (size_t)atoi(value);
    } else if (strcmp(name, "--gap") == 0) {
        s->gap = atof(value);
    } else if (strcmp(name, "--noise") == 0) {
        s->noise = atof(value);
    } else if (strcmp(name, "--repeat") == 0) {
        s->repeat = atoi(value);
    } else if (strcmp(name, "--check") == 0) {
        s->check = (size_t)atoi(value);
    } else if (strcmp(name, "--isa") == 0) {
        for (i = 0; i < BRDFFIT_ISA_COUNT; i++) {
            if (strcmp(value, brdffit_isa_string((brdffit_isa)i)) == 0) {
                s->isa = (brdffit_isa)i;
                return 1;
            }
        }
        return 0;
    } else {
        return set_model(&s->lobes, name, value);
    }
    return 1;
}

int main(int argc, char **argv)
{
    struct settings s = {.repeat = 5, .check = 50, .gap = 1e-3, .noise = 0.01};
    struct run run;
    int i;

    brdffit_options_init(&s.lobes);
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--csv") == 0) {
            s.csv = 1;
        } else if (strcmp(argv[i], "--float") == 0) {
            s.single = 1;
        } else if (i + 1 >= argc || !set(&s, argv[i], argv[i + 1])) {
            return usage();
        } else {
            i++;
        }
    }
    s.size = s.size ? s.size : s.lobes.lobes > 1 ? 64 : 256;
    if (!(s.size <= 4096 && s.repeat >= 1 && s.repeat <= MOST_REPEATS)) {
        return usage();
    }
    if (!measure(&s, &run)) {
        return 1;
    }
    print_run(&s, &run);
    return 0;
}
