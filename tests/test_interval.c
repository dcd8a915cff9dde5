/*
 * Enclosures over intervals by sampling inside, in long double and with no tolerance: tau below and kappa and mu
 * above their shifted chords, and everything within its range. SPDX-License-Identifier: MIT
 */
#include "moments_case.h"

#if defined(__SANITIZE_ADDRESS__)
#define TRIALS 20000L
#else
#define TRIALS 150000L
#endif
#define POINTS 12

static void within(const char *what, double got, long double exact, long double allowed)
{
    if (!(fabsl((long double)got - exact) <= allowed)) {
        fail_msg("%s: %.17g, exactly %.17Lg, allowed %Lg off", what, got, exact, allowed);
    }
}

/* A chord's error is at most shift 4 f (1 - f) at fraction f of the interval, in the variable u. */
static long double bend(long double f)
{
    return 4.0L * f * (1.0L - f);
}

static void failed(const struct moments_case *m, const char *what, const struct interval *v, double theta,
                   long double value, long double limit)
{
    brdffit_test_print(&m->samples, &m->options);
    fail_msg("%s at theta %a in u = [%a, %a]: %.20Lg against %.20Lg", what, theta, v->low->u, v->high->u, value, limit);
}

static void check_one(const struct moments_case *m, const struct interval *v, double theta, long double f,
                      const struct mc_exact *e)
{
    long double chord;
    size_t k;

    for (k = 0; k < m->channels; k++) {
        chord = (1.0L - f) * v->low->tau[k] + f * v->high->tau[k];
        if (isfinite(v->tau_shift[k]) && !(e->tau[k] <= chord + bend(f) * v->tau_shift[k])) {
            failed(m, "tau above chord", v, theta, e->tau[k], chord + bend(f) * v->tau_shift[k]);
        }
        if (!(e->tau[k] <= v->tau_sup[k])) {
            failed(m, "tau above its range", v, theta, e->tau[k], v->tau_sup[k]);
        }
    }
    chord = (1.0L - f) * v->low->kappa[0] + f * v->high->kappa[0];
    if (isfinite(v->kappa_shift[0]) && !(e->kappa >= chord - bend(f) * v->kappa_shift[0])) {
        failed(m, "kappa below chord", v, theta, e->kappa, chord - bend(f) * v->kappa_shift[0]);
    }
    if (!(e->kappa >= v->kappa_inf[0])) {
        failed(m, "kappa below its range", v, theta, e->kappa, v->kappa_inf[0]);
    }
}

/* Curvature of a lobe's own norm and its fourth moment, at a point. */
static void check_curvature(const struct moments_case *m, const struct interval *v, double theta,
                            const struct mc_exact *e)
{
    long double mean = 0.0L, slope = 0.0L, variance = 0.0L, m4 = 0.0L, curvature;
    size_t i;

    for (i = 0; i < m->count; i++) {
        long double p = e->shape[i] * e->shape[i] / e->h, x = mc_x(m, i, e->u);

        mean += p * x;
        slope += m->ggx ? p * 0.5L * x * x : 0.0L;
    }
    for (i = 0; i < m->count; i++) {
        long double p = e->shape[i] * e->shape[i] / e->h, d = mc_x(m, i, e->u) - mean;

        variance += p * d * d;
        m4 += p * d * d * d * d;
    }
    curvature = slope + 2.0L * variance;
    if (!(curvature >= v->curvature - 1e-30L * mean * mean)) {
        failed(m, "curvature below its infimum", v, theta, curvature, v->curvature);
    }
    if (v->eighth > 0.0 && !(sqrtl(m4) <= v->root_m4 + 1e-30L * mean * mean)) {
        failed(m, "fourth moment above its supremum", v, theta, sqrtl(m4), v->root_m4);
    }
}

struct drawn {
    const struct interval *side[2];
    double theta[2][2];
    double mu_shift[2], mu_corner[4], mu_inf;
    int refine;  /* by halves that meet at this part of the interval */
    double part;
};

static void check_mu(const struct moments_case *m, const struct drawn *s, const long double *f,
                     const struct mc_exact *e, const double *theta)
{
    long double mu = mc_mu(m, &e[0], &e[1]), chord = 0.0L;
    int c;

    for (c = 0; c < 4; c++) {
        chord += (c & 1 ? f[0] : 1.0L - f[0]) * (c & 2 ? f[1] : 1.0L - f[1]) * s->mu_corner[c];
    }
    chord -= bend(f[0]) * s->mu_shift[0] + bend(f[1]) * s->mu_shift[1];
    if (isfinite(s->mu_shift[0]) && isfinite(s->mu_shift[1]) && !(mu >= chord)) {
        failed(m, "mu below chord", s->side[0], theta[0], mu, chord);
    }
    if (!(mu >= s->mu_inf)) {
        failed(m, "mu below its range", s->side[1], theta[1], mu, s->mu_inf);
    }
}

static void draw_sides(const struct moments_case *m, double theta[2][2], struct brdffit_test_random *random)
{
    double low = m->fit.domain[0].low, high = m->fit.domain[0].high;
    int p, same = brdffit_test_below(random, 4) == 0;

    for (p = 0; p < 2; p++) {
        double width = (high - low) * brdffit_test_log_uniform(random, 1e-12, 1.0);

        theta[p][0] = brdffit_test_uniform(random, low, high - width);
        theta[p][1] = fmin(theta[p][0] + width, high);
    }
    if (theta[0][0] > theta[1][0]) {
        for (p = 0; p < 2; p++) {
            double keep = theta[0][p];

            theta[0][p] = theta[1][p];
            theta[1][p] = keep;
        }
    }
    /* Boxes are disjoint or on the diagonal. */
    if (same) {
        memcpy(theta[1], theta[0], sizeof theta[1]);
    } else {
        theta[0][1] = fmin(theta[0][1], theta[1][0]);
    }
}

static void open_sides(struct moments_case *m, struct drawn *s)
{
    struct bound_moment *engine = &m->fit.moment;
    struct sides sides = {&engine->moments, {0, 0}, {NULL, NULL}};
    /* Nodes 2 p and 2 p + 1 are the ends of side p, 4 + p splits it; then the two sides and their parts. */
    struct axis_interval interval[6] = {{0, 1, 0}, {2, 3, 0}, {0, 4, 0}, {4, 1, 0}, {2, 5, 0}, {5, 3, 0}};
    double coordinate[6];
    const struct axis axis = {.interval = interval, .coordinate = coordinate};
    uint32_t p, c;

    brdffit_moments_start(&engine->moments, &m->fit.data, &m->fit.model, m->fit.varpro.kernels);
    brdffit_intervals_start(engine->intervals, &engine->moments, 0, NULL);
    for (p = 0; p < 2; p++) {
        coordinate[2 * p] = s->theta[p][0];
        coordinate[2 * p + 1] = s->theta[p][1];
        s->side[p] = brdffit_interval(engine->intervals, p, &axis);
    }
    for (p = 0; p < 2 && s->refine; p++) {
        double middle = s->theta[p][0] + s->part * (s->theta[p][1] - s->theta[p][0]);
        struct interval *whole = brdffit_interval(engine->intervals, p, &axis);

        coordinate[4 + p] = middle;
        if (s->theta[p][0] < middle && middle < s->theta[p][1] && whole->eighth > 0.0) {
            brdffit_interval_refine(engine->intervals, whole, brdffit_interval(engine->intervals, 2 + 2 * p, &axis),
                                    brdffit_interval(engine->intervals, 3 + 2 * p, &axis));
        }
    }
    sides.side[0] = s->side[0];
    sides.side[1] = s->side[1];
    s->mu_inf = brdffit_pair_least(&sides);
    for (p = 0; p < 2; p++) {
        s->mu_shift[p] = brdffit_pair_shift(&sides, (int)p, s->mu_inf);
    }
    for (c = 0; c < 4; c++) {
        s->mu_corner[c] = brdffit_pair_corner(&sides, (int)c)->mu;
    }
}

static void attack(struct moments_case *m, struct drawn *s, struct brdffit_test_random *random)
{
    int i, p;

    open_sides(m, s);
    for (i = 0; i < POINTS; i++) {
        struct mc_exact e[2];
        long double f[2];
        double theta[2];

        for (p = 0; p < 2; p++) {
            long double low = mc_u(m, s->theta[p][0]), high = mc_u(m, s->theta[p][1]);
            double part = i < 4 ? (double)(i >> p & 1) : brdffit_test_uniform(random, 0.0, 1.0);

            theta[p] = fmin(s->theta[p][0] + part * (s->theta[p][1] - s->theta[p][0]), s->theta[p][1]);
            mc_evaluate(m, theta[p], &e[p]);
            f[p] = high > low ? (e[p].u - low) / (high - low) : 0.0L;
            check_one(m, s->side[p], theta[p], f[p], &e[p]);
            check_curvature(m, s->side[p], theta[p], &e[p]);
        }
        if (theta[0] <= theta[1]) {
            check_mu(m, s, f, e, theta);
        }
    }
}

static void test_enclosures(void **state)
{
    uint64_t seed;
    long done = 0;
    int i;

    (void)state;
    for (seed = 1; done < TRIALS; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        struct drawn s = {.refine = 0};

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        for (i = 0; i < 8 && m.fit.domain[0].low < m.fit.domain[0].high; i++) {
            draw_sides(&m, s.theta, &random);
            s.refine = i % 2;
            s.part = brdffit_test_uniform(&random, 0.05, 0.95);
            attack(&m, &s, &random);
            done += 2 * POINTS;
        }
        mc_free(&m);
    }
    print_message("%ld (interval, point) trials\n", done);
}

/* sum W [(x - mean)^2 + slope] g^ and (E slope + 2 Var x) sum W g^ at a point: their difference is W~''. */
static void exact_curvature(const struct moments_case *m, const struct mc_exact *e, size_t f, long double *part)
{
    long double mean = 0.0L, own = 0.0L;
    size_t i;

    for (i = 0; i < m->count; i++) {
        mean += e->shape[i] * e->shape[i] / e->h * mc_x(m, i, e->u);
    }
    part[0] = part[1] = 0.0L;
    for (i = 0; i < m->count; i++) {
        long double x = mc_x(m, i, e->u), slope = m->ggx ? 0.5L * x * x : 0.0L, d2 = (x - mean) * (x - mean);
        long double shape = mc_weight(m, i, f) * mc_phi(m, i, e->u) / sqrtl(e->h);

        own += e->shape[i] * e->shape[i] / e->h * (slope + 2.0L * d2);
        part[0] += shape * (d2 + slope);
        part[1] += shape;
    }
    part[1] *= own;
}

/* Shifts tend to width^2 / 8 times the second derivative itself: the bounds are of second order, with no waste. */
static void test_shifts_are_second_derivatives(void **state)
{
    struct moments_case m;
    uint64_t seed;
    size_t i;

    (void)state;
    for (seed = 1; seed <= 300; seed++) {
        struct drawn s = {.refine = 0};
        struct mc_exact e;
        long double part[2], norm = 0.0L;
        double middle;

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        middle = 0.6 * m.fit.domain[0].low + 0.4 * m.fit.domain[0].high;
        s.theta[0][0] = s.theta[1][0] = middle * (1.0 - 1e-7);
        s.theta[0][1] = s.theta[1][1] = middle * (1.0 - 1e-7) + 1e-5;
        mc_evaluate(&m, middle, &e);
        open_sides(&m, &s);
        for (i = 0; i < m.count; i++) {
            norm += mc_a(&m, i) * mc_a(&m, i);
        }
        if (s.side[0]->eighth > 0.0) {
            exact_curvature(&m, &e, 0, part);
            within("kappa''", s.side[0]->kappa_shift[0] / s.side[0]->eighth, (part[0] - part[1]) / sqrtl(norm),
                   0.02L * (part[0] + part[1]) / sqrtl(norm));
            exact_curvature(&m, &e, 1, part);
            if (!m.negative) {
                within("-tau''", s.side[0]->tau_shift[0] / s.side[0]->eighth, part[1] - part[0],
                       0.02L * (part[0] + part[1]));
            }
        }
        mc_free(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_enclosures),
        cmocka_unit_test(test_shifts_are_second_derivatives),
    };

    return cmocka_run_group_tests_name("interval", tests, NULL, NULL);
}
