/*
 * Benchmark of the models that a fit may have, in one run: certified fits, RMS error beside the paper's model, boxes and
 * time beside the same model without its extension. A program, not a test.
 *
 *     bench_models [--repeat N] [--only TEXT] FILE.csv...      a Markdown table on standard output
 *
 * RMS is the geometric mean over the files of the root of E^2, relative to the first model's; time the median over files of
 * the median of N fits (default 3), whole (brdffit_fit: reduction, search, report). All use every direction above the horizon, so
 * that the models see the same samples. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "brdffit_io.h"

struct form {
    const char *name;
    int lobes;
    brdffit_distribution distribution;
    brdffit_fresnel fresnel;
    brdffit_masking masking;
    brdffit_diffuse diffuse;
    double gap;
    int base; /* row that it extends: cost is told beside that; its own: none */
    int anisotropic;
};

#define PLAIN BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT
#define SCHLICK BRDFFIT_FRESNEL_SCHLICK, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT
#define SMITH BRDFFIT_FRESNEL_SCHLICK, BRDFFIT_MASKING_SMITH, BRDFFIT_DIFFUSE_LAMBERT

static const struct form forms[] = {
    {"1 Beckmann", 1, BRDFFIT_BECKMANN, PLAIN, 1e-3, 0, 0},
    {"2 Beckmann", 2, BRDFFIT_BECKMANN, PLAIN, 1e-3, 1, 0},
    {"3 Beckmann, gap 1e-2", 3, BRDFFIT_BECKMANN, PLAIN, 1e-2, 2, 0},
    {"1 GGX", 1, BRDFFIT_GGX, PLAIN, 1e-3, 3, 0},
    {"2 GGX", 2, BRDFFIT_GGX, PLAIN, 1e-3, 4, 0},
    {"1 Beckmann, Schlick", 1, BRDFFIT_BECKMANN, SCHLICK, 1e-3, 0, 0},
    {"2 Beckmann, Schlick", 2, BRDFFIT_BECKMANN, SCHLICK, 1e-3, 1, 0},
    {"1 GGX, Schlick", 1, BRDFFIT_GGX, SCHLICK, 1e-3, 3, 0},
    {"1 GGX, Smith, Schlick", 1, BRDFFIT_GGX, SMITH, 1e-3, 3, 0},
    {"2 GGX, Smith, Schlick", 2, BRDFFIT_GGX, SMITH, 1e-3, 4, 0},
    {"1 Beckmann, Smith, Schlick", 1, BRDFFIT_BECKMANN, SMITH, 1e-3, 0, 0},
    {"1 Beckmann, Oren-Nayar", 1, BRDFFIT_BECKMANN, BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY,
     BRDFFIT_DIFFUSE_OREN_NAYAR, 1e-3, 0, 0},
    {"1 GGX, Smith, Schlick, Burley", 1, BRDFFIT_GGX, BRDFFIT_FRESNEL_SCHLICK, BRDFFIT_MASKING_SMITH,
     BRDFFIT_DIFFUSE_BURLEY, 1e-3, 3, 0},
    {"1 Beckmann, anisotropic", 1, BRDFFIT_BECKMANN, PLAIN, 1e-3, 0, 1},
    {"1 GGX, anisotropic", 1, BRDFFIT_GGX, PLAIN, 1e-3, 3, 1},
    {"1 GGX, Schlick, anisotropic", 1, BRDFFIT_GGX, SCHLICK, 1e-3, 7, 1},
    {"1 anisotropic beside 1 Beckmann, gap 1e-2", 2, BRDFFIT_BECKMANN, PLAIN, 1e-2, 1, 1},
};

#define FORMS ((int)(sizeof forms / sizeof *forms))

/* What a form did over the files. */
struct tally {
    int fits, certified, failed;
    double boxes, log_rms, *seconds;
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *first, const void *second)
{
    double x = *(const double *)first, y = *(const double *)second;

    return (x > y) - (x < y);
}

static double median(double *v, int n)
{
    if (n == 0) {
        return NAN;
    }
    qsort(v, (size_t)n, sizeof *v, ascending);
    return v[n / 2];
}

static brdffit_options options_of(const struct form *form)
{
    brdffit_options o;

    brdffit_options_init(&o);
    o.lobes = form->lobes;
    o.distribution = form->distribution;
    o.fresnel = form->fresnel;
    o.masking = form->masking;
    o.diffuse = form->diffuse;
    o.anisotropic = form->anisotropic;
    o.relative_gap = form->gap;
    o.max_incidence = 90.0;
    return o;
}

/* One form on one file, `repeat` times: the workspace is taken once. */
static void run(const struct form *form, const brdffit_samples *samples, int repeat, struct tally *t)
{
    const brdffit_options o = options_of(form);
    size_t size = brdffit_workspace_size(samples->count, samples->channels, &o);
    void *workspace = malloc(size ? size : 1);
    const brdffit_result *result = NULL;
    double *seconds = malloc((size_t)repeat * sizeof *seconds);
    brdffit_status status = workspace && seconds ? BRDFFIT_OK : BRDFFIT_ERR_MEMORY;
    int i;

    for (i = 0; i < repeat && status == BRDFFIT_OK; i++) {
        double start = now();

        status = brdffit_fit(samples, &o, workspace, size, &result, NULL);
        seconds[i] = now() - start;
    }
    if (status == BRDFFIT_OK) {
        t->seconds[t->fits++] = median(seconds, repeat);
        t->certified += result->certified;
        t->boxes += (double)result->boxes;
        t->log_rms += 0.5 * log(result->e2);
    } else {
        t->failed++;
    }
    free(seconds);
    free(workspace);
}

static void print_table(struct tally *t)
{
    double seconds[FORMS];
    int i;

    for (i = 0; i < FORMS; i++) {
        seconds[i] = median(t[i].seconds, t[i].fits);
    }
    puts("| model | certified | RMS / first | boxes a fit | ms a fit | boxes × | time × |");
    puts("|---|---|---|---|---|---|---|");
    for (i = 0; i < FORMS; i++) {
        const struct form *f = &forms[i];
        const struct tally *base = &t[f->base];

        if (t[i].fits == 0) {
            continue;
        }
        printf("| %s | %d of %d | %.3f | %.0f | %.3f |", f->name, t[i].certified, t[i].fits + t[i].failed,
               exp(t[i].log_rms / t[i].fits - t[0].log_rms / t[0].fits), t[i].boxes / t[i].fits, 1e3 * seconds[i]);
        if (f->base == i || base->fits == 0) {
            puts(" | |");
        } else {
            printf(" %.2f | %.2f |\n", t[i].boxes / t[i].fits / (base->boxes / base->fits),
                   seconds[i] / seconds[f->base]);
        }
    }
}

static int run_file(const char *path, int repeat, const char *only, struct tally *t)
{
    brdffit_io_options options;
    brdffit_table *table;
    brdffit_error error;
    int i;

    brdffit_io_options_init(&options);
    if (brdffit_io_read(path, &options, &table, &error) != BRDFFIT_OK) {
        fprintf(stderr, "bench_models: %s: %s\n", path, error.message);
        return 1;
    }
    for (i = 0; i < FORMS; i++) {
        if (i == 0 || !only || strstr(forms[i].name, only)) {
            run(&forms[i], table->samples, repeat, &t[i]);
        }
    }
    brdffit_io_free(table);
    return 0;
}

int main(int argc, char **argv)
{
    struct tally tally[FORMS] = {{0, 0, 0, 0.0, 0.0, NULL}};
    const char *only = NULL;
    int repeat = 3, first = 1, failed = 0, i;

    while (first + 1 < argc && strncmp(argv[first], "--", 2) == 0) {
        if (strcmp(argv[first], "--repeat") == 0) {
            repeat = atoi(argv[first + 1]);
        } else if (strcmp(argv[first], "--only") == 0) {
            only = argv[first + 1];
        } else {
            break;
        }
        first += 2;
    }
    if (first >= argc || repeat < 1) {
        fputs("usage: bench_models [--repeat N] [--only TEXT] FILE.csv...\n", stderr);
        return 2;
    }
    for (i = 0; i < FORMS; i++) {
        tally[i].seconds = malloc((size_t)argc * sizeof(double));
    }
    for (i = first; i < argc; i++) {
        failed |= run_file(argv[i], repeat, only, tally);
    }
    print_table(tally);
    for (i = 0; i < FORMS; i++) {
        free(tally[i].seconds);
    }
    return failed;
}
