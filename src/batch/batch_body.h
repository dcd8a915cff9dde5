/*
 * Tiles of texels from data to proof: see fast.c for the mathematics. Included by batch_base.c, _avx2.c
 * and _avx512.c, which differ only in the instruction set that they are compiled for; BATCH_KERNELS names the table.
 * A texel's lane never depends on another's. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "batch/fast.h"
#include "batch/lanes_ascend.h"
#include "batch/lanes_sums.h"

#include "batch/lanes_bound.h"

/* Better valleys that a proof may meet before the general path takes over. */
#define ATTEMPTS 5
/* Share of the gap that the error of the polynomials may take before those with more terms are used. */
#define COARSE 0.2

/* Sums of squares from this to its inverse are fitted here. */
#define LEAST_TOTAL 1e-70

struct tile_state {
    struct ascent ascent;
    double theta[BATCH_TILE], s[BATCH_TILE], e2[BATCH_TILE];             /* of the last evaluation */
    double best[BATCH_TILE], best_theta[BATCH_TILE], best_s[BATCH_TILE]; /* incumbents */
    double total[BATCH_TILE], rest[BATCH_TILE];  /* sum |I|^2, and less sum omega^2 */
    double error[BATCH_TILE];                   /* of the incumbent when it is published */
    double level[BATCH_TILE], gamma[BATCH_TILE]; /* what is to be proven: E^2 >= level, no gain above gamma */
    uint64_t left[BATCH_TILE];                  /* windows to bound */
    unsigned char pending[BATCH_TILE];
};

/* The window on that side of each texel's best node where the next node is better. */
static void choose_starts(const struct batch_fast *f, const struct batch_tile *tile, struct ascent *c)
{
    double node[LANES];
    size_t j, l, part;

    for (part = 0; part < LANES; part += VEC) {
        vec top = vec_load(tile->gain + part), at = vec_set(0.0);

        for (j = 1; j <= f->windows; j++) {
            vec gain = vec_load(tile->gain + j * LANES + part);

            at = vec_select(gain > top, vec_set((double)j), at);
            top = vec_max(gain, top);
        }
        vec_store(node + part, at);
    }
    for (l = 0; l < LANES; l++) {
        const double *gain = tile->gain + l;
        size_t best = (size_t)node[l];
        double left = best > 0 ? gain[(best - 1) * LANES] : -1.0;
        double right = best < f->windows ? gain[(best + 1) * LANES] : -1.0;

        c->window[l] = right >= left ? best : best - 1;
        c->t[l] = right >= left ? -1.0 : 1.0;
    }
}

/* Climb from where the pending texels are, over at most three windows; the point reached into state->s. */
static void ascend_tile(const struct batch_fast *f, struct batch_tile *tile, struct tile_state *st)
{
    struct ascent *c = &st->ascent;
    double active[BATCH_TILE];
    size_t l, part;
    int round, any = 1;

    for (l = 0; l < LANES; l++) {
        active[l] = st->pending[l] ? 1.0 : 0.0;
    }
    for (round = 0; round < 3 && any; round++) {
        for (l = 0; l < LANES; l++) {
            if (active[l] > 0.0) {
                enter_window(f, tile, c, l);
            }
        }
        for (part = 0; part < LANES; part += VEC) {
            if (EACH_MOST > 1 && f->each > 1) {
                ascend_part(f, tile, c, active, part, 2);
            } else {
                ascend_part(f, tile, c, active, part, 1);
            }
        }
        for (l = 0, any = 0; l < LANES; l++) {
            int up = active[l] > 0.0 && c->t[l] >= 1.0 && c->slope[l] > 0.0 && c->window[l] + 1 < f->windows;
            int down = active[l] > 0.0 && c->t[l] <= -1.0 && c->slope[l] < 0.0 && c->window[l] > 0;

            active[l] = round < 2 && (up || down) ? 1.0 : 0.0;
            if (active[l] > 0.0) {
                c->window[l] = up ? c->window[l] + 1 : c->window[l] - 1;
                c->t[l] = up ? -1.0 : 1.0;
                any = 1;
            }
        }
    }
    for (l = 0; l < LANES; l++) {
        const struct batch_window *w = &f->window[c->window[l]];

        if (st->pending[l]) {
            st->s[l] = kernel_exp(w->center + w->radius * c->t[l]);
            st->theta[l] = w->center + w->radius * c->t[l];
        }
    }
}

/* Windows that their end nodes do not discard, a bit each: see fast.c. */
static void screen(const struct batch_fast *f, const struct batch_tile *tile, struct tile_state *st)
{
    double roots[LANES], sizes[LANES], roundings[LANES];
    size_t w, l, part;

    for (l = 0; l < LANES; l++) {
        roundings[l] = f->slack * st->total[l];
        roots[l] = sqrt(fmax(st->gamma[l], 0.0));
        sizes[l] = sqrt(fmax(st->rest[l], 0.0) + roundings[l]);
    }
    for (part = 0; part < LANES; part += VEC) {
        vec root = vec_load(roots + part), size = vec_load(sizes + part), rounding = vec_load(roundings + part);
        vec low = vec_load(tile->gain + part);
        vec_mask left = {0};

        for (w = 0; w < f->windows; w++) {
            const struct batch_window *window = &f->window[w];
            vec high = vec_load(tile->gain + (w + 1) * LANES + part), gain = vec_max(low, high) + rounding;
            vec threshold = window->shrink * root - window->delta * size;
            vec_mask out = (threshold > vec_set(0.0)) & (gain <= threshold * threshold);

            left |= ~out & (int64_t)(UINT64_C(1) << w);
            low = high;
        }
        for (l = 0; l < VEC; l++) {
            st->left[part + l] = (uint64_t)left[l];
        }
    }
}

static double third_of(const double *c, size_t terms)
{
    static const double binomial[BATCH_TERMS_MORE] = {0.0,  0.0,  0.0,  1.0,  4.0,   10.0,
                                                      20.0, 35.0, 56.0, 84.0, 120.0, 165.0};
    double sum = 0.0;
    size_t j;

    for (j = 3; j < terms; j++) {
        sum += binomial[j] * fabs(c[j]);
    }
    return sum * (1.0 + TOL_CURVATURE);
}

/*
 * How far a gain from the polynomials of window w may be from the truth, relative to the data's sum of squares: an estimate,
 * by which polynomials are chosen and the ascent starts again.
 */
static double gain_error(const struct batch_fast *f, size_t w, int more)
{
    const struct batch_window *window = &f->window[w];
    double error = f->slack;
    int i, j;

    for (j = 0; j < f->each; j++) {
        error += 2.0 * (window->n_error[j][more] + window->u_error[j][more]);
        for (i = 0; i <= j; i++) {
            error += window->d_error[BATCH_PAIR(i, j)];
        }
    }
    return error;
}

/* Bound every window that is left of one texel: 1 proven, 0 not; -1: a better point is where the ascent now starts. */
static int prove(const struct batch_fast *f, struct batch_tile *tile, struct tile_state *st, size_t lane)
{
    size_t K = f->channels, C = (size_t)f->each, k, w, calls = 0;
    double *omega = tile->work + K * C * BATCH_STRIDE_MORE, *norm = omega + K, *third = norm + K;
    double incumbent = st->rest[lane] - st->best[lane], noise;
    struct bound_texel b = {f, NULL, 0, tile->work, omega, norm, third, st->gamma[lane], f->slack, 0.0, 0.0};
    uint64_t left = st->left[lane];
    int proven = 1;

    for (k = 0; k < K; k++) {
        omega[k] = tile->omega[k * LANES + lane];
        norm[k] = sqrt(tile->ii[k * LANES + lane]);
    }
    for (w = 0; left && proven; w++, left >>= 1) {
        if (!(left & 1)) {
            continue;
        }
        b.window = &f->window[w];
        b.more = gain_error(f, w, 0) * st->total[lane] > COARSE * (st->best[lane] - st->level[lane]);
        window_data(f, tile, w, b.more, lane, tile->work);
        for (k = 0; k < K * C; k++) {
            third[k] = b.more ? third_of(tile->work + k * BATCH_STRIDE_MORE, BATCH_TERMS_MORE)
                              : third_of(tile->work + k * BATCH_TERMS, BATCH_TERMS);
        }
        noise = incumbent + 2e-7 * fmax(st->best[lane], 0.0) + gain_error(f, w, b.more) * st->total[lane];
        b.best = noise;
        proven = bound_window(&b, (st->best_theta[lane] - b.window->center) / b.window->radius, &calls);
        if (b.best > noise) {
            st->ascent.window[lane] = w;
            st->ascent.t[lane] = b.best_t;
            proven = -1;
            break;
        }
    }
    tile->outcome[lane].boxes += f->windows + calls * LANES;
    return proven;
}

/* What an error of s does to a shape, at most; in the second column what is taken off all of it counts, too. */
static double steepest(const struct batch_fast *f, double s)
{
    double most = 0.0;
    int j;

    if (!f->steep) {
        return 2.0 + (f->kind->smith ? TOL_MASKING : 0.0);
    }
    for (j = 0; j < f->each; j++) {
        const double *c = f->column[j].sight.c;
        double off = j > 0 ? f->column[j].sight.c_min - f->column[0].sight.c_min : 0.0, largest = 0.0;
        size_t m;

        for (m = 0; m < f->distinct; m++) {
            largest = fmax(largest, c[m]);
        }
        most = fmax(most, fmin(largest * s, 745.0) + (off > 0.0 ? 2.0 * f->column[j].sight.c_min * s : 0.0));
    }
    return most + (f->kind->smith ? TOL_MASKING : 0.0);
}

/*
 * How far the objective of an incumbent at s may be from that of the model in the doubles that are published: residuals
 * within TOL_PUBLISHED units, here and there, and shapes as in published.c, of which those with an exponent beyond 745
 * are 0; sums over the samples plainly.
 */
static double published_error(const struct batch_fast *f, double s, double e2, double total)
{
    double unit = TOL_UNIT * (6.0 * TOL_PUBLISHED + TOL_PUBLISHED_EXPONENT * steepest(f, s));

    return 2.0 * unit * sqrt(e2) * sqrt(total) + unit * unit * total +
           2.0 * TOL_UNIT * (double)(f->used + f->channels) * e2;
}

/* What is to be proven of each texel: its incumbent to the gap that is easier. */
static void set_levels(const struct batch_fast *f, const struct batch_rules *rules, struct tile_state *st)
{
    size_t l;

    for (l = 0; l < LANES; l++) {
        double most, relative, absolute, doubt = f->doubt * sqrt(st->total[l]) * (1.0 + 8.0 * TOL_UNIT), root;

        st->error[l] = st->best[l] < INFINITY ? published_error(f, st->best_s[l], st->best[l], st->total[l]) : 0.0;
        most = st->best[l] + st->error[l];
        relative = most / (1.0 + rules->relative_gap) * (1.0 + 16.0 * TOL_UNIT);
        absolute = most * (1.0 + 16.0 * TOL_UNIT) - rules->absolute_gap * st->total[l] * (1.0 - 16.0 * TOL_UNIT);
        st->level[l] = fmin(relative, absolute);
        /* E^2 >= level holds for the true geometry when this one's is above the square of its root and the doubt. */
        root = sqrt(fmax(st->level[l], 0.0));
        st->gamma[l] = st->rest[l] - (st->level[l] + doubt * (2.0 * root + doubt)) - f->slack * st->total[l];
    }
}

/* Whether the lobes beyond the last node, which are its lobe but for the doubt of the tail, are above the level. */
static int tail_pays(const struct batch_fast *f, const struct batch_tile *tile, const struct tile_state *st,
                     size_t lane)
{
    double gain = tile->gain[f->windows * LANES + lane], doubt = f->doubt_tail * sqrt(st->total[lane]);
    double left = st->rest[lane] - gain * (1.0 + 1e-9) - f->slack * st->total[lane];
    double root = sqrt(st->level[lane]) * (1.0 + 1e-12) + doubt;

    return f->doubt_tail <= f->doubt || left >= root * root;
}

/* Proof of one pending texel whose incumbent is up to date. */
static void certify(const struct batch_fast *f, struct batch_tile *tile, struct tile_state *st, size_t lane, int last)
{
    struct batch_outcome *out = &tile->outcome[lane];
    int proven = st->level[lane] <= 0.0 ? 1 : tail_pays(f, tile, st, lane) ? prove(f, tile, st, lane) : 0;

    if (proven < 0 && !last) {
        return;
    }
    st->pending[lane] = 0;
    out->certified = proven > 0;
    out->s = st->best_s[lane];
    out->e2 = st->best[lane];
    out->error = st->error[lane];
    out->lower_bound = fmax(st->level[lane], 0.0);
    out->total = st->total[lane];
}

static void start_tile(const struct batch_fast *f, struct batch_tile *tile, struct tile_state *st,
                       const unsigned char *live)
{
    size_t l, k;

    for (l = 0; l < LANES; l++) {
        st->pending[l] = live[l];
        st->best[l] = INFINITY;
        st->theta[l] = f->window[0].center;
        st->s[l] = f->s_low;
        st->total[l] = st->rest[l] = 0.0;
        tile->outcome[l].certified = 0;
        tile->outcome[l].boxes = 0;
        tile->outcome[l].nodes = f->windows + 1;
        for (k = 0; k < f->channels; k++) {
            double omega = tile->omega[k * LANES + l];

            st->total[l] += tile->ii[k * LANES + l];
            st->rest[l] += tile->ii[k * LANES + l] - omega * omega;
        }
        /* Weights may take the sum of squares where its products leave the number range: the general path scales it. */
        st->pending[l] = st->pending[l] && st->total[l] >= LEAST_TOTAL && st->total[l] <= 1.0 / LEAST_TOTAL;
    }
    choose_starts(f, tile, &st->ascent);
    for (l = 0; l < LANES; l++) {
        enter_window(f, tile, &st->ascent, l);
    }
}

static void fit_tile(const struct batch_fast *f, const struct batch_rules *rules, struct batch_tile *tile,
                     const unsigned char *live)
{
    struct tile_state st;
    size_t l, k, K = f->channels;
    int attempt, any = 1;

    weigh(f, tile);
    sum_texels(f, tile);
    node_gains(f, tile);
    start_tile(f, tile, &st, live);
    for (attempt = 0; attempt < ATTEMPTS && any; attempt++) {
        double *x = tile->n, *y = tile->n + K * LANES; /* the ascent is done with n */

        ascend_tile(f, tile, &st);
        evaluate(f, tile, st.s, x, y, st.e2);
        for (l = 0; l < LANES; l++) {
            if (st.pending[l] && st.e2[l] < st.best[l]) {
                st.best[l] = st.e2[l];
                st.best_s[l] = st.s[l];
                st.best_theta[l] = st.theta[l];
                for (k = 0; k < K; k++) {
                    tile->x[k * LANES + l] = x[k * LANES + l];
                }
                for (k = 0; k < K * (size_t)f->each; k++) {
                    tile->y[k * LANES + l] = y[k * LANES + l];
                }
            }
        }
        set_levels(f, rules, &st);
        screen(f, tile, &st);
        for (l = 0, any = 0; l < LANES; l++) {
            if (st.pending[l]) {
                certify(f, tile, &st, l, attempt + 1 == ATTEMPTS);
                any = any || st.pending[l];
            }
        }
    }
}

const struct batch_kernels BATCH_KERNELS = {
    load_tile,
    fit_tile,
};
