/*
 * Recursive multi-start, as "Robust method of determining microfacet BRDF parameters in the presence of noise via
 * recursive optimization", Optical Engineering 60(9), 094103 (2021) has it: README.md says what of the paper was known
 * and what is assumed. A round fits from a fixed number of starts that span the ranges of the parameters, and the best
 * answer so far is kept; the next round's ranges lie around it and are half as wide; a round that finds nothing better
 * is the last. The knob is the number of starts a round.
 *
 * "recursive" fits by what was the best local solver here, levmar in the chart of square roots, from starts whose
 * coefficients solve the restricted problem; "-box" is the plain reading: sigma, x, y as they are, bounds on all of them
 * as lsqcurvefit takes them, starts that span all of them. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "curves.h"
#include "peers_solver.h"
#include "peers_start.h"

#define MOST_ROUNDS 10
#define NARROWER 0.5
/* Better is by more than this part of E^2. */
#define BETTER 1e-9

struct choice {
    const struct peers_solver *solver;
    enum peers_chart chart;
    int all; /* starts span coefficients too; else the restricted problem at the roughnesses has them */
};

static const struct choice choices[] = {
    {&peers_levmar, PEERS_SQUARES, 0},
    {&peers_levmar, PEERS_PLAIN, 1},
    {&peers_levmar, PEERS_LOG, 0},
#ifndef PEERS_NO_CERES
    {&peers_ceres, PEERS_LOG, 0},
#endif
};

/* Ranges of what starts span, and the best answer so far. */
struct recursion {
    const struct choice *choice;
    struct peers_problem problem; /* shares its arrays */
    void *solver;
    size_t spanned;
    double low[PEERS_MOST_PARAMETERS], high[PEERS_MOST_PARAMETERS]; /* of the first round */
    double best[PEERS_MOST_PARAMETERS], e2;
    double fits, iterations;
};

/* ---- Starts that span a box ------------------------------------------------------------------------------ */

/*
 * Points i + 1/2 times powers of 1/x modulo 1, x > 1 with x^(d+1) = x + 1: they fill a cube evenly whatever their number
 * is (M. Roberts' sequence; with d = 1 the golden ratio's).
 */
static double ratio(size_t dimensions)
{
    double x = 1.5;
    int i;

    for (i = 0; i < 60; i++) {
        x = pow(1.0 + x, 1.0 / (double)(dimensions + 1));
    }
    return 1.0 / x;
}

static void span(const struct recursion *r, int index, double width, double *to)
{
    double part = ratio(r->spanned), power = 1.0;
    size_t j;

    for (j = 0; j < r->spanned; j++) {
        double low = r->low[j], high = r->high[j], t;

        if (width < 1.0) {
            low = fmax(r->low[j], r->best[j] - 0.5 * width * (r->high[j] - r->low[j]));
            high = fmin(r->high[j], r->best[j] + 0.5 * width * (r->high[j] - r->low[j]));
        }
        power *= part;
        t = (index + 0.5) * power;
        to[j] = fmax(low, fmin(high, low + (t - floor(t)) * (high - low)));
    }
}

/* ---- Ranges ---------------------------------------------------------------------------------------------- */

/* The largest coefficient of a column of this height that random starts draw too: alone it explains the largest value. */
static double tallest(const struct peers_problem *p, size_t parameter)
{
    size_t lobes = (size_t)p->lobes;

    /* Of a lobe in the plain chart at roughness 1, whose column is at most b_max. */
    return parameter < lobes ? PEERS_SIGMA_MAX : 1.0 / (parameter < lobes + p->channels ? p->a_max : p->b_max);
}

static void set_ranges(struct recursion *r)
{
    size_t j;

    r->spanned = r->choice->all ? peers_parameters(&r->problem) : (size_t)r->problem.lobes;
    for (j = 0; j < r->spanned; j++) {
        r->low[j] = 0.0;
        r->high[j] = tallest(&r->problem, j);
        if (j < (size_t)r->problem.lobes) {
            r->low[j] = peers_sigma_to_chart(&r->problem, PEERS_LOG_UNIFORM_MIN);
            r->high[j] = peers_sigma_to_chart(&r->problem, PEERS_SIGMA_MAX);
        }
    }
}

/* ---- Rounds ---------------------------------------------------------------------------------------------- */

static void start(const struct recursion *r, int index, double width, double *parameter)
{
    double sigma[PEERS_MOST_LOBES];
    int lobe;

    span(r, index, width, parameter);
    if (!r->choice->all) {
        for (lobe = 0; lobe < r->problem.lobes; lobe++) {
            sigma[lobe] = peers_sigma(&r->problem, parameter, lobe);
        }
        peers_start_at(&r->problem, sigma, parameter);
    }
}

/* 1 when the round found something better. */
static int run_round(struct recursion *r, int starts, double width)
{
    double before = r->e2, parameter[PEERS_MOST_PARAMETERS], best[PEERS_MOST_PARAMETERS];
    int i;

    memcpy(best, r->best, sizeof best);
    for (i = 0; i < starts; i++) {
        double e2 = INFINITY;
        int iterations;

        start(r, i, width, parameter);
        iterations = r->choice->solver->run(r->solver, parameter);
        if (iterations >= 0 && peers_reasonable(&r->problem, parameter)) {
            e2 = peers_e2(&r->problem, parameter);
        }
        r->iterations += iterations > 0 ? iterations : 0;
        r->fits++;
        if (e2 < r->e2) {
            r->e2 = e2;
            memcpy(best, parameter, sizeof best);
        }
    }
    memcpy(r->best, best, sizeof best); /* the round's ranges lie around one point */
    return r->e2 < before * (1.0 - BETTER);
}

static void recurse(struct recursion *r, int starts)
{
    double width = 1.0;
    int round = 0;

    r->e2 = INFINITY;
    r->fits = r->iterations = 0.0;
    memset(r->best, 0, sizeof r->best);
    while (round++ < MOST_ROUNDS && run_round(r, starts, width)) {
        width *= NARROWER;
    }
}

static void run_recursive(const struct curves_task *task, const struct curves_method *method)
{
    struct recursion r = {.choice = &choices[method->choice], .problem = task->problem};
    int starts;

    r.problem.lobes = task->lobes;
    r.problem.chart = r.choice->chart;
    set_ranges(&r);
    r.solver = r.choice->solver->create(&r.problem);
    for (starts = 1; r.solver && starts <= task->options->starts; starts = curves_next(starts)) {
        struct curves_row row = {.knob = starts};
        double begun = curves_now();

        recurse(&r, starts);
        row.seconds = row.search = curves_now() - begun;
        row.e2 = r.e2;
        row.work = r.iterations;
        row.nodes = r.fits;
        curves_print(task, method->name, &row);
        if (row.seconds > task->options->patience) {
            break;
        }
    }
    if (r.solver) {
        r.choice->solver->destroy(r.solver);
    }
}

const struct curves_method curves_recursive_methods[] = {
    {"recursive", run_recursive, 0, 0},
    {"recursive-box", run_recursive, 0, 1},
    {"recursive:log", run_recursive, 1, 2},
#ifndef PEERS_NO_CERES
    {"recursive:ceres", run_recursive, 1, 3},
#endif
    {NULL, NULL, 0, 0},
};
