/*
 * Run time against error of every compiled method, file by file: see README.md.
 *
 *     curves [options] FILE...
 *
 * Prints CSV rows as they come. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include "curves.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "peers_solver.h"

#ifdef CURVES_NO_NLOPT
const struct curves_method curves_nlopt_methods[] = {{NULL, NULL, 0, 0}};
#endif

static const struct curves_method *const families[] = {curves_engine_methods,    curves_local_methods,
                                                       curves_recursive_methods, curves_varpro_methods,
                                                       curves_nlopt_methods,     curves_grid_methods};

double curves_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Up to `repeat` times within a tenth of the patience. */
int curves_more(const struct curves_task *task, int done, double spent)
{
    return done < task->options->repeat && spent * (1.0 + 1.0 / done) < 0.1 * task->options->patience;
}

static int compare(const void *first, const void *second)
{
    double x = *(const double *)first, y = *(const double *)second;

    return (x > y) - (x < y);
}

double curves_median(double *value, int count)
{
    qsort(value, (size_t)count, sizeof *value, compare);
    return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

int curves_next(int knob)
{
    int power = 1;

    while (power * 10 <= knob) {
        power *= 10;
    }
    return knob == 2 * power ? 5 * power : 2 * knob;
}

void curves_print(const struct curves_task *task, const char *method, const struct curves_row *row)
{
    printf("%s,%.17g,%s,%s,%016" PRIx64 ",%d,%.9g,%.9g,%.17g,%.17g,%d,%.17g,%.17g,%.17g\n", method, row->knob,
           task->options->set, task->file, task->problem.digest, task->lobes, row->seconds, row->search, row->e2,
           row->lower_bound, row->certified, row->work, row->nodes, task->problem.total);
    fflush(stdout);
}

/* Is the method among the comma-separated ones? */
static int wanted(const struct curves_options *options, const struct curves_method *method)
{
    const char *at = options->methods;
    size_t length = strlen(method->name);

    if (!at) {
        return !method->variant;
    }
    while (at) {
        if (strncmp(at, method->name, length) == 0 && (at[length] == '\0' || at[length] == ',')) {
            return 1;
        }
        at = strchr(at, ',');
        at += at != NULL;
    }
    return 0;
}

static void run_methods(const struct curves_task *task)
{
    const struct curves_method *method;
    size_t i;

    for (i = 0; i < sizeof families / sizeof *families; i++) {
        for (method = families[i]; method->name; method++) {
            if (wanted(task->options, method)) {
                method->run(task, method);
            }
        }
    }
}

static void name_file(const char *path, char *to, size_t size)
{
    const char *slash = strrchr(path, '/');
    char *dot;

    snprintf(to, size, "%s", slash ? slash + 1 : path);
    dot = strrchr(to, '.');
    if (dot && dot > to) {
        *dot = '\0';
    }
    while ((dot = strpbrk(to, ",\"\r\n")) != NULL) {
        *dot = '_';
    }
}

static int run_file(const struct curves_options *options, const char *path, const int lobes[2])
{
    struct curves_task task = {.options = options};
    const char *message = "out of memory";
    brdffit_error error;
    char name[256];
    int p, good;

    name_file(path, name, sizeof name);
    task.file = name;
    good = peers_problem_read(path, &task.problem, &message);
    if (good && brdffit_io_read(path, NULL, &task.table, &error) != BRDFFIT_OK) {
        message = error.message;
        good = 0;
    }
    good = good && curves_reduced_new(&task.reduced, &task.problem);
    for (p = 1; p <= 2 && good; p++) {
        task.lobes = p;
        if (lobes[p - 1]) {
            run_methods(&task);
        }
    }
    if (!good) {
        fprintf(stderr, "curves: %s: %s\n", path, message);
    }
    curves_reduced_free(&task.reduced);
    peers_problem_free(&task.problem);
    brdffit_io_free(task.table);
    return good;
}

/* ---- Command line --------------------------------------------------------------------------------------- */

static int list(void)
{
    const struct curves_method *method;
    size_t i;

    for (i = 0; i < sizeof families / sizeof *families; i++) {
        for (method = families[i]; method->name; method++) {
            printf("method,%s%s\n", method->name, method->variant ? ",variant" : "");
        }
    }
    printf("version,levmar,%s\n", peers_levmar.version);
#ifndef PEERS_NO_CERES
    printf("version,Ceres,%s\n", peers_ceres.version);
#endif
#ifndef CURVES_NO_NLOPT
    printf("version,NLopt,%s\n", curves_nlopt_version());
#endif
    return 0;
}

static int read_pair(const char *value, int most, int pair[2])
{
    char end;

    return sscanf(value, "%d,%d%c", &pair[0], &pair[1], &end) == 2 && pair[0] >= 0 && pair[1] >= 0 && pair[0] <= most &&
           pair[1] <= most;
}

static int read_value(struct curves_options *o, int lobes[2], const char *name, const char *value)
{
    char end;

    if (strcmp(name, "--repeat") == 0) {
        return sscanf(value, "%d%c", &o->repeat, &end) == 1 && o->repeat >= 1 && o->repeat <= CURVES_MOST_REPEATS;
    }
    if (strcmp(name, "--patience") == 0) {
        return sscanf(value, "%lf%c", &o->patience, &end) == 1 && o->patience > 0.0;
    }
    if (strcmp(name, "--starts") == 0) {
        return sscanf(value, "%d%c", &o->starts, &end) == 1 && o->starts >= 0;
    }
    if (strcmp(name, "--evaluations") == 0) {
        return sscanf(value, "%d%c", &o->evaluations, &end) == 1 && o->evaluations >= 0;
    }
    if (strcmp(name, "--grid") == 0) {
        return read_pair(value, 13, o->grid);
    }
    if (strcmp(name, "--width") == 0) {
        return read_pair(value, 20, o->width);
    }
    if (strcmp(name, "--lobes") == 0) {
        lobes[0] = strcmp(value, "2") != 0;
        lobes[1] = strcmp(value, "1") != 0;
        return !lobes[0] || !lobes[1] || strcmp(value, "both") == 0;
    }
    if (strcmp(name, "--set") == 0) {
        o->set = value;
        return !strpbrk(value, ",\"\r\n");
    }
    o->methods = value;
    return strcmp(name, "--methods") == 0;
}

int main(int argc, char **argv)
{
    struct curves_options options = {.repeat = 9,
                                     .patience = 1.0,
                                     .starts = 100,
                                     .evaluations = 10000,
                                     .grid = {11, 8},
                                     .width = {11, 6},
                                     .set = "-"};
    int lobes[2] = {1, 1}, i, good = 1;

    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        return list();
    }
    for (i = 1; i + 1 < argc && strncmp(argv[i], "--", 2) == 0; i += 2) {
        if (!read_value(&options, lobes, argv[i], argv[i + 1])) {
            break;
        }
    }
    if (i >= argc || strncmp(argv[i], "--", 2) == 0) {
        fprintf(stderr,
                "usage: curves [--methods A,B,...] [--lobes 1|2|both] [--set NAME] [--repeat R] [--patience S]\n"
                "              [--starts N] [--evaluations N] [--grid M1,M2] [--width M1,M2] FILE...\n"
                "       curves --list     methods, variants, versions of the peers that were built in\n");
        return 2;
    }
    printf("method,knob,set,file,data,lobes,seconds,search,e2,lower_bound,certified,work,nodes,sum_of_squares\n");
    for (; i < argc; i++) {
        good = run_file(&options, argv[i], lobes) && good;
    }
    return good ? 0 : 1;
}
