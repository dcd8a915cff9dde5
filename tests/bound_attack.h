/*
 * How bounds are attacked, shared by test_bound.c and test_bound_socp.c: the objective in long double from the
 * coefficients (a, b, c) themselves, and nasty boxes. SPDX-License-Identifier: MIT
 */
#ifndef BOUND_ATTACK_H
#define BOUND_ATTACK_H

#include <math.h>
#include <string.h>

#include "bound_case.h"
#include "fit/fit.h"

/* Min over z >= 0 of the objective at theta, in long double: supports enumerated on normalised columns. */
static inline long double attack_objective(const struct bound_case *c, const struct reduced *data, const double *theta)
{
    long double column[3][CASE_SAMPLES], sum = 0.0L;
    int lobes = c->lobes, n = (int)c->count, i, j, k, p;

    for (i = 0; i < n; i++) {
        column[0][i] = c->a[i];
    }
    for (p = 0; p < lobes; p++) {
        long double s = expl((long double)theta[p]), rest = 1.0L + data->table[0].c_min * s;

        for (i = 0; i < n; i++) {
            long double d = (long double)c->c[i] - data->table[0].c_min;

            column[1 + p][i] = c->distribution == BRDFFIT_GGX ? c->b[i] / powl(1.0L + d * s / rest, 2.0L)
                                                              : c->b[i] * expl(-d * s);
        }
    }
    for (j = 0; j <= lobes; j++) {
        long double norm = 0.0L;

        for (i = 0; i < n; i++) {
            norm += column[j][i] * column[j][i];
        }
        for (i = 0; i < n && norm > 0.0L; i++) {
            column[j][i] /= sqrtl(norm);
        }
    }
    for (k = 0; k < (int)c->channels; k++) {
        sum += case_nnls(c, data->channel_scale[k] * data->value_scale, k, lobes + 1, column);
    }
    return sum;
}

static inline void attack_set_side(struct axis *axis, uint32_t interval, uint32_t node, const double *range)
{
    axis->interval[interval].low = node;
    axis->interval[interval].high = node + 1;
    axis->interval[interval].child = 0;
    axis->coordinate[node] = range[0];
    axis->coordinate[node + 1] = range[1];
}

/* Boxes of a problem: around its optimum, on the diagonal, disjoint, wide, a hair wide. */
static inline void attack_draw_box(const struct fit *f, const struct point *optimum, int lobes, double range[2][2],
                                   uint64_t *s)
{
    double low = f->domain[0].low, high = f->domain[0].high, swap;
    int p, kind = (int)(case_next(s) % 4);

    for (p = 0; p < 2; p++) {
        double width = (high - low) * pow(10.0, -13.0 * pow(case_uniform(s), 2.0));
        double centre = kind < 2 ? optimum->theta[lobes > 1 ? p : 0] + width * case_signed(s)
                                 : low + (high - low) * case_uniform(s);

        range[p][0] = fmin(fmax(centre - width * case_uniform(s), low), high);
        range[p][1] = fmin(fmax(centre + width * case_uniform(s), range[p][0]), high);
    }
    if (kind == 3) {
        memcpy(range[1], range[0], sizeof range[0]);
        return;
    }
    if (range[0][0] > range[1][0]) {
        for (p = 0; p < 2; p++) {
            swap = range[0][p];
            range[0][p] = range[1][p];
            range[1][p] = swap;
        }
    }
    /* The engine's boxes are disjoint or equal. */
    range[0][1] = fmin(range[0][1], range[1][0]);
}

#endif
