/*
 * Local least-squares solvers from random starts, beside the certified optimum: see tools/paper/README.md.
 *
 *     peers [options] FILE...
 *
 * For each file it runs the starts that the cache does not have yet, in blocks that end at 1, 2, 5, 10, 20, 50, ...,
 * and appends a row a block. Interrupt it when you like: finished blocks are kept. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "brdffit_io.h"
#include "peers_cache.h"
#include "peers_solver.h"
#include "peers_start.h"

/* A start reached the certified optimum, or came near: relative, plus what rounding leaves of an exact fit. */
#define REACHED 1e-6
#define NEAR 1e-3
#define ROUNDING 1e-12

struct settings {
    const struct peers_solver *solver;
    enum peers_chart chart;
    struct peers_start start;
    unsigned long long starts;
    int lobes, quiet;
    const char *cache;
    double from[PEERS_MOST_LOBES]; /* > 0: one run from there instead, printed */
    char **file;
    int files;
};

static const struct peers_solver *const solvers[] = {
    &peers_levmar,
#ifndef PEERS_NO_CERES
    &peers_ceres,
#endif
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- One material --------------------------------------------------------------------------------------- */

static void run_block(const struct settings *s, const struct peers_problem *p, void *solver,
                      const struct peers_block *block, struct peers_outcome *o)
{
    double parameter[PEERS_MOST_PARAMETERS], begun = now(), allowance = ROUNDING * p->total;
    uint64_t i;
    int lobe;

    for (i = block->first; i < block->last; i++) {
        int iterations;
        double e2;

        peers_start_draw(p, &s->start, i, parameter);
        iterations = isfinite(peers_e2(p, parameter)) ? s->solver->run(solver, parameter) : -1;
        e2 = iterations >= 0 && peers_reasonable(p, parameter) ? peers_e2(p, parameter) : INFINITY;
        o->iterations += iterations > 0 ? iterations : 0;
        if (!isfinite(e2)) {
            o->excluded++;
            continue;
        }
        o->reached += e2 <= o->certified_e2 * (1.0 + REACHED) + allowance;
        o->near += e2 <= o->certified_e2 * (1.0 + NEAR) + allowance;
        if (e2 < o->best_e2) {
            o->best_e2 = e2;
            for (lobe = 0; lobe < p->lobes; lobe++) {
                o->best_sigma[lobe] = peers_sigma(p, parameter, lobe);
            }
        }
    }
    o->seconds = now() - begun;
}

/* E^2 to judge by: the library's, proven to 1e-6. */
static int certify(const char *path, int lobes, struct peers_outcome *o)
{
    brdffit_io_options io;
    brdffit_options options;
    brdffit_table *table = NULL;
    const brdffit_result *result = NULL;
    brdffit_error error;
    int good;

    brdffit_io_options_init(&io);
    io.merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    brdffit_options_init(&options);
    options.lobes = lobes;
    options.relative_gap = REACHED;
    good = brdffit_io_read(path, &io, &table, &error) == BRDFFIT_OK &&
           brdffit_fit_new(table->samples, &options, &result, &error) == BRDFFIT_OK;
    if (good) {
        o->certified_e2 = result->e2;
        o->lower_bound = result->lower_bound;
        o->sum_of_squares = result->sum_of_squares;
        if (!result->certified) {
            fprintf(stderr, "peers: %s: %d lobes: the optimum is not certified to %g\n", path, lobes, REACHED);
        }
    } else {
        fprintf(stderr, "peers: %s: %s\n", path, error.message);
    }
    brdffit_result_free(result);
    brdffit_io_free(table);
    return good;
}

static void name_material(const char *path, char *to, size_t size)
{
    static const char *const ending[] = {".gz", ".csv", ".tsv", ".binary"};
    const char *slash = strrchr(path, '/');
    size_t i, length;
    char *at;

    snprintf(to, size, "%s", slash ? slash + 1 : path);
    for (i = 0; i < sizeof ending / sizeof *ending; i++) {
        length = strlen(to);
        if (length > strlen(ending[i]) && strcmp(to + length - strlen(ending[i]), ending[i]) == 0) {
            to[length - strlen(ending[i])] = '\0';
        }
    }
    for (at = to; (at = strpbrk(at, ",\"\r\n")) != NULL;) {
        *at = '_';
    }
}

/* 1, 2, 5, 10, 20, 50, ... */
static uint64_t next_end(uint64_t first, uint64_t starts)
{
    static const uint64_t step[3] = {1, 2, 5};
    uint64_t decade, end = 0;
    int i;

    for (decade = 1; end <= first; decade *= 10) {
        for (i = 0; i < 3 && end <= first; i++) {
            end = step[i] * decade;
        }
    }
    return end < starts ? end : starts;
}

static int run_blocks(const struct settings *s, const struct peers_problem *p, const char *path,
                      struct peers_cache *cache, double *seconds)
{
    struct peers_block block = {.data = p->digest, .lobes = p->lobes, .peer = s->solver->name};
    struct peers_outcome known = {0};
    void *solver = NULL;
    uint64_t first;
    int good = 1, certified = 0;

    name_material(path, block.material, sizeof block.material);
    block.chart = peers_chart_name(s->chart);
    block.coefficients = s->start.nnls ? "nnls" : "random";
    block.sigma = s->start.log_uniform ? "log" : "uniform";
    block.seed = s->start.seed;
    for (first = 0; first < s->starts && good; first = block.last) {
        struct peers_outcome outcome;

        block.first = first;
        block.last = next_end(first, s->starts);
        if (peers_cache_knows(cache, &block)) {
            continue;
        }
        solver = solver ? solver : s->solver->create(p);
        good = solver && (certified || certify(path, p->lobes, &known));
        certified = 1;
        if (good) {
            outcome = known;
            outcome.best_e2 = INFINITY;
            run_block(s, p, solver, &block, &outcome);
            *seconds += outcome.seconds;
            good = peers_cache_add(cache, &block, &outcome);
        }
    }
    if (solver) {
        s->solver->destroy(solver);
    }
    return good;
}

/* One run from given roughnesses. */
static int run_from(const struct settings *s, const struct peers_problem *p, const char *path)
{
    double parameter[PEERS_MOST_PARAMETERS];
    void *solver = s->solver->create(p);
    int iterations = -1, lobe;

    peers_start_at(p, s->from, parameter);
    if (solver) {
        iterations = s->solver->run(solver, parameter);
        s->solver->destroy(solver);
    }
    printf("%s,%s,%s,%.17g", path, s->solver->name, peers_chart_name(s->chart), peers_e2(p, parameter));
    for (lobe = 0; lobe < p->lobes; lobe++) {
        printf(",%.17g", peers_sigma(p, parameter, lobe));
    }
    printf(",%d\n", iterations);
    return iterations >= 0;
}

/* A line that is rewritten on a terminal; elsewhere one every ten seconds of work; nothing when nothing was run. */
static void show_progress(const struct settings *s, int done, double seconds, double *shown)
{
    int terminal = isatty(STDERR_FILENO);

    if (s->quiet || !(seconds > 0.0) || !(terminal || done == s->files || seconds >= *shown + 10.0)) {
        return;
    }
    *shown = seconds;
    fprintf(stderr, "%s%s, chart %s, %d lobe%s, %llu starts: %d of %d files, %.0f s%s", terminal ? "\r" : "",
            s->solver->name, peers_chart_name(s->chart), s->lobes, s->lobes == 1 ? "" : "s", s->starts, done, s->files,
            seconds, terminal && done < s->files ? "" : "\n");
}

static int run_all(const struct settings *s)
{
    struct peers_cache cache;
    double seconds = 0.0, shown = 0.0;
    int i, good = 1, from = s->from[0] > 0.0;

    if (!from && !peers_cache_open(s->cache, &cache)) {
        fprintf(stderr, "peers: cannot read or write %s\n", s->cache);
        return 0;
    }
    for (i = 0; i < s->files && good; i++) {
        struct peers_problem problem;
        const char *message = "cannot be run";

        good = peers_problem_read(s->file[i], &problem, &message);
        problem.lobes = s->lobes;
        problem.chart = s->chart;
        good = good &&
               (from ? run_from(s, &problem, s->file[i]) : run_blocks(s, &problem, s->file[i], &cache, &seconds));
        if (!good) {
            fprintf(stderr, "peers: %s: %s\n", s->file[i], message);
        }
        show_progress(s, i + 1, seconds, &shown);
        peers_problem_free(&problem);
    }
    return (from || peers_cache_close(&cache)) && good;
}

/* ---- Command line --------------------------------------------------------------------------------------- */

static int choose(const char *value, const char *first, const char *second, int *chosen)
{
    *chosen = strcmp(value, second) == 0;
    return *chosen || strcmp(value, first) == 0;
}

static int choose_solver(struct settings *s, const char *name)
{
    size_t i;

    for (i = 0; i < sizeof solvers / sizeof *solvers; i++) {
        if (strcmp(name, solvers[i]->name) == 0) {
            s->solver = solvers[i];
            return 1;
        }
    }
    return 0;
}

static int choose_chart(struct settings *s, const char *name)
{
    int chart;

    for (chart = 0; chart < PEERS_CHARTS; chart++) {
        if (strcmp(name, peers_chart_name((enum peers_chart)chart)) == 0) {
            s->chart = (enum peers_chart)chart;
            return 1;
        }
    }
    return 0;
}

static int read_value(struct settings *s, const char *name, const char *value)
{
    unsigned long long number;
    char end;

    if (strcmp(name, "--peer") == 0) {
        return choose_solver(s, value);
    }
    if (strcmp(name, "--chart") == 0) {
        return choose_chart(s, value);
    }
    if (strcmp(name, "--coefficients") == 0) {
        return choose(value, "random", "nnls", &s->start.nnls);
    }
    if (strcmp(name, "--sigma") == 0) {
        return choose(value, "uniform", "log", &s->start.log_uniform);
    }
    if (strcmp(name, "--cache") == 0) {
        s->cache = value;
        return 1;
    }
    if (strcmp(name, "--from") == 0) {
        return (sscanf(value, "%lf,%lf%c", &s->from[0], &s->from[1], &end) == 2 ||
                sscanf(value, "%lf%c", &s->from[0], &end) == 1) &&
               s->from[0] > 0.0 && s->from[1] >= 0.0;
    }
    if (value[0] == '-' || sscanf(value, "%llu%c", &number, &end) != 1) {
        return 0;
    }
    if (strcmp(name, "--lobes") == 0) {
        s->lobes = (int)number;
        return number == 1 || number == 2;
    }
    if (strcmp(name, "--seed") == 0) {
        s->start.seed = number;
        return 1;
    }
    s->starts = number;
    return strcmp(name, "--starts") == 0 && number >= 1 && number <= 1000000000ULL;
}

static int read_arguments(struct settings *s, int argc, char **argv)
{
    int i;

    for (i = 1; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        if (strcmp(argv[i], "--quiet") == 0) {
            s->quiet = 1;
        } else if (i + 1 >= argc || !read_value(s, argv[i], argv[i + 1])) {
            return 0;
        } else {
            i++;
        }
    }
    s->file = argv + i;
    s->files = argc - i;
    return s->files > 0 && (s->lobes == 1 || !(s->from[0] > 0.0) || s->from[1] > 0.0);
}

int main(int argc, char **argv)
{
    struct settings s = {
        .solver = &peers_levmar, .chart = PEERS_LOG, .start = {1, 1, 1}, .starts = 100, .lobes = 1, .cache = "-"};
    size_t i;

    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        for (i = 0; i < sizeof solvers / sizeof *solvers; i++) {
            printf("%s,%s\n", solvers[i]->name, solvers[i]->version);
        }
        return 0;
    }
    if (!read_arguments(&s, argc, argv)) {
        fprintf(stderr, "usage: peers [--peer levmar|ceres] [--lobes 1|2] [--chart plain|log|squares]\n"
                        "             [--coefficients random|nnls] [--sigma uniform|log] [--starts N] [--seed S]\n"
                        "             [--cache FILE.csv] [--from S1[,S2]] [--quiet] FILE...\n"
                        "       peers --list     the solvers that were built in, with their versions\n");
        return 2;
    }
    return run_all(&s) ? 0 : 1;
}
