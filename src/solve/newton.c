/*
 * Damped Newton descent: see newton.h. SPDX-License-Identifier: MIT
 *
 * Only a way to better incumbents: nothing that is proven depends on it. It never returns a point worse than its
 * start. The domain is a box; a coordinate at its edge whose gradient points outwards is held.
 */
#include <math.h>

#include "solve/newton.h"
#include "base/tolerance.h"

/* Longest step in theta = ln s. */
#define LONGEST_STEP 1.5
/* Steps below this that no longer lower the objective are the end: sigma is then good to rounding. */
#define SHORTEST_STEP 1e-8
/* A last step shorter than this is not taken: sigma is good to 1e-10. */
#define NEGLIGIBLE 1e-10
/* Gains below this part of TOL_FLAT_RELATIVE drown in the objective's rounding. */
#define LEAST_PART 1e-3

static double clamp(const struct newton *d, int p, double theta)
{
    return theta < d->theta_low[p] ? d->theta_low[p] : theta > d->theta_high[p] ? d->theta_high[p] : theta;
}

static int held(const struct newton *d, const struct point *at, const struct varpro_value *f, int p)
{
    if (f->hessian[p][p] == 0.0 && f->gradient[p] == 0.0) {
        return 1;
    }
    return (at->theta[p] <= d->theta_low[p] && f->gradient[p] > 0.0) ||
           (at->theta[p] >= d->theta_high[p] && f->gradient[p] < 0.0);
}

/* One free coordinate. */
static double step_of_one(double h, double gradient, double damping)
{
    return -gradient / ((1.0 + damping) * (fabs(h) + 1e-300));
}

/* Two free coordinates p and q, in closed form. */
static void step_of_two(const struct varpro_value *f, int p, int q, double damping, double *step)
{
    double h00 = f->hessian[p][p], h11 = f->hessian[q][q], h01 = f->hessian[p][q], det, shift;

    /* Smallest eigenvalue of H decides how much has to be added. */
    shift = 0.5 * (h00 + h11) - sqrt(0.25 * (h00 - h11) * (h00 - h11) + h01 * h01);
    shift = fmax(0.0, -2.0 * shift) + 1e-14 * (fabs(h00) + fabs(h11)) + 1e-300;
    h00 = (h00 + shift) * (1.0 + damping);
    h11 = (h11 + shift) * (1.0 + damping);
    det = h00 * h11 - h01 * h01;
    if (!(det > 0.0)) {
        h01 = 0.0;
        det = h00 * h11;
    }
    step[p] = -(h11 * f->gradient[p] - h01 * f->gradient[q]) / det;
    step[q] = -(h00 * f->gradient[q] - h01 * f->gradient[p]) / det;
}

/* (H + shift) step = -gradient over the free coordinates by L D L'; 0 when that is not definite. */
static int solve_shifted(const struct varpro_value *f, const int *free, int n, double shift, double damping,
                         double *step)
{
    double lower[SIDES_MOST][SIDES_MOST], d[SIDES_MOST], z[SIDES_MOST];
    int i, j, k;

    for (j = 0; j < n; j++) {
        d[j] = (f->hessian[free[j]][free[j]] + shift) * (1.0 + damping);
        z[j] = -f->gradient[free[j]];
        for (k = 0; k < j; k++) {
            d[j] -= lower[j][k] * lower[j][k] * d[k];
            z[j] -= lower[j][k] * z[k];
        }
        if (!(d[j] > 0.0)) {
            return 0;
        }
        for (i = j + 1; i < n; i++) {
            lower[i][j] = f->hessian[free[i]][free[j]];
            for (k = 0; k < j; k++) {
                lower[i][j] -= lower[i][k] * lower[j][k] * d[k];
            }
            lower[i][j] /= d[j];
        }
    }
    for (j = n; j-- > 0;) {
        z[j] /= d[j];
        for (k = j + 1; k < n; k++) {
            z[j] -= lower[k][j] * z[k];
        }
        step[free[j]] = z[j];
    }
    return 1;
}

/* More of them: the least shift of a series that makes H definite. */
static void step_of_many(const struct varpro_value *f, const int *free, int n, double damping, double *step)
{
    double size = 0.0, shift;
    int i, j;

    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            size = fmax(size, fabs(f->hessian[free[i]][free[j]]));
        }
    }
    size += 1e-300;
    for (shift = 1e-14; shift < 1e3; shift *= 10.0) {
        if (solve_shifted(f, free, n, shift * size, damping, step)) {
            return;
        }
    }
    for (i = 0; i < n; i++) {
        step[free[i]] = step_of_one(size, f->gradient[free[i]], damping);
    }
}

/* Solve (H + damping) step = -gradient over the free coordinates, with H made positive definite. */
static void newton_step(const struct newton *d, const struct point *at, const struct varpro_value *f, double damping,
                        double *step)
{
    int free[SIDES_MOST], n = 0, p;

    for (p = 0; p < d->sides; p++) {
        step[p] = 0.0;
        if (!held(d, at, f, p)) {
            free[n++] = p;
        }
    }
    if (n == 1) {
        step[free[0]] = step_of_one(f->hessian[free[0]][free[0]], f->gradient[free[0]], damping);
    } else if (n == 2) {
        step_of_two(f, free[0], free[1], damping, step);
    } else if (n > 2) {
        step_of_many(f, free, n, damping, step);
    }
}

/* Limit, clamp and apply a step; returns its longest component, or 0 when it goes nowhere. */
static double move(const struct newton *d, const struct point *from, const double *step, struct point *to)
{
    double longest = 0.0;
    int p;

    for (p = 0; p < d->sides; p++) {
        double limited = step[p] > LONGEST_STEP ? LONGEST_STEP : step[p] < -LONGEST_STEP ? -LONGEST_STEP : step[p];

        if (!isfinite(limited)) {
            return 0.0;
        }
        to->theta[p] = clamp(d, p, from->theta[p] + limited);
        longest = fmax(longest, fabs(to->theta[p] - from->theta[p]));
    }
    return longest;
}

/* What a Newton step promises to lower the objective by. */
static double predicted(const struct newton *d, const struct varpro_value *f, const double *step)
{
    double promise = 0.0;
    int p;

    for (p = 0; p < d->sides; p++) {
        promise -= 0.5 * f->gradient[p] * step[p];
    }
    return promise;
}

/* A step whose gain the objective cannot show: the gradient still knows better where the optimum is. */
static double last_step(const struct newton *d, struct point *point, const double *step,
                        const struct varpro_value *here)
{
    struct varpro_value there;
    struct point next = *point;

    if (move(d, point, step, &next) > NEGLIGIBLE) {
        d->evaluate(d->self, &next, 0, &there);
        if (there.objective <= here->objective) {
            *point = next;
            return there.objective;
        }
    }
    return here->objective;
}

double brdffit_newton(const struct newton *d, struct point *point)
{
    struct varpro_value here, there;
    struct point next = *point;
    double damping = 0.0;
    int i;

    d->evaluate(d->self, point, 1, &here);
    for (i = 0; i < LIMIT_REFINE_STEPS && here.objective > 0.0; i++) {
        double step[SIDES_MOST], length, gained;

        newton_step(d, point, &here, damping, step);
        if (predicted(d, &here, step) <= fmax(d->least, TOL_FLAT_RELATIVE * LEAST_PART * here.objective)) {
            return last_step(d, point, step, &here);
        }
        length = move(d, point, step, &next);
        if (!(length > 0.0)) {
            break;
        }
        d->evaluate(d->self, &next, 1, &there);
        gained = here.objective - there.objective;
        if (gained > 0.0) {
            *point = next;
            here = there;
            damping = damping > 1e-3 ? damping / 10.0 : 0.0;
            if (length < SHORTEST_STEP && gained <= TOL_FLAT_RELATIVE * here.objective) {
                break;
            }
        } else if (length < SHORTEST_STEP) {
            break;
        } else {
            damping = damping > 0.0 ? damping * 10.0 : 1.0;
        }
    }
    return here.objective;
}
