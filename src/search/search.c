/*
 * The search: see search.h. SPDX-License-Identifier: MIT
 *
 * Invariant: every point of the domain lies in a box of the heap, or in one that was closed with a bound of at
 * least `closed`. So min(top of the heap, closed) is a lower bound at any moment, whatever stops the search.
 * Like lobes are exchangeable, so their intervals ascend: the first partition has multisets only, and a run of r equal
 * intervals splits into r + 1 boxes, by how many of them take the upper half.
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

/* Of every box; a number above the incumbent's is not hidden here: the report tells (fit/verdict.h). */
static double global_bound(const struct search *s)
{
    double open = s->heap->count ? s->heap->box[0].bound : INFINITY;

    return smaller(smaller(open, s->closed), s->current);
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
    p.lower_bound = smaller(global_bound(s), s->result->objective) * scale;
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

static void child(struct search *s, const struct box *parent, const uint32_t *interval)
{
    struct box box = *parent;
    struct point met;
    int p;

    for (p = 0; p < s->engine->sides.count; p++) {
        box.interval[p] = interval[p];
    }
    if (bound_box(s, &box, &met) < s->result->objective - s->engine->noise) {
        improve(s, &met);
    }
    box.bound = larger(box.bound, parent->bound); /* a child is part of its parent */
    observe(s, &box);
    keep_or_close(s, &box);
}

/* The low end of every side. */
static struct point lowest(const struct search *s)
{
    struct point at = {{0.0}};
    int p;

    for (p = 0; p < s->engine->sides.count; p++) {
        at.theta[p] = s->axis[s->engine->sides.axis[p]].coordinate[0];
    }
    return at;
}

/* A first incumbent where the engine has one at hand, so that the first boxes are bounded against it. */
static void start(struct search *s)
{
    struct point met = lowest(s);

    if (s->engine->start) {
        (void)s->engine->start(s->engine->self, &met);
        improve(s, &met);
    }
}

/* The next box of the first partition, intervals of like sides ascending; 0 after the last. */
static int next_box(const struct search *s, uint32_t *interval)
{
    const struct box_sides *sides = &s->engine->sides;
    int p, q;

    for (p = sides->count - 1; p >= 0; p--) {
        if (interval[p] + 1 < s->axis[sides->axis[p]].first) {
            interval[p]++;
            for (q = p + 1; q < sides->count; q++) {
                interval[q] = sides->first[q] <= p ? interval[p] : 0;
            }
            return 1;
        }
    }
    return 0;
}

/* Bound the whole first partition, then refine the best point met, before anything is closed. */
static void first_boxes(struct search *s)
{
    struct box box = {0.0, 0, 0, {0}};
    struct point met, best = lowest(s);
    double best_objective = INFINITY;
    uint32_t interval[SIDES_MOST] = {0};
    int p;

    do {
        double objective;

        for (p = 0; p < SIDES_MOST; p++) {
            box.interval[p] = interval[p];
        }
        objective = bound_box(s, &box, &met);
        if (objective < best_objective) {
            best_objective = objective;
            best = met;
        }
        observe(s, &box);
        keep_or_close(s, &box);
    } while (next_box(s, interval));
    if (!s->engine->start || best_objective < s->result->objective - s->engine->noise) {
        improve(s, &best);
    }
    s->current = INFINITY;
}

/* The run of like sides on the same interval as `side`: its first, and its length in *length. */
static int run_of(const struct search *s, const struct box *box, int side, int *length)
{
    const struct box_sides *sides = &s->engine->sides;
    int begin = side, end = side + 1;

    while (begin > sides->first[side] && box->interval[begin - 1] == box->interval[side]) {
        begin--;
    }
    while (end < sides->count && sides->first[end] == sides->first[side] && box->interval[end] == box->interval[side]) {
        end++;
    }
    *length = end - begin;
    return begin;
}

/* Boxes that splitting this one would bound. */
static size_t children_of(const struct search *s, const struct box *box)
{
    int length;

    (void)run_of(s, box, (int)box->split, &length);
    return (size_t)length + 1;
}

static int box_is_fine(const struct search *s, const struct box *box)
{
    double resolution = s->rules->sigma_resolution;
    int p, fine = resolution > 0.0;

    for (p = 0; p < s->engine->sides.count && fine; p++) {
        fine = s->engine->width(s->engine->self, s->engine->sides.axis[p], box->interval[p]) <= resolution;
    }
    return fine;
}

static void give_up(struct search *s, const struct box *box, brdffit_stop reason)
{
    close_box(s, box->bound);
    if (box->bound < s->stuck) {
        s->stuck = box->bound;
        s->stuck_by = reason;
    }
}

/* Split a side, and those that share its interval. 0 when it cannot be split. */
static int split(struct search *s, const struct box *box, int side)
{
    struct axis *axis = &s->axis[s->engine->sides.axis[side]];
    uint32_t interval[SIDES_MOST], children = brdffit_axis_split(axis, box->interval[side]);
    int begin, length, upper, p;

    if (!children) {
        return 0;
    }
    begin = run_of(s, box, side, &length);
    for (p = 0; p < SIDES_MOST; p++) {
        interval[p] = box->interval[p];
    }
    for (upper = 0; upper <= length; upper++) {
        for (p = 0; p < length; p++) {
            interval[begin + p] = p < length - upper ? children : children + 1;
        }
        child(s, box, interval);
    }
    return 1;
}

/* Whether every side is too narrow to split; otherwise a node is what lacks. */
static int narrow(const struct search *s, const struct box *box)
{
    int p, all = 1;

    for (p = 0; p < s->engine->sides.count; p++) {
        all = all && brdffit_axis_narrow(&s->axis[s->engine->sides.axis[p]], box->interval[p]);
    }
    return all;
}

/* The advised side first, then the others in turn. */
static void branch(struct search *s, struct box *box)
{
    int count = s->engine->sides.count, turn;

    if (box_is_fine(s, box)) {
        give_up(s, box, BRDFFIT_STOP_RESOLUTION);
        return;
    }
    for (turn = 0; turn < count; turn++) {
        if (split(s, box, ((int)box->split + turn) % count)) {
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
