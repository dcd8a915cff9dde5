/*
 * How D may change in a window, and how a whole window is screened. SPDX-License-Identifier: MIT
 *
 * Rate. Where |D'| <= rate D as quadratic forms all over, z D(t0 + d) z >= exp(-rate |d|) z D(t0) z for every z.
 *
 * Screening, from the end nodes. Let A(t) be the columns beside a, in the window's factors, chords taken in t, and y >= 0. The
 * residual r is beside a, too. With x the place of t on the chord, g the root of what is gained at an end,
 *
 *     r.A(t) y = (1 - x) r.A_low y + x r.A_high y + r.Delta(t) y
 *             <= max(g_low, g_high) chord of |A y| + |r| |Delta(t) y|
 *
 * so with |Delta(t) y| <= delta min(|A_low y|, |A_high y|) and |A(t) y| >= shrink chord of |A y|, for every y >= 0,
 *
 *     J <= (sqrt(max J at the ends) + delta |r|)^2 / shrink^2.
 *
 * By convexity (chord of |A y|)^2 <= chord of y D y, so that shrink^2 is at most the least eigenvalue of D against its chord.
 * Both are found on PIECES of the window, with what can happen within each by derivatives. D is that of window.c, whose
 * products of different columns are a little lower: for y >= 0 that takes from y D y, and as much from its chord.
 */
#include <math.h>

#include "batch/fast.h"
#include "base/tolerance.h"

#define PIECES 32
/* Where D changes faster, is known worse, or is further below its chord, products of different columns are lowered more: two
 * columns become parallel there. */
#define FAST 4.0
#define SHARE 1e-2
#define SHRUNK 0.5

typedef double matrix[EACH_MOST][EACH_MOST];

/* A window being looked at. */
struct looking {
    const struct batch_fast *fast;
    const struct batch_window *window;
    int n;
    double second, off; /* norms: of D'' at most, and of the errors of D */
    matrix low, high;   /* D at the ends */
};

/* D and its derivative at t. */
static void gram(const struct batch_window *w, int n, double t, matrix d, matrix slope)
{
    int i, j, q;

    for (j = 0; j < n; j++) {
        for (i = 0; i <= j; i++) {
            const double *c = w->d[BATCH_PAIR(i, j)];
            double value = 0.0, rise = 0.0;

            for (q = BATCH_TERMS_D - 1; q >= 0; q--) {
                rise = rise * t + value;
                value = value * t + c[q];
            }
            d[i][j] = d[j][i] = value;
            slope[i][j] = slope[j][i] = rise;
        }
    }
}

/* The inverse of the Cholesky factor of d, below the diagonal; 0 when there is none. */
static int whitener(matrix d, int n, matrix inverse)
{
    double l00, l10, l11;

    inverse[0][1] = inverse[1][0] = inverse[1][1] = 0.0;
    if (!(d[0][0] > 0.0)) {
        return 0;
    }
    l00 = sqrt(d[0][0]);
    inverse[0][0] = 1.0 / l00;
    if (n == 1) {
        return 1;
    }
    l10 = d[1][0] / l00;
    l11 = d[1][1] - l10 * l10;
    if (!(l11 > 0.0)) {
        return 0;
    }
    inverse[1][1] = 1.0 / sqrt(l11);
    inverse[1][0] = -l10 * inverse[0][0] * inverse[1][1];
    return 1;
}

/* W m W^T. */
static void whiten(matrix w, matrix m, int n, matrix out)
{
    int i, j, p, q;

    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            out[i][j] = 0.0;
            for (p = 0; p < n; p++) {
                for (q = 0; q < n; q++) {
                    out[i][j] += w[i][p] * m[p][q] * w[j][q];
                }
            }
        }
    }
}

static double norm(matrix m, int n)
{
    double sum = 0.0;
    int i, j;

    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            sum += m[i][j] * m[i][j];
        }
    }
    return sqrt(sum);
}

/* No eigenvalue is larger. */
static double largest(matrix m, int n)
{
    return n == 1 ? m[0][0] : fmax(m[0][0], m[1][1]) + fabs(m[0][1]);
}

static double squares(matrix m, int n)
{
    double length = norm(m, n);

    return length * length;
}

/* What a piece around t, |d| <= reach, says: the rate, and how far the chord of D is above D, relative to D. */
static void look_at_piece(const struct looking *l, double t, double reach, double *rate, double *above)
{
    matrix d, slope, w, chord, white, white_slope;
    double bend, floor, lifted;
    int i, j;

    gram(l->window, l->n, t, d, slope);
    if (!whitener(d, l->n, w)) {
        *rate = *above = INFINITY;
        return;
    }
    bend = squares(w, l->n) * 1.01;
    whiten(w, slope, l->n, white_slope);
    floor = 1.0 - reach * norm(white_slope, l->n) - bend * (0.5 * reach * reach * l->second + l->off);
    if (!(floor > 0.1)) {
        *rate = *above = INFINITY;
        return;
    }
    *rate = fmax(*rate, 1.01 * (norm(white_slope, l->n) + bend * reach * l->second) / floor);
    for (i = 0; i < l->n; i++) {
        for (j = 0; j < l->n; j++) {
            chord[i][j] = 0.5 * ((1.0 - t) * l->low[i][j] + (1.0 + t) * l->high[i][j]) - d[i][j];
            slope[i][j] = 0.5 * (l->high[i][j] - l->low[i][j]) - slope[i][j];
        }
    }
    whiten(w, chord, l->n, white);
    whiten(w, slope, l->n, white_slope);
    lifted = largest(white, l->n) + reach * norm(white_slope, l->n) +
             bend * (0.5 * reach * reach * l->second + 2.0 * l->off);
    *above = fmax(*above, lifted / floor);
}

/* Delta of a group in column j at t, from its polynomial with more terms. */
static double off_chord(const double *shape, double t)
{
    double here = 0.0, even = 0.0, odd = 0.0;
    int q;

    for (q = BATCH_TERMS_MORE - 1; q >= 0; q--) {
        here = here * t + shape[q];
        even += q % 2 ? 0.0 : shape[q];
        odd += q % 2 ? shape[q] : 0.0;
    }
    return here - (even + t * odd);
}

/* Gram matrix of Delta beside a at t. */
static void off_gram(const struct looking *l, size_t w, double t, matrix out)
{
    const struct batch_fast *f = l->fast;
    double along[EACH_MOST] = {0.0};
    size_t m;
    int i, j;

    for (i = 0; i < l->n; i++) {
        for (j = 0; j < l->n; j++) {
            out[i][j] = 0.0;
        }
    }
    for (m = 0; m < f->distinct; m++) {
        double off[EACH_MOST];

        for (j = 0; j < l->n; j++) {
            off[j] = off_chord(f->column[j].shape[1] + (w * f->distinct + m) * BATCH_STRIDE_MORE, t);
            along[j] += f->column[j].ab[m] * off[j];
            out[j][j] += f->column[j].bb[m] * (off[j] * off[j]) * (1.0 + 1e-12);
        }
        if (l->n > 1) {
            out[0][1] += f->cross[m] * off[0] * off[1];
        }
    }
    for (j = 0; j < l->n; j++) {
        for (i = 0; i <= j; i++) {
            out[i][j] -= along[i] * along[j];
            out[j][i] = out[i][j];
        }
    }
}

/* Largest |Delta''| of all columns together. */
static double off_bend(const struct looking *l, size_t w)
{
    const struct batch_fast *f = l->fast;
    double sum = 0.0;
    size_t m;
    int j, q;

    for (j = 0; j < l->n; j++) {
        for (m = 0; m < f->distinct; m++) {
            const double *shape = f->column[j].shape[1] + (w * f->distinct + m) * BATCH_STRIDE_MORE;
            double bend = 0.0;

            for (q = 2; q < BATCH_TERMS_MORE; q++) {
                bend += (double)(q * (q - 1)) * fabs(shape[q]);
            }
            sum += f->column[j].bb[m] * (bend * bend);
        }
    }
    return 1.01 * sqrt(sum);
}

/*
 * delta: Delta at places that cut the window evenly; between two of them each component is at most the larger, and what a
 * chord of that length misses.
 */
static double find_delta(const struct looking *l, size_t w, matrix low, matrix high)
{
    double step = 2.0 / PIECES, before = 0.0, most = 0.0, error = 0.0, inverse, missed;
    int i, j;

    for (j = 0; j < l->n; j++) {
        error += 2.0 * l->window->n_error[j][1];
    }
    inverse = sqrt(fmax(squares(low, l->n), squares(high, l->n)));
    missed = (step * step / 8.0 * off_bend(l, w) + error) * inverse;
    for (i = 1; i <= PIECES; i++) {
        double here = 0.0;
        matrix off, white;

        if (i < PIECES) {
            off_gram(l, w, -1.0 + step * i, off);
            whiten(low, off, l->n, white);
            here = largest(white, l->n);
            whiten(high, off, l->n, white);
            here = sqrt(fmax(0.0, fmax(here, largest(white, l->n))));
        }
        most = fmax(most, 1.01 * (fmax(here, before) + missed));
        before = here;
    }
    return most + TOL_CURVATURE;
}

static void start(struct looking *l)
{
    const struct batch_window *w = l->window;
    matrix slope;
    int i, j, q;

    l->second = l->off = 0.0;
    for (j = 0; j < l->n; j++) {
        for (i = 0; i <= j; i++) {
            double bend = 0.0, twice = i == j ? 1.0 : 2.0;

            for (q = 2; q < BATCH_TERMS_D; q++) {
                bend += (double)(q * (q - 1)) * fabs(w->d[BATCH_PAIR(i, j)][q]);
            }
            l->second += twice * bend;
            l->off += twice * w->d_error[BATCH_PAIR(i, j)];
        }
    }
    gram(w, l->n, -1.0, l->low, slope);
    gram(w, l->n, 1.0, l->high, slope);
}

/* Rate, excess, delta and shrink with D as it is. */
static void look(struct looking *l, struct batch_window *window, size_t w)
{
    double above = 0.0, excess = 0.0;
    matrix low, high, white, d, slope;
    int i;

    start(l);
    window->rate = 0.0;
    for (i = 0; i < PIECES; i++) {
        double t = -1.0 + (2.0 * i + 1.0) / PIECES;

        look_at_piece(l, t, 1.0 / PIECES, &window->rate, &above);
        gram(window, l->n, t, d, slope);
        excess = whitener(d, l->n, white) ? fmax(excess, 8.0 * squares(white, l->n) * l->off) : INFINITY;
    }
    /* exp(1) of what D is at the middle of a piece, and its inverse, are within a factor of 8. */
    window->excess = window->rate <= PIECES ? excess + TOL_CURVATURE : INFINITY;
    window->shrink = window->delta = -1.0;
    if (isfinite(above) && whitener(l->low, l->n, low) && whitener(l->high, l->n, high)) {
        window->delta = find_delta(l, w, low, high);
        window->shrink = 1.0 / sqrt(1.0 + fmax(above, 0.0)) - TOL_CURVATURE;
    }
}

void brdffit_batch_screen(const struct batch_fast *f, struct batch_window *window, size_t w)
{
    static const double apart[] = {BATCH_APART, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1};
    struct looking l = {.fast = f, .window = window, .n = f->each};
    double cosine = window->d[BATCH_PAIR(0, 1)][0];
    size_t i;

    for (i = 0; i < sizeof apart / sizeof apart[0]; i++) {
        window->apart = f->each > 1 ? apart[i] : 0.0;
        window->d[BATCH_PAIR(0, 1)][0] = cosine - window->apart;
        look(&l, window, w);
        if (f->each == 1 || (window->rate <= FAST && window->excess <= SHARE && window->shrink > SHRUNK)) {
            return;
        }
    }
}
