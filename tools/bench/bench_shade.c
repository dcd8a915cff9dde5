/*
 * Shading in single precision: directions a second and core for every kind of model, and how far the values are from
 * double precision. SPDX-License-Identifier: MIT
 *
 *     build/bench_shade [SECONDS]
 *
 * Packets of brdffit_shade_eval_many_f() on 65,536 pairs of directions, RGB. Half of the pairs lie near the mirror direction,
 * at every scale. Errors are relative, of pairs where the lobe is above exp(-30) of its peak; both precisions are given
 * the same directions.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "brdffit_shade.h"

#define COUNT 65536

static float direction[6][COUNT], value[3][COUNT];
static double error[COUNT];

static double uniform(void)
{
    static unsigned long long state = 1;
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 11) * 0x1p-53;
}

static void around(double v[3])
{
    const double z = 0.02 + 0.98 * uniform(), phi = 6.283185307179586 * uniform(), r = sqrt(1 - z * z);
    v[0] = r * cos(phi);
    v[1] = r * sin(phi);
    v[2] = z;
}

static void draw_pairs(void)
{
    for (int i = 0; i < COUNT; i++) {
        double l[3], v[3], length = 0;
        around(l);
        around(v);
        const double spread = pow(10, -4 * uniform());
        for (int j = 0; j < 3 && i % 2 == 0; j++) {
            v[j] = (j < 2 ? -l[j] : l[j]) + spread * (uniform() - 0.5);
        }
        v[2] = fabs(v[2]) + 1e-3;
        length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int j = 0; j < 3; j++) {
            direction[j][i] = (float)l[j];
            direction[3 + j][i] = (float)(v[j] / length);
        }
    }
}

static double now(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median and largest relative error of the green channel. */
static void judge(const struct brdffit_shade_description *d, double out[2])
{
    static struct brdffit_shade_d model;
    size_t n = 0;
    (void)brdffit_shade_make_d(&model, d);
    for (int i = 0; i < COUNT; i++) {
        double l[3], v[3], exact[3];
        for (int j = 0; j < 3; j++) {
            l[j] = (double)direction[j][i];
            v[j] = (double)direction[3 + j][i];
        }
        brdffit_shade_eval_d(&model, l, v, exact);
        if (exact[1] > 1e-13) {
            error[n++] = fabs((double)value[1][i] / exact[1] - 1);
        }
    }
    qsort(error, n, sizeof *error, ascending);
    out[0] = n > 0 ? error[n / 2] : 0;
    out[1] = n > 0 ? error[n - 1] : 0;
}

static void measure(const char *name, const struct brdffit_shade_description *d, double seconds)
{
    static struct brdffit_shade_f model;
    float *const out[3] = {value[0], value[1], value[2]};
    const struct brdffit_shade_pairs_f at = {direction[0], direction[1], direction[2],
                                             direction[3], direction[4], direction[5]};
    double best = 0, figures[2];
    if (!brdffit_shade_make_f(&model, d)) {
        return;
    }
    for (const double end = now() + seconds; now() < end;) {
        const double start = now();
        brdffit_shade_eval_many_f(&model, COUNT, &at, out);
        const double rate = COUNT / (now() - start) * 1e-6;
        best = rate > best ? rate : best;
    }
    judge(d, figures);
    printf("%-44s %8.0f %10.1e %10.1e\n", name, best, figures[0], figures[1]);
}

int main(int argc, char **argv)
{
    static const char *const names[] = {
        "beckmann", "ggx", "torrance-sparrow", "ward", "blinn-phong", "ashikhmin-shirley", "lafortune", "retro"};
    static const char *const maskings[] = {"v-cavity", "smith", "smith-separable", "none"};
    static const double sigma[] = {0.12, 0.3, 0.5}, x[] = {0.3, 0.2, 0.1},
                        y[] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
                        f0[] = {0.04, 0.04, 0.04, 0.04, 0.04, 0.04, 0.04, 0.04, 0.04},
                        more[] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    const double seconds = argc > 1 ? atof(argv[1]) : 0.3;
    struct brdffit_shade_description d = {1, 3, {0, 0, 0}, 0, BRDFFIT_SHADE_LAMBERT, 0, sigma, x, y, f0, more};
    char name[80];
    draw_pairs();
    printf("%-44s %8s %10s %10s\n", "RGB, Lambert and", "M/s", "median", "largest");
    for (int k = 0; k < BRDFFIT_SHADE_DISTRIBUTIONS; k++) {
        for (int g = 0; g < (k < 2 ? BRDFFIT_SHADE_MASKINGS : 1); g++) {
            d.distribution[0] = k;
            d.masking = g;
            (void)snprintf(name, sizeof name, "%s%s%s", names[k], k < 2 ? "/" : "", k < 2 ? maskings[g] : "");
            measure(name, &d, seconds);
        }
    }
    d.distribution[0] = d.distribution[1] = d.distribution[2] = BRDFFIT_SHADE_GGX;
    d.masking = BRDFFIT_SHADE_SMITH;
    d.schlick = 1;
    measure("ggx/smith/schlick", &d, seconds);
    d.diffuse = BRDFFIT_SHADE_BURLEY;
    measure("ggx/smith/schlick/burley", &d, seconds);
    d.diffuse = BRDFFIT_SHADE_OREN_NAYAR;
    measure("ggx/smith/schlick/oren-nayar", &d, seconds);
    d.diffuse = BRDFFIT_SHADE_LAMBERT;
    d.lobes = 2;
    measure("2ggx/smith/schlick", &d, seconds);
    d.lobes = 3;
    measure("3ggx/smith/schlick", &d, seconds);
    return 0;
}
