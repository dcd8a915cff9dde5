/*
 * Derivatives of the projected functional: see curves_projected.h. Compiled as curves_reduced.c is.
 *
 * With s = exp(-2 u) a lobe g = b exp(-c s) has dg/du = 2 c s g and d2g/du2 = 4 c^2 s^2 g - 2 dg/du. Eliminating the
 * coefficients z of the support from f(u, z) = |I - Phi z|^2 leaves f_uu - f_uz f_zz^-1 f_zu, of which Kaufman's matrix
 * is what remains when products of r are dropped. SPDX-License-Identifier: MIT
 */
#include "curves_projected.h"

#include <math.h>

#include "curves_sums.h"

/* All of it is inlined twice, for one lobe and for two: the loops over columns disappear. */
#define INLINE static inline __attribute__((always_inline))

#define COLUMNS 3
/* A column whose square outside the others is less than this part of it adds nothing to a support. */
#define DEPENDENT 1e-13

/* What one point has for all channels: columns a, g_1, g_2 as they stand. */
struct geometry {
    int lobes;
    double gram[COLUMNS][COLUMNS];
    double moved[2][COLUMNS]; /* dg_p . column j */
    double bent[2][COLUMNS];  /* (d2g_p + 2 dg_p) . column j */
    double both[2][2];        /* dg_p . dg_q */
};

/* Of one channel. */
struct channel {
    const double *z;               /* coefficients of the columns */
    double slope[2], bend[2];      /* r . dg_p, r . d2g_p */
    double half[COLUMNS][COLUMNS]; /* Cholesky factor of the support's Gram matrix, rows of others 0 */
};

INLINE void move(struct curves_reduced *r, int p, double s)
{
    const double *shape = r->shape + (size_t)p * r->count;
    double *moved = r->moved + (size_t)p * r->count, twice = 2.0 * s;
    size_t i;

    for (i = 0; i < r->count; i++) {
        moved[i] = twice * r->c[i] * shape[i];
    }
}

/* rest = (2 c s)^2 e_p. */
INLINE void bend(struct curves_reduced *r, int p, double s)
{
    const double *moved = r->moved + (size_t)p * r->count;
    double twice = 2.0 * s;
    size_t i;

    for (i = 0; i < r->count; i++) {
        r->rest[i] = twice * r->c[i] * moved[i];
    }
}

INLINE void look(struct curves_reduced *r, const double *s, struct geometry *g)
{
    size_t n = r->count;
    int p, q;

    g->gram[0][0] = r->norm_a * r->norm_a;
    for (p = 0; p < g->lobes; p++) {
        const double *shape = r->shape + (size_t)p * n, *moved = r->moved + (size_t)p * n;

        move(r, p, s[p]);
        g->gram[0][1 + p] = g->gram[1 + p][0] = sum2(n, r->ab, shape);
        g->moved[p][0] = sum2(n, r->ab, moved);
        for (q = 0; q < g->lobes; q++) {
            g->moved[p][1 + q] = sum3(n, r->b2, moved, r->shape + (size_t)q * n);
        }
        for (q = 0; q <= p; q++) {
            g->gram[1 + p][1 + q] = g->gram[1 + q][1 + p] = sum3(n, r->b2, shape, r->shape + (size_t)q * n);
            g->both[p][q] = g->both[q][p] = sum3(n, r->b2, moved, r->moved + (size_t)q * n);
        }
    }
}

/* Second derivatives of lobe p, into `bent`; r->rest holds its shape afterwards. */
INLINE void look_again(struct curves_reduced *r, int p, double s, struct geometry *g)
{
    size_t n = r->count;
    int q;

    bend(r, p, s);
    g->bent[p][0] = sum2(n, r->ab, r->rest);
    for (q = 0; q < g->lobes; q++) {
        g->bent[p][1 + q] = sum3(n, r->b2, r->rest, r->shape + (size_t)q * n);
    }
}

INLINE void factor(const struct geometry *g, struct channel *c)
{
    int i, j, l;

    for (j = 0; j <= g->lobes; j++) {
        double left;

        for (i = 0; i < j; i++) {
            double sum = c->z[j] > 0.0 ? g->gram[i][j] : 0.0;

            for (l = 0; l < i; l++) {
                sum -= c->half[i][l] * c->half[j][l];
            }
            c->half[j][i] = c->half[i][i] > 0.0 ? sum / c->half[i][i] : 0.0;
        }
        left = c->z[j] > 0.0 ? g->gram[j][j] : 0.0;
        for (l = 0; l < j; l++) {
            left -= c->half[j][l] * c->half[j][l];
        }
        c->half[j][j] = left > DEPENDENT * g->gram[j][j] ? sqrt(left) : 0.0;
    }
}

/* x -> half^-1 x, whose squares are those of x in the inverse of the support's Gram matrix. */
INLINE void whiten(const struct geometry *g, const struct channel *c, double *x)
{
    int j, l;

    for (j = 0; j <= g->lobes; j++) {
        for (l = 0; l < j; l++) {
            x[j] -= c->half[j][l] * x[l];
        }
        x[j] = c->half[j][j] > 0.0 ? x[j] / c->half[j][j] : 0.0;
    }
}

INLINE double product(const struct geometry *g, const double *x, const double *y)
{
    double sum = 0.0;
    int j;

    for (j = 0; j <= g->lobes; j++) {
        sum += x[j] * y[j];
    }
    return sum;
}

/* Half of what a channel adds to the matrix; `residual`: 1 with the terms of the Hessian that Gauss-Newton drops. */
INLINE void add_projected(const struct geometry *g, const struct channel *c, double residual, double *matrix)
{
    double w[2][COLUMNS];
    int p, q, j;

    for (p = 0; p < g->lobes; p++) {
        for (j = 0; j <= g->lobes; j++) {
            w[p][j] = c->z[1 + p] * g->moved[p][j] - (j == 1 + p ? residual * c->slope[p] : 0.0);
        }
        whiten(g, c, w[p]);
    }
    for (p = 0; p < g->lobes; p++) {
        for (q = 0; q < g->lobes; q++) {
            matrix[p * g->lobes + q] += c->z[1 + p] * c->z[1 + q] * g->both[p][q] - product(g, w[p], w[q]);
        }
        matrix[p * g->lobes + p] -= residual * c->z[1 + p] * c->bend[p];
    }
}

/* The other half of Golub and Pereyra's Jacobian, which lies in the span of the columns. */
INLINE void add_turn(const struct geometry *g, const struct channel *c, double *matrix)
{
    double w[2][COLUMNS] = {{0.0}};
    int p, q;

    for (p = 0; p < g->lobes; p++) {
        w[p][1 + p] = c->slope[p];
        whiten(g, c, w[p]);
    }
    for (p = 0; p < g->lobes; p++) {
        for (q = 0; q < g->lobes; q++) {
            matrix[p * g->lobes + q] += product(g, w[p], w[q]);
        }
    }
}

INLINE void twice(int lobes, double *matrix)
{
    int j;

    for (j = 0; j < lobes * lobes; j++) {
        matrix[j] *= 2.0;
    }
}

INLINE void clear(int lobes, double *matrix)
{
    int j;

    for (j = 0; j < lobes * lobes; j++) {
        matrix[j] = 0.0;
    }
}

INLINE void channels(struct curves_reduced *r, const double *s, struct geometry *g, int second, double *slopes,
                     double *bends)
{
    size_t n = r->count, k;
    int p;

    look(r, s, g);
    for (p = 0; p < g->lobes; p++) {
        if (second) {
            look_again(r, p, s[p], g);
        }
        for (k = 0; k < r->channels; k++) {
            const double *z = r->coefficient + 3 * k;
            double slope = sum2(n, r->ib + k * n, r->moved + (size_t)p * n) - product(g, z, g->moved[p]);

            if (p == 0) {
                slopes[2 * k + 1] = bends[2 * k + 1] = 0.0;
            }
            slopes[2 * k + (size_t)p] = slope;
            bends[2 * k + (size_t)p] = second
                                           ? sum2(n, r->ib + k * n, r->rest) - product(g, z, g->bent[p]) - 2.0 * slope
                                           : 0.0;
        }
    }
}

INLINE void add_channel(const struct geometry *g, const struct channel *c, int kind, double *gradient, double *matrix,
                        double *safe)
{
    int p;

    for (p = 0; p < g->lobes; p++) {
        gradient[p] -= 2.0 * c->z[1 + p] * c->slope[p];
    }
    add_projected(g, c, kind == CURVES_NEWTON ? 1.0 : 0.0, matrix);
    if (kind == CURVES_GOLUB_PEREYRA) {
        add_turn(g, c, matrix);
    }
    if (safe) {
        add_projected(g, c, 0.0, safe);
    }
}

INLINE void projected(struct curves_reduced *r, int lobes, const double *s, int kind, double *gradient, double *matrix,
                      double *safe)
{
    double slopes[2 * PEERS_MOST_CHANNELS], bends[2 * PEERS_MOST_CHANNELS];
    struct geometry g = {.lobes = lobes};
    size_t k;

    clear(lobes, matrix);
    if (safe) {
        clear(lobes, safe);
    }
    gradient[0] = gradient[lobes - 1] = 0.0;
    channels(r, s, &g, kind == CURVES_NEWTON, slopes, bends);
    for (k = 0; k < r->channels; k++) {
        struct channel c = {.z = r->coefficient + 3 * k,
                            .slope = {slopes[2 * k], slopes[2 * k + 1]},
                            .bend = {bends[2 * k], bends[2 * k + 1]}};

        factor(&g, &c);
        add_channel(&g, &c, kind, gradient, matrix, safe);
    }
    twice(lobes, matrix);
    if (safe) {
        twice(lobes, safe);
    }
}

CLONES void curves_projected(struct curves_reduced *r, int lobes, const double *u, int kind, double *gradient,
                             double *matrix, double *safe)
{
    double s[2] = {exp(-2.0 * u[0]), lobes == 2 ? exp(-2.0 * u[1]) : 0.0};

    if (lobes == 2) {
        projected(r, 2, s, kind, gradient, matrix, safe);
    } else {
        projected(r, 1, s, kind, gradient, matrix, safe);
    }
}
