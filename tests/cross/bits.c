/*
 * The bits of many fits, a line each: to be the same on every processor, with every compiler. SPDX-License-Identifier: MIT
 *
 *     bits COUNT < problems
 *
 * COUNT random problems of every distribution, masking, Fresnel and diffuse term, one to three lobes, in plenty of memory and
 * in little; then those of standard input, as problems.py writes them (hexadecimal, so that reading rounds nothing), each
 * with one lobe and with two. Needs the core and the C library alone. What it draws comes from integers, additions,
 * multiplications, divisions and brdffit_eval(), and from no libm.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "brdffit.h"

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif

#define MOST 96
#define CHANNELS 3

static uint64_t state = 1;

/* splitmix64. */
static uint64_t draw(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;

    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static double uniform(double low, double high)
{
    return low + (high - low) * ((double)(draw() >> 11) / 9007199254740992.0);
}

static unsigned below(unsigned n)
{
    return (unsigned)(draw() % n);
}

static uint64_t hash; /* FNV-1a over the bits of every number of a result */

static void add(double v)
{
    union {
        double number;
        uint64_t bits;
    } u = {v};
    int i;

    for (i = 0; i < 8; i++) {
        hash = (hash ^ (u.bits >> 8 * i & 255u)) * 0x100000001b3u;
    }
}

static void add_all(const double *v, size_t n)
{
    size_t i;

    for (i = 0; i < n; i++) {
        add(v[i]);
    }
}

static void report(const brdffit_result *r)
{
    const brdffit_model *m = r->model;
    size_t lobes = (size_t)m->lobes;

    hash = 0xcbf29ce484222325u;
    add_all(m->sigma, lobes);
    add_all(m->x, m->channels);
    add_all(m->y, m->channels * lobes);
    if (m->f0) {
        add_all(m->f0, m->channels * lobes);
    }
    add_all(r->rms, m->channels);
    add(r->e2);
    add(r->e2_error);
    add(r->lower_bound);
    add(r->kkt_residual);
    printf("%zu boxes, %s, sigma %a, E2 %a, bound %a, all %016llx\n", r->boxes, brdffit_stop_string(r->stop),
           m->sigma[0], r->e2, r->lower_bound, (unsigned long long)hash);
}

static void fit(const brdffit_samples *samples, const brdffit_options *options)
{
    size_t size = brdffit_workspace_size(samples->count, samples->channels, options);
    void *workspace = malloc(size ? size : 1);
    const brdffit_result *result;
    brdffit_error error;

    if (!workspace) {
        printf("no memory\n");
    } else if (brdffit_fit(samples, options, workspace, size, &result, &error) == BRDFFIT_OK) {
        report(result);
    } else {
        printf("%s\n", error.message);
    }
    free(workspace);
}

/* A direction: half tangents of its angle with the normal, up to `most`, and of its azimuth are drawn. */
static void direction(double most, double out[3])
{
    double t = uniform(0.0, most);
    double a = uniform(-4.0, 4.0); /* a statement each: the order of arguments is the compiler's */
    double sine = 2.0 * t / (1.0 + t * t);

    out[0] = sine * ((1.0 - a * a) / (1.0 + a * a));
    out[1] = sine * (2.0 * a / (1.0 + a * a));
    out[2] = (1.0 - t * t) / (1.0 + t * t);
}

static void choose(brdffit_options *o)
{
    brdffit_options_init(o);
    o->lobes = 1 + (int)(below(8) + 1) / 5; /* one or two */
    o->distribution = (brdffit_distribution)below(BRDFFIT_DISTRIBUTION_COUNT);
    if (o->distribution == BRDFFIT_BECKMANN || o->distribution == BRDFFIT_GGX) {
        o->masking = (brdffit_masking)below(BRDFFIT_MASKING_COUNT);
    }
    o->fresnel = below(4) ? BRDFFIT_FRESNEL_NONE : BRDFFIT_FRESNEL_SCHLICK;
    o->diffuse = below(3) ? BRDFFIT_DIFFUSE_LAMBERT : (brdffit_diffuse)below(BRDFFIT_DIFFUSE_COUNT);
    o->physical = o->distribution != BRDFFIT_TORRANCE_SPARROW && below(6) == 0;
    o->max_incidence = below(2) ? 60.0 : 90.0;
    o->box_budget = 600;
    o->memory = below(2) ? 0 : 30000 + below(300000);
    if (below(12) == 0) {
        o->lobes = 3;
        o->fresnel = BRDFFIT_FRESNEL_NONE;
        o->diffuse = BRDFFIT_DIFFUSE_LAMBERT;
    }
}

static void fit_random(void)
{
    static double light[3 * MOST], view[3 * MOST], value[CHANNELS * MOST];
    double sigma[2], x[CHANNELS], y[2 * CHANNELS], noise = uniform(0.0, 0.05);
    brdffit_options options;
    brdffit_samples samples;
    brdffit_model model;
    size_t i, count = 4 + below(MOST - 4);

    sigma[0] = uniform(0.02, 0.5);
    sigma[1] = uniform(0.1, 0.9);
    for (i = 0; i < CHANNELS; i++) {
        x[i] = uniform(0.0, 0.5);
        y[2 * i] = uniform(0.0, 0.1);
        y[2 * i + 1] = uniform(0.0, 0.1);
    }
    for (i = 0; i < count; i++) {
        direction(0.8, light + 3 * i);
        direction(0.9, view + 3 * i);
    }
    brdffit_samples_init(&samples);
    samples.count = count;
    samples.channels = CHANNELS;
    samples.light = light;
    samples.view = view;
    samples.values = value;
    choose(&options);
    brdffit_model_init(&model);
    model.distribution = options.distribution;
    model.lobes = 2;
    model.channels = CHANNELS;
    model.sigma = sigma;
    model.x = x;
    model.y = y;
    if (brdffit_eval(&model, &samples, value, NULL) != BRDFFIT_OK) {
        printf("no values\n");
        return;
    }
    for (i = 0; i < CHANNELS * count; i++) {
        value[i] *= 1.0 + noise * uniform(-1.0, 1.0);
    }
    fit(&samples, &options);
}

static double *numbers(size_t n)
{
    double *v = malloc((n ? n : 1) * sizeof *v);
    size_t i;

    for (i = 0; i < n && v; i++) {
        if (scanf("%la", v + i) != 1) {
            free(v);
            return NULL;
        }
    }
    return v;
}

/* A line "COUNT CHANNELS", then light, view and values. 0 at the end. */
static int fit_next(void)
{
    brdffit_options options;
    brdffit_samples samples;
    double *light, *view, *values;

    brdffit_samples_init(&samples);
    if (scanf("%zu %zu", &samples.count, &samples.channels) != 2) {
        return 0;
    }
    samples.light = light = numbers(3 * samples.count);
    samples.view = view = numbers(3 * samples.count);
    samples.values = values = numbers(samples.channels * samples.count);
    brdffit_options_init(&options);
    for (options.lobes = 1; options.lobes <= 2; options.lobes++) {
        fit(&samples, &options);
    }
    free(light);
    free(view);
    free(values);
    return 1;
}

int main(int argc, char **argv)
{
    int count = argc > 1 ? atoi(argv[1]) : 100;

    while (count-- > 0) {
        fit_random();
    }
    while (fit_next()) {
    }
    return 0;
}
