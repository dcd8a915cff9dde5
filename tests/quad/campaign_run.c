/*
 * See campaign_run.h. SPDX-License-Identifier: MIT
 */
#include "campaign_run.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_TEXELS 64
/* The reported point, a few of its neighbours and of the domain. */
#define EFFORT_LEAST 16

void campaign_defaults(struct campaign *c)
{
    memset(c, 0, sizeof *c);
    c->seed = 1;
    c->family = -1;
    c->effort = 200;
    c->boxes = 16;
    c->proofs = 32;
    c->print = 1;
    c->out = stdout;
}

/* Numbers of problems are independent of each other: any one can be had alone. */
static uint64_t seed_of(const struct campaign *c, unsigned long n)
{
    struct draw d;

    memset(&d, 0, sizeof d);
    d.state = c->seed * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)n * UINT64_C(0xd1b54a32d192ed03);
    (void)draw_bits(&d);
    return draw_bits(&d);
}

/* Problems with many channels get fewer evaluations, L1 and LINF too: theirs are dear. */
static size_t effort_of(const struct campaign *c, const struct draw *d)
{
    size_t cost = d->samples.count * d->samples.channels, effort = c->effort;

    if (d->question.options.norm != BRDFFIT_NORM_L2) {
        effort = effort / 3;
    }
    if (cost > 200) {
        effort = effort * 200 / cost;
    }
    return effort < EFFORT_LEAST ? EFFORT_LEAST : effort;
}

/* Boxes of several lobes, of many channels and of cone programs are dear: a search cut short claims a bound all the same. */
static void limit_boxes(const struct campaign *c, struct fit_question *q)
{
    size_t dear = q->options.engine == BRDFFIT_ENGINE_MOMENT && q->options.norm == BRDFFIT_NORM_L2 ? 1 : 20;
    size_t most = c->budget / (dear * (size_t)(q->lobes * q->lobes) * (1 + q->samples->channels / 8));

    if (c->budget && q->options.box_budget > most) {
        q->options.box_budget = most + 1;
    }
}

static size_t fit(const struct draw *d, struct fit_view *views)
{
    switch (d->route) {
    case DRAW_SUMS:
    case DRAW_BINS: fit_view_sums(views, &d->question, d->groups, d->bits); return 1;
    case DRAW_MANY: fit_view_many(views, d->texels, d->values, &d->question); return d->texels;
    default: fit_view_new(views, &d->question); return 1;
    }
}

static void attack(const struct campaign *c, struct draw *d, struct judgement *verdict)
{
    if (d->route != DRAW_FIT || d->samples.channels > 8) {
        return;
    }
    if (c->boxes && draw_one_in(d, c->boxes)) {
        attack_boxes(&d->question, draw_bits(d), effort_of(c, d) * 4, verdict);
    }
    if (c->proofs && d->question.options.norm == BRDFFIT_NORM_L2 && draw_one_in(d, c->proofs)) {
        attack_proof(&d->question, verdict->best * (1.0 + draw_power(d, -12.0, -1.0)) + DBL_MIN, verdict);
    }
}

static void print(const struct campaign *c, const struct draw *d, size_t texel, const struct fit_view *view,
                  const struct judgement *verdict, unsigned long n, const char *family, FILE *to)
{
    char text[2048];

    judge_describe(verdict, view, text, sizeof text);
    fprintf(to, "# campaign %llu 1 --from %lu --family %s --effort %zu --budget %zu: texel %zu: %s\n",
            (unsigned long long)c->seed, n, family, c->effort, c->budget, texel, text);
    draw_print(d, texel, to);
    fflush(to);
}

static void keep(const struct campaign *c, const struct draw *d, size_t texel, const struct fit_view *view,
                 const struct judgement *verdict, unsigned long n, const char *family)
{
    char path[4096];
    FILE *file;

    snprintf(path, sizeof path, "%s/%s_%llu_%lu_%zu.csv", c->keep, family, (unsigned long long)c->seed, n, texel);
    file = fopen(path, "w");
    if (file) {
        print(c, d, texel, view, verdict, n, family, file);
        fclose(file);
    }
}

/* Count; returns whether this is among the first of its kind. */
static int note(const struct campaign *c, struct campaign_row *row, const struct judgement *verdict, unsigned long n)
{
    int kind, first = 0;

    for (kind = 0; kind < JUDGE_COUNT; kind++) {
        if (!verdict->fault[kind]) {
            continue;
        }
        first |= row->fault[kind]++ < (unsigned long)c->print;
        if (row->fault[kind] == 1 || verdict->worst[kind] > row->worst[kind]) {
            row->worst[kind] = verdict->worst[kind];
            row->where[kind] = n;
        }
    }
    row->worst_total = fmax(row->worst_total, verdict->excess_total);
    return first;
}

static int faulty(const struct judgement *verdict)
{
    int kind, any = 0;

    for (kind = 0; kind < JUDGE_COUNT; kind++) {
        any |= verdict->fault[kind];
    }
    return any;
}

static void problem(const struct campaign *c, unsigned long n, int family, struct campaign_row *row)
{
    struct fit_view views[MOST_TEXELS];
    struct judgement verdict;
    struct draw d;
    size_t t, count, length;

    draw_problem(&d, &draw_families[family], seed_of(c, n));
    limit_boxes(c, &d.question);
    length = d.samples.count * d.samples.channels;
    count = fit(&d, views);
    for (t = 0; t < count; t++) {
        d.samples.values = d.values + t * length;
        (void)judge(&views[t], &d.question, effort_of(c, &d), &verdict);
        if (!verdict.refused) {
            attack(c, &d, &verdict);
        }
        row->fits++;
        row->refused += (unsigned long)verdict.refused;
        row->certified += (unsigned long)(!verdict.refused && views[t].certified);
        if (faulty(&verdict)) {
            row->faulty++;
            if (note(c, row, &verdict, n)) {
                print(c, &d, t, &views[t], &verdict, n, draw_families[family].name, c->out);
            }
            if (c->keep) {
                keep(c, &d, t, &views[t], &verdict, n, draw_families[family].name);
            }
        }
        fit_view_free(&views[t]);
    }
    draw_free(&d);
}

unsigned long campaign_run(const struct campaign *c, struct campaign_row *row)
{
    unsigned long n, all = 0;
    int f;

    memset(row, 0, CAMPAIGN_FAMILIES * sizeof *row);
    for (n = c->from; n < c->from + c->count; n++) {
        f = c->family >= 0 ? c->family : (int)(n % (unsigned long)draw_family_count);
        problem(c, n, f, &row[f]);
        if (c->progress && (n - c->from + 1) % c->progress == 0) {
            fprintf(stderr, "%lu of %lu\n", n - c->from + 1, c->count);
            campaign_table(row, stderr);
        }
    }
    for (f = 0; f < draw_family_count; f++) {
        all += row[f].faulty;
    }
    return all;
}

int campaign_replay(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    struct judgement verdict;
    struct fit_view view;
    struct draw d;
    int faults = -1, kind;

    memset(&verdict, 0, sizeof verdict);
    snprintf(text, size, "no problem in %s", path);
    if (file && draw_read(&d, file)) {
        (void)fit(&d, &view);
        (void)judge(&view, &d.question, 400, &verdict);
        if (!verdict.refused && d.route == DRAW_FIT) {
            attack_boxes(&d.question, 1, 1600, &verdict);
            attack_proof(&d.question, verdict.best * (1.0 + 1e-6), &verdict);
            attack_proof(&d.question, verdict.best * 1.05, &verdict);
        }
        for (kind = 0, faults = verdict.refused ? -1 : 0; kind < JUDGE_COUNT; kind++) {
            faults += verdict.fault[kind];
        }
        if (verdict.refused) {
            snprintf(text, size, "refused: %s", view.message);
        } else {
            judge_describe(&verdict, &view, text, size);
        }
        fit_view_free(&view);
        draw_free(&d);
    }
    if (file) {
        fclose(file);
    }
    return faults;
}

void campaign_table(const struct campaign_row *row, FILE *to)
{
    int f, kind;

    fprintf(to, "%-12s %8s %8s %9s %8s  %s\n", "family", "fits", "refused", "certified", "faulty",
            "fault: how many, worst (relative; bound: of the zero model too), in problem");
    for (f = 0; f < draw_family_count; f++) {
        const struct campaign_row *r = &row[f];

        if (!r->fits) {
            continue;
        }
        fprintf(to, "%-12s %8lu %8lu %9lu %8lu ", draw_families[f].name, r->fits, r->refused, r->certified, r->faulty);
        for (kind = 0; kind < JUDGE_COUNT; kind++) {
            if (r->fault[kind]) {
                fprintf(to, " %s: %lu, %.2g", judge_fault_string((enum judge_fault)kind), r->fault[kind],
                        r->worst[kind]);
                if (kind == JUDGE_BOUND) {
                    fprintf(to, " (%.2g)", r->worst_total);
                }
                fprintf(to, ", %lu;", r->where[kind]);
            }
        }
        fputc('\n', to);
    }
}
