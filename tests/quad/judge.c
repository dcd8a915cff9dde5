/*
 * See judge.h. SPDX-License-Identifier: MIT
 */
#include "judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Tolerances of e2, relative to itself and to the zero model, and of channel_scale and sum_of_squares. */
#define E2_RELATIVE 1e-9
#define E2_ABSOLUTE 1e-13
#define SCALE_RELATIVE 1e-12
/* A stopping rule is a comparison in double: a few units of rounding. Beyond that, what verify.c leaves to e2, which is
 * evaluated again after the stop. */
#define GAP_RELATIVE 1e-15
#define GAP_AFTER_RELATIVE 1e-12
#define GAP_AFTER_ABSOLUTE 1e-27
#define GAP_AFTER_LINEAR 1e-14 /* L1 and LINF, which do not square */

static const char *const names[JUDGE_COUNT] = {"bound", "e2",    "gap",  "gap_round", "order", "range",
                                               "nan",   "scale", "used", "box",       "proof"};

const char *judge_fault_string(enum judge_fault fault)
{
    return names[fault];
}

static void fault(struct judgement *out, enum judge_fault kind, quad size)
{
    out->fault[kind] = 1;
    out->worst[kind] = fmax(out->worst[kind], (double)size);
}

static void judge_numbers(const struct fit_view *v, struct judgement *out)
{
    size_t i, n = v->channels * (size_t)(v->fixed + v->lobes); /* x, and y after it */
    int fine = v->lower_bound >= 0.0 && v->lower_bound <= v->e2 && v->e2 < INFINITY && v->gap == v->e2 - v->lower_bound;

    for (i = 0; i < n; i++) {
        fine = fine && v->x[i] >= 0.0 && v->x[i] < INFINITY;
    }
    for (i = 0; v->f0 && i < v->channels * (size_t)v->lobes; i++) {
        fine = fine && v->f0[i] >= 0.0 && v->f0[i] <= 1.0 && (v->y[i] > 0.0 || v->f0[i] == 0.0);
    }
    if (v->nans) {
        fault(out, JUDGE_NAN, v->nans);
    } else if (!fine) {
        fault(out, JUDGE_ORDER, 0);
    }
}

static void judge_range(const struct fit_view *v, const struct fit_question *q, struct judgement *out)
{
    const brdffit_options *o = &q->options;
    int j;

    for (j = 0; j < v->lobes; j++) {
        int exponent = quad_by_exponent(q->distribution[j]);
        double low = exponent ? 1.0 / sqrt(o->exponent_max) : o->sigma_min;
        double high = exponent ? 1.0 / sqrt(o->exponent_min) : o->sigma_max;

        int disorder = j && q->distribution[j] == q->distribution[j - 1] && v->sigma[j] < v->sigma[j - 1];

        if (!(v->sigma[j] >= low && v->sigma[j] <= high) || disorder) {
            fault(out, JUDGE_RANGE, 0);
        }
    }
}

static void judge_scale(const struct fit_view *v, const struct fit_question *q, struct quad_problem *p,
                        struct judgement *out)
{
    size_t k;

    for (k = 0; k < p->channels; k++) {
        quad right = q->options.normalise == BRDFFIT_NORMALISE_NONE ? 0 : quad_largest(p, k);

        right = right > 0 ? right : 1;
        if (!(fabsq(v->scale[k] - right) <= SCALE_RELATIVE * right)) {
            fault(out, JUDGE_SCALE, fabsq(v->scale[k] / right - 1));
        }
    }
    quad_scale(p, v->scale);
    if (!(fabsq(v->sum_of_squares - p->total) <= SCALE_RELATIVE * p->total + 1e-307)) {
        fault(out, JUDGE_SCALE, p->total > 0 ? fabsq(v->sum_of_squares / p->total - 1) : 1);
    }
}

static void judge_e2(const struct fit_view *v, const struct quad_problem *p, struct judgement *out)
{
    quad e2 = quad_at_model(p, v->sigma, v->x, v->y, v->f0), off = fabsq(e2 - v->e2);

    out->e2 = (double)e2;
    if (!(off <= E2_RELATIVE * e2 + E2_ABSOLUTE * p->total + v->e2_error)) {
        fault(out, JUDGE_E2, off / fmaxq(e2, 1e-300));
    }
}

static void judge_gap(const struct fit_view *v, const struct fit_question *q, struct judgement *out)
{
    quad e2 = (quad)v->e2 + (v->binned ? v->e2_error : 0.0), allowed;

    if (!v->certified) {
        return;
    }
    allowed = v->stop == BRDFFIT_STOP_RELATIVE_GAP
                  ? (1 + (quad)q->options.relative_gap) * v->lower_bound
                  : (quad)v->lower_bound + (quad)q->options.absolute_gap * v->sum_of_squares;
    if (v->stop != BRDFFIT_STOP_RELATIVE_GAP && v->stop != BRDFFIT_STOP_ABSOLUTE_GAP) {
        fault(out, JUDGE_GAP, 1);
    } else if (!(e2 <= allowed * (1 + GAP_RELATIVE))) {
        quad rounding = q->options.norm == BRDFFIT_NORM_L2 ? GAP_AFTER_ABSOLUTE : GAP_AFTER_LINEAR;

        rounding = GAP_AFTER_RELATIVE * e2 + rounding * v->sum_of_squares;
        fault(out, e2 - allowed <= rounding ? JUDGE_GAP_ROUND : JUDGE_GAP, (e2 - allowed) / e2);
    }
}

static void no_lobes(struct quad_problem *p)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        memset(p->lobe[j].b, 0, p->count * sizeof *p->lobe[j].b);
    }
}

/* The lower bound against the reported point, what it descends to, and a scan. */
static void judge_bound(const struct fit_view *v, const struct fit_question *q, struct quad_problem *p, size_t effort,
                        struct judgement *out)
{
    static const int points[2][QUAD_LOBES] = {{24, 9, 5}, {8, 5, 3}};
    struct quad_domain domain;
    struct quad_search search;
    quad s[QUAD_LOBES] = {1, 1, 1}, over;
    int j;

    if (!quad_domain_of(p, &q->options, v->sigma_floor, &domain)) {
        no_lobes(p); /* all are outside of the model */
        quad_domain_of(p, &q->options, 0.0, &domain);
    }
    for (j = 0; j < p->lobes; j++) {
        s[j] = quad_s(v->sigma[j]);
    }
    quad_search_begin(&search, p, &domain, effort / 2);
    quad_descend(&search, s);
    search.limit = effort;
    quad_scan(&search, points[p->norm != BRDFFIT_NORM_L2][p->lobes - 1]);
    out->best = (double)search.best;
    for (j = 0; j < p->lobes; j++) {
        out->s[j] = (double)search.s[j];
    }
    over = v->lower_bound - search.best;
    if (over > QUAD_RELATIVE * search.best + QUAD_ABSOLUTE * p->total) {
        fault(out, JUDGE_BOUND, search.best > 0 ? over / search.best : 1);
        out->excess_total = (double)(over / p->total);
    }
}

int judge(const struct fit_view *v, const struct fit_question *q, size_t effort, struct judgement *out)
{
    struct quad_problem p;
    int kinds = 0, kind;

    memset(out, 0, sizeof *out);
    if (v->status != BRDFFIT_OK) {
        out->refused = 1;
        return 0;
    }
    if (quad_problem_new(&p, q->samples, &q->options, q->lobes, q->distribution)) {
        abort();
    }
    judge_numbers(v, out);
    judge_range(v, q, out);
    judge_gap(v, q, out);
    if (v->used && v->used != p.count) { /* 0: not told */
        if (!p.doubtful) {
            fault(out, JUDGE_USED, 0);
        }
    } else {
        judge_scale(v, q, &p, out);
        judge_e2(v, &p, out);
        judge_bound(v, q, &p, effort, out);
    }
    quad_problem_free(&p);
    for (kind = 0; kind < JUDGE_COUNT; kind++) {
        kinds += out->fault[kind];
    }
    return kinds;
}

void judge_describe(const struct judgement *j, const struct fit_view *v, char *text, size_t size)
{
    size_t used = 0;
    int kind;

    text[0] = '\0';
    for (kind = 0; kind < JUDGE_COUNT && used < size; kind++) {
        if (j->fault[kind]) {
            used += (size_t)snprintf(text + used, size - used, "%s by %.3g; ", names[kind], j->worst[kind]);
        }
    }
    if (used < size && j->fault[JUDGE_BOX]) {
        used += (size_t)snprintf(text + used, size - used, "box [%.17g, %.17g] x [%.17g, %.17g]: %.17g above %.17g; ",
                                 j->box.sigma_low[0], j->box.sigma_high[0], j->box.sigma_low[1], j->box.sigma_high[1],
                                 j->box.lower_bound, j->box_best);
    }
    if (used < size) {
        snprintf(text + used, size - used,
                 "lower_bound %.17g, least E^2 found %.17g at s %.17g %.17g %.17g (over by %.3g of the zero model); e2 "
                 "%.17g +- %.3g, at the parameters %.17g; certified %d (%s), sigma %.17g %.17g %.17g, floor %.17g",
                 v->lower_bound, j->best, j->s[0], j->s[1], j->s[2], j->excess_total, v->e2, v->e2_error, j->e2,
                 v->certified, brdffit_stop_string(v->stop), v->sigma[0], v->sigma[1], v->sigma[2], v->sigma_floor);
    }
}
