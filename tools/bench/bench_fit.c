/*
 * Benchmark of brdffit_fit() beside a brute force over the roughness: see README.md. A program, not a test:
 * times are printed, never judged; only a result above its peer's by more than its own gap is an error.
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "brdffit_io.h"
#include "lobes.h"

#define MOST_REPEATS 1001
/* E^2 this close are the same minimum: where E^2 is flat to 1e-12, a fit reports the largest sigma. */
#define SAME 1e-11

struct settings {
    /* lobes[i]: fit with i + 1 lobes; step: log2 of the brute force's, 0: none */
    int repeat, lobes[BRDFFIT_MAX_LOBES], step[BRDFFIT_MAX_LOBES];
    const brdffit_distribution *distributions; /* of each lobe; NULL: `distribution` */
    brdffit_distribution list[BRDFFIT_MAX_LOBES];
    int markdown, quiet;
    double gap;
    const char *brute;
    char beside[PATH_MAX]; /* tests/ref/brute beside this program */
    brdffit_distribution distribution;
    char **file;
    int files;
};

struct run {
    double reduce, search; /* seconds, medians */
    double e2, lower_bound, sigma[BRDFFIT_MAX_LOBES];
    size_t boxes, nodes, samples;
    int certified;
    double brute_e2, brute_seconds; /* brute_e2 < 0: not run */
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int at_reduced(void *user, const brdffit_progress *progress)
{
    if (progress->phase == BRDFFIT_PHASE_REDUCED) {
        *(double *)user = now();
    }
    return 0;
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

static int fail(const char *file, const brdffit_error *error)
{
    fprintf(stderr, "bench_fit: %s: %s\n", file, error->message);
    return 0;
}

/* Fit one table `repeat` times in one workspace. */
static int time_fit(const struct settings *s, const char *file, const brdffit_samples *samples, int lobes,
                    struct run *run)
{
    static double reduce[MOST_REPEATS], search[MOST_REPEATS];
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;
    double reduced = 0.0;
    size_t size;
    void *workspace;
    int i, good = 1;

    brdffit_options_init(&options);
    options.lobes = lobes;
    options.distribution = s->distribution;
    options.distributions = s->distributions;
    options.relative_gap = s->gap;
    options.progress = at_reduced;
    options.progress_user = &reduced;
    size = brdffit_workspace_size(samples->count, samples->channels, &options);
    workspace = malloc(size);
    if (!workspace) {
        fprintf(stderr, "bench_fit: out of memory\n");
        return 0;
    }
    for (i = 0; i < s->repeat && good; i++) {
        double start = now();

        good = brdffit_fit(samples, &options, workspace, size, &result, &error) == BRDFFIT_OK || fail(file, &error);
        search[i] = now() - reduced;
        reduce[i] = reduced - start;
    }
    if (good) {
        run->reduce = median(reduce, s->repeat);
        run->search = median(search, s->repeat);
        run->e2 = result->e2;
        run->lower_bound = result->lower_bound;
        memcpy(run->sigma, result->model->sigma, (size_t)lobes * sizeof *run->sigma);
        run->boxes = result->boxes;
        run->nodes = result->nodes;
        run->samples = result->samples_used;
        run->certified = result->certified;
    }
    free(workspace);
    return good;
}

/* ---- The peer ------------------------------------------------------------------------------------------- */

/* Start the brute force on every file; its JSON lines come out of the stream. */
static FILE *start_brute(const struct settings *s, int lobes, pid_t *child)
{
    char step[16], number[16];
    char **arguments = calloc((size_t)s->files + 9, sizeof *arguments);
    int ends[2], n = 0;

    if (!arguments || pipe(ends) != 0) {
        free(arguments);
        return NULL;
    }
    snprintf(step, sizeof step, "%d", s->step[lobes - 1]);
    snprintf(number, sizeof number, "%d", lobes);
    arguments[n++] = (char *)s->brute;
    arguments[n++] = (char *)"--json";
    arguments[n++] = (char *)"--lobes";
    arguments[n++] = number;
    arguments[n++] = (char *)"--step-log2";
    arguments[n++] = step;
    arguments[n++] = (char *)"--distribution";
    arguments[n++] = (char *)brdffit_distribution_string(s->distribution);
    memcpy(arguments + n, s->file, (size_t)s->files * sizeof *arguments);
    *child = fork();
    if (*child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        execv(s->brute, arguments);
        _exit(127);
    }
    close(ends[1]);
    free(arguments);
    return *child > 0 ? fdopen(ends[0], "r") : NULL;
}

/* Number that follows "name": in a line of JSON; NaN without. */
static double number_of(const char *line, const char *name)
{
    const char *at = strstr(line, name);

    return at ? strtod(at + strlen(name), NULL) : NAN;
}

static int run_brute(const struct settings *s, int lobes, struct run *run)
{
    pid_t child = 0;
    FILE *lines = start_brute(s, lobes, &child);
    char *line = NULL;
    size_t size = 0;
    int i, status = 0;

    if (!lines) {
        fprintf(stderr, "bench_fit: cannot run %s\n", s->brute);
        return 0;
    }
    for (i = 0; i < s->files && getline(&line, &size, lines) > 0; i++) {
        run[i].brute_e2 = number_of(line, "\"e2\":");
        run[i].brute_seconds = number_of(line, "\"seconds\":");
    }
    free(line);
    fclose(lines);
    if (waitpid(child, &status, 0) != child || status != 0 || i < s->files) {
        fprintf(stderr, "bench_fit: %s failed\n", s->brute);
        return 0;
    }
    return 1;
}

/* ---- Tables --------------------------------------------------------------------------------------------- */

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? slash + 1 : path;
}

static void print_files(const struct settings *s, int lobes, const struct run *run)
{
    const char *format = s->markdown ? "| %s | %d | %.4f | %.4f | %zu | %zu | %.2e | %.10g | %s |\n"
                                     : "%-32s %d %9.4f %9.4f %8zu %6zu %9.2e %16.10g  %s\n";
    int i;

    if (s->markdown) {
        printf("| file | lobes | search ms | reduce ms | boxes | nodes | gap / E² | E² | E² / brute - 1 |\n");
        printf("|---|---|---|---|---|---|---|---|---|\n");
    } else {
        printf("%-32s %s %9s %9s %8s %6s %9s %16s  %s\n", "file", "P", "search ms", "reduce ms", "boxes", "nodes",
               "gap/E2", "E2", "E2/brute-1");
    }
    for (i = 0; i < s->files; i++) {
        char ratio[32] = "-";

        if (run[i].brute_e2 >= 0.0) {
            snprintf(ratio, sizeof ratio, "%+.3e", run[i].e2 / run[i].brute_e2 - 1.0);
        }
        printf(format, base_name(s->file[i]), lobes, 1e3 * run[i].search, 1e3 * run[i].reduce, run[i].boxes,
               run[i].nodes, run[i].e2 > 0.0 ? 1.0 - run[i].lower_bound / run[i].e2 : 0.0, run[i].e2, ratio);
    }
    printf("\n");
}

struct totals {
    double search, reduce, brute, worst;
    size_t boxes, nodes;
    int certified, lower, equal, within, above;
};

static struct totals add_up(const struct settings *s, const struct run *run)
{
    struct totals t = {0.0, 0.0, 0.0, -INFINITY, 0, 0, 0, 0, 0, 0, 0};
    int i;

    for (i = 0; i < s->files; i++) {
        double ratio = run[i].e2 / run[i].brute_e2 - 1.0;

        t.search += run[i].search;
        t.reduce += run[i].reduce;
        t.boxes += run[i].boxes;
        t.nodes += run[i].nodes;
        t.certified += run[i].certified;
        if (!(run[i].brute_e2 >= 0.0)) {
            continue;
        }
        t.brute += run[i].brute_seconds;
        t.worst = fmax(t.worst, ratio);
        t.lower += ratio < -SAME;
        t.equal += fabs(ratio) <= SAME;
        t.within += ratio > SAME && ratio <= s->gap;
        t.above += !(ratio <= s->gap);
    }
    return t;
}

static void print_totals(const struct settings *s, int lobes, const struct totals *t)
{
    const char *bullet = s->markdown ? "- " : "  ";

    printf(s->markdown ? "**" : "");
    printf("%d lobe%s, %d files, %d certified at %g", lobes, lobes == 1 ? "" : "s", s->files, t->certified, s->gap);
    printf(s->markdown ? "**\n\n" : "\n");
    printf("%ssearch, all files: %.3f ms (median of %d runs each); reduction %.3f ms; %zu boxes, %zu nodes\n", bullet,
           1e3 * t->search, s->repeat, 1e3 * t->reduce, t->boxes, t->nodes);
    if (s->step[lobes - 1]) {
        printf("%sbrute force, step 2^-%d: %.3f s, %.0f times the search\n", bullet, s->step[lobes - 1], t->brute,
               t->brute / t->search);
        printf("%sE2 against brute force: lower %d, equal %d, higher within the gap %d, above (1 + gap) %d; worst "
               "ratio - 1: %+.3e\n",
               bullet, t->lower, t->equal, t->within, t->above, t->worst);
    }
    printf("\n");
}

/* ---- Everything ----------------------------------------------------------------------------------------- */

/* 1 when every file was fitted, certified and not above its peer. */
static int bench(const struct settings *s, int lobes)
{
    struct run *run = calloc((size_t)s->files, sizeof *run);
    struct totals totals;
    int i, good = run != NULL;

    for (i = 0; i < s->files && good; i++) {
        brdffit_table *table = NULL;
        brdffit_error error;

        run[i].brute_e2 = -1.0;
        good = brdffit_io_read(s->file[i], NULL, &table, &error) == BRDFFIT_OK || fail(s->file[i], &error);
        good = good && time_fit(s, s->file[i], table->samples, lobes, &run[i]);
        brdffit_io_free(table);
    }
    if (good && s->step[lobes - 1]) {
        good = run_brute(s, lobes, run);
    }
    if (good) {
        if (!s->quiet) {
            print_files(s, lobes, run);
        }
        totals = add_up(s, run);
        print_totals(s, lobes, &totals);
        good = totals.above == 0 && totals.certified == s->files;
    }
    free(run);
    return good;
}

/* both: one and two. */
static int read_lobes(struct settings *s, const char *value)
{
    brdffit_options options = {0};
    int i;

    if (strcmp(value, "both") == 0) {
        return 1;
    }
    if (!bench_lobes(value, &options, s->list)) {
        return 0;
    }
    s->distributions = options.distributions;
    for (i = 0; i < BRDFFIT_MAX_LOBES; i++) {
        s->lobes[i] = i + 1 == options.lobes;
    }
    return 1;
}

static int read_value(struct settings *s, const char *name, const char *value)
{
    char end;

    if (strcmp(name, "--repeat") == 0) {
        return sscanf(value, "%d%c", &s->repeat, &end) == 1 && s->repeat >= 1 && s->repeat <= MOST_REPEATS;
    }
    if (strcmp(name, "--lobes") == 0) {
        return read_lobes(s, value);
    }
    if (strcmp(name, "--brute-step") == 0) {
        return sscanf(value, "%d,%d%c", &s->step[0], &s->step[1], &end) == 2 && s->step[0] >= 0 && s->step[1] >= 0;
    }
    if (strcmp(name, "--gap") == 0) {
        return sscanf(value, "%lf%c", &s->gap, &end) == 1;
    }
    if (strcmp(name, "--distribution") == 0) {
        s->distribution = strcmp(value, "ggx") == 0 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        return s->distribution == BRDFFIT_GGX || strcmp(value, "beckmann") == 0;
    }
    s->brute = value;
    return strcmp(name, "--brute") == 0;
}

static int read_arguments(struct settings *s, int argc, char **argv)
{
    const char *slash = strrchr(argv[0], '/');
    int i;

    snprintf(s->beside, sizeof s->beside, "%.*stests/ref/brute", slash ? (int)(slash - argv[0]) + 1 : 0, argv[0]);
    s->brute = s->beside;
    for (i = 1; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        if (strcmp(argv[i], "--markdown") == 0) {
            s->markdown = 1;
        } else if (strcmp(argv[i], "--quiet") == 0) {
            s->quiet = 1;
        } else if (i + 1 >= argc || !read_value(s, argv[i], argv[i + 1])) {
            return 0;
        } else {
            i++;
        }
    }
    s->file = argv + i;
    s->files = argc - i;
    return s->files > 0;
}

int main(int argc, char **argv)
{
    struct settings s = {.repeat = 5, .lobes = {1, 1, 0}, .step = {11, 7, 0}, .gap = 1e-3};
    int lobes, good = 1;

    if (!read_arguments(&s, argc, argv)) {
        fprintf(
            stderr,
            "usage: bench_fit [--repeat R] [--lobes 1|2|both|3|NAME,...] [--brute-step M1,M2] "
            "[--brute PROGRAM]\n"
            "                 [--gap G] [--distribution beckmann|ggx] [--markdown] [--quiet] FILE.csv...\n"
            "M1, M2: the brute force's step is 2^-M, for one and two lobes; 0: leave it out. With three, and with names, it is.\n");
        return 2;
    }
    if (s.distributions) { /* which the brute force does not know */
        memset(s.step, 0, sizeof s.step);
    }
    for (lobes = 1; lobes <= BRDFFIT_MAX_LOBES; lobes++) {
        good = (!s.lobes[lobes - 1] || bench(&s, lobes)) && good;
    }
    return good ? 0 : 1;
}
