/*
 * Half angles that are one but for rounding. SPDX-License-Identifier: MIT
 */
#include "data/reduce_parts.h"

#include "base/tolerance.h"
#include "base/vector.h"

/* How far a half-vector angle may be from that of c and still be the same. */
static double snap_reach(double c)
{
    return (2.0 * sqrt(c) * (1.0 + c) + TOL_ANGLE) * TOL_ANGLE;
}

/* Smallest c of a geometry that is above `limit`; infinity when there is none. */
static double next_above(const struct reduced *r, const struct table *t, double limit)
{
    double next = INFINITY;
    size_t i;

    for (i = 0; i < r->used; i++) {
        next = t->sample_c[i] > limit ? smaller(next, t->sample_c[i]) : next;
    }
    return next;
}

/*
 * Largest change of c that joins c_min. The search looks at s up to TAIL_EXPONENT or so over the next c - c_min, where a
 * change of TOL_JOIN / s is nothing: that next c is the first one beyond reach.
 */
static double join_reach(const struct reduced *r, const struct table *t, double low, double s_end)
{
    double reach = snap_reach(low), next = next_above(r, t, low + reach);

    if (isfinite(next)) {
        s_end = smaller(s_end, 2.0 * TAIL_EXPONENT / (next - low));
    }
    return smaller(reach, TOL_JOIN / s_end);
}

/* Whether places p and q agree in the c of the geometries before g. */
static int agree_before(const struct reduced *r, int g, size_t p, size_t q)
{
    int h, same = 1;

    for (h = 0; h < g; h++) {
        same = same && r->table[h].sample_c[r->order[p]] == r->table[h].sample_c[r->order[q]];
    }
    return same;
}

/* Snap the c of one geometry among samples that agree in those before it. */
static void snap_table(struct reduced *r, int g, double s_end)
{
    struct table *t = &r->table[g];
    double low = g == 0 ? t->sample_c[r->order[0]] : next_above(r, t, -1.0), first = INFINITY, join;
    size_t place;

    join = isfinite(low) ? join_reach(r, t, low, s_end) : 0.0;
    for (place = 0; place < r->used; place++) {
        double *c = &t->sample_c[r->order[place]], change = *c - first;
        int fits = first == low ? change <= join : change <= snap_reach(first) && change <= TOL_SNAP * (first - low);

        if (!(fits && change >= 0.0) || place == 0 || !agree_before(r, g, place - 1, place)) {
            first = *c;
        } else if (change > 0.0) {
            t->snapped = first == low ? t->snapped : larger(t->snapped, change / (first - low));
            t->charge.c[r->order[place]] += change;
            t->charge.joined = first == low ? larger(t->charge.joined, change) : t->charge.joined;
            *c = first;
        }
    }
}

/* Second columns have the c of the first ones, changes and all. */
static void follow(const struct reduced *r, const struct table *first, struct table *t)
{
    size_t j;

    t->snapped = first->snapped;
    t->charge.joined = first->charge.joined;
    for (j = 0; j < r->used; j++) {
        if (t->sample_b[j] > 0.0) {
            t->sample_c[j] = first->sample_c[j];
            t->charge.c[j] = first->charge.c[j];
        }
    }
}

/*
 * Half-vector angles within TOL_ANGLE are one angle: mirror images of a direction differ in the last bits, and their
 * sums merge once they have one c; not where lobes of s <= s_end could tell them apart. The change is one more error of
 * that sample's c (charge.h), and relative to c - c_min it is kept for the moments.
 */
void brdffit_reduce_snap(struct reduced *r, const double *s_end)
{
    int g;

    for (g = 0; g < r->bases; g++) {
        if (g > 0) {
            brdffit_reduce_sort(r);
        }
        snap_table(r, g, s_end[g]);
    }
    for (; g < r->geometries; g++) {
        follow(r, &r->table[g - r->bases], &r->table[g]);
    }
    if (r->geometries > 1) {
        brdffit_reduce_sort(r);
    }
}

void brdffit_reduce_ends(const struct model *model, const brdffit_options *o, double *s_end)
{
    int kind, g;

    for (g = 0; g < model->geometries; g++) {
        s_end[g] = 0.0;
    }
    for (kind = 0; kind < model->kinds; kind++) {
        double end = model->kind[kind]->by_exponent ? o->exponent_max : 1.0 / (o->sigma_min * o->sigma_min);

        g = model->geometry[kind];
        s_end[g] = larger(s_end[g], end);
    }
}
