/*
 * What one fit costs, for N samples of K channels: one CSV row, and the peak memory of this whole process.
 *
 *     scaling [--samples N] [--channels K] [--lobes P] [--gap G] [--repeat R]
 *
 * The samples are two Beckmann lobes under random directions with 1 % noise, as coefficients, every c distinct: the
 * worst case of the reduction. One setting a process, so that the peak is that setting's.
 *
 *     scaling --peak PROGRAM [ARGUMENT...]
 *
 * Runs a program without its output and prints its peak memory in KiB. A process inherits the peak of the one that
 * started it (Linux keeps it over exec), so that only a small parent like this one can tell. SPDX-License-Identifier: MIT
 */
#define _DEFAULT_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "../goniometer/random.h"
#include "brdffit.h"

#define MOST_REPEATS 101

struct settings {
    size_t samples, channels;
    int lobes, repeat;
    double gap;
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int at_reduced(void *user, const brdffit_progress *progress)
{
    if (progress->phase == BRDFFIT_PHASE_REDUCED) {
        *(double *)user = now();
    }
    return 0;
}

static long peak_kilobytes(void)
{
    struct rusage usage;

    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : -1;
}

static int compare(const void *first, const void *second)
{
    double x = *(const double *)first, y = *(const double *)second;

    return (x > y) - (x < y);
}

/* Half angles as a half sphere of them has, to 60 degrees; b and a of the right size. */
static void fill(const struct settings *s, double *a, double *b, double *c, double *value)
{
    struct gonio_random random = brdffit_gonio_random(1, 0);
    size_t i, k;

    for (i = 0; i < s->samples; i++) {
        double cosine = 0.5 + 0.5 * brdffit_gonio_uniform(&random), nl = 0.5 + 0.5 * brdffit_gonio_uniform(&random);

        c[i] = (1.0 - cosine * cosine) / (cosine * cosine);
        a[i] = nl / 3.14159265358979323846;
        b[i] = 0.32 * (1.0 + c[i]) * (1.0 + c[i]);
        for (k = 0; k < s->channels; k++) {
            double tint = 0.3 + 0.7 * (double)k / (double)s->channels;
            double exact = tint * a[i] + b[i] * (2.0 * exp(-c[i] / 0.01) + (1.0 - 0.5 * tint) * exp(-c[i] / 0.16));

            value[i * s->channels + k] = exact * (1.0 + 0.01 * brdffit_gonio_normal(&random));
        }
    }
}

static int run(const struct settings *s)
{
    static double whole[MOST_REPEATS], search[MOST_REPEATS];
    double *a = malloc(s->samples * (3 + s->channels) * sizeof *a), reduced = 0.0;
    brdffit_samples samples;
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;
    void *workspace;
    size_t size;
    long data;
    int i;

    brdffit_options_init(&options);
    options.lobes = s->lobes;
    options.relative_gap = s->gap;
    options.progress = at_reduced;
    options.progress_user = &reduced;
    size = brdffit_workspace_size(s->samples, s->channels, &options);
    workspace = malloc(size);
    if (!a || !workspace) {
        fprintf(stderr, "scaling: out of memory\n");
        return 0;
    }
    brdffit_samples_init(&samples);
    samples.form = BRDFFIT_FORM_COEFFICIENTS;
    samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples.count = s->samples;
    samples.channels = s->channels;
    samples.a = a;
    samples.b = a + s->samples;
    samples.c = a + 2 * s->samples;
    samples.values = a + 3 * s->samples;
    fill(s, a, a + s->samples, a + 2 * s->samples, a + 3 * s->samples);
    data = peak_kilobytes();
    for (i = 0; i < s->repeat; i++) {
        double begun = now();

        if (brdffit_fit(&samples, &options, workspace, size, &result, &error) != BRDFFIT_OK) {
            fprintf(stderr, "scaling: %s\n", error.message);
            return 0;
        }
        whole[i] = now() - begun;
        search[i] = now() - reduced;
    }
    qsort(whole, (size_t)s->repeat, sizeof *whole, compare);
    qsort(search, (size_t)s->repeat, sizeof *search, compare);
    printf("samples,channels,lobes,gap,seconds,search,boxes,nodes,certified,distinct_c,data_kib,peak_kib\n"
           "%zu,%zu,%d,%g,%.9g,%.9g,%zu,%zu,%d,%zu,%ld,%ld\n",
           s->samples, s->channels, s->lobes, s->gap, whole[s->repeat / 2], search[s->repeat / 2], result->boxes,
           result->nodes, result->certified, result->distinct_c, data, peak_kilobytes());
    free(workspace);
    free(a);
    return 1;
}

static int read_value(struct settings *s, const char *name, const char *value)
{
    char end;

    if (strcmp(name, "--samples") == 0) {
        return sscanf(value, "%zu%c", &s->samples, &end) == 1 && s->samples >= 1 && value[0] != '-';
    }
    if (strcmp(name, "--channels") == 0) {
        return sscanf(value, "%zu%c", &s->channels, &end) == 1 && s->channels >= 1 && value[0] != '-';
    }
    if (strcmp(name, "--lobes") == 0) {
        return sscanf(value, "%d%c", &s->lobes, &end) == 1;
    }
    if (strcmp(name, "--gap") == 0) {
        return sscanf(value, "%lf%c", &s->gap, &end) == 1;
    }
    return strcmp(name, "--repeat") == 0 && sscanf(value, "%d%c", &s->repeat, &end) == 1 && s->repeat >= 1 &&
           s->repeat <= MOST_REPEATS;
}

/* 0 when the program was run and ended well. */
static int print_peak(char **command)
{
    struct rusage usage;
    pid_t child = fork();
    int status = -1;

    if (child == 0) {
        if (freopen("/dev/null", "w", stdout) && freopen("/dev/null", "w", stderr)) {
            execv(command[0], command);
        }
        _exit(127);
    }
    if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) {
        fprintf(stderr, "scaling: %s failed\n", command[0]);
        return 1;
    }
    printf("%ld\n", usage.ru_maxrss);
    return 0;
}

/* In a child, whose peak begins with the little that this process has. */
static int run_apart(const struct settings *s)
{
    pid_t child = fork();
    int status = 1;

    if (child == 0) {
        int good = run(s);

        fflush(stdout);
        _exit(good ? 0 : 1);
    }
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

int main(int argc, char **argv)
{
    struct settings s = {84, 3, 1, 5, 1e-3};
    int i = 1;

    if (argc > 2 && strcmp(argv[1], "--peak") == 0) {
        return print_peak(argv + 2);
    }
    while (i + 1 < argc && read_value(&s, argv[i], argv[i + 1])) {
        i += 2;
    }
    if (i != argc) {
        fprintf(stderr, "usage: scaling [--samples N] [--channels K] [--lobes P] [--gap G] [--repeat R]\n"
                        "       scaling --peak PROGRAM [ARGUMENT...]\n");
        return 2;
    }
    return run_apart(&s) ? 0 : 1;
}
