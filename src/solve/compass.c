/*
 * Descent without derivatives: see compass.h. SPDX-License-Identifier: MIT
 */
#include "solve/compass.h"

#include <math.h>

/* First step in theta = ln s, and the relative one that ends the descent. */
#define LONGEST 0.25
#define SHORTEST 1e-15

int brdffit_compass_try(struct compass *d, const struct point *there)
{
    struct point next = *there;
    double objective;
    int p, moved = 0;

    for (p = 0; p < d->sides; p++) {
        next.theta[p] = fmin(d->theta_high[p], fmax(d->theta_low[p], next.theta[p]));
        moved = moved || next.theta[p] != d->at->theta[p];
    }
    if (!moved || d->left <= 0) {
        return 0;
    }
    d->left--;
    objective = d->evaluate(d->self, &next);
    if (!(objective < d->objective)) {
        return 0;
    }
    d->objective = objective;
    *d->at = next;
    return 1;
}

/* Ways to go: both along each side, then the four diagonals of each pair of sides. */
#define WAYS_MOST (2 * SIDES_MOST + 2 * SIDES_MOST * (SIDES_MOST - 1))

struct ways {
    int count;
    signed char to[WAYS_MOST][SIDES_MOST];
};

static void add_way(struct ways *w, int p, int up, int q, int up_too)
{
    int i;

    for (i = 0; i < SIDES_MOST; i++) {
        w->to[w->count][i] = (signed char)(i == p ? up : i == q ? up_too : 0);
    }
    w->count++;
}

static struct ways all_ways(int sides)
{
    struct ways w = {.count = 0};
    int p, q;

    for (p = 0; p < sides; p++) {
        add_way(&w, p, 1, -1, 0);
        add_way(&w, p, -1, -1, 0);
    }
    for (p = 0; p < sides; p++) {
        for (q = p + 1; q < sides; q++) {
            add_way(&w, p, 1, q, 1);
            add_way(&w, p, -1, q, -1);
            add_way(&w, p, 1, q, -1);
            add_way(&w, p, -1, q, 1);
        }
    }
    return w;
}

/*
 * Compass search: steps along the axes and diagonals, doubled where they lead down and halved where none does. The
 * objective has kinks, so derivatives would not help; at a kink halving still gains a bit a round.
 */
void brdffit_compass(struct compass *d)
{
    const int sides = d->sides;
    const struct ways ways = all_ways(sides);
    double step = LONGEST;
    int last = 0, i, p;

    while (d->left > 0 && d->objective > 0.0 && step > SHORTEST * (1.0 + fabs(d->at->theta[0]))) {
        int down = 0;

        for (i = 0; i < ways.count && !down; i++) {
            int way = (last + i) % ways.count;
            struct point there = *d->at;

            for (p = 0; p < sides; p++) {
                there.theta[p] += step * ways.to[way][p];
            }
            down = brdffit_compass_try(d, &there);
            last = down ? way : last;
        }
        step = down ? fmin(2.0 * step, LONGEST) : 0.5 * step;
    }
}
