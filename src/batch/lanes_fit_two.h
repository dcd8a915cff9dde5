/*
 * Two lobes from the sums of a tile to proof. Part of batch_body.h, after fit_tile(), whose sums are there.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_LANES_FIT_TWO_H
#define BRDFFIT_BATCH_LANES_FIT_TWO_H

#include "batch/lanes_pairs.h"
#include "batch/lanes_boxes.h"

/* Better hills that a proof may meet before the general path takes over. */
#define HILLS 6

struct two_state {
    struct summit summit[BATCH_TILE];
    double s[2][BATCH_TILE], e2[BATCH_TILE], best[BATCH_TILE], best_s[2][BATCH_TILE];
    double total[BATCH_TILE], rest[BATCH_TILE], error[BATCH_TILE], level[BATCH_TILE];
    double gamma[BATCH_TILE], gamma_tail[BATCH_TILE]; /* the latter where a lobe may be beyond the last node */
    unsigned char pending[BATCH_TILE];
};

/* The exact objective of two lobes, as evaluate() has it of one. */
static void evaluate_two(const struct batch_fast *f, struct batch_tile *tile, double s[2][BATCH_TILE], double *x,
                         double *y, double *objective)
{
    size_t M = f->distinct, m, l, part;
    int j;

    for (j = 0; j < 2; j++) {
        for (l = 0; l < LANES; l++) {
            brdffit_batch_shape(f, 0, s[j][l], tile->one);
            for (m = 0; m < M; m++) {
                tile->phi[j][m * LANES + l] = tile->one[m];
            }
        }
    }
    for (part = 0; part < LANES; part += VEC) {
        evaluate_part(f, tile, part, 2, x, y, objective);
    }
}

/* The pending texels climb, are evaluated, and keep what is better. */
static void improve(const struct batch_fast *f, struct batch_tile *tile, struct two_state *st)
{
    double *x = tile->n, *y = tile->n + f->channels * LANES;
    size_t l, k;
    int j;

    for (l = 0; l < LANES; l++) {
        if (st->pending[l]) {
            struct texel_of_two texel = {.f = f, .tile = tile, .lane = l};

            climb_two(&texel, &st->summit[l]);
            for (j = 0; j < 2; j++) {
                const struct batch_window *w = &f->window[st->summit[l].window[j]];

                st->s[j][l] = kernel_exp(w->center + w->radius * st->summit[l].t[j]);
            }
        }
    }
    evaluate_two(f, tile, st->s, x, y, st->e2);
    for (l = 0; l < LANES; l++) {
        if (st->pending[l] && st->e2[l] < st->best[l]) {
            st->best[l] = st->e2[l];
            st->best_s[0][l] = st->s[0][l];
            st->best_s[1][l] = st->s[1][l];
            for (k = 0; k < f->channels; k++) {
                tile->x[k * LANES + l] = x[k * LANES + l];
                tile->y[2 * k * LANES + l] = y[2 * k * LANES + l];
                tile->y[(2 * k + 1) * LANES + l] = y[(2 * k + 1) * LANES + l];
            }
        }
    }
}

/* Every pair of windows of one texel: 1 proven, 0 not, -1 a better hill was met. */
static int prove_two(const struct batch_fast *f, struct batch_tile *tile, struct two_state *st, size_t lane)
{
    struct texel_of_two x = {.f = f, .tile = tile, .lane = lane};
    double noise = (1e-12 + 4.0 * f->window[st->summit[lane].window[1]].n_error[0][0]) * st->total[lane];
    struct summit better = {{0, 0}, {0.0, 0.0}, st->rest[lane] - st->best[lane]};
    size_t which[2], calls = 0;
    int proven = 1;

    better.gain += fmin(noise, 0.1 * (st->best[lane] - st->level[lane])) + 1e-13 * st->total[lane];
    for (which[1] = 0; which[1] < f->windows && proven > 0; which[1]++) {
        x.gamma = which[1] + 1 < f->windows ? st->gamma[lane] : fmin(st->gamma[lane], st->gamma_tail[lane]);
        for (which[0] = 0; which[0] <= which[1] && proven > 0; which[0]++) {
            if (!(tile->upper[BATCH_PAIR(which[0], which[1]) * LANES + lane] <= x.gamma)) {
                proven = bound_pair(&x, which, &calls, &better);
            }
        }
    }
    if (proven < 0) {
        st->summit[lane] = better;
    }
    tile->two[lane].boxes += f->windows * (f->windows + 1) / 2 + calls * LANES;
    return proven;
}

static void certify_two(const struct batch_fast *f, struct batch_tile *tile, struct two_state *st, size_t lane,
                        int last)
{
    struct batch_outcome *out = &tile->two[lane];
    int proven = st->level[lane] <= 0.0 ? 1 : prove_two(f, tile, st, lane);

    if (proven < 0 && !last) {
        return;
    }
    st->pending[lane] = 0;
    out->certified = proven > 0;
    out->s = st->best_s[0][lane];
    out->other = st->best_s[1][lane];
    out->e2 = st->best[lane];
    out->error = st->error[lane];
    out->lower_bound = fmax(st->level[lane], 0.0);
    out->total = st->total[lane];
}

static void start_two(const struct batch_fast *f, struct batch_tile *tile, struct two_state *st,
                      const unsigned char *live)
{
    struct best_pairs best;
    size_t l;

    near_windows(f, tile);
    bound_pairs(f, tile, &best);
    for (l = 0; l < LANES; l++) {
        st->summit[l] = (struct summit){{best.v[l], best.w[l]}, {0.0, 0.0}, 0.0};
        st->best[l] = INFINITY;
        st->s[0][l] = st->s[1][l] = st->best_s[0][l] = st->best_s[1][l] = f->s_low;
        st->rest[l] = rest_of(f, tile, l, &st->total[l]);
        st->pending[l] = live[l] && st->total[l] >= LEAST_TOTAL && st->total[l] <= 1.0 / LEAST_TOTAL;
        tile->two[l].certified = 0;
        tile->two[l].boxes = 0;
        tile->two[l].nodes = f->windows + 1;
    }
}

static void fit_two(const struct batch_fast *f, const struct batch_rules *rules, struct batch_tile *tile,
                    const unsigned char *live)
{
    struct two_state st;
    size_t l;
    int hill, any = 1;

    start_two(f, tile, &st, live);
    for (hill = 0; hill < HILLS && any; hill++) {
        improve(f, tile, &st);
        for (l = 0, any = 0; l < LANES; l++) {
            if (st.pending[l]) {
                double s = fmax(st.best_s[0][l], st.best_s[1][l]);
                struct goal goal = {st.best[l], st.total[l], st.rest[l], f->doubt_two, s};

                set_level(f, rules, &goal, &st.error[l], &st.level[l], &st.gamma[l]);
                goal.doubt = f->doubt_tail_two;
                set_level(f, rules, &goal, &st.error[l], &st.level[l], &st.gamma_tail[l]);
                certify_two(f, tile, &st, l, hill + 1 == HILLS);
                any = any || st.pending[l];
            }
        }
    }
}

#endif
