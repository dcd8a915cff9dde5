/*
 * A map: every texel of an image stack fitted and proven, by several threads that share one plan.
 * SPDX-License-Identifier: MIT
 */
#include <brdffit.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#define LIGHTS 32
#define WIDTH 64
#define HEIGHT 48
#define TEXELS (WIDTH * HEIGHT)
#define THREADS 4

static double light[3 * LIGHTS], view[3 * LIGHTS];
static float stack[LIGHTS * TEXELS]; /* image by image */
static double sigma[TEXELS];
static unsigned char status[TEXELS];

/* A part of the map, with what its thread needs. */
struct part {
    const brdffit_plan *plan;
    size_t first, count;
    brdffit_many_stats stats;
    brdffit_error error;
    int failed;
};

static void make_geometry(brdffit_samples *geometry)
{
    for (int i = 0; i < LIGHTS; i++) {
        double theta = (5.0 + 45.0 * (i / 8) / 3.0) * 3.14159265358979323846 / 180.0;
        double phi = 2.0 * 3.14159265358979323846 * (i % 8) / 8.0;

        light[3 * i] = sin(theta) * cos(phi);
        light[3 * i + 1] = sin(theta) * sin(phi);
        light[3 * i + 2] = cos(theta);
        view[3 * i + 2] = 1.0; /* from above */
    }
    brdffit_samples_init(geometry);
    geometry->count = LIGHTS;
    geometry->channels = 1;
    geometry->light = light;
    geometry->view = view;
}

/* A camera's images of a surface that gets rougher from left to right. */
static int render(const brdffit_samples *geometry)
{
    double x = 0.3, y, roughness, values[LIGHTS];
    brdffit_model model;

    brdffit_model_init(&model);
    model.channels = 1;
    model.sigma = &roughness;
    model.x = &x;
    model.y = &y;
    for (size_t t = 0; t < TEXELS; t++) {
        roughness = 0.1 + 0.4 * (double)(t % WIDTH) / WIDTH;
        y = 0.1 * roughness;
        if (brdffit_eval(&model, geometry, values, NULL) != BRDFFIT_OK) {
            return 0;
        }
        for (size_t i = 0; i < LIGHTS; i++) {
            stack[i * TEXELS + t] = (float)values[i];
        }
    }
    return 1;
}

static void *fit_part(void *user)
{
    struct part *part = user;
    size_t size = brdffit_many_workspace_size(part->plan);
    void *workspace = malloc(size);
    brdffit_texels texels;
    brdffit_texel_results results;

    brdffit_many_stats_init(&part->stats);
    brdffit_texels_init(&texels, part->plan);
    texels.count = part->count;
    texels.values = stack + part->first;
    texels.type = BRDFFIT_TYPE_FLOAT;
    texels.texel_stride = 1;
    texels.sample_stride = TEXELS;
    brdffit_texel_results_init(&results);
    results.sigma = sigma + part->first; /* whatever is wanted: x, y, e2, lower_bound ... */
    results.status = status + part->first;
    part->failed = !workspace || brdffit_fit_many(part->plan, &texels, &results, workspace, size, &part->stats,
                                                  &part->error) != BRDFFIT_OK;
    free(workspace);
    return NULL;
}

int main(void)
{
    static struct part part[THREADS];
    pthread_t thread[THREADS];
    brdffit_samples geometry;
    const brdffit_plan *plan;
    brdffit_error error = {.message = "no memory"};
    size_t size, certified = 0;
    void *memory;
    int failed = 0;

    make_geometry(&geometry);
    size = brdffit_plan_size(&geometry, NULL);
    memory = malloc(size);
    if (!render(&geometry) || !memory ||
        brdffit_plan_init(&geometry, NULL, memory, size, &plan, &error) != BRDFFIT_OK) {
        fprintf(stderr, "map: %s\n", error.message);
        return 1;
    }
    for (size_t i = 0; i < THREADS; i++) {
        part[i].plan = plan;
        part[i].first = i * TEXELS / THREADS;
        part[i].count = TEXELS / THREADS;
        if (pthread_create(&thread[i], NULL, fit_part, &part[i]) != 0) {
            return 1;
        }
    }
    for (size_t i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        failed = failed || part[i].failed;
        certified += part[i].stats.certified;
    }
    free(memory);
    printf("%zu of %d texels certified; sigma from %.3f to %.3f\n", certified, TEXELS, sigma[0], sigma[WIDTH - 1]);
    printf("the first texel is %s\n", brdffit_texel_status_string((brdffit_texel_status)status[0]));
    return failed || certified != TEXELS;
}
