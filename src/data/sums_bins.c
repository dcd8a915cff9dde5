/*
 * Groups of sums, and which of them the samples of binned ones go to. What bins do to a fit: sums_remainder.c.
 * SPDX-License-Identifier: MIT
 *
 * Nodes are the doubles with `bits` bits after the first, so that a sample's node and the next, and its shares of the
 * two (linear in c, positive, together 1), come out without rounding. The smallest c are not binned: lobes far narrower
 * than the rest see nothing else. They wait in ascending order, and the largest of them goes to its nodes when a smaller
 * one comes; all products but w^2 b^4 (of the effective number of samples only) are linear in w, so that this is what
 * its samples would have given one by one.
 */
#include <math.h>
#include <string.h>

#include "model/lobe.h"
#include "base/error.h"
#include "model/geometry.h"
#include "data/sums.h"

#define BITS_MOST 20
/* 2 to that: the narrowest cell. Node 0, below it, counts as a wide one, which errs on the safe side. */
#define LEAST (-1000)

size_t brdffit_sums_find(struct brdffit_sums *s, double c)
{
    uint64_t bits;
    size_t at;

    c += 0.0; /* -0 is 0 */
    if (s->recent < s->groups && s->c[s->recent] == c) {
        return s->recent;
    }
    memcpy(&bits, &c, sizeof bits);
    bits *= 0x9e3779b97f4a7c15u;
    for (at = (size_t)(bits >> 32) & (s->slots - 1); s->slot[at]; at = (at + 1) & (s->slots - 1)) {
        if (s->c[s->slot[at] - 1] == c) {
            return s->recent = s->slot[at] - 1;
        }
    }
    if (s->groups == s->capacity) {
        return s->capacity;
    }
    s->slot[at] = (uint32_t)(s->groups + 1);
    s->c[s->groups] = c;
    s->cell[s->groups].high = s->cell[s->groups].low = 0.0;
    memset(sums_group(s, s->groups), 0, SUMS_PRODUCTS(s->channels) * sizeof(struct sums_pair));
    return s->recent = s->groups++;
}

brdffit_status brdffit_sums_bins(brdffit_sums *s, int bits, brdffit_error *error)
{
    size_t g;

    if (!s || bits < 1 || bits > BITS_MOST) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "bins: sums is NULL, or bits are not in [1, 20]");
    }
    if (s->groups > 0 || s->bits) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "bins: the sums are not empty, or are binned already");
    }
    if (!brdffit_lobe_kind_of(s->distribution)->exponential) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "bins: the remainder is known for exponential lobes only");
    }
    if (s->capacity < 8) {
        return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE, "bins: fewer than 8 groups");
    }
    s->bits = bits;
    s->exact = s->capacity / 8 < BRDFFIT_SUMS_EXACT ? s->capacity / 8 : BRDFFIT_SUMS_EXACT;
    for (g = 0; g < s->exact; g++) {
        s->c[g] = INFINITY; /* an empty group without a lobe, until it is used */
        s->cell[g].high = s->cell[g].low = 0.0;
        memset(sums_group(s, g), 0, SUMS_PRODUCTS(s->channels) * sizeof(struct sums_pair));
    }
    s->groups = s->recent = s->exact;
    return BRDFFIT_OK;
}

double brdffit_sums_width(const struct brdffit_sums *s, double node)
{
    int exponent;

    (void)frexp(node, &exponent);
    return ldexp(1.0, exponent - 1 - s->bits > LEAST ? exponent - 1 - s->bits : LEAST);
}

/* Nodes of c > 0; 0 when there is no room for them. */
static int find_nodes(struct brdffit_sums *s, double c, struct sums_split *split)
{
    double width = brdffit_sums_width(s, c), low = floor(c / width) * width, above = (c - low) / width;

    split->group[0] = brdffit_sums_find(s, low);
    split->group[1] = above > 0.0 ? brdffit_sums_find(s, low + width) : split->group[0];
    split->share[0] = 1.0 - above;
    split->share[1] = above;
    return split->group[0] == s->capacity || split->group[1] == s->capacity ? 0 : above > 0.0 ? 2 : 1;
}

/* The largest of the exact c to its nodes; its group is empty then. 0 when there is no room. */
static int evict(struct brdffit_sums *s, size_t group)
{
    size_t i, n = SUMS_PRODUCTS(s->channels);
    struct sums_pair *from = sums_group(s, group);
    struct sums_split split;
    int part, parts = find_nodes(s, s->c[group], &split);

    for (part = 0; part < parts; part++) {
        struct sums_pair *to = sums_group(s, split.group[part]);

        sums_note_errors(&s->errors[split.group[part]], &s->errors[group]);
        for (i = 0; i < n; i++) {
            sums_add(&to[i], from[i].high * split.share[part]);
            to[i].low += from[i].low * split.share[part];
        }
    }
    if (parts > 0) {
        sums_add(&s->cell[split.group[0]], sums_value(&from[SUMS_BB]));
        memset(from, 0, n * sizeof *from);
        memset(&s->errors[group], 0, sizeof *s->errors);
    }
    return parts;
}

/* Place of the first exact c that is not below. */
static size_t place_of(const struct brdffit_sums *s, double c)
{
    size_t low = 0, high = s->exact_used;

    while (low < high) {
        size_t middle = (low + high) / 2;

        if (s->c[s->ascending[middle]] < c) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* An exact group for c, which is none yet; s->capacity when there is no room to evict another. */
static size_t insert(struct brdffit_sums *s, size_t place, double c)
{
    size_t group = s->exact_used;

    if (s->exact_used == s->exact) {
        group = s->ascending[s->exact - 1];
        if (!evict(s, group)) {
            return s->capacity;
        }
        s->exact_used--;
    }
    memmove(s->ascending + place + 1, s->ascending + place, (s->exact_used - place) * sizeof *s->ascending);
    s->ascending[place] = (uint32_t)group;
    s->exact_used++;
    s->c[group] = c;
    return group;
}

int brdffit_sums_split(struct brdffit_sums *s, double c, double bb, struct sums_split *split)
{
    size_t place;
    int parts;

    c += 0.0; /* -0 is 0 */
    place = place_of(s, c);
    if (place < s->exact_used || s->exact_used < s->exact) {
        int there = place < s->exact_used && s->c[s->ascending[place]] == c;

        split->group[0] = there ? s->ascending[place] : insert(s, place, c);
        split->share[0] = 1.0;
        return split->group[0] < s->capacity;
    }
    parts = find_nodes(s, c, split);
    if (parts > 0) {
        sums_add(&s->cell[split->group[0]], bb);
    }
    return parts;
}
