/*
 * See attack.h. SPDX-License-Identifier: MIT
 */
#include "attack.h"

#include <stdlib.h>
#include <string.h>

#define BOXES 16
/* Sides of a box are s of the search turned into sigma and rounded: stay this far inside. */
#define INSIDE 1e-15

static void attack_box(const struct quad_problem *p, const struct fit_box *box, size_t effort, struct judgement *out)
{
    struct quad_domain domain;
    struct quad_search search;
    quad s[QUAD_LOBES] = {1, 1, 1}, over;
    int j, corner;

    for (j = 0; j < p->lobes; j++) {
        domain.low[j] = quad_s(box->sigma_high[j]) * (1 + (quad)INSIDE);
        domain.high[j] = quad_s(box->sigma_low[j]) * (1 - (quad)INSIDE);
        if (!(domain.low[j] <= domain.high[j])) {
            return;
        }
    }
    quad_search_begin(&search, p, &domain, effort / 2);
    for (corner = 0; corner < 1 << p->lobes; corner++) {
        for (j = 0; j < p->lobes; j++) {
            s[j] = corner & (1 << j) ? domain.high[j] : domain.low[j];
        }
        (void)quad_try(&search, s);
    }
    memcpy(s, search.s, sizeof s);
    quad_descend(&search, s);
    for (j = 0; j < p->lobes; j++) {
        s[j] = sqrtq(domain.low[j] * domain.high[j]);
    }
    search.limit = effort;
    quad_descend(&search, s);
    over = box->lower_bound - search.best;
    if (over > QUAD_RELATIVE * search.best + QUAD_ABSOLUTE * p->total) {
        double size = search.best > 0 ? (double)(over / search.best) : 1.0;

        if (!out->fault[JUDGE_BOX] || size > out->worst[JUDGE_BOX]) {
            out->worst[JUDGE_BOX] = size;
            out->box = *box;
            out->box_best = (double)search.best;
        }
        out->fault[JUDGE_BOX] = 1;
    }
}

void attack_boxes(const struct fit_question *q, unsigned long long seed, size_t effort, struct judgement *out)
{
    struct fit_box boxes[BOXES];
    struct quad_problem p;
    struct fit_view view;
    size_t count, i;

    memset(boxes, 0, sizeof boxes);
    count = fit_view_boxes(q, boxes, BOXES, seed);
    fit_view_new(&view, q);
    if (view.status == BRDFFIT_OK && !quad_problem_new(&p, q->samples, &q->options, q->lobes, q->distribution)) {
        if (p.count == view.used) {
            quad_scale(&p, view.scale);
            for (i = 0; i < count; i++) {
                attack_box(&p, &boxes[i], effort / BOXES + 16, out);
            }
        }
        quad_problem_free(&p);
    }
    fit_view_free(&view);
}

void attack_proof(const struct fit_question *q, double level, struct judgement *out)
{
    struct fit_question asked = *q;

    asked.options.box_budget = 300;
    if (level > out->best && level > 0.0 && fit_view_proves(&asked, level)) {
        out->fault[JUDGE_PROOF] = 1;
        out->worst[JUDGE_PROOF] = level / out->best - 1.0;
    }
}
