/*
 * Random problems, fitted and judged, and what was found of each family. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_CAMPAIGN_RUN_H
#define BRDFFIT_TESTS_CAMPAIGN_RUN_H

#include "draw.h"
#include "attack.h"

#define CAMPAIGN_FAMILIES 24

struct campaign {
    uint64_t seed;
    unsigned long from, count; /* problems by number; problem n is of family n mod draw_family_count */
    int family;                /* only this one; -1: all */
    size_t effort;             /* evaluations of E^2 a fit */
    size_t budget;             /* boxes of a fit of one lobe, at most; fewer for dearer boxes; 0: as drawn */
    size_t boxes, proofs;      /* one fit in so many has its boxes attacked, and a level proven; 0: none */
    int print;                 /* faulty problems to print in full, of each family and kind of fault */
    const char *keep;          /* folder for all of them, or NULL */
    unsigned long progress;    /* a line on stderr after so many problems; 0: none */
    FILE *out;
};

struct campaign_row {
    unsigned long fits, refused, certified, faulty;
    unsigned long fault[JUDGE_COUNT];
    double worst[JUDGE_COUNT];
    double worst_total;             /* bound: relative to the zero model */
    unsigned long where[JUDGE_COUNT]; /* the problem that is worst */
};

void campaign_defaults(struct campaign *c);

/* row: CAMPAIGN_FAMILIES of them, one a family. Returns how many fits are faulty. */
unsigned long campaign_run(const struct campaign *c, struct campaign_row *row);

/* The problem in a file of draw_print()'s, boxes of it and proofs of a level too; describes what is at fault in `text`. Returns how many
 * kinds of faults there are, or -1 when the file cannot be read or the fit is refused. */
int campaign_replay(const char *path, char *text, size_t size);

/* A line a family and kind of fault. */
void campaign_table(const struct campaign_row *row, FILE *to);

#endif
