/*
 * Brute force over sigma = k 2^-M in (0, 6] as a method of the benchmark, in double and as fast as we can write it:
 * lobes are computed once, pairs are screened sixty-four at a time by what they would explain without the constraint
 * of sign, and only those that could beat the best so far are solved. tests/ref/brute.c is its slow, exact sibling.
 * This file is compiled as curves_reduced.c is. SPDX-License-Identifier: MIT
 */
#include "curves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define CLONES __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define CLONES
#endif

#define BLOCK 64
/* Below this 1 - cosine^2 the screen has lost its digits and the pair is solved. */
#define NARROW 1e-6

/* Lobes of unit length with the diffuse column taken out: v_i = (g_i - kappa_i a) / sqrt(1 - kappa_i^2). */
struct grid {
    const struct curves_reduced *reduced;
    size_t count, stride, channels, depth;
    double *u;             /* count: ln sigma; owns the memory */
    double *lobe;          /* depth x stride: sqrt(b2) e / |g|, so that dot products are cosines */
    double *kappa, *scale; /* stride: a.g, 1 / sqrt(1 - kappa^2) */
    double *rho, *squares; /* channels x stride: I.v; stride: sum of its squares */
    double base;           /* sum of omega^2 */
};

static int grid_new(struct grid *g, struct curves_reduced *r, int step_log2)
{
    size_t i, d, k;

    g->reduced = r;
    g->count = (size_t)6 << step_log2;
    g->stride = (g->count + BLOCK - 1) / BLOCK * BLOCK;
    g->channels = r->channels;
    g->depth = r->count;
    g->u = calloc(g->stride * (g->depth + g->channels + 4), sizeof *g->u);
    if (!g->u) {
        return 0;
    }
    g->lobe = g->u + g->stride;
    g->kappa = g->lobe + g->depth * g->stride;
    g->scale = g->kappa + g->stride;
    g->squares = g->scale + g->stride;
    g->rho = g->squares + g->stride;
    g->base = 0.0;
    for (k = 0; k < g->channels; k++) {
        g->base += r->omega[k] * r->omega[k];
    }
    for (i = 0; i < g->count; i++) {
        double norm = 0.0, kappa = 0.0;

        g->u[i] = log(ldexp((double)(i + 1), -step_log2));
        curves_reduced_value(r, 1, &g->u[i], NULL); /* leaves e^-cs in shape */
        for (d = 0; d < g->depth; d++) {
            norm += r->b2[d] * r->shape[d] * r->shape[d];
            kappa += r->ab[d] * r->shape[d];
        }
        norm = sqrt(norm);
        kappa /= norm * r->norm_a;
        g->kappa[i] = kappa;
        g->scale[i] = 1.0 / sqrt(fmax(1.0 - kappa * kappa, 1e-300));
        for (d = 0; d < g->depth; d++) {
            g->lobe[d * g->stride + i] = sqrt(r->b2[d]) * r->shape[d] / norm;
        }
        for (k = 0; k < g->channels; k++) {
            double tau = 0.0;

            for (d = 0; d < g->depth; d++) {
                tau += r->ib[k * g->depth + d] * r->shape[d];
            }
            g->rho[k * g->stride + i] = (tau / norm - kappa * r->omega[k]) * g->scale[i];
            g->squares[i] += g->rho[k * g->stride + i] * g->rho[k * g->stride + i];
        }
    }
    return 1;
}

/* What pairs (i, first + t) would explain were all signs free; infinite where the screen cannot tell. */
CLONES static void screen(const struct grid *g, size_t i, size_t first, double *restrict upper)
{
    double nu[BLOCK] = {0.0}, cross[BLOCK] = {0.0};
    size_t d, k, t;

    for (d = 0; d < g->depth; d++) {
        const double *row = g->lobe + d * g->stride + first;
        double mine = g->lobe[d * g->stride + i];

        for (t = 0; t < BLOCK; t++) {
            nu[t] += mine * row[t];
        }
    }
    for (k = 0; k < g->channels; k++) {
        const double *row = g->rho + k * g->stride + first;
        double mine = g->rho[k * g->stride + i];

        for (t = 0; t < BLOCK; t++) {
            cross[t] += mine * row[t];
        }
    }
    for (t = 0; t < BLOCK; t++) {
        double cosine = (nu[t] - g->kappa[i] * g->kappa[first + t]) * g->scale[i] * g->scale[first + t];
        double rest = 1.0 - cosine * cosine;
        double value = g->base + (g->squares[i] + g->squares[first + t] - 2.0 * cosine * cross[t]) / rest;

        upper[t] = rest > NARROW ? value : INFINITY;
    }
}

/* Distinct lobes that are the same to the last digit (the tail of narrow ones) need no pair. */
static int same_lobe(const struct grid *g, size_t i, size_t j)
{
    size_t d;

    for (d = 0; d < g->depth; d++) {
        if (fabs(g->lobe[d * g->stride + i] - g->lobe[d * g->stride + j]) > 1e-13) {
            return 0;
        }
    }
    return 1;
}

/* Best pair, from the best single lobe on. Returns the number of pairs that were solved. */
static double scan_pairs(const struct grid *g, struct curves_reduced *r, double *best, double u[2])
{
    double upper[BLOCK], slack = 1e-8 * r->total, solved = 0.0;
    size_t i, first, t;

    for (i = 0; i < g->count; i++) {
        for (first = i / BLOCK * BLOCK; first < g->stride; first += BLOCK) {
            screen(g, i, first, upper);
            for (t = 0; t < BLOCK; t++) {
                size_t j = first + t;
                double pair[2], e2;

                if (!(upper[t] + slack > r->total - *best) || j <= i || j >= g->count ||
                    (upper[t] == INFINITY && same_lobe(g, i, j))) {
                    continue;
                }
                pair[0] = g->u[i];
                pair[1] = g->u[j];
                e2 = curves_reduced_value(r, 2, pair, NULL);
                solved++;
                if (e2 < *best) {
                    *best = e2;
                    memcpy(u, pair, sizeof pair);
                }
            }
        }
    }
    return solved;
}

static double scan_single(struct curves_reduced *r, int step_log2, double *best, double *u)
{
    size_t i, count = (size_t)6 << step_log2;

    for (i = 1; i <= count; i++) {
        double at = log(ldexp((double)i, -step_log2)), e2 = curves_reduced_value(r, 1, &at, NULL);

        if (e2 < *best) {
            *best = e2;
            u[0] = u[1] = at;
        }
    }
    return (double)count;
}

static void run_grid(const struct curves_task *task, const struct curves_method *method)
{
    struct curves_reduced reduced = task->reduced; /* shares its arrays */
    int m;

    for (m = 1; m <= task->options->grid[task->lobes - 1]; m++) {
        double time[CURVES_MOST_REPEATS], spent = 0.0, u[2] = {0.0, 0.0};
        struct curves_row row = {.knob = ldexp(1.0, -m)};
        struct grid grid;
        int done = 0;

        while (done == 0 || curves_more(task, done, spent)) {
            double begun = curves_now(), best = INFINITY;

            row.work = scan_single(&reduced, m, &best, u);
            if (task->lobes == 2) {
                if (!grid_new(&grid, &reduced, m)) {
                    return;
                }
                row.work = scan_pairs(&grid, &reduced, &best, u);
                free(grid.u);
            }
            time[done] = curves_now() - begun;
            spent += time[done++];
        }
        row.seconds = row.search = curves_median(time, done);
        row.e2 = curves_judge(&task->problem, task->lobes, u);
        curves_print(task, method->name, &row);
        if (row.seconds > task->options->patience) {
            return;
        }
    }
}

const struct curves_method curves_grid_methods[] = {{"grid", run_grid, 0, 0}, {NULL, NULL, 0, 0}};
