/*
 * The vector form, and descent in moment space, for any list of one to three lobes: objective against long double,
 * derivatives against its differences, descents that never worsen. SPDX-License-Identifier: MIT
 */
#include "bound/moment/descend.h"
#include "lobes_case.h"

static void draw_theta(const struct lobes_case *m, struct point *at, uint64_t *s)
{
    int p;

    memset(at, 0, sizeof *at);
    for (p = 0; p < m->lobes; p++) {
        const struct domain *d = fit_domain(&m->fit, p);
        double high = fmin(d->high, d->low + 16.0);

        at->theta[p] = case_next(s) % 2 ? d->low + (high - d->low) * case_uniform(s)
                                        : lc_clamp(m->true_theta[p] + 0.3 * case_signed(s), d->low, d->high);
    }
}

/* Columns and data carry a few units each, and exponents times that: so does the residual. */
static long double allowed_root(const struct lobes_case *m, const struct point *at)
{
    long double exponent = 1.0L;
    size_t i;
    int p;

    for (p = 0; p < m->lobes; p++) {
        for (i = 0; i < m->count && !m->ggx[p]; i++) {
            if (m->row_b[p][i] > 0.0L) {
                exponent = fmaxl(exponent, fminl(expl((long double)at->theta[p]) * m->row_c[p][i], 40.0L));
            }
        }
    }
    return 64.0L * exponent * TOL_UNIT * sqrtl((long double)m->fit.data.total);
}

static void test_objective(void **state)
{
    static struct lobes_case m;
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= 1500; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            for (i = 0; i < 8; i++) {
                struct varpro_value value;
                struct point at;
                long double exact;

                draw_theta(&m, &at, &s);
                brdffit_varpro_evaluate(&m.fit.varpro, &at, 0, &value);
                exact = lc_objective(&m, at.theta);
                if (!(fabsl(sqrtl((long double)value.objective) - sqrtl(exact)) <= allowed_root(&m, &at))) {
                    brdffit_test_print(&m.samples, &m.options);
                    fail_msg("seed %u: objective %.17g, exactly %.17Lg at %a %a %a (total %g)", (unsigned)seed,
                             value.objective, exact, at.theta[0], at.theta[1], at.theta[2], m.fit.data.total);
                }
                /* A column along which the residual has slope g would gain g^2: less than the rounding of a sum of squares
                 * does not decide between supports (weights of 1e-12 beside 1e12 make such columns). */
                if (!(value.kkt >= 0.0 &&
                      (value.kkt <= 1e-13 ||
                       (m.samples.weights &&
                        value.kkt * value.kkt <= 16.0 * TOL_UNIT * (value.objective / m.fit.data.total))))) {
                    brdffit_test_print(&m.samples, &m.options);
                    fail_msg("seed %u: KKT residual %g at %a %a %a", (unsigned)seed, value.kkt, at.theta[0],
                             at.theta[1], at.theta[2]);
                }
            }
        }
        lc_close(&m);
    }
}

/* ---- Derivatives -------------------------------------------------------------------------------------------- */

static long double moved(const struct lobes_case *m, const struct point *at, int p, double up, int q, double up_too)
{
    struct point there = *at;

    there.theta[p] += up;
    there.theta[q] += up_too;
    return lc_objective(m, there.theta);
}

/* First and second differences of fourth order along side p, the mixed one of second order for q != p. */
static void differences(const struct lobes_case *m, const struct point *at, int p, int q, double h, long double *first,
                        long double *second)
{
    long double f0 = lc_objective(m, at->theta);

    if (p == q) {
        long double a = moved(m, at, p, h, p, 0.0), b = moved(m, at, p, -h, p, 0.0);
        long double c = moved(m, at, p, 2.0 * h, p, 0.0), d = moved(m, at, p, -2.0 * h, p, 0.0);

        *first = (8.0L * (a - b) - (c - d)) / (12.0L * h);
        *second = (16.0L * (a + b) - (c + d) - 30.0L * f0) / (12.0L * h * h);
    } else {
        *first = 0.0L;
        *second = (moved(m, at, p, h, q, h) - moved(m, at, p, h, q, -h) - moved(m, at, p, -h, q, h) +
                   moved(m, at, p, -h, q, -h)) /
                  (4.0L * h * h);
    }
}

/* Which coefficients are used, of all channels. */
static unsigned long supports_at(struct lobes_case *m, struct point at, int p, double up)
{
    struct varpro_value value;
    unsigned long supports = 0;
    size_t k;

    at.theta[p] += up;
    brdffit_varpro_evaluate(&m->fit.varpro, &at, 0, &value);
    for (k = 0; k < m->channels; k++) {
        supports = supports * (1u << LC_COLUMNS) + m->fit.varpro.answer[k].support;
    }
    return supports;
}

/* Whether they are the same on both sides, a few steps away: where one changes, second derivatives jump. */
static int same_supports(struct lobes_case *m, const struct point *at, double reach)
{
    unsigned long here = supports_at(m, *at, 0, 0.0);
    int p, same = 1;

    for (p = 0; p < m->lobes; p++) {
        same = same && supports_at(m, *at, p, reach) == here && supports_at(m, *at, p, -reach) == here;
    }
    return same;
}

/* Where two steps agree, supports are stable, and derivatives are what the differences say. Returns whether they do. */
static int check_derivatives(struct lobes_case *m, const struct point *at)
{
    const double h = 1e-3;
    long double total = m->fit.data.total;
    struct varpro_value value;
    int p, q, steady = same_supports(m, at, 8.0 * h);

    brdffit_varpro_evaluate(&m->fit.varpro, at, 1, &value);
    for (p = 0; p < m->lobes && steady; p++) {
        for (q = p; q < m->lobes && steady; q++) {
            long double first[2], second[2], tolerance = (p == q ? 1e-7L : 3e-5L) * total;

            differences(m, at, p, q, h, &first[0], &second[0]);
            differences(m, at, p, q, 2.0 * h, &first[1], &second[1]);
            steady = fabsl(first[0] - first[1]) <= 1e-9L * total && fabsl(second[0] - second[1]) <= tolerance;
            if (!steady) {
                break;
            }
            second[0] = p == q ? second[0] : (4.0L * second[0] - second[1]) / 3.0L;
            if ((p == q && !(fabsl(value.gradient[p] - first[0]) <= 1e-8L * total)) ||
                !(fabsl(value.hessian[p][q] - second[0]) <= tolerance) || value.hessian[p][q] != value.hessian[q][p]) {
                brdffit_test_print(&m->samples, &m->options);
                fail_msg("sides %d, %d of %d at %a %a %a: gradient %.12g, by differences %.12Lg; second %.12g, %.12Lg",
                         p, q, m->lobes, at->theta[0], at->theta[1], at->theta[2], value.gradient[p], first[0],
                         value.hessian[p][q], second[0]);
            }
        }
    }
    return steady;
}

/* Whether lobes are apart, and more samples than columns: else the problem has no derivative that differences see. */
static int resolved(const struct lobes_case *m, const struct point *at)
{
    int p, q, apart = m->count >= 8;

    for (p = 0; p < m->lobes; p++) {
        apart = apart && at->theta[p] > fit_domain(&m->fit, p)->low + 0.01 && at->theta[p] < 11.0;
        for (q = 0; q < p; q++) {
            apart = apart && fabs(at->theta[p] - at->theta[q]) > 0.4;
        }
    }
    return apart;
}

static void test_derivatives(void **state)
{
    static struct lobes_case m;
    long done[LC_LOBES] = {0}, mixed = 0;
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= 1500; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            for (i = 0; i < 6; i++) {
                struct point at;

                draw_theta(&m, &at, &s);
                if (resolved(&m, &at) && check_derivatives(&m, &at)) {
                    done[m.lobes - 1]++;
                    mixed += lc_mixed(&m);
                }
            }
        }
        lc_close(&m);
    }
    print_message("%ld, %ld, %ld points with 1, 2, 3 lobes, %ld of mixed ones\n", done[0], done[1], done[2], mixed);
    assert_true(done[0] > 100 && done[1] > 200 && done[2] > 200 && mixed > 200);
}

/* ---- Descents ----------------------------------------------------------------------------------------------- */

static void check_inside(const struct lobes_case *m, const struct point *at)
{
    int p;

    for (p = 0; p < m->lobes; p++) {
        assert_true(at->theta[p] >= fit_domain(&m->fit, p)->low && at->theta[p] <= fit_domain(&m->fit, p)->high);
    }
}

static void test_descents_never_worsen(void **state)
{
    static struct lobes_case m;
    long in_moments = 0;
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= 900; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            struct varpro *v = &m.fit.varpro;

            brdffit_moments_start(&m.fit.moment.moments, &m.fit.data, &m.fit.model, v->kernels);
            for (i = 0; i < 4; i++) {
                struct varpro_value before, after;
                struct point at;
                double said;

                draw_theta(&m, &at, &s);
                brdffit_varpro_evaluate(v, &at, 0, &before);
                if (model_exponential(&m.fit.model)) {
                    double noise = 4.0 * m.fit.moment.moments.slack;

                    brdffit_moment_descend(&m.fit.moment.moments, &m.fit.model, v->theta_low, v->theta_high, &at);
                    check_inside(&m, &at);
                    brdffit_varpro_evaluate(v, &at, 0, &after);
                    assert_true(after.objective <=
                                before.objective + 1e3 * noise); /* moments lose digits: a hint only */
                    before = after;
                    in_moments++;
                }
                said = brdffit_varpro_descend(v, &at);
                check_inside(&m, &at);
                assert_true(said <= before.objective);
                brdffit_varpro_evaluate(v, &at, 0, &after);
                assert_true(after.objective == said);
            }
        }
        lc_close(&m);
    }
    assert_true(in_moments > 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_objective),
        cmocka_unit_test(test_derivatives),
        cmocka_unit_test(test_descents_never_worsen),
    };

    return cmocka_run_group_tests_name("varpro_lobes", tests, NULL, NULL);
}
