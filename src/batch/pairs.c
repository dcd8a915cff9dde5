/*
 * Pairs of windows, for two lobes: what the plan knows of the product of their columns. SPDX-License-Identifier: MIT
 *
 * D_12(t1, t2) = sum_m bb_m phi_m(t1) phi_m(t2) - u(t1) u(t2), each in the factors of its window, is the product of the
 * polynomials of window.c, those with 8 terms: off by at most n_error |b phi| of the other, each way, and as much for u.
 * Of a term t1^i t2^j what is beyond second order in a step (d1, d2), |d| <= h <= 1, is at most binomial(i + j, 3) h^3.
 */
#include <math.h>

#include "batch/fast.h"
#include "base/tolerance.h"

/* Rounding of a coefficient and its use, in u of the product of the columns' sizes. */
#define ROUNDING 4096.0

/* What the polynomials of a window are at most, and beyond degree 2 or 3 at its middle. */
static void measure_window(struct batch_fast *f, size_t w)
{
    struct batch_window *window = &f->window[w];
    double size = 0.0, rest = 0.0;
    size_t m, q;

    for (m = 0; m < f->distinct; m++) {
        const double *shape = f->column[0].shape[0] + (w * f->distinct + m) * BATCH_TERMS;
        double all = 0.0, beyond = 0.0;

        for (q = 0; q < BATCH_TERMS; q++) {
            all += fabs(shape[q]);
            beyond += q > 3 ? fabs(shape[q]) : 0.0;
        }
        size += f->column[0].bb[m] * (all * all);
        rest += f->column[0].bb[m] * (beyond * beyond);
    }
    window->size = 1.01 * sqrt(size);
    window->n_rest = 1.01 * sqrt(rest) + window->n_error[0][0];
    window->d_rest = window->d_error[0];
    for (q = 3; q < BATCH_TERMS_D; q++) {
        window->d_rest += 1.01 * fabs(window->d[0][q]);
    }
    window->u_rest = window->u_error[0][0];
    for (q = 3; q < BATCH_TERMS; q++) {
        window->u_rest += 1.01 * fabs(window->u[0][0][q]);
    }
}

static void multiply(const struct batch_fast *f, size_t v, size_t w, struct batch_pair *pair)
{
    size_t m, i, j;

    for (i = 0; i < BATCH_TERMS; i++) {
        for (j = 0; j < BATCH_TERMS; j++) {
            pair->d[i][j] = -f->window[v].u[0][0][i] * f->window[w].u[0][0][j];
        }
    }
    for (m = 0; m < f->distinct; m++) {
        const double *one = f->column[0].shape[0] + (v * f->distinct + m) * BATCH_TERMS;
        const double *two = f->column[0].shape[0] + (w * f->distinct + m) * BATCH_TERMS;

        for (i = 0; i < BATCH_TERMS; i++) {
            double factor = f->column[0].bb[m] * one[i];

            for (j = 0; j < BATCH_TERMS; j++) {
                pair->d[i][j] += factor * two[j];
            }
        }
    }
}

void brdffit_batch_pairs(struct batch_fast *f)
{
    size_t v, w, i, j;

    for (w = 0; w < f->windows; w++) {
        measure_window(f, w);
    }
    for (w = 0; w < f->windows; w++) {
        for (v = 0; v <= w; v++) {
            const struct batch_window *one = &f->window[v], *two = &f->window[w];
            struct batch_pair *pair = &f->pair[BATCH_PAIR(v, w)];

            multiply(f, v, w, pair);
            pair->error = 1.01 * ((one->n_error[0][0] + one->u_error[0][0]) * two->size +
                                  (two->n_error[0][0] + two->u_error[0][0]) * (one->size + one->n_error[0][0])) +
                          ROUNDING * TOL_UNIT * one->size * two->size;
            pair->third = pair->rest = 0.0;
            for (i = 0; i < BATCH_TERMS; i++) {
                for (j = 0; j < BATCH_TERMS; j++) {
                    size_t n = i + j;

                    pair->third += n > 2 ? 1.01 * (double)(n * (n - 1) * (n - 2) / 6) * fabs(pair->d[i][j]) : 0.0;
                    pair->rest += n > 2 ? 1.01 * fabs(pair->d[i][j]) : 0.0;
                }
            }
            pair->rest += pair->error;
        }
    }
}
