/*
 * The vector form: objective against long double, derivatives against differences of the long double objective,
 * and the descent. SPDX-License-Identifier: MIT
 */
#include "moments_case.h"

/* From here on a model of so many lobes, at most those that the fit was laid out for. */
static void use_lobes(struct moments_case *m, int lobes)
{
    m->options.lobes = lobes;
    brdffit_model_make(&m->fit.model, &m->options);
}

/* ||I_k - A z||^2 over z >= 0, in long double, by Gram-Schmidt on every support. */
struct columns {
    int count;
    long double value[3][MC_SAMPLES], data[MC_SAMPLES];
};

static long double dot(const long double *u, const long double *v, size_t n)
{
    long double sum = 0.0L;
    size_t i;

    for (i = 0; i < n; i++) {
        sum += u[i] * v[i];
    }
    return sum;
}

/* Residual of one support, or -1 when a coefficient is negative or the columns are dependent. */
static long double one_support(const struct columns *c, unsigned support, size_t n)
{
    long double q[3][MC_SAMPLES], r[3][3], t[3], z[3], rest[MC_SAMPLES];
    int m = 0, j, k, pass;
    size_t i;

    memcpy(rest, c->data, sizeof rest);
    for (j = 0; j < c->count; j++) {
        if (!(support & (1u << j))) {
            continue;
        }
        memcpy(q[m], c->value[j], sizeof q[m]);
        memset(r[m], 0, sizeof r[m]);
        for (pass = 0; pass < 2; pass++) {
            for (k = 0; k < m; k++) {
                long double along = dot(q[k], q[m], n);

                for (i = 0; i < n; i++) {
                    q[m][i] -= along * q[k][i];
                }
                r[m][k] += along;
            }
        }
        r[m][m] = sqrtl(dot(q[m], q[m], n));
        if (!(r[m][m] > 1e-17L)) {
            return -1.0L;
        }
        for (i = 0; i < n; i++) {
            q[m][i] /= r[m][m];
        }
        t[m] = dot(q[m], rest, n);
        for (i = 0; i < n; i++) {
            rest[i] -= t[m] * q[m][i];
        }
        m++;
    }
    for (j = m - 1; j >= 0; j--) {
        z[j] = t[j];
        for (k = j + 1; k < m; k++) {
            z[j] -= r[k][j] * z[k];
        }
        z[j] /= r[j][j];
        if (z[j] < 0.0L) {
            return -1.0L;
        }
    }
    return dot(rest, rest, n);
}

/* E^2 at theta, and the support of each channel as one number. */
static long double objective(const struct moments_case *m, const double *theta, int lobes, unsigned long *supports)
{
    struct columns c;
    long double sum = 0.0L;
    size_t i, k;
    int p;

    c.count = 1 + lobes;
    for (p = 0; p <= lobes; p++) {
        long double u = p ? mc_u(m, theta[p - 1]) : 0.0L, norm;

        for (i = 0; i < m->count; i++) {
            c.value[p][i] = p ? mc_b(m, i) * mc_phi(m, i, u) : mc_a(m, i);
        }
        norm = sqrtl(dot(c.value[p], c.value[p], m->count));
        for (i = 0; i < m->count; i++) {
            c.value[p][i] /= norm;
        }
    }
    *supports = 0;
    for (k = 0; k < m->channels; k++) {
        long double best = INFINITY;
        unsigned support, chosen = 0;

        for (i = 0; i < m->count; i++) {
            c.data[i] = mc_value(m, i, k);
        }
        for (support = 0; support < 1u << c.count; support++) {
            long double rss = one_support(&c, support, m->count);

            if (rss >= 0.0L && rss < best) {
                best = rss;
                chosen = support;
            }
        }
        sum += best;
        *supports = *supports * 8 + chosen;
    }
    return sum;
}

static void draw_point(const struct moments_case *m, struct point *at, struct brdffit_test_random *random)
{
    double high = m->fit.domain[0].high;
    int p;

    for (p = 0; p < 2; p++) {
        at->theta[p] = brdffit_test_uniform(random, m->fit.domain[0].low, fmax(fmin(high, 12.0), m->fit.domain[0].low));
    }
}

/* Data that two lobes explain, with noise: supports are then stable, as they are near an optimum. */
static void lobes_new(struct moments_case *m, uint64_t seed, double noise, struct point *truth)
{
    struct brdffit_test_random random = {seed * 31 + 1};
    struct arena arena;
    size_t i, k;

    mc_new(m, 1);
    mc_free(m);
    m->ggx = (int)(seed % 2);
    m->options.distribution = m->ggx ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
    m->count = 40;
    m->channels = 3;
    for (i = 0; i < m->count; i++) {
        m->a[i] = brdffit_test_uniform(&random, 0.16, 0.32);
        m->b[i] = brdffit_test_uniform(&random, 0.3, 2.0);
        m->c[i] = pow(tan(0.022 * (double)i), 2.0) + (i ? 0.0 : 1e-7);
    }
    truth->theta[0] = -2.0 * log(brdffit_test_uniform(&random, 0.3, 0.5));
    truth->theta[1] = -2.0 * log(brdffit_test_uniform(&random, 0.06, 0.15));
    m->c_min = 1e-7L;
    for (i = 0; i < m->count; i++) {
        for (k = 0; k < 3; k++) {
            long double sum = m->a[i] * (0.5 + 0.1 * (double)k);
            int p;

            for (p = 0; p < 2; p++) {
                sum += (0.3 + 0.2 * (double)(k + (size_t)p)) * m->b[i] * mc_phi(m, i, mc_u(m, truth->theta[p]));
            }
            m->values[3 * i + k] = (double)sum * (1.0 + noise * brdffit_test_normal(&random));
        }
    }
    m->samples = brdffit_test_coefficients(m->count, 3, m->a, m->b, m->c, m->values);
    i = brdffit_workspace_size(m->count, 3, &m->options);
    m->workspace = malloc(i);
    assert_non_null(m->workspace);
    brdffit_arena_init(&arena, m->workspace, i);
    brdffit_fit_layout(&m->fit, &arena, m->count, 3, &m->options);
    assert_int_equal(brdffit_reduce(&m->fit.data, &m->samples, &m->fit.model, &m->options, NULL), BRDFFIT_OK);
    brdffit_fit_prepare(&m->fit, &m->options);
    assert_true((long double)m->fit.data.table[0].c_min == (long double)m->c[0]);
    m->c_min = (long double)m->c[0];
}

/* Columns and data carry a few units each: so does the residual, and the objective twice that times its norm. */
static void check_objective(struct moments_case *m, const struct point *at, int lobes)
{
    struct varpro_value value;
    unsigned long supports;
    long double exact = objective(m, at->theta, lobes, &supports), exponent = 1.0L, off;
    size_t i;

    use_lobes(m, lobes);
    brdffit_varpro_evaluate(&m->fit.varpro, at, 0, &value);
    for (i = 0; i < m->count && !m->ggx; i++) {
        long double x = mc_u(m, at->theta[0]) * ((long double)m->c[i] - m->c_min);

        exponent = fmaxl(exponent, fminl(x, 40.0L));
    }
    off = 64.0L * exponent * TOL_UNIT * sqrtl((long double)m->fit.data.total);
    if (!(fabsl(sqrtl((long double)value.objective) - sqrtl(exact)) <= off)) {
        brdffit_test_print(&m->samples, &m->options);
        fail_msg("objective %.17g, exactly %.17Lg, at %a %a, %d lobes", value.objective, exact, at->theta[0],
                 at->theta[1], lobes);
    }
    assert_true(value.kkt >= 0.0 && value.kkt <= 1e-13);
}

static void test_objective(void **state)
{
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= 600; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        struct point at;

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        for (i = 0; i < 10; i++) {
            draw_point(&m, &at, &random);
            check_objective(&m, &at, 1 + i % 2);
        }
        mc_free(&m);
    }
}

static int supports_stable(const struct moments_case *m, const double *theta, int lobes, double step)
{
    unsigned long here, there;
    int i, j;

    (void)objective(m, theta, lobes, &here);
    for (i = -2; i <= 2; i++) {
        for (j = -2; j <= 2; j++) {
            double moved[2] = {theta[0] + i * step, theta[1] + j * step};

            (void)objective(m, moved, lobes, &there);
            if (there != here) {
                return 0;
            }
        }
    }
    return 1;
}

/* Differences of the long double objective: error about step^4 times sixth derivatives, and 1e-19 / step^2. */
static void check_derivatives(struct moments_case *m, const struct point *at, int lobes, double step)
{
    long double e[5][5], total = (long double)m->fit.data.total;
    struct varpro_value value;
    unsigned long ignored;
    int i, j, p, q;

    use_lobes(m, lobes);
    brdffit_varpro_evaluate(&m->fit.varpro, at, 1, &value);
    for (i = -2; i <= 2; i++) {
        for (j = -2; j <= 2; j++) {
            double moved[2] = {at->theta[0] + i * step, at->theta[1] + j * step};

            e[i + 2][j + 2] = objective(m, moved, lobes, &ignored);
        }
    }
    for (p = 0; p < lobes; p++) {
        long double f[5], first, second;

        for (i = 0; i < 5; i++) {
            f[i] = p ? e[2][i] : e[i][2];
        }
        first = (8.0L * (f[3] - f[1]) - (f[4] - f[0])) / (12.0L * step);
        second = (16.0L * (f[3] + f[1]) - (f[4] + f[0]) - 30.0L * f[2]) / (12.0L * step * step);
        if (!(fabsl(value.gradient[p] - first) <= 1e-8L * total) ||
            !(fabsl(value.hessian[p][p] - second) <= 1e-6L * total)) {
            fail_msg("lobe %d of %d at %a %a: gradient %.12g, by differences %.12Lg; second %.12g, %.12Lg", p, lobes,
                     at->theta[0], at->theta[1], value.gradient[p], first, value.hessian[p][p], second);
        }
    }
    if (lobes > 1) {
        long double mixed = (e[3][3] - e[3][1] - e[1][3] + e[1][1]) / (4.0L * step * step), wide;

        wide = (e[4][4] - e[4][0] - e[0][4] + e[0][0]) / (16.0L * step * step);
        mixed = (4.0L * mixed - wide) / 3.0L;
        for (p = 0, q = 1; p < 2; p++, q--) {
            if (!(fabsl(value.hessian[p][q] - mixed) <= 1e-6L * total)) {
                fail_msg("at %a %a: mixed %.12g, by differences %.12Lg", at->theta[0], at->theta[1],
                         value.hessian[p][q], mixed);
            }
        }
    }
}

/* Both families, one and two lobes, far from the optimum and near it. */
static void test_derivatives(void **state)
{
    uint64_t seed;
    int i, done[3] = {0, 0, 0};

    (void)state;
    for (seed = 1; seed <= 40; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        struct point at, truth;

        lobes_new(&m, seed, seed % 4 ? 0.05 : 0.0, &truth);
        for (i = 0; i < 12; i++) {
            int lobes = 1 + i % 2;

            draw_point(&m, &at, &random);
            if (i % 3 == 0) {
                at.theta[0] = truth.theta[0] + brdffit_test_uniform(&random, -0.3, 0.3);
                at.theta[1] = truth.theta[1] + brdffit_test_uniform(&random, -0.3, 0.3);
            }
            if (fabs(at.theta[0] - at.theta[1]) > 0.3 && supports_stable(&m, at.theta, lobes, 1e-3)) {
                check_derivatives(&m, &at, lobes, 1e-3);
                done[lobes]++;
            }
        }
        mc_free(&m);
    }
    assert_true(done[1] >= 100 && done[2] >= 100);
}

/* ---- descent ------------------------------------------------------------------------------------------ */

static void test_descent_never_worsens(void **state)
{
    uint64_t seed;
    int i, p;

    (void)state;
    for (seed = 1; seed <= 400; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        for (i = 0; i < 6; i++) {
            struct point at, before;
            struct varpro_value value, after;
            double objective_there;

            use_lobes(&m, 1 + i % 2);
            draw_point(&m, &at, &random);
            before = at;
            brdffit_varpro_evaluate(&m.fit.varpro, &at, 0, &value);
            objective_there = brdffit_varpro_descend(&m.fit.varpro, &at);
            assert_true(objective_there <= value.objective);
            for (p = 0; p < m.fit.model.lobes; p++) {
                assert_true(at.theta[p] >= m.fit.domain[0].low && at.theta[p] <= m.fit.domain[0].high);
                assert_true(at.theta[p] <= m.fit.domain[0].high || at.theta[p] == before.theta[p]);
            }
            brdffit_varpro_evaluate(&m.fit.varpro, &at, 0, &after);
            assert_true(after.objective == objective_there);
        }
        mc_free(&m);
    }
}

/* Data without noise: sigma to 1e-9 from a start some way off. */
static void test_descent_finds_exact_roughness(void **state)
{
    uint64_t seed;
    int p;

    (void)state;
    for (seed = 1; seed <= 60; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        struct point at, truth;
        double found;

        lobes_new(&m, seed, 0.0, &truth);
        use_lobes(&m, 2);
        for (p = 0; p < 2; p++) {
            at.theta[p] = truth.theta[p] + brdffit_test_uniform(&random, -0.4, 0.4);
        }
        found = brdffit_varpro_descend(&m.fit.varpro, &at);
        assert_true(found <= 1e-28 * m.fit.data.total);
        for (p = 0; p < 2; p++) {
            double relative = fabs(expm1(-0.5 * (at.theta[p] - truth.theta[p])));

            if (!(relative <= 1e-9)) {
                fail_msg("seed %u lobe %d: sigma off by %g", (unsigned)seed, p, relative);
            }
        }
        mc_free(&m);
    }
}

/* With noise: where the descent ends inside, the gradient has gone. */
static void test_descent_ends_at_a_stationary_point(void **state)
{
    uint64_t seed;
    int p;

    (void)state;
    for (seed = 1; seed <= 60; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        struct point at, truth;
        struct varpro_value value;

        lobes_new(&m, seed, 0.02, &truth);
        use_lobes(&m, 1 + (int)(seed & 1));
        draw_point(&m, &at, &random);
        (void)brdffit_varpro_descend(&m.fit.varpro, &at);
        brdffit_varpro_evaluate(&m.fit.varpro, &at, 1, &value);
        for (p = 0; p < m.fit.model.lobes; p++) {
            if (at.theta[p] > m.fit.domain[0].low && at.theta[p] < m.fit.domain[0].high) {
                assert_true(fabs(value.gradient[p]) <= 1e-7 * m.fit.data.total);
            }
        }
        mc_free(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_objective),
        cmocka_unit_test(test_derivatives),
        cmocka_unit_test(test_descent_never_worsens),
        cmocka_unit_test(test_descent_finds_exact_roughness),
        cmocka_unit_test(test_descent_ends_at_a_stationary_point),
    };

    return cmocka_run_group_tests_name("varpro", tests, NULL, NULL);
}
