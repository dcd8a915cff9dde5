/*
 * The search: see search.h. SPDX-License-Identifier: MIT
 *
 * Invariant: every point of the domain lies in a box of the heap, or in one that was closed with a bound of at
 * least `closed`. So min(top of the heap, closed) is a lower bound at any moment, whatever stops the search.
 * Boxes of two lobes keep the first interval at or below the second (lobes are exchangeable): the first
 * partition has the pairs i <= j only, and a box on the diagonal splits into three, not four.
 */
#include "search/search.h"

#include <math.h>

#include "base/vector.h"

struct search {
    struct axis *axis;
    struct heap *heap;
    const struct engine *engine;
    const struct search_rules *rules;
    struct search_result *result;
    double closed;        /* smallest bound of a box that was closed */
    double current;       /* bound of what is being split or not bounded yet; INFINITY between boxes */
    double stuck;         /* smallest bound of a box that cannot be split, part of `closed` */
    brdffit_stop stuck_by;
    uint64_t sequence;
    int full, cancelled, spent; /* why the loop ended early: heap full, callback, budget */
};

double brdffit_search_cutoff(const struct search_rules *rules, double objective)
{
    return smaller(objective / (1.0 + rules->relative_gap), objective - rules->absolute_gap);
}

static void close_box(struct search *s, double bound)
{
    s->closed = smaller(s->closed, bound);
}

static double global_bound(const struct search *s)
{
    double open = s->heap->count ? s->heap->box[0].bound : INFINITY;

    return smaller(smaller(smaller(open, s->closed), s->current), s->result->objective);
}

static int report(struct search *s)
{
    brdffit_progress p;
    double scale = s->rules->progress_scale;

    if (!s->rules->progress) {
        return 0;
    }
    p.phase = BRDFFIT_PHASE_SEARCH;
    p.boxes = s->result->boxes;
    p.e2 = s->result->objective * scale;
    p.lower_bound = global_bound(s) * scale;
    return s->rules->progress(s->rules->progress_user, &p) != 0;
}

static void improve(struct search *s, struct point *point)
{
    double objective = s->engine->try_point(s->engine->self, point);

    if (objective < s->result->objective) {
        s->result->objective = objective;
        s->result->point = *point;
    }
}

/* Bound a box. A point met that beats the incumbent beyond rounding is refined; returns what was met. */
static double bound_box(struct search *s, struct box *box, struct point *met)
{
    double objective;

    box->sequence = s->sequence++;
    box->bound = brdffit_search_cutoff(s->rules, s->result->objective);
    s->result->boxes++;
    objective = s->engine->bound(s->engine->self, box, met);
    if (s->result->boxes % 256 == 0 && report(s)) {
        s->cancelled = 1;
    }
    return objective;
}

static void observe(const struct search *s, const struct box *box)
{
    if (s->rules->observe) {
        s->rules->observe(s->rules->observe_self, box);
    }
}

static void keep_or_close(struct search *s, const struct box *box)
{
    if (box->bound >= brdffit_search_cutoff(s->rules, s->result->objective)) {
        close_box(s, box->bound);
    } else if (!brdffit_heap_push(s->heap, box)) {
        close_box(s, box->bound);
        s->full = 1;
    }
}

static void child(struct search *s, const struct box *parent, uint32_t first, uint32_t second)
{
    struct box box = *parent;
    struct point met;

    box.interval[0] = first;
    box.interval[1] = second;
    if (bound_box(s, &box, &met) < s->result->objective - s->engine->noise) {
        improve(s, &met);
    }
    box.bound = larger(box.bound, parent->bound); /* a child is part of its parent */
    observe(s, &box);
    keep_or_close(s, &box);
}

/* A first incumbent where the engine has one at hand, so that the first boxes are bounded against it. */
static void start(struct search *s)
{
    struct point met = {{s->axis->coordinate[0], s->axis->coordinate[0]}};

    if (s->engine->start) {
        (void)s->engine->start(s->engine->self, &met);
        improve(s, &met);
    }
}

/* Bound the whole first partition, then refine the best point met, before anything is closed. */
static void first_boxes(struct search *s)
{
    struct box box = {0.0, 0, {0, 0}, 0};
    struct point met, best = {{s->axis->coordinate[0], s->axis->coordinate[0]}};
    double best_objective = INFINITY;
    uint32_t i, j;

    for (i = 0; i < s->axis->first; i++) {
        uint32_t last = s->engine->lobes > 1 ? s->axis->first : i + 1;

        for (j = i; j < last; j++) {
            double objective;

            box.interval[0] = i;
            box.interval[1] = s->engine->lobes > 1 ? j : 0;
            objective = bound_box(s, &box, &met);
            if (objective < best_objective) {
                best_objective = objective;
                best = met;
            }
            observe(s, &box);
            keep_or_close(s, &box);
        }
    }
    if (!s->engine->start || best_objective < s->result->objective - s->engine->noise) {
        improve(s, &best);
    }
    s->current = INFINITY;
}

/* Boxes that splitting this one would bound. */
static size_t children_of(const struct search *s, const struct box *box)
{
    return s->engine->lobes > 1 && box->interval[0] == box->interval[1] ? 3 : 2;
}

static int box_is_fine(const struct search *s, const struct box *box)
{
    double resolution = s->rules->sigma_resolution;

    return resolution > 0.0 && s->engine->width(s->engine->self, box->interval[0]) <= resolution &&
           (s->engine->lobes < 2 || s->engine->width(s->engine->self, box->interval[1]) <= resolution);
}

static void give_up(struct search *s, const struct box *box, brdffit_stop reason)
{
    close_box(s, box->bound);
    if (box->bound < s->stuck) {
        s->stuck = box->bound;
        s->stuck_by = reason;
    }
}

/* Split one side, or both on the diagonal. 0 when that side cannot be split. */
static int split(struct search *s, const struct box *box)
{
    uint32_t first = box->interval[0], second = box->interval[1], children;

    if (s->engine->lobes > 1 && first == second) {
        children = brdffit_axis_split(s->axis, first);
        if (children) {
            child(s, box, children, children);
            child(s, box, children, children + 1);
            child(s, box, children + 1, children + 1);
        }
        return children != 0;
    }
    children = brdffit_axis_split(s->axis, box->interval[box->split]);
    if (children) {
        child(s, box, box->split ? first : children, box->split ? children : second);
        child(s, box, box->split ? first : children + 1, box->split ? children + 1 : second);
    }
    return children != 0;
}

/* Whether every side is too narrow to split; otherwise a node is what lacks. */
static int narrow(const struct search *s, const struct box *box)
{
    return brdffit_axis_narrow(s->axis, box->interval[0]) &&
           (s->engine->lobes < 2 || brdffit_axis_narrow(s->axis, box->interval[1]));
}

static void branch(struct search *s, struct box *box)
{
    if (box_is_fine(s, box)) {
        give_up(s, box, BRDFFIT_STOP_RESOLUTION);
        return;
    }
    if (split(s, box)) {
        return;
    }
    if (s->engine->lobes > 1 && box->interval[0] != box->interval[1]) {
        box->split = !box->split;
        if (split(s, box)) {
            return;
        }
    }
    give_up(s, box, narrow(s, box) ? BRDFFIT_STOP_ROUNDING : BRDFFIT_STOP_MEMORY);
}

static brdffit_stop why_stopped(const struct search *s)
{
    const struct search_result *r = s->result;

    if (r->lower_bound >= r->objective / (1.0 + s->rules->relative_gap)) {
        return BRDFFIT_STOP_RELATIVE_GAP;
    }
    if (r->lower_bound >= r->objective - s->rules->absolute_gap) {
        return BRDFFIT_STOP_ABSOLUTE_GAP;
    }
    if (s->cancelled) {
        return BRDFFIT_STOP_CANCELLED;
    }
    if (s->full) {
        return BRDFFIT_STOP_MEMORY;
    }
    return s->spent ? BRDFFIT_STOP_BUDGET : s->stuck_by;
}

void brdffit_search(struct axis *axis, struct heap *heap, const struct engine *engine, const struct search_rules *rules,
                    struct search_result *result)
{
    struct search s = {.axis = axis,
                       .heap = heap,
                       .engine = engine,
                       .rules = rules,
                       .result = result,
                       .closed = INFINITY,
                       .stuck = INFINITY,
                       .stuck_by = BRDFFIT_STOP_ROUNDING,
                       .cancelled = rules->cancelled};

    heap->count = 0;
    result->boxes = 0;
    result->objective = INFINITY;
    start(&s);
    first_boxes(&s);
    while (heap->count && !s.full && !s.cancelled) {
        struct box box = heap->box[0];

        if (box.bound >= brdffit_search_cutoff(rules, result->objective)) {
            break; /* and so is every other box */
        }
        if (children_of(&s, &box) > rules->box_budget - result->boxes) {
            s.spent = 1;
            break;
        }
        (void)brdffit_heap_pop(heap);
        s.current = box.bound;
        branch(&s, &box);
        s.current = INFINITY;
    }
    result->lower_bound = global_bound(&s);
    result->stop = why_stopped(&s);
}
