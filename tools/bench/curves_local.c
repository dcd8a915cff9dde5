/*
 * Local least-squares solvers from random starts as methods of the benchmark: after 1, 2, 5, 10 ... starts, the best so
 * far and the time so far. Charts and starts are those that did best in tools/paper (its README says what was tried);
 * "-box" is the plain reading of the paper, whose levmar starts in a box. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>

#include "curves.h"
#include "peers_solver.h"
#include "peers_start.h"

struct choice {
    const struct peers_solver *solver;
    enum peers_chart chart;
    struct peers_start start;
};

static const struct choice choices[] = {
    {&peers_levmar, PEERS_SQUARES, {1, 1, 1}},
    {&peers_levmar, PEERS_PLAIN, {0, 0, 1}},
#ifndef PEERS_NO_CERES
    {&peers_ceres, PEERS_LOG, {1, 1, 1}},
#endif
};

/* Is n one of 1, 2, 5, 10, 20, 50, ... ? */
static int milestone(int n)
{
    while (n % 10 == 0) {
        n /= 10;
    }
    return n == 1 || n == 2 || n == 5;
}

static void run_starts(const struct curves_task *task, const struct curves_method *method)
{
    const struct choice *choice = &choices[method->choice];
    struct peers_problem problem = task->problem; /* shares its arrays */
    struct curves_row row = {.e2 = INFINITY};
    double parameter[PEERS_MOST_PARAMETERS];
    void *solver;
    int i;

    problem.lobes = task->lobes;
    problem.chart = choice->chart;
    solver = choice->solver->create(&problem);
    for (i = 1; solver && i <= task->options->starts; i++) {
        double begun = curves_now(), e2 = INFINITY;
        int iterations;

        peers_start_draw(&problem, &choice->start, (uint64_t)i - 1, parameter);
        iterations = choice->solver->run(solver, parameter);
        if (iterations >= 0 && peers_reasonable(&problem, parameter)) {
            e2 = peers_e2(&problem, parameter);
        }
        row.seconds += curves_now() - begun;
        row.work += iterations > 0 ? iterations : 0;
        row.e2 = fmin(row.e2, e2);
        if (milestone(i)) {
            row.knob = i;
            row.search = row.seconds;
            curves_print(task, method->name, &row);
            if (row.seconds > task->options->patience) {
                break;
            }
        }
    }
    if (solver) {
        choice->solver->destroy(solver);
    }
}

const struct curves_method curves_local_methods[] = {
    {"levmar", run_starts, 0, 0},
    {"levmar-box", run_starts, 0, 1},
#ifndef PEERS_NO_CERES
    {"ceres", run_starts, 0, 2},
#endif
    {NULL, NULL, 0, 0},
};
