/*
 * NLopt's global algorithms on the reduced problem in u = ln sigma over [1e-3, 6]. The knob is the number of evaluations;
 * of each algorithm's answer, a local search by L-BFGS with the analytic gradient follows (it too counts), since every
 * algorithm here is better with it, and all evaluations are of the compiled objective. Variants that were tried and
 * were not better can be named on the command line. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <string.h>

#include "curves.h"

/* How an algorithm is run. */
struct recipe {
    nlopt_algorithm algorithm;
    nlopt_algorithm local; /* of MLSL */
    int polish;            /* L-BFGS from the answer */
    int linear;            /* the variable is sigma itself */
};

/* MLSL compares every point with every other: its time grows with the square of the evaluations. */
#define MOST_OF_MLSL 2000

enum { POLISH = 1, PLAIN = 0, LOGARITHM = 0, LINEAR = 1 };

static const struct recipe recipes[] = {
    {NLOPT_GN_DIRECT_L, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_G_MLSL, NLOPT_LD_LBFGS, PLAIN, LOGARITHM},
    {NLOPT_GD_STOGO, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_GN_CRS2_LM, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_GN_DIRECT_L, NLOPT_LD_LBFGS, PLAIN, LOGARITHM},
    {NLOPT_GN_DIRECT_L, NLOPT_LD_LBFGS, POLISH, LINEAR},
    {NLOPT_GN_DIRECT_L_RAND, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_GN_ORIG_DIRECT_L, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_G_MLSL_LDS, NLOPT_LD_LBFGS, PLAIN, LOGARITHM},
    {NLOPT_G_MLSL, NLOPT_LN_SBPLX, PLAIN, LOGARITHM},
    {NLOPT_G_MLSL, NLOPT_LD_LBFGS, PLAIN, LINEAR},
    {NLOPT_GD_STOGO_RAND, NLOPT_LD_LBFGS, POLISH, LOGARITHM},
    {NLOPT_GD_STOGO, NLOPT_LD_LBFGS, PLAIN, LOGARITHM},
    {NLOPT_GN_CRS2_LM, NLOPT_LD_LBFGS, PLAIN, LOGARITHM},
    {NLOPT_GN_CRS2_LM, NLOPT_LD_LBFGS, POLISH, LINEAR},
};

/* What NLopt evaluates; it keeps the best point itself, because an algorithm may return another. */
struct target {
    struct curves_reduced reduced;
    int linear;
    double evaluations, best, at[2];
};

static double objective(unsigned lobes, const double *x, double *gradient, void *data)
{
    struct target *t = data;
    double u[2] = {0.0, 0.0}, e2;
    unsigned j;

    for (j = 0; j < lobes; j++) {
        u[j] = t->linear ? log(x[j]) : x[j];
    }
    e2 = curves_reduced_value(&t->reduced, (int)lobes, u, gradient);
    for (j = 0; gradient && t->linear && j < lobes; j++) {
        gradient[j] /= x[j];
    }
    t->evaluations++;
    if (e2 < t->best) {
        t->best = e2;
        memcpy(t->at, u, lobes * sizeof *u);
    }
    return e2;
}

static nlopt_opt make(nlopt_algorithm algorithm, struct target *target, unsigned lobes, int evaluations)
{
    nlopt_opt opt = nlopt_create(algorithm, lobes);
    double low = target->linear ? CURVES_SIGMA_MIN : log(CURVES_SIGMA_MIN);
    double high = target->linear ? CURVES_SIGMA_MAX : log(CURVES_SIGMA_MAX);

    if (opt) {
        nlopt_set_lower_bounds1(opt, low);
        nlopt_set_upper_bounds1(opt, high);
        nlopt_set_min_objective(opt, objective, target);
        nlopt_set_maxeval(opt, evaluations);
    }
    return opt;
}

static void polish(struct target *target, unsigned lobes)
{
    nlopt_opt opt;
    double x[2], f;
    unsigned j;

    target->linear = 0;
    opt = make(NLOPT_LD_LBFGS, target, lobes, 100);
    for (j = 0; j < lobes; j++) {
        x[j] = fmin(fmax(target->at[j], log(CURVES_SIGMA_MIN)), log(CURVES_SIGMA_MAX));
    }
    nlopt_set_ftol_rel(opt, 1e-14);
    nlopt_optimize(opt, x, &f);
    nlopt_destroy(opt);
}

static void optimise(const struct recipe *recipe, struct target *target, unsigned lobes, int evaluations)
{
    nlopt_opt opt = make(recipe->algorithm, target, lobes, evaluations), local;
    double x[2], f;
    unsigned j;

    for (j = 0; j < lobes; j++) { /* only CRS and StoGO look at the start: not on the diagonal */
        x[j] = log(0.1) + 1.5 * j;
        x[j] = recipe->linear ? exp(x[j]) : x[j];
    }
    if (recipe->algorithm == NLOPT_G_MLSL || recipe->algorithm == NLOPT_G_MLSL_LDS) {
        local = make(recipe->local, target, lobes, 0);
        nlopt_set_ftol_rel(local, 1e-14);
        nlopt_set_local_optimizer(opt, local); /* copied */
        nlopt_destroy(local);
    }
    nlopt_srand(1);
    nlopt_optimize(opt, x, &f);
    nlopt_destroy(opt);
    if (recipe->polish) {
        polish(target, lobes);
    }
}

static void run_nlopt(const struct curves_task *task, const struct curves_method *method)
{
    static const int step[] = {10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000};
    int most = task->options->evaluations, mlsl = recipes[method->choice].algorithm == NLOPT_G_MLSL ||
                                                  recipes[method->choice].algorithm == NLOPT_G_MLSL_LDS;
    size_t i;

    if (mlsl && most > MOST_OF_MLSL) {
        most = MOST_OF_MLSL;
    }
    for (i = 0; i < sizeof step / sizeof *step && step[i] <= most; i++) {
        double time[CURVES_MOST_REPEATS], spent = 0.0;
        struct curves_row row = {.knob = step[i]};
        struct target target;
        int done = 0;

        while (done == 0 || curves_more(task, done, spent)) {
            double begun = curves_now();

            target = (struct target){task->reduced, recipes[method->choice].linear, 0.0, INFINITY, {0.0, 0.0}};
            optimise(&recipes[method->choice], &target, (unsigned)task->lobes, step[i]);
            time[done] = curves_now() - begun;
            spent += time[done++];
        }
        row.seconds = row.search = curves_median(time, done);
        row.work = target.evaluations;
        row.e2 = curves_judge(&task->problem, task->lobes, target.at);
        curves_print(task, method->name, &row);
        if (row.seconds > task->options->patience) {
            return;
        }
    }
}

const struct curves_method curves_nlopt_methods[] = {
    {"nlopt-direct-l", run_nlopt, 0, 0},
    {"nlopt-mlsl", run_nlopt, 0, 1},
    {"nlopt-stogo", run_nlopt, 0, 2},
    {"nlopt-crs", run_nlopt, 0, 3},
    {"nlopt-direct-l:unpolished", run_nlopt, 1, 4},
    {"nlopt-direct-l:linear", run_nlopt, 1, 5},
    {"nlopt-direct-l:rand", run_nlopt, 1, 6},
    {"nlopt-direct-l:original", run_nlopt, 1, 7},
    {"nlopt-mlsl:sobol", run_nlopt, 1, 8},
    {"nlopt-mlsl:sbplx", run_nlopt, 1, 9},
    {"nlopt-mlsl:linear", run_nlopt, 1, 10},
    {"nlopt-stogo:rand", run_nlopt, 1, 11},
    {"nlopt-stogo:unpolished", run_nlopt, 1, 12},
    {"nlopt-crs:unpolished", run_nlopt, 1, 13},
    {"nlopt-crs:linear", run_nlopt, 1, 14},
    {NULL, NULL, 0, 0},
};

const char *curves_nlopt_version(void)
{
    static char version[32];
    int major, minor, bugfix;

    nlopt_version(&major, &minor, &bugfix);
    snprintf(version, sizeof version, "%d.%d.%d", major, minor, bugfix);
    return version;
}
