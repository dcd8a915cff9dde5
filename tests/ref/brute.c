/*
 * Brute force over the roughness: the slow, obviously right reference of the fits.
 *
 *     brute [--lobes 1|2] [--step-log2 M] [--distribution beckmann|ggx] [--polish] [--json] FILE.csv...
 *
 * Prints the smallest E^2 over sigma = k 2^-M in (0, 6] (pairs of them for two lobes), with the paper's rules:
 * incidence up to 60 degrees, channels divided by their maximum. --polish goes on from the best grid point by
 * a pattern search, to a local optimum off the grid. One line a file. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <time.h>

#include "brute_scan.h"

struct brute_settings {
    int lobes, step_log2, ggx, polish, json;
};

struct brute_answer {
    long double e2, sigma[2];
    double points, seconds;
};

static double brute_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The kept grid points again, from the samples' residuals; the smallest E^2 wins. */
static void brute_pick(const struct brute_problem *p, const struct brute_grid *grid, int lobes,
                       const struct brute_best *best, struct brute_answer *answer)
{
    size_t i;

    answer->e2 = INFINITY;
    for (i = 0; i < best->count; i++) {
        long double sigma[2] = {grid->step * (long double)(best->index[i][0] + 1),
                                grid->step * (long double)(best->index[i][1] + 1)};
        long double e2 = brute_objective(p, sigma, lobes);

        if (e2 < answer->e2) {
            answer->e2 = e2;
            answer->sigma[0] = sigma[0];
            answer->sigma[1] = sigma[1];
        }
    }
}

/* Pattern search in ln sigma: try the neighbours at `step`, halve it when none is better. */
static void brute_polish(const struct brute_problem *p, int lobes, struct brute_answer *answer)
{
    static const int direction[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
    long double step = 0.25L;

    while (step > 1e-10L) {
        int j, better = 0;

        for (j = 0; j < (lobes == 2 ? 8 : 2) && !better; j++) {
            long double sigma[2] = {answer->sigma[0] * expl(step * direction[j][0]),
                                    answer->sigma[1] * expl(step * direction[j][1])};
            long double e2 = brute_objective(p, sigma, lobes);

            if (sigma[0] <= 6.0L && sigma[1] <= 6.0L && e2 < answer->e2) {
                answer->e2 = e2;
                answer->sigma[0] = sigma[0];
                answer->sigma[1] = sigma[1];
                better = 1;
            }
        }
        step *= better ? 1.0L : 0.5L;
    }
}

static void brute_solve(const struct brute_problem *p, const struct brute_settings *settings,
                        struct brute_answer *answer)
{
    double start = brute_now(), nodes;
    struct brute_grid grid;
    struct brute_best *best = ref_allocate(1, sizeof *best);

    brute_grid_new(&grid, p, settings->step_log2);
    brute_scan(&grid, settings->lobes, best);
    brute_pick(p, &grid, settings->lobes, best, answer);
    nodes = (double)grid.count;
    answer->points = settings->lobes == 2 ? 0.5 * nodes * (nodes + 1.0) : nodes;
    brute_grid_free(&grid);
    free(best);
    if (settings->polish) {
        brute_polish(p, settings->lobes, answer);
    }
    if (settings->lobes == 2 && answer->sigma[0] > answer->sigma[1]) {
        long double first = answer->sigma[0];

        answer->sigma[0] = answer->sigma[1];
        answer->sigma[1] = first;
    }
    answer->seconds = brute_now() - start;
}

static void brute_print(const char *path, const struct brute_problem *p, const struct brute_settings *settings,
                        const struct brute_answer *answer)
{
    if (!settings->json) {
        printf("%s  E2 %.17Lg  sigma %.9Lg", path, answer->e2, answer->sigma[0]);
        if (settings->lobes == 2) {
            printf(" %.9Lg", answer->sigma[1]);
        }
        printf("  %.0f points  %.3f s\n", answer->points, answer->seconds);
        return;
    }
    printf("{\"schema\":\"brdffit.brute/1\",\"file\":\"");
    for (; *path; path++) {
        if (*path == '"' || *path == '\\') {
            putchar('\\');
        }
        putchar(*path);
    }
    printf("\",\"distribution\":\"%s\",\"lobes\":%d,\"step_log2\":%d,\"points\":%.0f,\"samples\":%zu,"
           "\"distinct_c\":%zu,\"e2\":%.17Lg,\"sigma\":[%.17Lg",
           settings->ggx ? "ggx" : "beckmann", settings->lobes, settings->step_log2, answer->points, p->sample.count,
           p->basis.rows.count - 1, answer->e2, answer->sigma[0]);
    if (settings->lobes == 2) {
        printf(",%.17Lg", answer->sigma[1]);
    }
    printf("],\"seconds\":%.6f}\n", answer->seconds);
}

/* Number of options read; -1 when they make no sense. */
static int brute_options(int argc, char **argv, struct brute_settings *settings)
{
    int i;

    for (i = 1; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";

        if (strcmp(argv[i], "--json") == 0) {
            settings->json = 1;
        } else if (strcmp(argv[i], "--polish") == 0) {
            settings->polish = 1;
        } else if (strcmp(argv[i], "--lobes") == 0 && (strcmp(value, "1") == 0 || strcmp(value, "2") == 0)) {
            settings->lobes = value[0] - '0';
            i++;
        } else if (strcmp(argv[i], "--step-log2") == 0 && atoi(value) >= 1 && atoi(value) <= 14) {
            settings->step_log2 = atoi(value);
            i++;
        } else if (strcmp(argv[i], "--distribution") == 0 &&
                   (strcmp(value, "ggx") == 0 || strcmp(value, "beckmann") == 0)) {
            settings->ggx = value[0] == 'g';
            i++;
        } else {
            return -1;
        }
    }
    return i < argc ? i : -1;
}

int main(int argc, char **argv)
{
    struct brute_settings settings = {1, 11, 0, 0, 0};
    int i = brute_options(argc, argv, &settings), failed = 0;

    if (i < 0) {
        fprintf(stderr, "usage: brute [--lobes 1|2] [--step-log2 1..14] [--distribution beckmann|ggx] [--polish] "
                        "[--json] FILE.csv...\n");
        return 2;
    }
    for (; i < argc; i++) {
        struct brute_table table;
        struct brute_problem problem;
        struct brute_answer answer;

        if (!brute_read(argv[i], &table)) {
            failed = 1;
            continue;
        }
        brute_problem_new(&problem, &table, settings.ggx);
        if (problem.sample.count == 0 || problem.sample.channels > BRUTE_MAX_CHANNELS) {
            fprintf(stderr, "brute: %s: no samples to fit, or more than 64 channels\n", argv[i]);
            failed = 1;
        } else {
            brute_solve(&problem, &settings, &answer);
            brute_print(argv[i], &problem, &settings, &answer);
            fflush(stdout);
        }
        brute_problem_free(&problem);
        free(table.cell);
    }
    return failed;
}
