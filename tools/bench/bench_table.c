/*
 * Benchmark of whole tables and of the number of samples: see README.md. A program, not a test: times are printed,
 * never judged. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "brdffit_io.h"

#define MOST_REPEATS 1001
#define CHUNK ((size_t)4096)

struct settings {
    int repeat;
    size_t scaling; /* largest N of the second table; 0: none */
    FILE *csv;
    char program[PATH_MAX]; /* brdffit beside this program */
};

/* ---- Clock and lines ------------------------------------------------------- */

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *first, const void *second)
{
    double x = *(const double *)first, y = *(const double *)second;

    return (x > y) - (x < y);
}

static double median(double *value, int count)
{
    qsort(value, (size_t)count, sizeof *value, compare);
    return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

/* One line of the CSV: quantity is in seconds but for "ratio" and "bytes". */
static void record(const struct settings *s, const char *what, const char *file, int lobes, size_t n, double value)
{
    if (s->csv) {
        fprintf(s->csv, "%s,\"%s\",%d,%zu,%.9g\n", what, file, lobes, n, value);
    }
}

static void stop(const char *what, const char *why)
{
    fprintf(stderr, "bench_table: %s: %s\n", what, why);
    exit(1);
}

static void *memory(size_t size)
{
    void *block = malloc(size > 0 ? size : 1);

    if (!block) {
        stop("memory", "there is not enough");
    }
    return block;
}

/* ---- Whole tables ---------------------------------------------------------- */

/* Seconds that a program takes from its start to its end, its output thrown away; *bytes: its peak memory. */
static double run(char *const *argv, double *bytes)
{
    double start = now();
    struct rusage usage;
    int status;
    pid_t child = fork();

    if (child == 0) {
        int null = open("/dev/null", O_WRONLY);

        if (null < 0 || dup2(null, STDOUT_FILENO) < 0) {
            _exit(127);
        }
        execvp(argv[0], argv);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        stop(argv[0], "did not run, or did not succeed");
    }
    if (bytes && getrusage(RUSAGE_CHILDREN, &usage) == 0) {
        *bytes = 1024.0 * (double)usage.ru_maxrss;
    }
    return now() - start;
}

static int at_reduced(void *user, const brdffit_progress *progress)
{
    if (progress->phase == BRDFFIT_PHASE_REDUCED) {
        *(double *)user = now();
    }
    return 0;
}

struct parts {
    double read, reduce, search;
};

/* The same fit inside this process: one sweep, sums to moments, search. */
static struct parts parts_of(const char *file, int lobes)
{
    double start = now(), read, reduced = 0.0, end;
    brdffit_options options;
    brdffit_table *table = NULL;
    const brdffit_result *result;
    brdffit_error error = {0};
    struct parts parts;
    void *workspace;
    size_t size;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.progress = at_reduced;
    options.progress_user = &reduced;
    if (brdffit_io_read_sums(file, NULL, &options, &table, &error) != BRDFFIT_OK || !table->sums) {
        stop(file, error.message ? error.message : "is not a MERL table");
    }
    read = now();
    size = brdffit_sums_workspace_size(table->sums, &options);
    workspace = memory(size);
    if (brdffit_fit_sums(table->sums, &options, workspace, size, &result, &error) != BRDFFIT_OK) {
        stop(file, error.message);
    }
    end = now();
    free(workspace);
    brdffit_io_free(table);
    parts.read = read - start;
    parts.reduce = reduced - read;
    parts.search = end - reduced;
    return parts;
}

static void bench_file(const struct settings *s, const char *file)
{
    static double cat[MOST_REPEATS], whole[2][MOST_REPEATS], part[2][3][MOST_REPEATS];
    char lobes_text[2][2] = {"1", "2"};
    double bytes = 0.0, cat_median;
    int i, lobes;

    for (i = 0; i < s->repeat; i++) { /* alternating, so that all see the same machine */
        char *cat_argv[] = {"cat", (char *)(uintptr_t)file, NULL};

        cat[i] = run(cat_argv, NULL);
        for (lobes = 0; lobes < 2; lobes++) {
            char *argv[] = {(char *)(uintptr_t)s->program, "fit", "--lobes", lobes_text[lobes],
                            (char *)(uintptr_t)file,       NULL};
            struct parts parts;

            whole[lobes][i] = run(argv, &bytes);
            parts = parts_of(file, lobes + 1);
            part[lobes][0][i] = parts.read;
            part[lobes][1][i] = parts.reduce;
            part[lobes][2][i] = parts.search;
        }
    }
    cat_median = median(cat, s->repeat);
    record(s, "cat", file, 0, 0, cat_median);
    record(s, "bytes", file, 0, 0, bytes);
    for (lobes = 0; lobes < 2; lobes++) {
        double all = median(whole[lobes], s->repeat), m[3];

        for (i = 0; i < 3; i++) {
            m[i] = median(part[lobes][i], s->repeat);
        }
        printf("%-36s %d lobe%s  cat %6.2f ms  fit %6.2f ms  ratio %5.2f  (read %.2f, reduce %.3f, search %.2f ms; "
               "%.0f MB)\n",
               strrchr(file, '/') ? strrchr(file, '/') + 1 : file, lobes + 1, lobes ? "s" : " ", 1e3 * cat_median,
               1e3 * all, all / cat_median, 1e3 * m[0], 1e3 * m[1], 1e3 * m[2], bytes / 1e6);
        record(s, "fit", file, lobes + 1, 0, all);
        record(s, "ratio", file, lobes + 1, 0, all / cat_median);
        record(s, "read", file, lobes + 1, 0, m[0]);
        record(s, "reduce", file, lobes + 1, 0, m[1]);
        record(s, "search", file, lobes + 1, 0, m[2]);
    }
}

/* ---- Cost against the number of samples ------------------------------------ */

struct chunk {
    brdffit_samples samples;
    double a[CHUNK], b[CHUNK], c[CHUNK], values[3 * CHUNK];
    uint64_t state;
};

static double uniform(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Two lobes and 2 % noise; 90 distinct c, or as many as samples. */
static void fill(struct chunk *k, size_t count, int scattered)
{
    size_t i, j;

    brdffit_samples_init(&k->samples);
    k->samples.count = count;
    k->samples.channels = 3;
    k->samples.form = BRDFFIT_FORM_COEFFICIENTS;
    k->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    k->samples.a = k->a;
    k->samples.b = k->b;
    k->samples.c = k->c;
    k->samples.values = k->values;
    for (i = 0; i < count; i++) {
        double part = uniform(&k->state), c, lobe;

        part = scattered ? part : floor(90.0 * part) / 90.0;
        c = tan(1.5 * part * part) * tan(1.5 * part * part);
        k->a[i] = 0.1 + 0.2 * uniform(&k->state);
        k->b[i] = 0.2 + uniform(&k->state);
        k->c[i] = c;
        lobe = k->b[i] * (exp(-c / 0.01) / 0.01 + 2.0 * exp(-c / 0.16) / 0.16);
        for (j = 0; j < 3; j++) {
            k->values[3 * i + j] = (k->a[i] + 0.1 * (double)(j + 1) * lobe) * (0.98 + 0.04 * uniform(&k->state));
        }
    }
}

/* scattered 0: 90 distinct c; 1: as many as samples, a group each; 2: the same in bins. */
static void scale_sums(const struct settings *s, size_t n, int scattered)
{
    static struct chunk chunk;
    static double fits[MOST_REPEATS];
    static const char *const shown[] = {"90 distinct c", "every c distinct", "every c distinct, bins"};
    static const char *const add[] = {"add", "add_scattered", "add_bins"}, *const fit[] = {"fit", "fit_scattered",
                                                                                           "fit_bins"};
    size_t groups = scattered == 2 ? 16384 : scattered ? 4096 : 90, size = brdffit_sums_size(3, groups), at, room;
    brdffit_sums *sums = NULL;
    brdffit_options options;
    brdffit_error error = {0};
    const brdffit_result *result = NULL;
    void *block = memory(size), *workspace;
    double adding = 0.0;
    int i;

    brdffit_options_init(&options);
    options.lobes = 2;
    if (brdffit_sums_init(block, size, 3, groups, &options, &sums, &error) != BRDFFIT_OK) {
        stop("sums", error.message);
    }
    if (scattered == 2 && brdffit_sums_bins(sums, 8, &error) != BRDFFIT_OK) {
        stop("bins", error.message);
    }
    chunk.state = n;
    for (at = 0; at < n; at += CHUNK) {
        double start;

        fill(&chunk, n - at < CHUNK ? n - at : CHUNK, scattered);
        start = now();
        if (brdffit_sums_add(sums, &chunk.samples, &error) != BRDFFIT_OK) {
            printf("%10zu samples, %s: %s\n", n, shown[scattered], error.message);
            free(block);
            return;
        }
        adding += now() - start;
    }
    room = brdffit_sums_workspace_size(sums, &options);
    workspace = memory(room);
    for (i = 0; i < s->repeat; i++) {
        double start = now();

        if (brdffit_fit_sums(sums, &options, workspace, room, &result, &error) != BRDFFIT_OK) {
            stop("fit", error.message);
        }
        fits[i] = now() - start;
    }
    printf("%10zu samples, %s: added in %.3g s (%.0f ns each), fitted in %.3f ms; %.1f MB of sums\n", n,
           shown[scattered], adding, 1e9 * adding / (double)n, 1e3 * median(fits, s->repeat), (double)size / 1e6);
    if (scattered == 2) {
        printf("%28s%zu bins; E^2 to %.1e of itself, gap %.1e, %s\n", "", result->distinct_c,
               result->e2_error / result->e2, result->gap / result->e2, brdffit_stop_string(result->stop));
    }
    record(s, add[scattered], "", 2, n, adding);
    record(s, fit[scattered], "", 2, n, median(fits, s->repeat));
    free(workspace);
    free(block);
}

/* ---- Command line ----------------------------------------------------------- */

static int usage(void)
{
    fputs("usage: bench_table [--repeat R] [--scaling MOST] [--csv FILE] [TABLE.binary ...]\n", stderr);
    return 2;
}

static void find_program(struct settings *s, const char *self)
{
    const char *slash = strrchr(self, '/');
    int length = slash ? (int)(slash - self) : 1;

    (void)snprintf(s->program, sizeof s->program, "%.*s/brdffit", length, slash ? self : ".");
}

int main(int argc, char **argv)
{
    struct settings s = {15, 0, NULL, ""};
    size_t n;
    int i;

    find_program(&s, argv[0]);
    for (i = 1; i < argc && argv[i][0] == '-'; i++) {
        if (i + 1 == argc) {
            return usage();
        } else if (strcmp(argv[i], "--repeat") == 0) {
            s.repeat = atoi(argv[++i]);
        } else if (strcmp(argv[i], "--scaling") == 0) {
            s.scaling = (size_t)strtod(argv[++i], NULL);
        } else if (strcmp(argv[i], "--csv") == 0) {
            s.csv = fopen(argv[++i], "w");
            if (!s.csv) {
                stop(argv[i], "cannot be written");
            }
            fputs("what,file,lobes,n,value\n", s.csv);
        } else {
            return usage();
        }
    }
    if (s.repeat < 1 || s.repeat > MOST_REPEATS || (i == argc && s.scaling == 0)) {
        return usage();
    }
    for (; i < argc; i++) {
        bench_file(&s, argv[i]);
    }
    for (n = 100; n <= s.scaling; n *= 10) {
        scale_sums(&s, n, 0);
        scale_sums(&s, n, 1);
        scale_sums(&s, n, 2);
    }
    return s.csv && fclose(s.csv) != 0;
}
