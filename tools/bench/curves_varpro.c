/*
 * Variable projection from random starts: the local solver that suits this problem best. The coefficients are
 * eliminated by non-negative least squares (curves_reduced.c), and Levenberg-Marquardt runs in u = ln sigma alone, with
 * the derivatives of curves_projected.c. The knob is the number of starts, whose roughnesses are those of levmar's and
 * Ceres's starts. A run of n starts is timed as a whole, because a start takes less than reading the clock does.
 *
 * The matrix is the Hessian where that is positive definite, else Kaufman's; variants take Kaufman's or Golub and
 * Pereyra's everywhere. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "curves.h"
#include "curves_projected.h"
#include "peers_start.h"

/*
 * A start ends when a step promises less than this part of E^2, the best of them goes on until this part: Newton's steps
 * square the error. Or when it promises less than this part of the data's squares: rounding.
 */
#define COARSE 1e-8
#define FINE 1e-13
#define ROUNDING 1e-16
#define MOST_STEPS 100
/* Longest step in ln sigma, and where damping starts after a step that failed (relative to the matrix). */
#define LONGEST 1.5
#define FIRST_DAMPING 0.1
#define MOST_DAMPING 1e6
/* A start costs about a hundredth of one of levmar's: there may be this many times as many. */
#define MORE_STARTS 20
/* A start where no lobe has a coefficient is drawn again, until so many times as many as starts have been drawn. */
#define MOST_DRAWS 10

struct local {
    struct curves_reduced reduced; /* shares its arrays */
    int lobes, kind;
    double low, high; /* of u */
    double u[2], e2, gradient[2], matrix[4];
    double damping;
    double evaluations;
};

static double value(struct local *l, const double *u)
{
    l->evaluations++;
    return curves_reduced_value(&l->reduced, l->lobes, u, NULL);
}

static int definite(int lobes, const double *m)
{
    return m[0] > 0.0 && (lobes == 1 || m[0] * m[3] - m[1] * m[2] > 1e-12 * m[0] * m[3]);
}

/* At l->u, where value() was called last. */
static void differentiate(struct local *l)
{
    double safe[4];

    curves_projected(&l->reduced, l->lobes, l->u, l->kind, l->gradient, l->matrix,
                     l->kind == CURVES_NEWTON ? safe : NULL);
    if (l->kind == CURVES_NEWTON && !definite(l->lobes, l->matrix)) {
        memcpy(l->matrix, safe, sizeof safe);
    }
}

/* May variable j move against its gradient? */
static int is_free(const struct local *l, int j)
{
    return l->gradient[j] > 0.0 ? l->u[j] > l->low : l->gradient[j] < 0.0 && l->u[j] < l->high;
}

/* (matrix + damping x diagonal) step = -gradient over the free variables. */
static void solve(const struct local *l, double *step)
{
    const double *m = l->matrix, *g = l->gradient, more = 1.0 + l->damping;
    int first = is_free(l, 0), second = l->lobes == 2 && is_free(l, 1);
    double d0 = m[0] * more, d1 = l->lobes == 2 ? m[3] * more : 0.0, cross = first && second ? m[1] : 0.0;
    double determinant = d0 * d1 - cross * cross;

    step[0] = first ? -g[0] / d0 : 0.0;
    step[1] = second ? -g[1] / d1 : 0.0;
    if (first && second && determinant > 1e-14 * d0 * d1) {
        step[0] = (cross * g[1] - d1 * g[0]) / determinant;
        step[1] = (cross * g[0] - d0 * g[1]) / determinant;
    }
}

/* The point that a step of at most LONGEST leads to, inside the box; the step becomes what was walked. */
static void walk(const struct local *l, double *step, double *to)
{
    double longest = 0.0;
    int j;

    for (j = 0; j < l->lobes; j++) {
        step[j] = step[j] == step[j] ? step[j] : 0.0; /* 0 over 0: flat */
        longest = fmax(longest, fabs(step[j]));
    }
    for (j = 0; j < l->lobes; j++) {
        double wanted = longest > LONGEST
                            ? (isinf(step[j]) ? copysign(LONGEST, step[j]) : step[j] * (LONGEST / longest))
                            : step[j];

        to[j] = fmin(fmax(l->u[j] + (wanted == wanted ? wanted : 0.0), l->low), l->high);
        step[j] = to[j] - l->u[j];
    }
}

static double promised(const struct local *l, const double *step)
{
    double sum = 0.0;
    int i, j;

    for (i = 0; i < l->lobes; i++) {
        sum -= l->gradient[i] * step[i];
        for (j = 0; j < l->lobes; j++) {
            sum -= 0.5 * step[i] * l->matrix[i * l->lobes + j] * step[j];
        }
    }
    return sum;
}

/* Marquardt: less damping after what went as promised, more after what did not. */
static void damp(struct local *l, double gained, double promise)
{
    if (!(gained > 0.0)) {
        l->damping = fmax(8.0 * l->damping, FIRST_DAMPING);
    } else if (gained > 0.75 * promise) {
        l->damping = l->damping > FIRST_DAMPING ? 0.1 * l->damping : 0.0;
    } else if (gained < 0.25 * promise) {
        l->damping = fmax(2.0 * l->damping, 0.5 * FIRST_DAMPING);
    }
}

static void place(struct local *l)
{
    l->e2 = value(l, l->u);
}

/* Has a lobe a coefficient at the point that value() was called for last? Else nothing changes as lobes do. */
static int alive(const struct local *l)
{
    size_t k;

    for (k = 0; k < l->reduced.channels; k++) {
        const double *z = l->reduced.coefficient + 3 * k;

        if (z[1] > 0.0 || z[2] > 0.0) {
            return 1;
        }
    }
    return 0;
}

/* From where place() was called last to a local minimum, until a step promises no more than `decrease` of E^2. */
static void descend(struct local *l, double decrease)
{
    int i;

    l->damping = 0.0;
    differentiate(l);
    for (i = 0; i < MOST_STEPS && l->damping < MOST_DAMPING; i++) {
        double step[2], to[2], promise, e2;

        solve(l, step);
        walk(l, step, to);
        promise = promised(l, step);
        if (!(promise > decrease * l->e2 + ROUNDING * l->reduced.total)) {
            break;
        }
        e2 = value(l, to);
        damp(l, l->e2 - e2, promise);
        if (e2 < l->e2) {
            l->e2 = e2;
            memcpy(l->u, to, sizeof to);
            differentiate(l);
        }
    }
}

/* Goes to the next start at which a lobe counts, or to the last of those allowed. */
static void start_at_next(struct local *l, const struct peers_problem *problem, int *drawn, int most)
{
    static const struct peers_start start = {1, 1, 1};

    do {
        peers_start_roughness(problem, &start, (uint64_t)(*drawn)++, l->u);
        place(l);
    } while (!alive(l) && *drawn < most);
}

/* The best of n starts. */
static void best_of(struct local *l, const struct peers_problem *problem, int starts, double *u)
{
    double best = INFINITY;
    int i, drawn = 0;

    for (i = 0; i < starts; i++) {
        start_at_next(l, problem, &drawn, MOST_DRAWS * starts);
        descend(l, COARSE);
        if (l->e2 < best) {
            best = l->e2;
            memcpy(u, l->u, sizeof l->u);
        }
    }
    memcpy(l->u, u, sizeof l->u);
    place(l);
    descend(l, FINE);
    memcpy(u, l->u, sizeof l->u);
}

static struct local prepare(const struct curves_task *task, const struct curves_method *method)
{
    return (struct local){.reduced = task->reduced,
                          .lobes = task->lobes,
                          .kind = method->choice,
                          .low = log(CURVES_SIGMA_MIN),
                          .high = log(CURVES_SIGMA_MAX)};
}

static void run_varpro(const struct curves_task *task, const struct curves_method *method)
{
    struct peers_problem problem = task->problem; /* shares its arrays */
    int most = task->options->starts * MORE_STARTS, n;

    problem.lobes = task->lobes;
    problem.chart = PEERS_LOG;
    for (n = 1; n <= most; n = curves_next(n)) {
        double time[CURVES_MOST_REPEATS], spent = 0.0, u[2] = {0.0, 0.0};
        struct curves_row row = {.knob = n};
        int done = 0;

        while (done == 0 || curves_more(task, done, spent)) {
            struct local local = prepare(task, method);
            double begun = curves_now();

            best_of(&local, &problem, n, u);
            time[done] = curves_now() - begun;
            spent += time[done++];
            row.work = local.evaluations;
        }
        row.seconds = row.search = curves_median(time, done);
        row.e2 = curves_judge(&task->problem, task->lobes, u);
        curves_print(task, method->name, &row);
        if (row.seconds > task->options->patience) {
            return;
        }
    }
}

const struct curves_method curves_varpro_methods[] = {
    {"varpro", run_varpro, 0, CURVES_NEWTON},
    {"varpro:kaufman", run_varpro, 1, CURVES_KAUFMAN},
    {"varpro:golub-pereyra", run_varpro, 1, CURVES_GOLUB_PEREYRA},
    {NULL, NULL, 0, 0},
};
