/*
 * Damped Newton descent: see newton.h. SPDX-License-Identifier: MIT
 *
 * Only a way to better incumbents: nothing that is proven depends on it. It never returns a point worse than its
 * start. The domain is a square; a coordinate at its edge whose gradient points outwards is held.
 */
#include <math.h>

#include "solve/newton.h"
#include "base/tolerance.h"

/* Longest step in theta = ln s. */
#define LONGEST 1.5
/* Steps below this that no longer lower the objective are the end: sigma is then good to rounding. */
#define SHORTEST 1e-8
/* A last step shorter than this is not taken: sigma is good to 1e-10. */
#define NEGLIGIBLE 1e-10
/* Gains below this part of TOL_FLAT_RELATIVE drown in the objective's rounding. */
#define LEAST_PART 1e-3

static double clamp(const struct newton *d, double theta)
{
    return theta < d->theta_low ? d->theta_low : theta > d->theta_high ? d->theta_high : theta;
}

static int held(const struct newton *d, const struct point *at, const struct varpro_value *f, int p)
{
    if (f->hessian[p][p] == 0.0 && f->gradient[p] == 0.0) {
        return 1;
    }
    return (at->theta[p] <= d->theta_low && f->gradient[p] > 0.0) ||
           (at->theta[p] >= d->theta_high && f->gradient[p] < 0.0);
}

/* Solve (H + damping) step = -gradient over the free coordinates, with H made positive definite. */
static void newton_step(const struct newton *d, const struct point *at, const struct varpro_value *f, double damping,
                        double step[2])
{
    double h00 = f->hessian[0][0], h11 = f->hessian[1][1], h01 = f->hessian[0][1], det, shift;
    int hold0 = held(d, at, f, 0), hold1 = d->lobes < 2 || held(d, at, f, 1);

    step[0] = step[1] = 0.0;
    if (hold0 || hold1) {
        int p = hold0 ? 1 : 0;

        if (!(hold0 && hold1)) {
            step[p] = -f->gradient[p] / ((1.0 + damping) * (fabs(f->hessian[p][p]) + 1e-300));
        }
        return;
    }
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
    step[0] = -(h11 * f->gradient[0] - h01 * f->gradient[1]) / det;
    step[1] = -(h00 * f->gradient[1] - h01 * f->gradient[0]) / det;
}

/* Limit, clamp and apply a step; returns its longest component, or 0 when it goes nowhere. */
static double move(const struct newton *d, const struct point *from, const double step[2], struct point *to)
{
    double longest = 0.0;
    int p;

    for (p = 0; p < d->lobes; p++) {
        double limited = step[p] > LONGEST ? LONGEST : step[p] < -LONGEST ? -LONGEST : step[p];

        if (!isfinite(limited)) {
            return 0.0;
        }
        to->theta[p] = clamp(d, from->theta[p] + limited);
        longest = fmax(longest, fabs(to->theta[p] - from->theta[p]));
    }
    return longest;
}

/* What a Newton step promises to lower the objective by. */
static double predicted(const struct newton *d, const struct varpro_value *f, const double step[2])
{
    double promise = -0.5 * f->gradient[0] * step[0];

    return d->lobes > 1 ? promise - 0.5 * f->gradient[1] * step[1] : promise;
}

/* A step whose gain the objective cannot show: the gradient still knows better where the optimum is. */
static double last_step(const struct newton *d, struct point *point, const double step[2],
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
        double step[2], length, gained;

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
            if (length < SHORTEST && gained <= TOL_FLAT_RELATIVE * here.objective) {
                break;
            }
        } else if (length < SHORTEST) {
            break;
        } else {
            damping = damping > 0.0 ? damping * 10.0 : 1.0;
        }
    }
    return here.objective;
}
