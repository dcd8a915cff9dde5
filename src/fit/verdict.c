/*
 * What may be claimed of a fit: see verdict.h. SPDX-License-Identifier: MIT
 *
 * The truth E^2 of the model lies in [e2 - error, e2 + error], and no model has less than `bound`. So
 *
 *     bound > e2 + error                        one of the two is false, and nobody knows which: nothing is proven
 *     e2 + error <= (1 + relative_gap) bound    certified, whatever made the search end
 *     e2 + error - bound <= absolute_gap total  the same
 *     otherwise                                 open, for the reason that the search ended; when that was a gap, what
 *                                               it saw closed is open by rounding
 *
 * A bound that is above e2, but not beyond its error, is lowered to it, so that a gap is never negative. Comparisons
 * have their own rounding on the careful side, a few u of what they compare; numbers near the smallest are scaled up
 * first (exactly), where a rounding would be no small part of them.
 */
#include "fit/verdict.h"

#include <math.h>

#include "base/tolerance.h"

/* Rounding of the comparisons below: four operations. */
#define CAREFUL (8.0 * TOL_UNIT)
/* Numbers below the first are multiplied by the second. */
#define SMALL 1e-200
#define LARGER 0x1p600

static int is_number(double x)
{
    return x >= 0.0 && isfinite(x);
}

static int closes(const struct evidence *v, double unit, int relative)
{
    double bound = v->bound * unit, most = (v->e2 * unit + v->error * unit) * (1.0 + CAREFUL);
    double room = relative                ? bound * v->relative_gap
                  : v->absolute_gap > 0.0 ? v->absolute_gap * (v->total * unit)
                                          : 0.0;

    if (!is_number(most) || !(room >= 0.0)) {
        return 0;
    }
    return most - bound <= room * (1.0 - CAREFUL) || most <= bound;
}

static int closes_relative(const struct evidence *v, double unit)
{
    return is_number(v->relative_gap) && closes(v, unit, 1);
}

static int closes_absolute(const struct evidence *v, double unit)
{
    return is_number(v->absolute_gap) && is_number(v->total) && closes(v, unit, 0);
}

static struct verdict open_because(brdffit_stop ended)
{
    struct verdict out = {ended, 0, 0.0, INFINITY};

    if (ended == BRDFFIT_STOP_RELATIVE_GAP || ended == BRDFFIT_STOP_ABSOLUTE_GAP ||
        !((unsigned)ended < BRDFFIT_STOP_COUNT)) {
        out.stop = BRDFFIT_STOP_ROUNDING;
    }
    return out;
}

struct verdict brdffit_verdict(const struct evidence *evidence)
{
    struct evidence v = *evidence;
    struct verdict out = open_because(v.ended);
    double unit = v.e2 + v.error < SMALL ? LARGER : 1.0; /* where total times that overflows, any gap is wide enough */

    if (v.ended == BRDFFIT_STOP_CONTRADICTION) {
        v.bound = 0.0;
    }
    v.error = v.error >= 0.0 ? v.error : (double)INFINITY;
    if (!is_number(v.e2)) {
        return out;
    }
    if (v.bound > (v.e2 + v.error) * (1.0 + CAREFUL)) {
        out.stop = BRDFFIT_STOP_CONTRADICTION;
        out.gap = v.e2;
        return out;
    }
    v.bound = is_number(v.bound) ? v.bound : 0.0;
    if (v.ended != BRDFFIT_STOP_CONTRADICTION && (closes_relative(&v, unit) || closes_absolute(&v, unit))) {
        out.stop = closes_relative(&v, unit) ? BRDFFIT_STOP_RELATIVE_GAP : BRDFFIT_STOP_ABSOLUTE_GAP;
        out.certified = 1;
    }
    out.lower_bound = v.bound < v.e2 ? v.bound : v.e2;
    out.gap = v.e2 - out.lower_bound;
    return out;
}
