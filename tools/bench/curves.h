/*
 * Run time against error: what the benchmark's methods share. A method runs on one file with P lobes and prints one CSV
 * row per value of its knob; seconds are processor time of this thread, so that other programs disturb them little.
 * SPDX-License-Identifier: MIT
 */
#ifndef CURVES_H
#define CURVES_H

#include "brdffit_io.h"
#include "curves_reduced.h"

#ifdef __cplusplus
extern "C" {
#endif

struct curves_options {
    int repeat;          /* most repeats of what is fast; a median is printed */
    double patience;     /* seconds: nothing is repeated that takes longer in all, and no larger knob is tried */
    int starts;          /* most starts of local solvers (varpro: twenty times as many, as it is so much faster) */
    int evaluations;     /* most evaluations of NLopt's algorithms */
    int grid[2];         /* finest step of the grid, 2^-M, for one and two lobes */
    int width[2];        /* narrowest box of engine socp, 2^-M */
    const char *set;     /* name of the data set, printed */
    const char *methods; /* comma-separated; NULL: all that are not variants */
};

struct curves_task {
    const struct curves_options *options;
    const char *file; /* name without its folder and ending */
    brdffit_table *table;
    struct peers_problem problem;
    struct curves_reduced reduced;
    int lobes;
};

struct curves_row {
    double knob, seconds, search, e2, lower_bound;
    int certified;
    double work, nodes; /* evaluations, boxes or iterations; engine: one-dimensional evaluations */
};

void curves_print(const struct curves_task *task, const char *method, const struct curves_row *row);

double curves_now(void);
int curves_more(const struct curves_task *task, int done, double spent); /* is another repeat worth it? */
double curves_median(double *value, int count);
int curves_next(int knob); /* 1, 2, 5, 10, 20, 50 ... */

struct curves_method {
    const char *name;
    void (*run)(const struct curves_task *task, const struct curves_method *method);
    int variant; /* run only when named */
    int choice;  /* for the method's own use */
};

#define CURVES_MOST_REPEATS 101

extern const struct curves_method curves_engine_methods[], curves_grid_methods[], curves_local_methods[],
    curves_nlopt_methods[], curves_recursive_methods[], curves_varpro_methods[]; /* end with a name of NULL */

const char *curves_nlopt_version(void);

#ifdef __cplusplus
}
#endif
#endif
