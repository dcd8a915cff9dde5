/*
 * The reduced problem of the benchmark's peers: see curves_reduced.h. This file is compiled with -O3 and, where the
 * compiler can, for several instruction sets, one of which is chosen at run time: these loops are the peers' time.
 * SPDX-License-Identifier: MIT
 */
#include "curves_reduced.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "curves_sums.h"

/* A column with less than this of its square outside the others adds nothing. */
#define DEPENDENT 1e-14

/* ---- From samples --------------------------------------------------------------------------------------- */

struct order {
    double c;
    size_t sample;
};

static int compare(const void *first, const void *second)
{
    double x = ((const struct order *)first)->c, y = ((const struct order *)second)->c;

    return (x > y) - (x < y);
}

/* Half angles computed from directions that are mirror images differ in the last digits: they are one. */
static int same_c(double first, double second)
{
    return second - first <= 1e-13 * (1.0 + second);
}

static int make_room(struct curves_reduced *r, size_t samples, size_t channels)
{
    size_t most = (samples + 7) / 8 * 8, size = most * (8 + channels) + 6 * channels;

    memset(r, 0, sizeof *r);
    r->c = aligned_alloc(64, (size * sizeof *r->c + 63) / 64 * 64);
    if (!r->c) {
        return 0;
    }
    memset(r->c, 0, size * sizeof *r->c);
    r->channels = channels;
    r->b2 = r->c + most;
    r->ab = r->b2 + most;
    r->shape = r->ab + most;
    r->moved = r->shape + 2 * most;
    r->rest = r->moved + 2 * most;
    r->ib = r->rest + most;
    r->omega = r->ib + channels * most;
    r->tau = r->omega + channels;
    r->rho = r->tau + channels;
    r->coefficient = r->rho + channels;
    return 1;
}

static void add(struct curves_reduced *r, const struct peers_problem *p, size_t i, size_t at, size_t stride)
{
    size_t k;

    r->b2[at] += p->b[i] * p->b[i];
    r->ab[at] += p->a[i] * p->b[i];
    r->norm_a += p->a[i] * p->a[i];
    for (k = 0; k < p->channels; k++) {
        double value = p->value[i * p->channels + k];

        r->ib[k * stride + at] += value * p->b[i];
        r->omega[k] += value * p->a[i];
        r->total += value * value;
    }
}

int curves_reduced_new(struct curves_reduced *r, const struct peers_problem *p)
{
    struct order *order = malloc(p->samples * sizeof *order);
    size_t i, k, distinct = 0;

    if (!order || !make_room(r, p->samples, p->channels)) {
        free(order);
        return 0;
    }
    for (i = 0; i < p->samples; i++) {
        order[i].c = p->c[i];
        order[i].sample = i;
    }
    qsort(order, p->samples, sizeof *order, compare);
    for (i = 0; i < p->samples; i++) {
        distinct += i == 0 || !same_c(order[i - 1].c, order[i].c);
    }
    r->count = (distinct + 7) / 8 * 8;
    for (distinct = 0, i = 0; i < p->samples; i++) {
        distinct += i > 0 && !same_c(order[i - 1].c, order[i].c);
        r->c[distinct] = order[i].c - order[0].c;
        add(r, p, order[i].sample, distinct, r->count);
    }
    r->norm_a = sqrt(r->norm_a);
    for (k = 0; k < p->channels; k++) {
        r->omega[k] /= r->norm_a;
    }
    free(order);
    return 1;
}

void curves_reduced_free(struct curves_reduced *r)
{
    free(r->c);
    r->c = NULL;
}

/* ---- Restricted problems in closed form ------------------------------------------------------------------ */

/* Unit columns of one channel: a, g1, and g2 = mu g1 + rest, |rest|^2 = q. */
struct columns {
    double kappa1, kappa2, mu; /* a.g1, a.g2, g1.g2 */
    double q, cross;           /* |rest|^2, a.rest */
};

struct targets {
    double omega, tau1, tau2, rho; /* I.a, I.g1, I.g2, I.rest */
};

/* Explained squares of a and one lobe; coefficients of the unit columns to z[0], z[at]. */
static inline __attribute__((always_inline)) double explain_one(double omega, double tau, double kappa, int at,
                                                                double *z)
{
    double best = 0.0, left = 1.0 - kappa * kappa, x = (omega - kappa * tau) / left, y = (tau - kappa * omega) / left;

    z[0] = z[1] = z[2] = 0.0;
    if (left > DEPENDENT && x > 0.0 && y > 0.0) {
        z[0] = x;
        z[at] = y;
        return omega * x + tau * y;
    }
    if (omega > 0.0) {
        z[0] = omega;
        best = omega * omega;
    }
    if (tau > 0.0 && tau * tau > best) {
        z[0] = 0.0;
        z[at] = tau;
        best = tau * tau;
    }
    return best;
}

/* Of all three columns. The unconstrained optimum of a support is the answer when all of it is positive. */
static inline __attribute__((always_inline)) double explain_two(const struct columns *m, const struct targets *t,
                                                                double *z)
{
    double w[3], best, second, z2, z1, x, left, open;

    if (m->q > DEPENDENT) {
        left = 1.0 - m->kappa1 * m->kappa1 - m->cross * m->cross / m->q;
        open = t->omega - m->kappa1 * t->tau1 - m->cross * t->rho / m->q;
        x = open / left;
        z2 = (t->rho - m->cross * x) / m->q;
        z1 = t->tau1 - m->kappa1 * x - m->mu * z2;
        if (left > DEPENDENT && x > 0.0 && z1 > 0.0 && z2 > 0.0) {
            z[0] = x;
            z[1] = z1;
            z[2] = z2;
            return t->tau1 * t->tau1 + t->rho * t->rho / m->q + open * open / left;
        }
    }
    best = explain_one(t->omega, t->tau1, m->kappa1, 1, z);
    second = explain_one(t->omega, t->tau2, m->kappa2, 2, w);
    if (second > best) {
        best = second;
        memcpy(z, w, sizeof w);
    }
    if (m->q > DEPENDENT) {
        z2 = t->rho / m->q;
        z1 = t->tau1 - m->mu * z2;
        second = t->tau1 * t->tau1 + t->rho * z2;
        if (z1 > 0.0 && z2 > 0.0 && second > best) {
            best = second;
            z[0] = 0.0;
            z[1] = z1;
            z[2] = z2;
        }
    }
    return best;
}

/* ---- Value and gradient ---------------------------------------------------------------------------------- */

static inline __attribute__((always_inline)) double value_one(struct curves_reduced *r, double s)
{
    size_t n = r->count, k;
    double norm, kappa, explained = 0.0;

    shape_of(n, r->c, s, r->shape);
    norm = sqrt(sum3(n, r->b2, r->shape, r->shape));
    kappa = sum2(n, r->ab, r->shape) / (norm * r->norm_a);
    for (k = 0; k < r->channels; k++) {
        double *z = r->coefficient + 3 * k;

        explained += explain_one(r->omega[k], sum2(n, r->ib + k * n, r->shape) / norm, kappa, 1, z);
        z[0] /= r->norm_a;
        z[1] /= norm;
    }
    return r->total - explained;
}

static inline __attribute__((always_inline)) double value_two(struct curves_reduced *r, double s1, double s2)
{
    size_t n = r->count, i, k;
    double *g1 = r->shape, *g2 = r->shape + n, norm1, norm2, explained = 0.0, along;
    struct columns m;

    shape_of(n, r->c, s1, g1);
    shape_of(n, r->c, s2, g2);
    norm1 = sqrt(sum3(n, r->b2, g1, g1));
    norm2 = sqrt(sum3(n, r->b2, g2, g2));
    m.mu = sum3(n, r->b2, g1, g2) / (norm1 * norm2);
    along = m.mu / norm1;
    for (i = 0; i < n; i++) {
        r->rest[i] = g2[i] / norm2 - along * g1[i];
    }
    m.q = sum3(n, r->b2, r->rest, r->rest);
    m.kappa1 = sum2(n, r->ab, g1) / (norm1 * r->norm_a);
    m.cross = sum2(n, r->ab, r->rest) / r->norm_a;
    m.kappa2 = m.cross + m.mu * m.kappa1;
    for (k = 0; k < r->channels; k++) {
        double *z = r->coefficient + 3 * k;
        struct targets t = {r->omega[k], sum2(n, r->ib + k * n, g1) / norm1, 0.0, sum2(n, r->ib + k * n, r->rest)};

        t.tau2 = t.rho + m.mu * t.tau1;
        explained += explain_two(&m, &t, z);
        z[0] /= r->norm_a;
        z[1] /= norm1;
        z[2] /= norm2;
    }
    return r->total - explained;
}

/*
 * The coefficients being optimal, E^2 changes as the lobes do: with s = exp(-2 u),
 * dE^2/du_p = -4 s_p sum_k y_kp sum_d c e_p (I_k b - x_k a b - sum_q y_kq b^2 e_q).
 */
static inline __attribute__((always_inline)) void slope(struct curves_reduced *r, int lobes, const double *s,
                                                        double *gradient)
{
    size_t n = r->count, i, k, p, q, most = (size_t)lobes;

    for (p = 0; p < most; p++) {
        double u, h[2], sum = 0.0;

        for (i = 0; i < n; i++) {
            r->rest[i] = r->c[i] * r->shape[p * n + i];
        }
        u = sum2(n, r->ab, r->rest);
        for (q = 0; q < most; q++) {
            h[q] = sum3(n, r->b2, r->rest, r->shape + q * n);
        }
        for (k = 0; k < r->channels; k++) {
            const double *z = r->coefficient + 3 * k;
            double v = sum2(n, r->ib + k * n, r->rest) - z[0] * u;

            for (q = 0; q < most; q++) {
                v -= z[1 + q] * h[q];
            }
            sum += z[1 + p] * v;
        }
        gradient[p] = -4.0 * s[p] * sum;
    }
}

CLONES double curves_reduced_value(struct curves_reduced *r, int lobes, const double *u, double *gradient)
{
    double s[2] = {exp(-2.0 * u[0]), lobes == 2 ? exp(-2.0 * u[1]) : 0.0};
    double e2 = lobes == 2 ? value_two(r, s[0], s[1]) : value_one(r, s[0]);

    if (gradient) {
        slope(r, lobes, s, gradient);
    }
    return e2;
}

/* ---- For other languages --------------------------------------------------------------------------------- */

struct curves_reduced *curves_reduced_open(const char *path)
{
    struct peers_problem problem;
    struct curves_reduced *r = malloc(sizeof *r);
    const char *message;
    int good = r && peers_problem_read(path, &problem, &message);

    if (good) {
        good = curves_reduced_new(r, &problem);
        peers_problem_free(&problem);
    }
    if (!good) {
        free(r);
        r = NULL;
    }
    return r;
}

void curves_reduced_close(struct curves_reduced *r)
{
    if (r) {
        curves_reduced_free(r);
        free(r);
    }
}

double curves_reduced_one(struct curves_reduced *r, double u)
{
    return curves_reduced_value(r, 1, &u, NULL);
}

double curves_reduced_two(struct curves_reduced *r, double u1, double u2)
{
    double u[2] = {u1, u2};

    return curves_reduced_value(r, 2, u, NULL);
}

void curves_reduced_batch(struct curves_reduced *r, int lobes, size_t points, const double *u, double *e2)
{
    size_t i;

    for (i = 0; i < points; i++) {
        e2[i] = curves_reduced_value(r, lobes, u + i * (size_t)lobes, NULL);
    }
}

double curves_reduced_judge(const char *path, int lobes, const double *u)
{
    struct peers_problem problem;
    const char *message;
    double e2 = NAN;

    if (peers_problem_read(path, &problem, &message)) {
        e2 = curves_judge(&problem, lobes, u);
        peers_problem_free(&problem);
    }
    return e2;
}
