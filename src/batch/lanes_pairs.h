/*
 * Two lobes: every pair of windows as one box, a texel a lane. Part of batch_body.h. SPDX-License-Identifier: MIT
 *
 * n_k is its Taylor series at the middle of a window, whose terms up to t^3 are dot products of the texel's sums with the plan's
 * polynomials; all else belongs to the plan. What that does not discard is cut into pieces (lanes_boxes.h). The bound of a
 * pair holds whatever the incumbent.
 */
#ifndef BRDFFIT_BATCH_LANES_PAIRS_H
#define BRDFFIT_BATCH_LANES_PAIRS_H

#include "batch/lanes_two.h"

/* tile->near: n_k and its derivatives over 1, 2 and 6 at the middle of every window. */
static void near_windows(const struct batch_fast *f, struct batch_tile *tile)
{
    size_t M = f->distinct, K = f->channels, w, k, m, part;

    for (part = 0; part < LANES; part += VEC) {
        for (w = 0; w < f->windows; w++) {
            const double *shape = f->column[0].shape[0] + w * M * BATCH_TERMS;

            for (k = 0; k < K; k++) {
                const double *sum = tile->sum[0] + k * M * LANES + part;
                double *out = tile->near + (w * K + k) * 4 * LANES + part;
                vec zero = vec_set(0.0), n0 = zero, n1 = zero, n2 = zero, n3 = zero;

                for (m = 0; m < M; m++) {
                    vec r = vec_load(sum + m * LANES);
                    const double *at = shape + m * BATCH_TERMS;

                    n0 += r * at[0];
                    n1 += r * at[1];
                    n2 += r * at[2];
                    n3 += r * at[3];
                }
                vec_store(out, n0);
                vec_store(out + LANES, n1);
                vec_store(out + 2 * LANES, n2);
                vec_store(out + 3 * LANES, n3);
            }
        }
    }
}

LANES_INLINE struct taylor taylor_of(const double *c)
{
    return (struct taylor){vec_set(c[0]), vec_set(c[1]), vec_set(c[2])};
}

LANES_INLINE void whole_pair(const struct batch_fast *f, size_t v, size_t w, struct box_of_two *b)
{
    const struct batch_window *window[2] = {&f->window[v], &f->window[w]};
    const struct batch_pair *pair = &f->pair[BATCH_PAIR(v, w)];
    int j;

    for (j = 0; j < 2; j++) {
        b->h[j] = vec_set(1.0 + 1e-9);
        b->d[j] = taylor_of(window[j]->d[0]);
        b->u[j] = taylor_of(window[j]->u[0][0]);
        b->d_error[j] = vec_set(window[j]->d_rest);
        b->u_error[j] = vec_set(window[j]->u_rest);
    }
    b->c.at = vec_set(pair->d[0][0]);
    b->c.one = vec_set(pair->d[1][0]);
    b->c.two = vec_set(pair->d[0][1]);
    b->c.one_one = vec_set(pair->d[2][0]);
    b->c.one_two = vec_set(pair->d[1][1]);
    b->c.two_two = vec_set(pair->d[0][2]);
    b->c.error = vec_set(pair->rest);
}

/* n of one window for all channels, every other place of n and e. */
LANES_INLINE void near_taylor(const struct batch_fast *f, const struct batch_tile *tile, size_t w, size_t part,
                              const vec *norm, struct taylor *n, vec *e)
{
    size_t K = f->channels, k;

    for (k = 0; k < K; k++) {
        const double *at = tile->near + (w * K + k) * 4 * LANES + part;

        n[2 * k] = (struct taylor){vec_load(at), vec_load(at + LANES), vec_load(at + 2 * LANES)};
        e[2 * k] = vec_abs(vec_load(at + 3 * LANES)) * 1.01 + f->window[w].n_rest * norm[k];
    }
}

/* The pair of windows, v < w, whose middle gains most. */
struct best_pairs {
    size_t v[BATCH_TILE], w[BATCH_TILE];
};

LANES_INLINE void bound_pairs_part(const struct batch_fast *f, struct batch_tile *tile, size_t part,
                                   struct best_pairs *best)
{
    size_t K = f->channels, v, w, k, l;
    struct taylor n[2 * BATCH_MOST_CHANNELS];
    vec e[2 * BATCH_MOST_CHANNELS], omega[BATCH_MOST_CHANNELS], norm[BATCH_MOST_CHANNELS];
    vec top = vec_set(-1.0), at = vec_set(0.0);
    double place[VEC];

    for (k = 0; k < K; k++) {
        omega[k] = vec_load(tile->omega + k * LANES + part);
        norm[k] = vec_sqrt(vec_load(tile->ii + k * LANES + part)) * (1.0 + 1e-9);
    }
    for (w = 0; w < f->windows; w++) {
        near_taylor(f, tile, w, part, norm, n + 1, e + 1);
        for (v = 0; v <= w; v++) {
            struct box_of_two box;
            struct bound_of_two out;
            vec middle;

            near_taylor(f, tile, v, part, norm, n, e);
            whole_pair(f, v, w, &box);
            bound_two(&box, K, n, e, omega, f->slack, 0, &out);
            vec_store(tile->upper + BATCH_PAIR(v, w) * LANES + part, out.upper);
            middle = v < w ? out.middle : vec_set(-1.0);
            at = vec_select(middle > top, vec_set((double)(v * BATCH_MOST_NODES + w)), at);
            top = vec_max(middle, top);
        }
    }
    vec_store(place, at);
    for (l = 0; l < VEC; l++) {
        best->v[part + l] = (size_t)place[l] / BATCH_MOST_NODES;
        best->w[part + l] = (size_t)place[l] % BATCH_MOST_NODES;
    }
}

/* tile->upper of every pair. */
static void bound_pairs(const struct batch_fast *f, struct batch_tile *tile, struct best_pairs *best)
{
    size_t part;

    for (part = 0; part < LANES; part += VEC) {
        bound_pairs_part(f, tile, part, best);
    }
}

#endif
