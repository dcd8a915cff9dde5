/*
 * Two lobes: pieces of a pair of windows of one texel, a lane each: the climb to an incumbent, and the proof. Part of
 * batch_body.h. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_LANES_BOXES_H
#define BRDFFIT_BATCH_LANES_BOXES_H

#include "batch/lanes_two.h"

/* Boxes waiting to be cut, and calls for one texel, before the general path takes over. */
#define BOXES_WAITING 512
#define BOX_CALLS 4000
/* Steps of a climb. */
#define CLIMB_STEPS 40

struct texel_of_two {
    const struct batch_fast *f;
    const struct batch_tile *tile;
    size_t lane;
    uint64_t known;                 /* windows whose polynomials are in tile->data */
    double gamma;                   /* what is to be proven */
    double third[BATCH_MOST_NODES]; /* |third derivative of n| / 6 in each window, the largest of its channels */
};

/* Middles and half widths of eight boxes. */
struct boxes {
    double t[2][LANES], h[2][LANES];
};

static void know_window(struct texel_of_two *x, size_t w)
{
    const struct batch_fast *f = x->f;
    double *data = x->tile->data + w * f->channels * BATCH_TERMS;
    size_t k;

    if (x->known >> w & 1) {
        return;
    }
    window_data(f, x->tile, w, 0, x->lane, data);
    x->known |= UINT64_C(1) << w;
    x->third[w] = 0.0;
    for (k = 0; k < f->channels; k++) {
        x->third[w] = fmax(x->third[w], third_of(data + k * BATCH_TERMS, BATCH_TERMS));
    }
}

/* D_12 and its derivatives: polynomials in t2 of every power of t1, then in t1. */
LANES_INLINE void cross_at(const struct batch_pair *pair, vec t1, vec t2, struct cross *c)
{
    vec zero = vec_set(0.0);
    int i;

    *c = (struct cross){zero, zero, zero, zero, zero, zero, zero};
    for (i = (int)BATCH_TERMS - 1; i >= 0; i--) {
        struct taylor row = taylor_at(pair->d[i], BATCH_TERMS, t2);

        c->one_one = c->one_one * t1 + c->one;
        c->one = c->one * t1 + c->at;
        c->at = c->at * t1 + row.f0;
        c->one_two = c->one_two * t1 + c->two;
        c->two = c->two * t1 + row.f1;
        c->two_two = c->two_two * t1 + row.f2;
    }
}

LANES_INLINE void bound_boxes_part(const struct texel_of_two *x, const size_t which[2], const struct boxes *boxes,
                                   size_t part, int climb, struct bound_of_two *out)
{
    const struct batch_fast *f = x->f;
    const struct batch_pair *pair = &f->pair[BATCH_PAIR(which[0], which[1])];
    struct taylor n[2 * BATCH_MOST_CHANNELS];
    vec e[2 * BATCH_MOST_CHANNELS], omega[BATCH_MOST_CHANNELS], t[2], most;
    struct box_of_two b;
    size_t k, j;

    for (j = 0; j < 2; j++) {
        const struct batch_window *window = &f->window[which[j]];
        const double *data = x->tile->data + which[j] * f->channels * BATCH_TERMS;
        vec h3;

        t[j] = vec_load(boxes->t[j] + part);
        b.h[j] = vec_load(boxes->h[j] + part) * (1.0 + 1e-9);
        h3 = b.h[j] * b.h[j] * b.h[j];
        b.d[j] = taylor_at(window->d[0], BATCH_TERMS_D, t[j]);
        b.u[j] = taylor_at(window->u[0][0], BATCH_TERMS, t[j]);
        b.d_error[j] = window->d_third[0] * h3 + window->d_error[0];
        b.u_error[j] = window->u_third[0][0] * h3 + window->u_error[0][0];
        for (k = 0; k < f->channels; k++) {
            double norm = sqrt(x->tile->ii[k * LANES + x->lane]) * (1.0 + 1e-9);

            n[2 * k + j] = taylor_at(data + k * BATCH_TERMS, BATCH_TERMS, t[j]);
            e[2 * k + j] = x->third[which[j]] * h3 + window->n_error[0][0] * norm;
        }
    }
    for (k = 0; k < f->channels; k++) {
        omega[k] = vec_set(x->tile->omega[k * LANES + x->lane]);
    }
    cross_at(pair, t[0], t[1], &b.c);
    most = vec_max(b.h[0], b.h[1]);
    b.c.error = pair->third * (most * most * most) + pair->error;
    bound_two(&b, f->channels, n, e, omega, f->slack, climb, out);
}

/* ---- the climb ---- */

/* A point of a climb, and what is gained there. */
struct summit {
    size_t window[2];
    double t[2], gain;
};

/* Lobes are exchangeable: the windows ascend. */
static void order_summit(struct summit *at)
{
    struct summit was = *at;
    int j;

    for (j = 0; was.window[0] > was.window[1] && j < 2; j++) {
        at->window[j] = was.window[1 - j];
        at->t[j] = was.t[1 - j];
    }
}

/* Into the next window where a coordinate is at the end of its own and wants on; 0 when none does. */
static int cross_over(const struct batch_fast *f, struct summit *at, const double slope[2])
{
    int j, moved = 0;

    for (j = 0; j < 2; j++) {
        if (at->t[j] >= 1.0 && slope[j] > 0.0 && at->window[j] + 1 < f->windows) {
            at->window[j]++;
            at->t[j] = -1.0;
            moved = 1;
        } else if (at->t[j] <= -1.0 && slope[j] < 0.0 && at->window[j] > 0) {
            at->window[j]--;
            at->t[j] = 1.0;
            moved = 1;
        }
    }
    order_summit(at);
    return moved;
}

/* Newton's step with the curvatures along the axes of the hill taken downwards: so it leads uphill, and not far. */
static void newton_step(const double hill[5], double step[2])
{
    double half = 0.5 * (hill[2] - hill[4]), root = sqrt(half * half + 0.25 * hill[3] * hill[3]), longest;
    double middle = 0.5 * (hill[2] + hill[4]), value[2] = {middle + root, middle - root}, axis[2], size, along;
    int i, j;

    axis[0] = half >= 0.0 ? half + root : 0.5 * hill[3]; /* of value[0] */
    axis[1] = half >= 0.0 ? 0.5 * hill[3] : root - half;
    size = sqrt(axis[0] * axis[0] + axis[1] * axis[1]);
    step[0] = step[1] = 0.0;
    for (i = 0; i < 2; i++) {
        double unit[2] = {size > 0.0 ? axis[0] / size : 1.0, size > 0.0 ? axis[1] / size : 0.0}, across = unit[0];

        unit[0] = i ? -unit[1] : unit[0];
        unit[1] = i ? across : unit[1];
        along = (hill[0] * unit[0] + hill[1] * unit[1]) / fmax(2.0 * fabs(value[i]), 1e-300);
        for (j = 0; j < 2; j++) {
            step[j] += along * unit[j];
        }
    }
    longest = fmax(fabs(step[0]), fabs(step[1]));
    for (j = 0; longest > 1.5 && j < 2; j++) {
        step[j] *= 1.5 / longest;
    }
}

/* To the best of some points along a step, none included; 1 when something was gained. */
static int walk(struct texel_of_two *x, struct summit *at, const double step[2], double hill[5])
{
    static const double length[LANES] = {0.0, 1.0, 0.5, 0.25, 0.0625, 0.00390625, 2.0, 4.0};
    struct boxes boxes = {.h = {{0.0}, {0.0}}};
    double middle[LANES], out[5][LANES];
    size_t l, part, best = 0;
    int j;

    for (l = 0; l < LANES; l++) {
        for (j = 0; j < 2; j++) {
            boxes.t[j][l] = fmax(-1.0, fmin(1.0, at->t[j] + length[l] * step[j]));
        }
    }
    know_window(x, at->window[0]);
    know_window(x, at->window[1]);
    for (part = 0; part < LANES; part += VEC) {
        struct bound_of_two b;

        bound_boxes_part(x, at->window, &boxes, part, 1, &b);
        vec_store(middle + part, b.middle);
        for (j = 0; j < 5; j++) {
            vec_store(out[j] + part, b.hill[j]);
        }
    }
    for (l = 1; l < LANES; l++) {
        best = middle[l] > middle[best] ? l : best;
    }
    for (j = 0; j < 5; j++) {
        hill[j] = out[j][best];
    }
    at->t[0] = boxes.t[0][best];
    at->t[1] = boxes.t[1][best];
    at->gain = middle[best];
    return best > 0;
}

/* From a start to the top of its hill. */
static void climb_two(struct texel_of_two *x, struct summit *at)
{
    const double none[2] = {0.0, 0.0};
    double hill[5];
    int i;

    (void)walk(x, at, none, hill);
    for (i = 0; i < CLIMB_STEPS; i++) {
        double step[2];
        int gained;

        newton_step(hill, step);
        gained = walk(x, at, step, hill);
        if (cross_over(x->f, at, hill)) {
            (void)walk(x, at, none, hill);
        } else if (!gained) {
            break;
        }
    }
}

/* ---- the proof ---- */

/* Cut a box in eight: the longer side in four. */
static void cut_box(const double t[2], const double h[2], struct boxes *out)
{
    int longer = h[1] > h[0], l;

    for (l = 0; l < (int)LANES; l++) {
        double four = 0.25 * h[longer], two = 0.5 * h[1 - longer];

        out->t[longer][l] = t[longer] + (2.0 * (double)(l % 4) - 3.0) * four;
        out->h[longer][l] = four;
        out->t[1 - longer][l] = t[1 - longer] + (l < 4 ? -two : two);
        out->h[1 - longer][l] = two;
    }
}

/* Bit l set when box l is not discarded; a better middle than the incumbent goes to *better. */
static unsigned bound_boxes(struct texel_of_two *x, const size_t which[2], const struct boxes *boxes,
                            struct summit *better)
{
    double upper[LANES], middle[LANES];
    unsigned left = 0;
    size_t l, part;

    for (part = 0; part < LANES; part += VEC) {
        struct bound_of_two b;

        bound_boxes_part(x, which, boxes, part, 0, &b);
        vec_store(upper + part, b.upper);
        vec_store(middle + part, b.middle);
    }
    for (l = 0; l < LANES; l++) {
        int mirrored = which[0] == which[1] && boxes->t[0][l] - boxes->h[0][l] > boxes->t[1][l] + boxes->h[1][l];

        if (upper[l] <= x->gamma || mirrored) {
            continue;
        }
        left |= 1u << l;
        if (middle[l] > better->gain) {
            *better = (struct summit){{which[0], which[1]}, {boxes->t[0][l], boxes->t[1][l]}, middle[l]};
        }
    }
    return left;
}

/* A pair of windows until everything is discarded: 1; 0 when it takes too long; -1: a better point was met. */
static int bound_pair(struct texel_of_two *x, const size_t which[2], size_t *calls, struct summit *better)
{
    double t[BOXES_WAITING][2], h[BOXES_WAITING][2], before = better->gain;
    const double middle[2] = {0.0, 0.0}, whole[2] = {1.0 + 1e-12, 1.0 + 1e-12};
    struct boxes boxes;
    int waiting = 0, l, j;

    know_window(x, which[0]);
    know_window(x, which[1]);
    cut_box(middle, whole, &boxes);
    for (;;) {
        unsigned left;

        if (++*calls > BOX_CALLS) {
            return 0;
        }
        left = bound_boxes(x, which, &boxes, better);
        if (better->gain > before) {
            return -1;
        }
        for (l = 0; left && l < (int)LANES; l++) {
            if (!(left >> l & 1)) {
                continue;
            }
            if (waiting >= BOXES_WAITING || boxes.h[0][l] < NARROW) {
                return 0;
            }
            for (j = 0; j < 2; j++) {
                t[waiting][j] = boxes.t[j][l];
                h[waiting][j] = boxes.h[j][l];
            }
            waiting++;
        }
        if (waiting == 0) {
            return 1;
        }
        waiting--;
        cut_box(t[waiting], h[waiting], &boxes);
    }
}

#endif
