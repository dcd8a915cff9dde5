/*
 * Nodes and pairs against long double: every sum within the rounding that the node states, kappa, tau and mu on
 * their safe sides, for data of any span. SPDX-License-Identifier: MIT
 */
#include "moments_case.h"

#define CASES 1500u

static double draw_theta(const struct moments_case *m, struct brdffit_test_random *random)
{
    switch (brdffit_test_below(random, 4)) {
    case 0: return m->fit.domain[0].low;
    case 1: return m->fit.domain[0].high;
    case 2: /* sigma = 1e-12 or 1e3, whatever the domain */
        return brdffit_test_below(random, 2) ? 55.262042231857095 : -13.815510557964274;
    default: return brdffit_test_uniform(random, m->fit.domain[0].low, m->fit.domain[0].high);
    }
}

static const struct node *node_at(struct moments_case *m, uint32_t index, double theta)
{
    marks_clear(&m->fit.moment.moments.kind[0].ready, index);
    return brdffit_moments_node(&m->fit.moment.moments, 0, index, theta);
}

static const struct pair *pair_of(struct moments *moments, uint32_t first, uint32_t second)
{
    const struct couple couple = {{0, 0}, {first, second}};

    return brdffit_moments_pair(moments, &couple);
}

static void within(const char *what, double got, long double exact, long double allowed)
{
    /* Below 1e-280 terms may have been flushed to zero, which nothing notices. */
    if (!(fabsl((long double)got - exact) <= allowed + 1e-280L)) {
        fail_msg("%s: %.17g, exactly %.17Lg, off by %Lg, allowed %Lg", what, got, exact,
                 fabsl((long double)got - exact), allowed);
    }
}

/* H and every functional's sum: the claim of moments.h. */
static void check_sums(const struct moments_case *m, const struct node *node, const struct mc_exact *e)
{
    size_t f, i;

    within("u", node->u, e->u, 8.0L * TOL_UNIT * e->u);
    within("H", node->h, e->h, node->epsilon * e->h);
    within("root", node->root, sqrtl(e->h), node->epsilon * sqrtl(e->h));
    assert_int_equal(m->fit.data.functionals, 1 + m->channels * (m->fit.data.functionals > 1 + m->channels ? 2 : 1));
    for (f = 0; f < m->fit.data.functionals; f++) {
        long double sum = 0.0L;

        for (i = 0; i < m->count; i++) {
            sum += mc_weight(m, i, f) * mc_phi(m, i, e->u);
        }
        within("sum W phi", node->functional[f].f0, sum, node->epsilon * sum);
    }
}

/*
 * kappa not above, tau not below the truth, and neither further off than the allowance and the same again for the
 * sums' own rounding.
 */
static void check_projections(const struct moments_case *m, const struct node *node, const struct mc_exact *e)
{
    size_t k, i;

    assert_true((long double)node->kappa[0] <= e->kappa);
    assert_true((long double)node->kappa[0] >= e->kappa - 2.0L * node->epsilon);
    for (k = 0; k < m->channels; k++) {
        long double norm = 0.0L;

        for (i = 0; i < m->count; i++) {
            norm += mc_value(m, i, k) * mc_value(m, i, k);
        }
        norm = sqrtl(norm);
        within("|I|", m->fit.moment.moments.norm[k], norm, 100.0L * TOL_UNIT * norm);
        assert_true((long double)node->tau[k] >= e->tau[k]);
        assert_true((long double)node->tau[k] <= e->tau[k] + 2.5L * node->epsilon * norm);
    }
}

/* Moments of x under p and under each W phi, which curvature is made of: TOL_CURVATURE is to cover their rounding. */
static void check_moments(const struct moments_case *m, const struct node *node, const struct mc_exact *e)
{
    long double mean = 0.0L, m2 = 0.0L, m3 = 0.0L, m4 = 0.0L, spread3 = 0.0L;
    size_t i, f;

    for (i = 0; i < m->count; i++) {
        mean += e->shape[i] * e->shape[i] / e->h * mc_x(m, i, e->u);
    }
    within("mean", node->mean, mean, 1e-13L * mean);
    for (i = 0; i < m->count; i++) {
        long double p = e->shape[i] * e->shape[i] / e->h, d = mc_x(m, i, e->u) - mean;

        m2 += p * d * d;
        m3 += p * d * d * d;
        spread3 += p * fabsl(d * d * d);
        m4 += p * d * d * d * d;
    }
    /* x carries rounding u, so d does, absolutely: where x hardly varies, that is what limits. */
    within("m2", node->m2, m2, 1e-12L * m2 + 8.0L * mean * TOL_UNIT * sqrtl(m2) + 16.0L * powl(mean * TOL_UNIT, 2.0L));
    if (!m->ggx) {
        long double floor = mean * TOL_UNIT + sqrtl(m2);

        within("m3", node->m3, m3, 1e-12L * spread3 + 16.0L * mean * TOL_UNIT * floor * floor);
        within("m4", node->m4, m4, 1e-12L * m4 + 16.0L * mean * TOL_UNIT * powl(floor + powl(m4, 0.25L), 3.0L));
    }
    for (f = 0; f < m->fit.data.functionals; f++) {
        long double f0 = 0.0L, f1 = 0.0L, f2 = 0.0L, spread = 0.0L, off;

        for (i = 0; i < m->count; i++) {
            long double w = mc_weight(m, i, f) * mc_phi(m, i, e->u), d = mc_x(m, i, e->u) - (long double)node->mean;

            f0 += w;
            f1 += w * d;
            f2 += w * d * d;
            spread += w * fabsl(d);
        }
        off = 4.0L * mean * TOL_UNIT;
        within("f1", node->functional[f].f1, f1, 1e-12L * spread + off * f0);
        within("f2", node->functional[f].f2, f2, 1e-12L * f2 + off * (2.0L * spread + off * f0));
    }
}

static void test_nodes(void **state)
{
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= CASES; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        brdffit_moments_start(&m.fit.moment.moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
        for (i = 0; i < 6; i++) {
            double theta = draw_theta(&m, &random);
            const struct node *node = node_at(&m, (uint32_t)i, theta);
            struct mc_exact e;

            mc_evaluate(&m, theta, &e);
            check_sums(&m, node, &e);
            check_projections(&m, node, &e);
            check_moments(&m, node, &e);
        }
        mc_free(&m);
    }
}

static void test_omega(void **state)
{
    uint64_t seed;
    size_t i, k;

    (void)state;
    for (seed = 1; seed <= CASES; seed++) {
        struct moments_case m;
        long double aa = 0.0L;

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        brdffit_moments_start(&m.fit.moment.moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
        for (i = 0; i < m.count; i++) {
            aa += mc_a(&m, i) * mc_a(&m, i);
        }
        for (k = 0; k < m.channels; k++) {
            const struct moments *moments = &m.fit.moment.moments;
            long double omega = 0.0L;

            for (i = 0; i < m.count; i++) {
                omega += mc_a(&m, i) * mc_value(&m, i, k) / sqrtl(aa);
            }
            assert_true((long double)moments->omega[0][k] >= omega);
            assert_true((long double)moments->omega[0][k] <= omega + 2.0L * moments->epsilon * moments->norm[k]);
        }
        mc_free(&m);
    }
}

static void check_pair(const struct moments_case *m, const struct pair *pair, double theta_p, double theta_q)
{
    const struct node *node = m->fit.moment.moments.kind[0].node;
    double epsilon = fmax(node[pair->first].epsilon, node[pair->second].epsilon);
    struct mc_exact p, q;
    long double value = 0.0L, mean = 0.0L, variance = 0.0L, mu, exponent;
    size_t i;

    mc_evaluate(m, theta_p, &p);
    mc_evaluate(m, theta_q, &q);
    mu = mc_mu(m, &p, &q);
    assert_true((long double)pair->mu <= mu);
    for (i = 0; i < m->count; i++) {
        value += p.shape[i] * q.shape[i];
        mean += p.shape[i] * q.shape[i] * ((long double)m->c[i] - m->c_min);
    }
    mean /= value;
    exponent = m->ggx ? 4.0L : mean * (p.u + q.u);
    within("mu", pair->mu, mu, 2.0L * epsilon + 8.0L * TOL_UNIT * (exponent + 1.0L));
    within("pair", pair->value, value, (2.0L * epsilon + 4.0L * TOL_UNIT * exponent) * value);
    if (m->ggx) {
        return; /* mean and variance of c' are for exponential families only */
    }
    for (i = 0; i < m->count; i++) {
        long double d = (long double)m->c[i] - m->c_min - mean;

        variance += p.shape[i] * q.shape[i] / value * d * d;
    }
    within("pair mean", pair->mean, mean, 1e-13L * mean);
    within("pair variance", pair->variance, variance,
           1e-12L * variance + 8.0L * mean * TOL_UNIT * (sqrtl(variance) + 2.0L * mean * TOL_UNIT));
}

static void test_pairs(void **state)
{
    uint64_t seed;
    uint32_t i, j;

    (void)state;
    for (seed = 1; seed <= CASES / 3; seed++) {
        struct brdffit_test_random random = {seed};
        struct moments_case m;
        double theta[5];

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        brdffit_moments_start(&m.fit.moment.moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
        for (i = 0; i < 5; i++) {
            theta[i] = draw_theta(&m, &random);
            (void)brdffit_moments_node(&m.fit.moment.moments, 0, i, theta[i]);
        }
        for (i = 0; i < 5; i++) {
            for (j = 0; j < 5; j++) {
                check_pair(&m, pair_of(&m.fit.moment.moments, i, j), theta[i], theta[j]);
            }
        }
        mc_free(&m);
    }
}

/* A pair that another pushed out of the cache comes back with the same bits. */
static void test_pair_cache(void **state)
{
    struct moments_case m;
    struct moments *moments = &m.fit.moment.moments;
    struct pair first[80];
    uint32_t i, j;

    (void)state;
    mc_new(&m, 3);
    brdffit_moments_start(moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
    for (i = 0; i < 80; i++) {
        (void)brdffit_moments_node(moments, 0, i, -5.0 + 0.1 * i);
        first[i] = *pair_of(moments, i, 79 - i < i ? 79 - i : i);
    }
    for (i = 0; i < 80; i++) {
        for (j = 0; j < 80; j++) {
            const struct pair *pair = pair_of(moments, i, j);

            assert_true(pair->first == i && pair->second == j);
        }
    }
    for (i = 0; i < 80; i++) {
        const struct pair *pair = pair_of(moments, first[i].first, first[i].second);

        assert_true(pair->mu == first[i].mu && pair->value == first[i].value && pair->mean == first[i].mean);
    }
    assert_int_equal(moments->evaluated, 80);
    mc_free(&m);
}

/* Shapes kept or computed again: the same bits. */
static void test_shapes_not_kept(void **state)
{
    uint64_t seed;
    uint32_t i;

    (void)state;
    for (seed = 1; seed <= 60; seed++) {
        struct moments_case m;
        struct moments *moments = &m.fit.moment.moments;
        struct node kept[2];
        struct pair pair;
        double tau[2], kappa[2]; /* copies: a node's own are recomputed where they are */

        mc_new(&m, seed);
        if (mc_without_lobes(&m)) {
            mc_free(&m);
            continue;
        }
        brdffit_moments_start(moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
        for (i = 0; i < 2; i++) {
            kept[i] = *brdffit_moments_node(moments, 0, i, -1.0 + 4.0 * i);
            tau[i] = kept[i].tau[0];
            kappa[i] = kept[i].kappa[0];
            assert_non_null(kept[i].phi);
        }
        pair = *pair_of(moments, 0, 1);
        moments->kind[0].phi_doubles = 0;
        brdffit_moments_start(moments, &m.fit.data, &m.fit.model, m.fit.varpro.kernels);
        for (i = 0; i < 2; i++) {
            const struct node *node = brdffit_moments_node(moments, 0, i, -1.0 + 4.0 * i);

            assert_null(node->phi);
            assert_true(node->h == kept[i].h && node->kappa[0] == kappa[i] && node->m2 == kept[i].m2);
            assert_true(node->tau[0] == tau[i]);
        }
        assert_true(pair_of(moments, 0, 1)->mu == pair.mu);
        mc_free(&m);
    }
}

/* u and its derivatives by theta for any c_min that is accepted: right, and rising. */
static void test_family_variable(void **state)
{
    static const double c_min[] = {0.0, 1e-300, 1e-12, 1.0, 1e6, 1e30, 1e60, 1e90, LIMIT_C};
    const struct lobe_kind *family[2] = {&brdffit_lobe_beckmann, &brdffit_lobe_ggx};
    size_t i, f;

    (void)state;
    for (f = 0; f < 2; f++) {
        for (i = 0; i < sizeof c_min / sizeof c_min[0]; i++) {
            double theta, before = 0.0;

            for (theta = -13.8; theta <= 55.27; theta += 0.13) {
                long double s = expl((long double)theta), p = f ? c_min[i] * s : 0.0L;
                double u[3];

                family[f]->variable(&(struct lobe_sight){.c_min = c_min[i]}, theta, u);
                if (!(u[0] > 0.0)) {
                    fail_msg("family %zu, c_min %g, theta %g: u = %g", f, c_min[i], theta, u[0]);
                }
                within("u", u[0], s / (1.0L + p), 8.0L * TOL_UNIT * s / (1.0L + p));
                within("u'", u[1], s / powl(1.0L + p, 2.0L), 16.0L * TOL_UNIT * s / powl(1.0L + p, 2.0L));
                within("u''", u[2], s * (1.0L - p) / powl(1.0L + p, 3.0L), 32.0L * TOL_UNIT * s / powl(1.0L + p, 2.0L));
                assert_true(u[0] >= before * (1.0 - 8.0 * TOL_UNIT));
                before = u[0];
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nodes),           cmocka_unit_test(test_omega),
        cmocka_unit_test(test_pairs),           cmocka_unit_test(test_pair_cache),
        cmocka_unit_test(test_shapes_not_kept), cmocka_unit_test(test_family_variable),
    };

    return cmocka_run_group_tests_name("moments", tests, NULL, NULL);
}
